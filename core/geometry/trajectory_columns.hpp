#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/trajectory_file.hpp"
#include "core/text_file.hpp"

namespace stillpoint {

/// Which column of a trajectory file holds what, and how columns are parted.
struct TrajectoryLayout {
  int columns = 8;       ///< a row has
  int time = 0;          ///< column of the stamp, or of its whole seconds; -1 = a pose has none (TartanAir)
  int nanoseconds = -1;  ///< column of what is added to them [ns]; -1 = none
  std::array<int, 3> position = {1, 2, 3};       ///< columns of x, y, z
  std::array<int, 4> quaternion = {4, 5, 6, 7};  ///< columns of x, y, z, w
  QuaternionOrder order = QuaternionOrder::xyzw;
  bool order_is_named = false;  ///< by a header, or by the format
  bool is_matrix = false;       ///< a 3x4 or 4x4 matrix, row by row, behind a stamp or without
  bool decimal_commas = false;
  int header_rows = 0;  ///< 1 where the first line that is no comment names the columns

  /// Puts the quaternion's columns in the other order where they stand side by side.
  void set_order(QuaternionOrder wanted);
  [[nodiscard]] std::vector<std::string_view> split(std::string_view text) const;
  [[nodiscard]] std::optional<double> number(std::string_view text) const;
  /// 13 or 17 columns of a matrix begin with a stamp, 7 of a pose have none.
  [[nodiscard]] bool has_stamps() const;
  /// The columns of stamp, position and quaternion (x y z w), or of the matrix and then its stamp's; that of
  /// nanoseconds comes last. Without a stamp the first one stands for nothing.
  [[nodiscard]] std::vector<int> wanted() const;
  /// What a row should hold, for messages.
  [[nodiscard]] std::string expected() const;
};

/// Finds a file's layout from its header, a comment or the first line, and from how its rows are parted; the
/// TUM format's where nothing says otherwise.
[[nodiscard]] TrajectoryLayout find_layout(const std::vector<TextLine>& lines,
                                           const std::vector<TextLine>& comments);

}  // namespace stillpoint
