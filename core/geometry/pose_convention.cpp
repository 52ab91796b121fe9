#include "core/geometry/pose_convention.hpp"

#include "core/geometry/rotation_fit.hpp"

namespace stillpoint {
namespace {

Pose mirrored(const Pose& pose, const Eigen::Vector3d& signs) {
  const Eigen::DiagonalMatrix<double, 3> flip(signs);
  Pose result = Pose::Identity();
  result.linear() = flip * pose.linear() * flip;
  result.translation() = flip * pose.translation();
  return result;
}

/// By half a turn about the camera's own x.
Pose turned_about_x(const Pose& pose) {
  Pose result = pose;
  result.linear().col(1) *= -1.0;
  result.linear().col(2) *= -1.0;
  return result;
}

/// Axes of the motion capture system seen from ROS's, as the data set's page gives them.
Pose bonn_ros() {
  Pose pose = Pose::Identity();
  pose.linear() << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  return pose;
}

/// The camera in the marker body, as the data set's page gives it. Its matrix is 1.059 times a rotation; the
/// rotation nearest to it is taken, and the translation as it stands.
Pose bonn_marker() {
  Eigen::Matrix3d published;
  published << 1.0157, 0.1828, -0.2389, 0.0009, -0.8431, -0.6413, -0.3009, 0.6147, -0.8085;
  Pose pose = Pose::Identity();
  pose.linear() = fit_rotation(published).rotation;
  pose.translation() = Eigen::Vector3d(0.0113, -0.0098, 0.0111);
  return pose;
}

Pose reread_w_first(const Pose& pose) {
  const Eigen::Quaterniond read(pose.linear());
  Pose result = pose;
  result.linear() =
      Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).normalized().toRotationMatrix();
  return result;
}

}  // namespace

const std::vector<PoseConvention>& other_conventions() {
  static const std::vector<PoseConvention> all = {PoseConvention::inverse,    PoseConvention::w_first,
                                                  PoseConvention::mirrored_x, PoseConvention::mirrored_y,
                                                  PoseConvention::mirrored_z, PoseConvention::opengl,
                                                  PoseConvention::bonn};
  return all;
}

std::string_view to_string(PoseConvention convention) {
  switch (convention) {
    case PoseConvention::inverse:
      return "inverse";
    case PoseConvention::w_first:
      return "w-first";
    case PoseConvention::mirrored_x:
      return "mirrored-x";
    case PoseConvention::mirrored_y:
      return "mirrored-y";
    case PoseConvention::mirrored_z:
      return "mirrored-z";
    case PoseConvention::opengl:
      return "opengl";
    case PoseConvention::bonn:
      return "bonn";
    case PoseConvention::as_written:
      break;
  }
  return "as-written";
}

std::string_view meaning_of(PoseConvention convention) {
  switch (convention) {
    case PoseConvention::inverse:
      return "the poses lead from world to camera";
    case PoseConvention::w_first:
      return "the quaternions have w first";
    case PoseConvention::mirrored_x:
      return "the poses are mirrored in x against the images";
    case PoseConvention::mirrored_y:
      return "the poses are mirrored in y against the images";
    case PoseConvention::mirrored_z:
      return "the poses are mirrored in z against the images";
    case PoseConvention::opengl:
      return "the poses are of an OpenGL camera, y up and z backward";
    case PoseConvention::bonn:
      return "the poses are those of Bonn's marker body";
    case PoseConvention::as_written:
      break;
  }
  return "the poses lead from camera to world";
}

std::optional<PoseConvention> convention_by_name(std::string_view name) {
  if (name == to_string(PoseConvention::as_written)) return PoseConvention::as_written;
  for (const PoseConvention convention : other_conventions())
    if (name == to_string(convention)) return convention;
  return std::nullopt;
}

Pose camera_pose(const Pose& written, PoseConvention convention) {
  switch (convention) {
    case PoseConvention::inverse:
      return written.inverse();
    case PoseConvention::w_first:
      return reread_w_first(written);
    case PoseConvention::mirrored_x:
      return mirrored(written, {-1, 1, 1});
    case PoseConvention::mirrored_y:
      return mirrored(written, {1, -1, 1});
    case PoseConvention::mirrored_z:
      return mirrored(written, {1, 1, -1});
    case PoseConvention::opengl:
      return turned_about_x(written);
    case PoseConvention::bonn:
      return bonn_ros().inverse() * written * bonn_ros() * bonn_marker();
    case PoseConvention::as_written:
      break;
  }
  return written;
}

Pose written_pose(const Pose& world_from_camera, PoseConvention convention) {
  if (convention == PoseConvention::bonn)
    return bonn_ros() * world_from_camera * bonn_marker().inverse() * bonn_ros().inverse();
  return camera_pose(world_from_camera, convention);  // the others undo themselves
}

}  // namespace stillpoint
