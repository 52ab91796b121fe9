#include "core/inspect/frame_pair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <unordered_map>

#include "core/inspect/frame_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"

namespace stillpoint {
namespace {

constexpr double kNearestShown = 0.05;  // m before a camera: nearer, a pixel means nothing
constexpr double kCurveBegins = 0.2;    // m: no depth camera of the field measures nearer

Eigen::Vector2d pixel_of(const FeatureRecord& feature) {
  return {static_cast<double>(feature.pixel.x), static_cast<double>(feature.pixel.y)};
}

/// Of every map point that a frame found, its feature.
std::unordered_map<int, int> features_by_point(const FrameRecord& record) {
  std::unordered_map<int, int> features;
  for (int i = 0; i < static_cast<int>(record.features.size()); ++i)
    if (const int point = record.features[static_cast<std::size_t>(i)].map_point; point != kNone)
      features.emplace(point, i);
  return features;
}

std::optional<Eigen::Vector2d> shown_at(const Camera& camera, const Eigen::Vector3d& point) {
  if (point.z() < kNearestShown) return std::nullopt;
  return camera.distort(camera.project(point));
}

}  // namespace

std::optional<double> PairedFeature::error() const {
  if (!expected) return std::nullopt;
  return (pixel_here - *expected).norm();
}

std::optional<double> FramePair::median_error() const {
  if (errors.empty()) return std::nullopt;
  return errors[errors.size() / 2];
}

FramePair pair_frames(const FrameView& here, const FrameView& other, const Camera& camera) {
  FramePair pair;
  if (here.record == nullptr || other.record == nullptr) return pair;
  const FrameRecord &mine = *here.record, &its = *other.record;
  if (mine.estimated && its.estimated) {
    pair.here_from_other = mine.world_from_camera.inverse() * its.world_from_camera;
    pair.baseline_m = pair.here_from_other->translation().norm();
    pair.rotation_deg =
        Eigen::AngleAxisd(pair.here_from_other->rotation()).angle() * 180.0 / std::numbers::pi;
  }
  std::unordered_map<int, int> others = features_by_point(its);
  for (int i = 0; i < static_cast<int>(mine.features.size()); ++i) {
    const FeatureRecord& feature = mine.features[static_cast<std::size_t>(i)];
    if (feature.map_point == kNone) continue;
    const auto found = others.find(feature.map_point);
    if (found == others.end()) {
      ++pair.only_here;
      continue;
    }
    const FeatureRecord& there = its.features[static_cast<std::size_t>(found->second)];
    PairedFeature paired{.map_point = feature.map_point, .here = i, .other = found->second};
    others.erase(found);
    paired.pixel_here = pixel_of(feature), paired.pixel_other = pixel_of(there);
    paired.inlier = feature.fate == FeatureFate::inlier && there.fate == FeatureFate::inlier;
    if (pair.here_from_other && there.depth > 0.0F)
      paired.expected =
          pixel_at_depth(camera, *pair.here_from_other, paired.pixel_other, static_cast<double>(there.depth));
    if (const auto error = paired.error()) pair.errors.push_back(*error);
    pair.features.push_back(paired);
  }
  pair.only_other = static_cast<int>(others.size());
  std::sort(pair.errors.begin(), pair.errors.end());
  return pair;
}

std::optional<Eigen::Vector2d> pixel_at_depth(const Camera& camera, const Pose& to_from,
                                              const Eigen::Vector2d& pixel, double depth_m) {
  return shown_at(camera, to_from * camera.back_project(camera.undistorted(pixel), depth_m));
}

std::vector<Eigen::Vector2d> epipolar_curve(const Camera& camera, const Pose& to_from,
                                            const Eigen::Vector2d& pixel, double margin_px) {
  // In even steps of inverse depth places are about evenly spaced.
  constexpr int kSteps = 64;
  const Eigen::Vector3d ray = camera.back_project(camera.undistorted(pixel), 1.0);
  std::vector<Eigen::Vector2d> curve;
  for (int step = kSteps; step >= 0; --step) {
    const double inverse_depth = step / (kSteps * kCurveBegins);
    // Beside the point at depth z, scaled by 1 / z, so that it stands at infinity, too.
    const Eigen::Vector3d point = to_from.linear() * ray + inverse_depth * to_from.translation();
    if (point.z() < kNearestShown * std::max(inverse_depth, 1e-3)) continue;
    const Eigen::Vector2d ideal = camera.project(point);
    // Far outside the image a lens' polynomial means nothing.
    if (ideal.x() < -0.5 * camera.width || ideal.x() > 1.5 * camera.width ||
        ideal.y() < -0.5 * camera.height || ideal.y() > 1.5 * camera.height)
      continue;
    const Eigen::Vector2d place = camera.distort(ideal);
    if (place.x() < -margin_px || place.y() < -margin_px || place.x() > camera.width - 1 + margin_px ||
        place.y() > camera.height - 1 + margin_px)
      continue;
    curve.push_back(place);
  }
  return curve;
}

}  // namespace stillpoint
