#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// Frames as a person names them: "10", "20:40:5" (20, 25, 30, 35: the end is not among them), "5:", ":3",
/// and several of these with commas between. Negative numbers count from the end: -1 is the last frame.
/// @param option what they were given to, for messages
/// @returns the frames in ascending order, each once
/// @throws InputError in one sentence for what cannot be read, and for frames that are not there
[[nodiscard]] std::vector<int> parse_frame_ranges(std::string_view text, int frame_count,
                                                  std::string_view option = "--frames");

/// "1600x900" as width and height in px.
/// @throws InputError for anything else, or a side that is not between 16 and 16384
[[nodiscard]] std::pair<int, int> parse_size(std::string_view text);

/// What stands between commas, blanks around it taken off; nothing for an empty text.
[[nodiscard]] std::vector<std::string> split_list(std::string_view text);

/// The same of names that people choose: a comma within one is written \,.
[[nodiscard]] std::vector<std::string> split_names(std::string_view text);

}  // namespace stillpoint
