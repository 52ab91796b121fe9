#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.hpp"

namespace stillpoint {

/// How fast the camera turned when each of the last frames was taken, from how far it turned between them.
/// A rolling shutter bends a frame by it from top to bottom, and between two frames taken at different rates
/// the picture shears as no camera's motion could make it.
class AngularVelocities {
 public:
  /// A frame more. @param turn since the last one: log(before_from_now), rad @param seconds since then, > 0
  /// @param most frames that `at` is asked to look back
  void add(const Eigen::Vector3d& turn, double seconds, int most);
  void clear() { turns_.clear(); }

  /// Angular velocity in the camera's own axes, rad / s, `back` frames ago. Between two turns it changes
  /// evenly, and beyond the first and the last as it did beside them.
  [[nodiscard]] Eigen::Vector3d at(int back) const;

  /// How far `at(0)`, which no later turn confirms yet, may be off, rad / s about each axis: as far as the
  /// rate has changed from frame to frame.
  [[nodiscard]] double sigma() const;

 private:
  struct Turn {
    Eigen::Vector3d rate;  ///< rad / s, the mean of the time between two frames
    double seconds;
  };
  std::vector<Turn> turns_;  ///< newest last
};

/// When each row is taken, s after the middle one. @param row px of `camera`'s image
[[nodiscard]] inline double after_middle(const Camera& camera, float row) {
  return camera.row_time(static_cast<double>(row));
}

/// Carries points to where a frame taken all at once, at its middle row, would show them, as if the camera
/// only turned: that is most of it, and depth is not known.
/// @param rows px of `camera`'s image: each point's, as the image has it
/// @param straight the same points undistorted, moved in place
void undo_shutter(const Camera& camera, const Eigen::Vector3d& rate, const std::vector<cv::Point2f>& rows,
                  std::vector<cv::Point2f>& straight);

}  // namespace stillpoint
