#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "core/motion/lin2017/lin2017_config.hpp"
#include "core/motion/motion_method.hpp"
#include "core/motion/residual_motion.hpp"

namespace stillpoint {

// Scene flow of the features of method `lin2017`, and its classes by direction.

/// A frame as the next one is compared with it.
struct FlowFrame {
  int index = -1;
  double timestamp = 0.0;        ///< s
  std::vector<cv::Mat> pyramid;  ///< as cv::buildOpticalFlowPyramid makes it
  cv::Mat depth;                 ///< CV_32FC1, m
  PixelRays rays;
};

/// What is held of a feature.
enum class FeatureClass : std::uint8_t {
  kUnjudged,  ///< not followed, or without depth within a surface in either frame
  kStatic,
  kStray,    ///< moves, but nothing about it moves likewise: dropped in this frame
  kMoving,   ///< of a thing that moves
  kVirtual,  ///< matches a virtual map point
};

/// A feature's scene flow, in this frame's camera.
struct FeatureFlow {
  bool followed = false;
  bool measured = false;  ///< followed, and with depth in both frames
  cv::Point2f before;     ///< px: where it was in the last frame, when followed
  ScenePair pair;
  Eigen::Vector3f flow = Eigen::Vector3f::Zero();  ///< s = X' - (R X + t), m
  float sigma = 0.0F;                              ///< m: standard deviation along s
  int bin = -1;                                    ///< class of direction; -1: too short to have one
  FeatureClass kind = FeatureClass::kUnjudged;
};

/// Follows features from this frame to the last and back, and takes depth at both ends.
[[nodiscard]] std::vector<FeatureFlow> follow_features(std::span<const MotionFeature> features,
                                                       const FlowFrame& here, const FlowFrame& last,
                                                       const Lin2017Config& config);

/// s and its noise under a motion of the camera; what is too short is static, the rest gets its class of
/// direction and is stray until its neighbours say more. Unmeasured features are left as they are.
void measure_flow(std::vector<FeatureFlow>& flows, const CameraMotion& camera, const SceneFlowNoise& noise,
                  const Lin2017Config& config);

/// Class of a direction: azimuth from straight ahead to the right, elevation from straight down up;
/// elevation · azimuth_bins + azimuth, each from 0.
[[nodiscard]] int direction_bin(const Eigen::Vector3f& flow, int azimuth_bins, int elevation_bins);

/// A class with enough features that neighbours support is a thing that moves, and these are of it. @return
/// the classes
std::vector<int> find_moving_things(std::span<const MotionFeature> features, std::vector<FeatureFlow>& flows,
                                    const Lin2017Config& config);

}  // namespace stillpoint
