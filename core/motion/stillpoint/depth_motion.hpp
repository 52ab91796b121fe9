#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/motion/regions.hpp"
#include "core/motion/rgbd_view.hpp"
#include "core/motion/stillpoint/stillpoint_config.hpp"

namespace stillpoint {

// What is dynamic, judged where there is depth: every pixel is warped by the camera's own motion into frames
// a moment back and some tenths of a second back, and must be found there, as far away and as bright as it is
// now. What was seen *through* before is moving for certain; so is what the noise of depth and brightness
// cannot explain. Evidence adds up over the frames.

/// An earlier frame to compare with.
struct ReferenceView {
  std::shared_ptr<const RgbdView> view;
  Pose reference_from_current = Pose::Identity();
  bool old = false;     ///< far enough back for slow dynamic objects to have gone somewhere
  int frames_back = 0;  ///< for display
};

/// Least gaps, in frames, to the references of the frame with this index: the near one, and a far one. Two
/// far ones take turns, the older at odd indices: consecutive frames would learn little from both.
[[nodiscard]] inline std::array<int, 2> reference_gaps(const StillpointConfig& config, int frame_index) {
  return {config.near_reference, frame_index % 2 == 0 ? config.far_reference : config.slow_reference};
}

/// The largest of these gaps at any frame.
[[nodiscard]] inline int farthest_reference(const StillpointConfig& config) {
  return std::max({config.near_reference, config.far_reference, config.slow_reference});
}

/// How far a superpixel lies from where the camera's motion alone would have it.
struct SuperpixelMotion {
  cv::Vec2f shift;        ///< px, downsampled image of the reference
  float step = 0.0F;      ///< m, along the reference's optical axis
  float log_odds = 0.0F;  ///< of moving; 0 = says nothing
};

/// What comparing with one reference says of each pixel. Small images, CV_32FC1.
struct ReferenceEvidence {
  ReferenceView reference;  ///< what was compared with
  cv::Mat
      depth_residual;  ///< standard deviations: measured less expected depth there; NaN = cannot be compared
  cv::Mat intensity_residual;  ///< grey levels beyond what gradient explains; NaN = cannot be compared
  cv::Mat log_odds;            ///< of moving; 0 = says nothing
  double registration_error_px =
      0.0;                       ///< downsampled px by which surfaces lie beside their place, estimated too
  double intensity_sigma = 0.0;  ///< grey levels, estimated from this pair
  std::vector<SuperpixelMotion> motions;  ///< one a superpixel; empty where the reference is too young for it
  double ms = 0.0;                        ///< wall time of the comparison; for reading only
};

/// A superpixel of one surface (make_superpixels), and how likely it moves.
struct Superpixel {
  cv::Point2f centre;  ///< px, downsampled image
  float depth = 0.0F;  ///< m
  int pixels = 0;
  float evidence = 0.0F;  ///< mean log-odds of its pixels
  float log_odds = 0.0F;  ///< after smoothing with the neighbours on the same surface
  bool moving = false;
};

/// Two superpixels that touch on one surface, and how many pixels of boundary they share: the weight of their
/// agreement.
struct AdjacencyEdge {
  int a = 0, b = 0;
  int boundary = 0;
};

/// The superpixels of one view.
struct Superpixels {
  cv::Mat labels;  ///< CV_32SC1: the superpixel of each pixel, -1 where there is no depth
  std::vector<Superpixel> all;
  std::vector<AdjacencyEdge> adjacency;  ///< all of them, by a, then b; a < b
};

/// What each step took, ms of wall time. For reading only: no result depends on it.
struct DepthMotionTimes {
  double prior = 0.0;        ///< warping the prior
  double superpixels = 0.0;  ///< the superpixels' judgement
  double mask = 0.0;         ///< painting, cleaning and fitting the outline
};

/// What depth-aware motion detection saw, stage by stage.
struct StillpointTrace {
  std::vector<ReferenceEvidence> references;
  cv::Mat slow;   ///< CV_32FC1 log-odds that superpixels say by how far they shifted or went back
  cv::Mat prior;  ///< CV_32FC1 log-odds from the frame before, warped here, newly observed regions labelled
  cv::Mat log_odds;  ///< CV_32FC1, all evidence and the prior: becomes the next frame's prior
  cv::Mat labels;    ///< CV_32SC1: superpixel of each pixel, -1 = no depth
  std::vector<Superpixel> superpixels;
  cv::Mat small_mask;       ///< CV_8UC1, small
  cv::Mat mask;             ///< CV_8UC1, full size: 255 = moving
  double mask_share = 0.0;  ///< of the frame's pixels, 0 to 1
  std::string note;         ///< why there is no mask; empty when all is well
  DepthMotionTimes ms;
};

/// What the next frame needs of this one.
struct MotionPrior {
  std::shared_ptr<const RgbdView> view;
  cv::Mat log_odds;  ///< CV_32FC1
};

/// A pure function of its arguments.
/// @param superpixels of the current view, as make_superpixels gives them
/// @param references earlier frames with depth; none gives an empty mask and a note
/// @param prior of the frame before, with the motion to it; null where there is none
/// @param full_depth CV_32FC1, m: the frame's own, to which the mask's outline is fitted
/// @param threads above 1, references are compared with beside each other; the result is the same
[[nodiscard]] StillpointTrace detect_depth_motion(const RgbdView& current, Superpixels superpixels,
                                                  const cv::Mat& full_depth,
                                                  const std::vector<ReferenceView>& references,
                                                  const MotionPrior* prior, const Pose& previous_from_current,
                                                  const StillpointConfig& config, int threads = 1);

/// How exact a view's depth is: a Kinect's, but for a stereo pair.
[[nodiscard]] inline DepthNoise depth_noise(const RgbdView& view) {
  return view.camera.depth_noise(kKinectNoise);
}

}  // namespace stillpoint
