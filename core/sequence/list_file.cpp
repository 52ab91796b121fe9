#include "core/sequence/list_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

double read_stamp(const std::string& path, int line, std::string_view text, const char* expected) {
  const auto stamp = parse_number(text);
  if (!stamp || !std::isfinite(*stamp))
    throw InputError(
        fmt::format("{}:{}: found {} as a timestamp, expected {}", path, line, in_quotes(text), expected));
  return *stamp;
}

/// Sorts by time and drops repeated stamps; `key` gives an element's colour entry.
template <typename T, typename Key>
void put_in_order(std::vector<T>& entries, const Key& key, const std::string& path,
                  std::vector<std::string>& warnings) {
  const auto earlier = [&](const T& a, const T& b) { return key(a).timestamp < key(b).timestamp; };
  const auto out_of_order = std::adjacent_find(entries.begin(), entries.end(),
                                               [&](const T& a, const T& b) { return earlier(b, a); });
  if (out_of_order != entries.end()) {
    warnings.push_back(
        fmt::format("{}:{}: the stamp is earlier than the one before it; the list was sorted by time", path,
                    key(*(out_of_order + 1)).line));
    std::stable_sort(entries.begin(), entries.end(), earlier);
  }
  const auto same = [&](const T& a, const T& b) { return key(a).timestamp == key(b).timestamp; };
  const auto repeat = std::adjacent_find(entries.begin(), entries.end(), same);
  if (repeat == entries.end()) return;
  const int line = key(*(repeat + 1)).line;
  const std::size_t before = entries.size();
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
  warnings.push_back(fmt::format("{}:{}: the stamp was there before; {} such line(s) were dropped", path,
                                 line, before - entries.size()));
}

bool lies_in(std::string_view file, std::string_view folder) {
  if (file.starts_with("./")) file.remove_prefix(2);
  return file.starts_with(folder) || file.find(fmt::format("/{}", folder)) != std::string_view::npos;
}

}  // namespace

std::vector<ListEntry> read_list(const std::string& path, std::vector<std::string>& warnings) {
  constexpr const char* kExpected = "a line of 'timestamp filename'";
  std::vector<ListEntry> entries;
  for (const TextLine& line : read_text_lines(path)) {
    const auto columns = split_columns(line.text);
    if (columns.size() < 2)
      throw InputError(
          fmt::format("{}:{}: found {}, expected {}", path, line.number, in_quotes(line.text), kExpected));
    const double stamp = read_stamp(path, line.number, columns[0], kExpected);
    const auto name_at = static_cast<std::size_t>(columns[1].data() - line.text.data());
    entries.push_back({stamp, line.text.substr(name_at), line.number});
  }
  if (entries.empty()) throw InputError(fmt::format("{}: names no images, expected {}", path, kExpected));
  put_in_order(
      entries, [](const ListEntry& e) -> const ListEntry& { return e; }, path, warnings);
  return entries;
}

std::vector<ListedPair> read_associations(const std::string& path, std::vector<std::string>& warnings) {
  constexpr const char* kExpected = "a line of 't_rgb rgb/FILE t_depth depth/FILE'";
  std::vector<ListedPair> pairs;
  for (const TextLine& line : read_text_lines(path)) {
    const auto columns = split_columns(line.text);
    if (columns.size() != 4)
      throw InputError(fmt::format("{}:{}: found {} columns in {}, expected {}", path, line.number,
                                   columns.size(), in_quotes(line.text), kExpected));
    ListEntry first{read_stamp(path, line.number, columns[0], kExpected), std::string(columns[1]),
                    line.number};
    ListEntry second{read_stamp(path, line.number, columns[2], kExpected), std::string(columns[3]),
                     line.number};
    const bool depth_first = lies_in(first.file, "depth") && !lies_in(second.file, "depth");
    if (depth_first) std::swap(first, second);
    pairs.push_back({std::move(first), std::move(second)});
  }
  if (pairs.empty()) throw InputError(fmt::format("{}: names no images, expected {}", path, kExpected));
  put_in_order(
      pairs, [](const ListedPair& p) -> const ListEntry& { return p.colour; }, path, warnings);
  return pairs;
}

bool are_frame_numbers(const std::vector<double>& stamps) {
  constexpr double kMostFrames = 1e6;
  double smallest_step = kMostFrames;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] < 0 || stamps[i] >= kMostFrames || stamps[i] != std::floor(stamps[i])) return false;
    if (i > 0) smallest_step = std::min(smallest_step, stamps[i] - stamps[i - 1]);
  }
  return smallest_step == 1.0;
}

}  // namespace stillpoint
