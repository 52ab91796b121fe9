#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// One image named by a list, and the line that names it.
struct ListEntry {
  double timestamp = 0.0;  ///< s, or the frame number where a dataset counts frames
  std::string file;        ///< as written, relative to the folder of the list
  int line = 0;            ///< from 1
};

/// A colour image and its depth image, as `associations.txt` pairs them.
struct ListedPair {
  ListEntry colour, depth;
};

/// Reads `rgb.txt`, `depth.txt` or `mask.txt`: `timestamp filename` a line, parted by blanks, tabs, commas or
/// semicolons, `#` starts a comment, and a first line that names the columns is passed over; the name may
/// hold single blanks. Entries come back by strictly increasing time: lines out of order are sorted and, of
/// equal stamps, the first is kept; a last line that was cut short and single malformed lines are skipped;
/// each is told in `warnings`.
/// @throws InputError with file and line where half of the lines or more are malformed or repeat a stamp, and
/// for a list
///         without entries.
[[nodiscard]] std::vector<ListEntry> read_list(const std::string& path, std::vector<std::string>& warnings);

/// The same of a list whose text is at hand; `path` names it in messages.
[[nodiscard]] std::vector<ListEntry> read_list(const std::string& path, std::string_view text,
                                               std::vector<std::string>& warnings);

/// Reads `associations.txt`: `t_rgb rgb/… t_depth depth/…`, or depth first as ICL-NUIM writes it; the order
/// is told by which name lies in a folder of depth. Sorted and cleared of repeats as read_list does, by the
/// colour stamp.
/// @throws InputError as read_list does.
[[nodiscard]] std::vector<ListedPair> read_associations(const std::string& path,
                                                        std::vector<std::string>& warnings);
[[nodiscard]] std::vector<ListedPair> read_associations(const std::string& path, std::string_view text,
                                                        std::vector<std::string>& warnings);

}  // namespace stillpoint
