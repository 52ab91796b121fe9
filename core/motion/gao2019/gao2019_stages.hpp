#pragma once

#include <memory>
#include <optional>

#include "core/motion/feature_pose.hpp"
#include "core/motion/gao2019/block_motion.hpp"
#include "core/motion/gao2019/sparse_alignment.hpp"
#include "core/motion/motion_method.hpp"
#include "core/motion/yi2013/grid_motion.hpp"

namespace stillpoint {

/// What of a frame needs no pose.
struct Gao2019Frame {
  int index = -1;
  AlignmentPyramid pyramid;
  std::vector<AlignmentPoint> corners;
  std::vector<cv::Mat> filtered;  ///< pyramid of the median-filtered frame, for the grid flow
  Yi2013Blocks blocks;
  cv::Mat depths;  ///< CV_32FC1, m, a value a block
  PixelRays rays;  ///< of the blocks
};

/// What the next frame needs of this one: never changed once it is made, so that copies may share it.
struct Gao2019State {
  std::shared_ptr<const Gao2019Frame> frame;
  /// What the next frame is aligned with: features with depth and a map point that lie in no moving block;
  /// corners outside of these where there are too few.
  std::vector<AlignmentPoint> points;
  Yi2013Model model;
  int frames = 0;  ///< since the model began
};

/// The model's way through a frame.
struct Gao2019Step {
  Yi2013Motion motion;  ///< homography of the grid, for blocks without depth
  Yi2013Model chosen;   ///< the last model in this frame's pixels, before this frame went into it
  double gain = 1.0;    ///< that the warped model was brightened by
  cv::Mat matches;      ///< CV_8UC1 of Yi2013Match
  cv::Mat deviations;   ///< CV_32FC1: max (I - μ)² / σ̃²; NaN where nothing is judged
  cv::Mat moving;       ///< CV_8UC1, a value a block: beyond the limit
  cv::Mat cleaned;      ///< CV_8UC1
  std::shared_ptr<Gao2019State> after;
  double ms_grid = 0.0, ms_warp = 0.0, ms_update = 0.0;
};

/// What method `gao2019` saw of a frame.
struct Gao2019Trace final : MotionTrace {
  std::shared_ptr<const Gao2019State> last;  ///< null where the model begins
  SparseAlignment alignment;
  /// here_from_last of the odometry's first pose; nothing where the last frame has no pose
  std::optional<Pose> by_odometry;
  Pose first = Pose::Identity();  ///< here_from_last that warped the model
  bool aligned = false;           ///< it is the alignment's
  Gao2019Step step;
  cv::Mat mask;
  FeaturePose second;                     ///< from the features that are left
  Pose second_motion = Pose::Identity();  ///< here_from_last of it
  int dropped = 0;                        ///< features with map points in moving blocks
  double ms_align = 0.0, ms_second = 0.0;
};

/// The stages of method `gao2019`: first pose, background model, moving blocks, second pose.
[[nodiscard]] StageLog describe_gao2019(const Frame& frame, const Gao2019Trace& trace,
                                        const Gao2019Config& config);

}  // namespace stillpoint
