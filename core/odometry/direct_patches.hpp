#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// A frame that later ones may be aligned with directly: its images, shared, and how they came about. Nothing
/// is computed from them before a frame needs it.
struct DirectReference {
  int frame_index = 0;
  cv::Mat gray;                 ///< CV_8UC1
  cv::Mat depth;                ///< CV_32FC1, m
  std::optional<double> lag{};  ///< s, from the frame's time to depth's stamp; nothing: not to be corrected
  Vector6d velocity = Vector6d::Zero();  ///< of the camera, a second, while the frame was taken
  cv::Mat moving;  ///< CV_8UC1, small, non-zero where anything of a block moves; empty when nothing does
  int reference_keyframe = -1;  ///< its pose hangs on this keyframe's, as the map is adjusted under it
  Pose camera_from_keyframe = Pose::Identity();
};

/// The mask of what is dynamic made small for keeping: a block moves where any of its pixels does.
[[nodiscard]] cv::Mat small_mask(const cv::Mat& mask);
/// Whether a small mask covers a full-size pixel.
[[nodiscard]] bool covers(const cv::Mat& small, const cv::Point2f& pixel);

/// Grey levels of one size after the other, each half the one before; the first is the image itself.
using GreyPyramid = std::vector<cv::Mat>;
[[nodiscard]] GreyPyramid grey_pyramid(const cv::Mat& gray, int coarsest_level);

/// A place of the reference with texture and depth.
struct PatchPoint {
  cv::Point2f pixel;        ///< px, in the image as it is
  Eigen::Vector3d point;    ///< m, in the reference camera, at the time of its middle row
  int column = 0, row = 0;  ///< of the grid of cells: coarse levels take every second or fourth
};

/// At most one place a cell of the image: the steepest brightness within a surface that has depth and does
/// not move. Steepness is asked for relative to the image's own, so that a blurred one has places too.
[[nodiscard]] std::vector<PatchPoint> choose_patches(const DirectReference& reference, const Camera& camera,
                                                     bool rolling_shutter, int cell_px);

}  // namespace stillpoint
