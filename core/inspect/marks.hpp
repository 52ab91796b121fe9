#pragma once

#include <optional>
#include <string>
#include <vector>

namespace stillpoint {

// What a person marks in a sequence.

/// Frames `first` to `last`, both among them.
struct FrameSpan {
  int first = 0, last = 0;
  bool operator==(const FrameSpan&) const = default;
};

/// A frame to come back to.
struct Bookmark {
  int frame = 0;
  std::string note;
  bool operator==(const Bookmark&) const = default;
};

/// A pixel watched from frame to frame.
struct Pin {
  int frame = 0;            ///< where it was set
  double x = 0.0, y = 0.0;  ///< px in that frame; the middle of pixel (i, j) is (i, j)
  std::string name;         ///< "A"
  bool operator==(const Pin&) const = default;
};

/// A corner of an outline.
struct Corner {
  double x = 0.0, y = 0.0;  ///< px; the middle of pixel (i, j) is (i, j)
  bool operator==(const Corner&) const = default;
};

/// What a person drew round a moving object: a closed polygon, three corners or more.
using Outline = std::vector<Corner>;

/// A frame whose truth was drawn by hand: all that moves in it.
struct DrawnFrame {
  int frame = 0;
  std::vector<Outline> movers;  ///< none: nothing moves
  bool operator==(const DrawnFrame&) const = default;
};

/// A condition over what is recorded, and where it holds.
struct Breakpoint {
  std::string expression;  ///< "rpe > 0.05 || inliers < 30"
  bool enabled = true;
  bool operator==(const Breakpoint&) const = default;
};

struct BreakpointView {
  Breakpoint breakpoint;
  std::string error;      ///< one sentence; empty when the expression can be read
  int error_column = 0;   ///< from 0, into the expression
  std::vector<int> hits;  ///< processed frames at which it holds, ascending
  std::string note{};     ///< what it names and no frame processed has, one sentence; empty when nothing
};

}  // namespace stillpoint
