#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/depth_noise.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

struct DepthCamera;

/// Points nearer to a camera than this are not projected into it.
inline constexpr double kNearestProjected = 0.05;  // m

/// A pinhole camera with Brown-Conrady distortion, and the scale of its depth images.
///
/// Images are shown as they are; geometry uses undistorted pixels (Camera::undistort). The left camera of a
/// rectified stereo pair has no distortion, and a baseline to the right one: its depth comes of matching
/// both.
struct Camera {
  std::string name = "ros_default";
  int width = 640;                                        ///< px
  int height = 480;                                       ///< px
  double fx = 525.0, fy = 525.0, cx = 319.5, cy = 239.5;  ///< px
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;          ///< distortion, OpenCV's order and meaning
  double depth_scale = 5000.0;                            ///< depth image units a metre
  double readout_s = 0.0;  ///< s from the first row's exposure to the last one's, negative where the last is
                           ///< taken first; 0 = global shutter
  double stamp_delay_s = 0.0;  ///< s from a colour image's stamp to the moment its middle row was taken,
                               ///< which is the frame's time: poses are of that moment
  std::optional<double> depth_readout_s{};  ///< of depth images, as readout_s of colour's; nothing = the same
  double depth_delay_s = 0.0;  ///< s from a depth image's stamp to the moment its middle row was measured
  double baseline_m =
      0.0;  ///< m, to the right camera of a rectified stereo pair; 0 = depth is a sensor's own
  double depth_sigma_per_m2 = 0.0;  ///< 1/m, of a stereo pair: its depths z have standard deviation this z²
  /// Of depth images that are stored as another camera sees them; null = they are registered to this one's.
  /// Frames come with registered depth either way.
  std::shared_ptr<const DepthCamera> depth_camera{};

  [[nodiscard]] bool has_distortion() const;

  /// Whether depth comes of a stereo pair.
  [[nodiscard]] bool is_stereo() const { return baseline_m > 0; }

  /// The noise of depth: a stereo pair's own, otherwise what is known of the sensor that `sensor` speaks of.
  [[nodiscard]] DepthNoise depth_noise(const DepthNoise& sensor) const {
    return is_stereo() ? stereo_depth_noise(depth_sigma_per_m2) : sensor;
  }

  /// Standard deviation (m) of a stereo pair's depth z (m); 0 where depth is a sensor's own. Tolerances that
  /// were chosen for a sensor hold its noise already, and grow by this.
  [[nodiscard]] double stereo_sigma(double z) const { return is_stereo() ? depth_sigma_per_m2 * z * z : 0.0; }

  /// A limit of depth (m) that was chosen for a Kinect: as many baselines away for a stereo pair, because the
  /// noise of either in px is the same there.
  [[nodiscard]] double depth_limit(double kinect_m) const {
    return is_stereo() ? kinect_m * baseline_m / kKinectBaseline : kinect_m;
  }

  /// The baseline (m) whose disparity stands for depth in px: a stereo pair's own, otherwise `sensor`.
  [[nodiscard]] double baseline_or(double sensor) const { return is_stereo() ? baseline_m : sensor; }

  /// How far below the image's middle a row lies, as a share of the height: -1/2 to 1/2.
  [[nodiscard]] double row_share(double row) const { return to_raster(row).px() / height - 0.5; }
  /// The row of the image's middle, whose moment is the frame's time: between two rows where they are even.
  [[nodiscard]] double middle_row() const { return to_pixel(RasterCoordinate(0.5 * height)); }

  /// When a row of colour is taken: s after the middle row.
  [[nodiscard]] double row_time(double row) const { return row_share(row) * readout_s; }

  /// How long (s) after colour depth is measured, in a row of both. @param lag_s from the frame's time to
  /// depth's stamp
  [[nodiscard]] double depth_lag(double lag_s, double row) const {
    const double lag = lag_s + depth_delay_s;
    return depth_readout_s ? lag + row_share(row) * (*depth_readout_s - readout_s) : lag;
  }

  /// Whether depth is measured at another moment than colour in any row.
  [[nodiscard]] bool depth_is_late(double lag_s) const {
    return lag_s + depth_delay_s != 0.0 || (depth_readout_s && *depth_readout_s != readout_s);
  }

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

/// A depth camera that sees its own image, from a place of its own.
struct DepthCamera {
  Camera camera;  ///< intrinsics, distortion and size of the depth images; its depth_scale is not used
  Pose colour_from_depth = Pose::Identity();  ///< points of the depth camera to those of the colour camera
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
/// readout_s, stamp_delay_s, depth_readout_s, depth_delay_s, baseline_m, and a table `[depth_camera]` where
/// depth images are not registered: fx, fy, cx, cy, width, height, k1 to k3, p1, p2, and `colour_from_depth`,
/// three or four rows of four numbers (m), the identity where it is not given. Or, by the file's ending, from
/// YAML (camera_yaml.hpp).
/// @throws InputError on a missing file, a syntax error (with its line), an unknown key or a value out of
/// range.
[[nodiscard]] Camera read_camera(const std::string& path);

/// The same of a text that is at hand; `path` names it in messages, and its ending tells TOML from YAML.
[[nodiscard]] Camera read_camera_text(const std::string& path, const std::string& text);

/// `NAME|FILE.toml|FILE.yaml` as given on the command line.
/// @throws InputError as camera_by_name and read_camera do.
[[nodiscard]] Camera camera_from_argument(const std::string& argument);

}  // namespace stillpoint
