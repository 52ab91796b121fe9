#pragma once

#include <functional>
#include <vector>

#include "core/odometry/direct_patches.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

/// A frame to be aligned.
struct DirectTarget {
  cv::Mat gray;    ///< CV_8UC1
  cv::Mat depth;   ///< CV_32FC1, m; empty where there is none: then depth checks nothing
  cv::Mat moving;  ///< small mask of what is classified as dynamic in it; empty when nothing is
  /// Which way the camera goes while the rows are exposed, by the pose that is tried: of one second,
  /// log(now_from_before). Null where all rows are exposed at once.
  std::function<Vector6d(const Pose& target_from_reference)> velocity;
};

struct DirectAlignment {
  Pose target_from_reference = Pose::Identity();
  /// JᵀWJ over the squared noise, of a perturbation from the left, translation first; a patch's pixels, which
  /// tell nearly the same, weighted by direct.pixel_share.
  Matrix6d information = Matrix6d::Zero();
  double gain = 1.0, bias = 0.0;  ///< of the target's grey levels against the reference's
  double noise = 0.0;             ///< grey levels, standard deviation of residuals at the finest level
  DirectRecord record;            ///< without reference_frame and share; says whether the checks are passed
};

/// Sparse direct alignment: the pose under which small patches about places with known depth look alike in
/// both frames. Inverse compositional Gauss-Newton on a pyramid, coarse to fine (Baker & Matthews 2004;
/// Forster et al. 2014), Student's t weights (Kerl et al. 2013), gain and bias of brightness estimated beside
/// the pose. It begins from the best of `starts` and of turns about the last of them, which are all tried at
/// the coarsest level.
///
/// An exposure during which the camera moves evenly blurs a patch to both sides alike, so that alignment
/// stays true where corners are gone.
/// @param starts target_from_reference, at least one: the likeliest first
/// @return not believed when patches are too few, do not look alike, or lie at other depths than measured
[[nodiscard]] DirectAlignment align_directly(const DirectReference& reference, const DirectTarget& target,
                                             const std::vector<Pose>& starts, const Camera& camera,
                                             const Config& config);

}  // namespace stillpoint
