#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/lin2017/lin2017_config.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

// Virtual map points of method `lin2017`: features that moved are kept for some frames and go on as they
// went, so that a thing that pauses, or is found anew, stays out of the pose.

using BinaryDescriptor = std::array<std::uint8_t, 32>;

/// @param position, velocity in the world, or in one frame's camera while it is judged: m, m/s
struct VirtualPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  BinaryDescriptor descriptor{};
  int age = 0;  ///< frames since it was last seen to move
};

/// Upright binary descriptors (rotated BRIEF at angle 0) of every feature. @param gray CV_8UC1
[[nodiscard]] std::vector<BinaryDescriptor> upright_descriptors(const cv::Mat& gray,
                                                                std::span<const MotionFeature> features);

/// How many bits are unlike.
[[nodiscard]] int hamming(const BinaryDescriptor& a, const BinaryDescriptor& b);

/// The same points after some time: moved on by their velocity, a frame older; those beyond the age are gone.
[[nodiscard]] std::vector<VirtualPoint> moved_on(const std::vector<VirtualPoint>& points, double seconds,
                                                 int most_age);

/// The points in other coordinates: position and velocity.
[[nodiscard]] std::vector<VirtualPoint> transformed(const std::vector<VirtualPoint>& points,
                                                    const Pose& to_from);

/// Where points lie in the image, px; NaN behind the camera. @param points in the camera
[[nodiscard]] std::vector<cv::Point2f> projections(const std::vector<VirtualPoint>& points,
                                                   const Camera& camera);

/// For each point the feature that is most like it among those near its projection; -1 where none is like
/// enough.
[[nodiscard]] std::vector<int> match_virtual_points(const std::vector<VirtualPoint>& points,
                                                    const std::vector<cv::Point2f>& projected,
                                                    std::span<const MotionFeature> features,
                                                    const std::vector<BinaryDescriptor>& descriptors,
                                                    const Lin2017Config& config);

}  // namespace stillpoint
