#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace stillpoint {

struct FrameView;
struct PairGeometry;

// What every layer of a frame says at one point of the scene: the inspector's table, without GL or ImGui.

/// One layer.
struct Reading {
  std::string name;     ///< "Difference": without the point, the same for every point of a frame
  std::string value;    ///< with its unit; "–" where the layer has nothing there
  bool speaks = false;  ///< it is above its threshold, in the mask, …: worth an eye
};

struct ReadingGroup {
  std::string title;
  std::vector<Reading> readings;
};

/// Groups and names depend on the frame alone, so that several points stand side by side in a table.
/// @param target px of frame t, the middle of pixel (i, j) is (i, j)
[[nodiscard]] std::vector<ReadingGroup> read_point(const FrameView& view, const PairGeometry& pair,
                                                   const Eigen::Vector2d& target);

}  // namespace stillpoint
