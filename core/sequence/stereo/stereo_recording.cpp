#include "core/sequence/stereo/stereo_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {

std::vector<double> read_times(const FileStore& folder, const std::string& name) {
  std::vector<double> times;
  for (const TextLine& line : text_lines(folder.read_text(name))) {
    const auto number = parse_number(line.text);
    if (!number || !std::isfinite(*number))
      throw InputError(fmt::format("{}:{}: {} is no time, expected one number a line", folder.path_of(name),
                                   line.number, in_quotes(line.text)));
    if (!times.empty() && *number <= times.back())
      throw InputError(fmt::format("{}:{}: {} is no later than the line before", folder.path_of(name),
                                   line.number, line.text));
    times.push_back(*number);
  }
  return times;
}

void stamp_by_times(const std::string& path, const std::vector<double>& times, FolderLists& lists) {
  std::vector<ListEntry>& left = lists.colours.entries;
  // Of as many rows as images the i-th is the i-th's; otherwise an image's number is its row.
  const bool in_order = times.size() == left.size();
  std::vector<double> numbers;
  for (const ListEntry& entry : left) numbers.push_back(entry.timestamp);
  const auto row_of = [&](double number) -> std::size_t {
    if (!in_order) return static_cast<std::size_t>(number);
    return static_cast<std::size_t>(std::lower_bound(numbers.begin(), numbers.end(), number) -
                                    numbers.begin());
  };
  if (!in_order && numbers.back() >= static_cast<double>(times.size()))
    throw InputError(fmt::format("{}: has {} times for {} left images, whose last one is number {:.0f}", path,
                                 times.size(), left.size(), numbers.back()));
  for (ListEntry& entry : lists.depths->entries)
    // A right image without a left one belongs to nothing.
    entry.timestamp = std::binary_search(numbers.begin(), numbers.end(), entry.timestamp)
                          ? times[row_of(entry.timestamp)]
                          : std::numeric_limits<double>::quiet_NaN();
  std::erase_if(lists.depths->entries, [](const ListEntry& entry) { return std::isnan(entry.timestamp); });
  for (std::size_t i = 0; i < left.size(); ++i) left[i].timestamp = times[row_of(numbers[i])];
}

std::optional<StereoRecording> read_stereo_recording(const FileStore& folder, const OpenOptions& options) {
  for (const auto read : {read_euroc, read_kitti, read_tartanair, read_left_right})
    if (auto recording = read(folder, options)) return recording;
  return std::nullopt;
}

}  // namespace stillpoint
