#include "core/sequence/list_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr std::size_t kFewLines = 4;  // below, a repeat says nothing about a list

/// A line that holds no entry.
class MalformedLine : public InputError {
 public:
  using InputError::InputError;
};

double read_stamp(const std::string& path, int line, std::string_view text, const char* expected) {
  const auto stamp = parse_number(text);
  if (!stamp || !is_stamp(*stamp))
    throw MalformedLine(
        fmt::format("{}:{}: found {} as a timestamp, expected {}", path, line, in_quotes(text), expected));
  return *stamp;
}

/// Whether a first line names columns instead of filling them.
bool is_header(std::string_view text) {
  const std::string lower = lower_case(std::string(text));
  const auto columns = split_columns(lower);
  if (columns.empty() || parse_number(columns[0])) return false;
  return lower.find("time") != std::string::npos || lower.find("stamp") != std::string::npos ||
         lower.find("file") != std::string::npos;
}

/// The entries of a list's lines, one by one by `read`; those it finds malformed are skipped as long as they
/// are few.
template <typename T, typename Read>
std::vector<T> read_lines(const std::string& path, std::string_view text, const char* expected,
                          std::vector<std::string>& warnings, const Read& read) {
  std::vector<TextLine> lines = text_lines(text);
  if (!lines.empty() && is_header(lines.front().text)) lines.erase(lines.begin());
  std::vector<T> entries;
  std::string fault, last_fault;
  std::size_t faults = 0;
  for (const TextLine& line : lines) {
    try {
      entries.push_back(read(line));
      last_fault.clear();
    } catch (const MalformedLine& malformed) {
      if (faults++ == 0) fault = malformed.what();
      last_fault = malformed.what();
    }
  }
  if (entries.empty() && fault.empty())
    throw InputError(fmt::format("{}: names no images, expected {}", path, expected));
  const bool cut_short = faults == 1 && !last_fault.empty() && !entries.empty() &&
                         split_columns(lines.back().text).size() < split_columns(lines.front().text).size();
  if (entries.empty() || (2 * faults >= lines.size() && !cut_short)) throw InputError(fault);
  if (cut_short)
    warnings.push_back(fmt::format("{}; the last line was cut short and skipped", fault));
  else if (faults > 0)
    warnings.push_back(
        fmt::format("{}; {} of {} such were skipped", fault, faults, counted(lines.size(), "line")));
  return entries;
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
  const std::size_t repeats = before - entries.size();
  if (before >= kFewLines && 2 * repeats > before)
    throw InputError(fmt::format(
        "{}:{}: {} of {} stamps are there before: they were written with too few digits to tell frames apart",
        path, line, repeats, before));
  warnings.push_back(fmt::format("{}:{}: the stamp was there before; {} dropped", path, line,
                                 counted(repeats, "such line")));
}

/// Whether a name lies in a folder of depth: `depth/`, `aligned_depth/`, ….
bool lies_in_depth(std::string_view file) {
  const auto end = file.find_last_of("/\\");
  return end != std::string_view::npos && file.substr(0, end).find("depth") != std::string_view::npos;
}

}  // namespace

std::vector<ListEntry> read_list(const std::string& path, std::vector<std::string>& warnings) {
  return read_list(path, read_text(path), warnings);
}

std::vector<ListedPair> read_associations(const std::string& path, std::vector<std::string>& warnings) {
  return read_associations(path, read_text(path), warnings);
}

std::vector<ListEntry> read_list(const std::string& path, std::string_view text,
                                 std::vector<std::string>& warnings) {
  constexpr const char* kExpected = "a line of 'timestamp filename'";
  auto entries = read_lines<ListEntry>(path, text, kExpected, warnings, [&](const TextLine& line) {
    const auto columns = split_columns(line.text);
    if (columns.size() < 2)
      throw MalformedLine(
          fmt::format("{}:{}: found {}, expected {}", path, line.number, in_quotes(line.text), kExpected));
    const double stamp = read_stamp(path, line.number, columns[0], kExpected);
    // A name may hold blanks: it goes on to the end of the line, or to the end of its quotes.
    auto name_at = static_cast<std::size_t>(columns[1].data() - line.text.data());
    if (line.text[name_at - 1] == '"') --name_at;
    std::string name = line.text.substr(name_at);
    if (name.size() > 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    return ListEntry{stamp, std::move(name), line.number};
  });
  put_in_order(
      entries, [](const ListEntry& e) -> const ListEntry& { return e; }, path, warnings);
  return entries;
}

std::vector<ListedPair> read_associations(const std::string& path, std::string_view text,
                                          std::vector<std::string>& warnings) {
  constexpr const char* kExpected = "a line of 't_rgb rgb/FILE t_depth depth/FILE'";
  auto pairs = read_lines<ListedPair>(path, text, kExpected, warnings, [&](const TextLine& line) {
    const auto columns = split_columns(line.text);
    if (columns.size() != 4)
      throw MalformedLine(fmt::format("{}:{}: found {} columns in {}, expected {}", path, line.number,
                                      columns.size(), in_quotes(line.text), kExpected));
    ListedPair pair{
        {read_stamp(path, line.number, columns[0], kExpected), std::string(columns[1]), line.number},
        {read_stamp(path, line.number, columns[2], kExpected), std::string(columns[3]), line.number}};
    if (lies_in_depth(pair.colour.file) && !lies_in_depth(pair.depth.file))
      std::swap(pair.colour, pair.depth);
    return pair;
  });
  put_in_order(
      pairs, [](const ListedPair& p) -> const ListEntry& { return p.colour; }, path, warnings);
  return pairs;
}

}  // namespace stillpoint
