#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/sequence/generated/random.hpp"
#include "core/sequence/generated/ray_caster.hpp"

namespace stillpoint::generated {

/// A structured-light depth camera beside a colour camera, of the first Kinect's kind.
///
/// Depth noise and step sizes grow with the square of depth (deviation 1.2 mm + 1.9 mm/m² (z - 0.4 m)²;
/// disparity in steps of 1/8 px at a 75 mm base), after Khoshelham & Elberink 2012 and Nguyen et al. 2012.
/// What the projector cannot reach, grazing surfaces, ragged outlines, and dark or shiny things have no
/// depth.
class Sensor {
 public:
  explicit Sensor(unsigned seed);

  /// CV_8UC3 with a lens's softness, vignetting, exposure flicker and noise.
  [[nodiscard]] cv::Mat colour(const cv::Mat& perfect, int frame, double seconds) const;

  /// CV_16UC1 in camera.depth_scale units a metre, 0 = no measurement.
  /// @param dropout by id: the share of a thing that is not measured.
  [[nodiscard]] cv::Mat depth(const Rendering& ideal, const std::vector<float>& dropout, const Camera& camera,
                              int frame) const;

 private:
  unsigned seed_;
  Wander exposure_;
};

}  // namespace stillpoint::generated
