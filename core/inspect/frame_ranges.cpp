#include "core/inspect/frame_ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <set>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr int kSmallestSide = 16, kLargestSide = 16384;  // px, as Offscreen has them

std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

[[noreturn]] void refuse(std::string_view option, std::string_view text) {
  throw InputError(fmt::format("{} {}: expected frames like 10, 20:40:5 or -1, with commas between", option,
                               in_quotes(text)));
}

int number_or(std::string_view part, int otherwise, std::string_view option, std::string_view whole) {
  if (part.empty()) return otherwise;
  const auto number = whole_number(part);
  if (!number) refuse(option, whole);
  return *number;
}

void add_range(std::string_view option, std::string_view part, int count, std::set<int>& frames) {
  const auto pieces = split(part, ':');
  if (pieces.size() > 3 || part.empty()) refuse(option, part);
  const auto from_end = [count](int frame) { return frame < 0 ? count + frame : frame; };
  if (pieces.size() == 1) {
    const int frame = from_end(number_or(part, 0, option, part));
    if (frame < 0 || frame >= count)
      throw InputError(fmt::format("{} {}: the sequence has frames 0 to {}", option, part, count - 1));
    frames.insert(frame);
    return;
  }
  const int begin = from_end(number_or(pieces[0], 0, option, part));
  const int end = std::min(from_end(number_or(pieces[1], count, option, part)), count);
  const int step = pieces.size() == 3 ? number_or(pieces[2], 1, option, part) : 1;
  if (step < 1) refuse(option, part);
  if (begin < 0 || begin >= end)
    throw InputError(fmt::format("{} {}: names none of the frames 0 to {}", option, part, count - 1));
  // 64 bits: a long step leads beyond the last int.
  for (std::int64_t frame = begin; frame < end; frame += step) frames.insert(static_cast<int>(frame));
}

}  // namespace

std::vector<int> parse_frame_ranges(std::string_view text, int frame_count, std::string_view option) {
  std::set<int> frames;
  for (const std::string_view part : split(text, ',')) add_range(option, part, frame_count, frames);
  return {frames.begin(), frames.end()};
}

std::pair<int, int> parse_size(std::string_view text) {
  const auto parts = split(text, 'x');
  const auto width = parts.size() == 2 ? whole_number(parts[0]) : std::nullopt;
  const auto height = parts.size() == 2 ? whole_number(parts[1]) : std::nullopt;
  const auto fits = [](int side) { return side >= kSmallestSide && side <= kLargestSide; };
  if (!width || !height || !fits(*width) || !fits(*height))
    throw InputError(fmt::format("--size {}: expected WIDTHxHEIGHT, each {} to {} px, like 1600x900",
                                 in_quotes(text), kSmallestSide, kLargestSide));
  return {*width, *height};
}

std::vector<std::string> split_list(std::string_view text) {
  std::vector<std::string> names;
  for (std::string_view part : split(text, ',')) {
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
    if (!part.empty()) names.emplace_back(part);
  }
  return names;
}

std::vector<std::string> split_names(std::string_view text) {
  // No text that is typed has this letter.
  constexpr char kKept = '\x1f';
  std::string kept;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool comma = text.substr(i).starts_with("\\,");
    kept += comma ? kKept : text[i];
    if (comma) ++i;
  }
  std::vector<std::string> names = split_list(kept);
  for (std::string& name : names) std::replace(name.begin(), name.end(), kKept, ',');
  return names;
}

}  // namespace stillpoint
