#pragma once

namespace stillpoint {

/// m from the first Kinect's projector to its depth camera: what depth limits chosen for it are measured by.
inline constexpr double kKinectBaseline = 0.075;

/// How exact a measured depth is. Triangulation errs by a constant disparity, so that the error of depth
/// grows with the square of depth, for structured light and for stereo alike.
struct DepthNoise {
  float floor_m = 0.0F;        ///< m: part of the standard deviation that is there at any depth
  float per_m2 = 0.0F;         ///< 1/m: part that grows with the square of depth
  double shared_per_m2 = 0.0;  ///< 1/m: what the pixels of one surface share, and their mean keeps

  /// Standard deviation (m) of a depth z (m).
  [[nodiscard]] float sigma(float z) const { return floor_m + per_m2 * z * z; }
};

/// The first Kinect's and its kin (Khoshelham & Oude Elberink 2012; Nguyen et al. 2012).
inline constexpr DepthNoise kKinectNoise{0.0012F, 0.0019F, 0.004};

/// A stereo pair's: sigma_z = z² sigma_d / (f b), all of it shared by a surface's pixels, which are matched
/// together. @param per_m2 sigma_d / (f b), 1/m
[[nodiscard]] inline DepthNoise stereo_depth_noise(double per_m2) {
  return {0.0F, static_cast<float>(per_m2), per_m2};
}

}  // namespace stillpoint
