#pragma once

#include <opencv2/core.hpp>

#include "core/motion/rgbd_view.hpp"

namespace stillpoint {

/// The camera of a BoardScene.
[[nodiscard]] const Camera& board_camera();

/// A textured wall two metres off, seen by a camera that slides along x; before it a board one metre off.
struct BoardScene {
  double camera_x = 0.0;  // m
  double board_x = 0.0;   // m, of the board's middle in the world
  double board_z = 1.0;   // m
  bool board = true;
  double brightness = 0.0;  // grey levels added to all
  bool relief = false;  // the wall is hilly: before a flat one a board's slide looks like a turn and a step
  double board_pitch = 1.0;  // another one is another picture on the board

  /// @param gray CV_8UC1; @param depth CV_32FC1, m; @param truth CV_8UC1, 255 on the board
  void render(cv::Mat& gray, cv::Mat& depth, cv::Mat* truth = nullptr) const;
  [[nodiscard]] RgbdView view() const;
};

}  // namespace stillpoint
