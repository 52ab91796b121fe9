#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// A pinhole camera with Brown-Conrady distortion, and the scale of its depth images.
///
/// Images are shown as they are; geometry uses undistorted pixels (Camera::undistort).
struct Camera {
  std::string name = "ros_default";
  int width = 640;                                        ///< px
  int height = 480;                                       ///< px
  double fx = 525.0, fy = 525.0, cx = 319.5, cy = 239.5;  ///< px
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;          ///< distortion, OpenCV's order and meaning
  double depth_scale = 5000.0;                            ///< depth image units a metre
  double readout_s = 0.0;  ///< s from the first row's exposure to the last one's; 0 = global shutter. Stamps
                           ///< are the middle row's

  [[nodiscard]] bool has_distortion() const;

  /// 3x3 intrinsic matrix, CV_64F.
  [[nodiscard]] cv::Matx33d matrix() const;

  /// The undistorted pixel of a camera-frame point (z > 0), in px.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }

  /// The camera-frame point (m) of an undistorted pixel at depth z (m).
  [[nodiscard]] Eigen::Vector3d back_project(const Eigen::Vector2d& pixel, double z) const {
    return {(pixel.x() - cx) / fx * z, (pixel.y() - cy) / fy * z, z};
  }

  /// The pixel where an ideal pinhole of the same matrix would see what an image pixel shows, by Newton's
  /// method: distort leads back within 1e-6 px. Where distortion folds the image over, and no pixel is the
  /// right one, the nearest found.
  [[nodiscard]] Eigen::Vector2d undistorted(const Eigen::Vector2d& pixel) const;

  /// The same of many, in single precision.
  [[nodiscard]] std::vector<cv::Point2f> undistort(const std::vector<cv::Point2f>& pixels) const;

  /// The image pixel of an undistorted pixel: the inverse of undistorted.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& undistorted) const;

  /// The same camera for images of another size: intrinsics scaled, distortion kept.
  [[nodiscard]] Camera scaled_to(int new_width, int new_height) const;
};

/// The built-in cameras by name: freiburg1, freiburg2, freiburg3, ros_default, icl_nuim, bonn, generated.
[[nodiscard]] const std::vector<Camera>& known_cameras();

/// The built-in camera of that name.
/// @throws InputError naming the known ones.
[[nodiscard]] Camera camera_by_name(std::string_view name);

/// The camera a folder's name speaks of by a whole word ("…_freiburg1_…", "fr2_desk", "rgbd_bonn_…",
/// "living_room_traj2_…"), or nothing: a part of a word ("vehicle", "particles") says nothing.
[[nodiscard]] std::optional<Camera> camera_from_folder_name(std::string_view folder_name);

/// Reads a camera from TOML: keys name, width, height, fx, fy, cx, cy, k1, k2, p1, p2, k3, depth_scale,
/// readout_s; or, by the file's ending, from YAML (camera_yaml.hpp).
/// @throws InputError on a missing file, a syntax error (with its line), an unknown key or a value out of
/// range.
[[nodiscard]] Camera read_camera(const std::string& path);

/// The same of a text that is at hand; `path` names it in messages, and its ending tells TOML from YAML.
[[nodiscard]] Camera read_camera_text(const std::string& path, const std::string& text);

/// `NAME|FILE.toml|FILE.yaml` as given on the command line.
/// @throws InputError as camera_by_name and read_camera do.
[[nodiscard]] Camera camera_from_argument(const std::string& argument);

}  // namespace stillpoint
