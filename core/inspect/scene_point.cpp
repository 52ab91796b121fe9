#include "core/inspect/scene_point.hpp"

#include <cmath>

#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

constexpr double kNearest = 0.05;  // m before the camera: nearer, a pixel means nothing

Eigen::Vector3d back_project(const Camera& camera, const Eigen::Vector2d& pixel, double z) {
  const cv::Point2f given(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  // Asked for each pixel of an image: a list of one is not made for nothing.
  const cv::Point2f ideal = camera.has_distortion() ? camera.undistort({given}).front() : given;
  return camera.back_project({static_cast<double>(ideal.x), static_cast<double>(ideal.y)}, z);
}

std::optional<Eigen::Vector2d> warp_by_depth(const Camera& camera, const cv::Mat& depth, const Pose& to_from,
                                             const Eigen::Vector2d& pixel) {
  const std::optional<double> z = depth_at_pixel(depth, pixel);
  if (!z) return std::nullopt;
  const Eigen::Vector3d there = to_from * back_project(camera, pixel, *z);
  if (there.z() < kNearest) return std::nullopt;
  return camera.distort(camera.project(there));
}

std::optional<Eigen::Vector2d> warp_by_homography(const cv::Matx33d& homography,
                                                  const Eigen::Vector2d& pixel) {
  const cv::Vec3d moved = homography * cv::Vec3d(pixel.x(), pixel.y(), 1.0);
  const cv::Point2d carried(moved[0] / moved[2], moved[1] / moved[2]);
  if (!std::isfinite(carried.x) || !std::isfinite(carried.y)) return std::nullopt;
  return Eigen::Vector2d(carried.x, carried.y);
}

std::optional<WarpedPoint> as_warped(const std::optional<Eigen::Vector2d>& pixel, WarpedBy by) {
  if (!pixel) return std::nullopt;
  return WarpedPoint{*pixel, by};
}

/// Along a direction's own homography, else against the other's.
std::optional<WarpedPoint> warp_either_way(const std::optional<cv::Matx33d>& along,
                                           const std::optional<cv::Matx33d>& against,
                                           const Eigen::Vector2d& pixel) {
  if (along) return as_warped(warp_by_homography(*along, pixel), WarpedBy::kHomography);
  if (against) return as_warped(warp_by_homography(against->inv(), pixel), WarpedBy::kHomography);
  return std::nullopt;
}

std::optional<WarpedPoint> in_reference(const PairGeometry& pair, const Eigen::Vector2d& target) {
  if (pair.reference_from_target)
    if (const auto carried =
            warp_by_depth(pair.camera, pair.target_depth, *pair.reference_from_target, target))
      return WarpedPoint{*carried, WarpedBy::kDepth};
  return warp_either_way(pair.backward, pair.forward, target);
}

std::optional<WarpedPoint> from_reference(const PairGeometry& pair, const Eigen::Vector2d& reference) {
  if (pair.reference_from_target)
    if (const auto carried = warp_by_depth(pair.camera, pair.reference_depth,
                                           pair.reference_from_target->inverse(), reference))
      return WarpedPoint{*carried, WarpedBy::kDepth};
  return warp_either_way(pair.forward, pair.backward, reference);
}

std::optional<Pose> estimated_pose(const RunView& run, int frame) {
  // Records are in order of frames, from the first on.
  if (frame < 0 || frame >= static_cast<int>(run.records.size())) return std::nullopt;
  const FrameRecord& record = run.records[static_cast<std::size_t>(frame)];
  if (!record.estimated || record.index != frame) return std::nullopt;
  return record.world_from_camera;
}

}  // namespace

PairGeometry pair_geometry(const FrameView& view, const RunView& run, const Camera& camera) {
  PairGeometry pair;
  pair.camera = camera;
  pair.target_depth = view.frame.depth;
  pair.reference_depth = view.reference.depth;
  pair.world_from_target = view.record != nullptr && view.record->estimated
                               ? std::optional(view.record->world_from_camera)
                               : estimated_pose(run, view.index);
  const std::optional<Pose> world_from_reference = estimated_pose(run, view.reference.index);
  if (pair.world_from_target && world_from_reference && view.reference.readable())
    pair.reference_from_target = world_from_reference->inverse() * *pair.world_from_target;
  for (const auto& log : {view.motion, view.motion_beside}) {
    if (!log) continue;
    if (!pair.forward) pair.forward = log->forward;
    if (!pair.backward) pair.backward = log->backward;
    pair.small_factor = std::max(pair.small_factor, log->small_factor);
  }
  return pair;
}

std::optional<WarpedPoint> scene_point_in(const PairGeometry& pair, FrameSpace space,
                                          const Eigen::Vector2d& target) {
  switch (space) {
    case FrameSpace::kTarget:
      return WarpedPoint{target, WarpedBy::kItself};
    case FrameSpace::kSmall:
      return WarpedPoint{downsampled(target, pair.small_factor), WarpedBy::kItself};
    case FrameSpace::kReference:
      return in_reference(pair, target);
    case FrameSpace::kCompensatedBackward:
      if (!pair.backward) return std::nullopt;
      return as_warped(warp_by_homography(*pair.backward, target), WarpedBy::kHomography);
    case FrameSpace::kCompensatedForward: {
      if (!pair.forward) return std::nullopt;
      const auto reference = in_reference(pair, target);
      // On the homography's plane compensation is exact; parallax, known by depth, shows as an offset.
      if (!reference || reference->by != WarpedBy::kDepth) return WarpedPoint{target, WarpedBy::kHomography};
      return as_warped(warp_by_homography(*pair.forward, reference->pixel), WarpedBy::kDepth);
    }
  }
  return std::nullopt;
}

std::optional<WarpedPoint> target_point(const PairGeometry& pair, FrameSpace space,
                                        const Eigen::Vector2d& pixel) {
  switch (space) {
    case FrameSpace::kTarget:
      return WarpedPoint{pixel, WarpedBy::kItself};
    case FrameSpace::kSmall:
      return WarpedPoint{upsampled(pixel, pair.small_factor), WarpedBy::kItself};
    case FrameSpace::kReference:
      return from_reference(pair, pixel);
    case FrameSpace::kCompensatedBackward:
      if (!pair.backward) return std::nullopt;
      return as_warped(warp_by_homography(pair.backward->inv(), pixel), WarpedBy::kHomography);
    case FrameSpace::kCompensatedForward: {
      if (!pair.forward) return std::nullopt;
      const auto reference = warp_by_homography(pair.forward->inv(), pixel);
      if (!reference) return std::nullopt;
      const auto target = from_reference(pair, *reference);
      if (target && target->by == WarpedBy::kDepth) return target;
      return WarpedPoint{pixel, WarpedBy::kHomography};
    }
  }
  return std::nullopt;
}

std::optional<double> depth_at_pixel(const cv::Mat& depth, const Eigen::Vector2d& pixel) {
  if (!pixel.allFinite() || pixel.cwiseAbs().maxCoeff() > 1e6) return std::nullopt;
  const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
  if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) return std::nullopt;
  const float z = depth.at<float>(y, x);
  if (!(z > 0.0F)) return std::nullopt;
  return static_cast<double>(z);
}

std::optional<Eigen::Vector3d> point_in_camera(const PairGeometry& pair, const Eigen::Vector2d& target) {
  const std::optional<double> z = depth_at_pixel(pair.target_depth, target);
  if (!z) return std::nullopt;
  return back_project(pair.camera, target, *z);
}

}  // namespace stillpoint
