#pragma once

#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "core/run/frame_figures.hpp"

namespace stillpoint {

/// A condition that cannot be read: what() is one sentence that names the column.
class ConditionError : public InputError {
 public:
  ConditionError(const std::string& what, int column) : InputError(what), column_(column) {}
  [[nodiscard]] int column() const { return column_; }  ///< from 0, into the text

 private:
  int column_;
};

/// A condition over what a run records of each frame: `rpe > 5 cm || inliers < 30`.
///
///   condition  = and { "||" and };  and = not { "&&" not };  not = "!" not | comparison
///   comparison = sum [ ( "<" | "<=" | ">" | ">=" | "==" | "!=" ) sum ]
///   sum        = product { ( "+" | "-" ) product };  product = factor { ( "*" | "/" ) factor }
///   factor     = "-" factor | number [ unit ] | name | "(" condition ")"
///              | "abs(x)" | "previous(x)" | "change(x)" | "spike(x, sigmas)"
///
/// `and`, `or` and `not` do as well. Names are those of frame_figure_infos(); units are m, cm, mm, deg, px,
/// ms, s and %. A plain number takes the unit of what it is compared with. previous(x) is x of the frame
/// before, change(x) is x - previous(x). spike(x, n) holds where x lies more than n standard deviations off
/// the median of the 60 frames before (robustly: 1.4826 times their median deviation), once there are 8.
/// What is not known is not a number: each comparison with it is false.
class Condition {
 public:
  /// @throws ConditionError
  explicit Condition(std::string_view text);

  [[nodiscard]] bool holds(const FrameFigures& figures, int row) const;
  /// Indices of the frames at which it holds, ascending.
  [[nodiscard]] std::vector<int> frames(const FrameFigures& figures) const;
  /// Names in it of figures that no frame has, such as errors without ground truth: no comparison with them
  /// holds. None as long as there are no frames.
  [[nodiscard]] std::vector<std::string_view> unknown_figures(const FrameFigures& figures) const;
  /// How near the figures in it come over these frames, for a condition that holds at none of them:
  /// "rpe from 0.8 mm (frame 5) to 7.2 mm (frame 2); lost at none; none has mask_iou".
  [[nodiscard]] std::string reach(const FrameFigures& figures, const std::vector<int>& among) const;
  /// What it is made of, indices into frame_figure_infos(): all it asks of FrameFigures.
  [[nodiscard]] const std::set<int>& figures() const { return columns_; }
  /// The text it was read from.
  [[nodiscard]] const std::string& text() const { return text_; }

  struct Node;

 private:
  std::string text_;
  std::shared_ptr<const Node> root_;
  std::set<int> columns_;  // of FrameFigures that it names
};

/// "12-15, 40": frames as people read them, neighbours joined.
[[nodiscard]] std::string frames_text(const std::vector<int>& frames);

/// How conditions are written and the names they know, for a terminal.
[[nodiscard]] std::string condition_help();

}  // namespace stillpoint
