#include "core/inspect/feature_explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/counted.hpp"
#include "core/inspect/feature_trail.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/motion/regions.hpp"
#include "core/motion/stage_log.hpp"
#include "core/run/saved_map.hpp"

namespace stillpoint {
namespace {

std::optional<double> value_at(const Layer& layer, const Eigen::Vector2d& pixel) {
  const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
  const cv::Mat& image = layer.image;
  if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) return std::nullopt;
  if (!layer.valid.empty() && layer.valid.at<std::uint8_t>(y, x) == 0) return std::nullopt;
  const double value = image.depth() == CV_32F ? static_cast<double>(image.at<float>(y, x))
                                               : static_cast<double>(image.at<std::uint8_t>(y, x));
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

/// What the layers that have a limit say at the feature's place: of stages with rounds the last round's.
void add_margins(const StageLog& log, const PairGeometry& pair, FeatureExplanation& explanation) {
  const Eigen::Vector2d pixel(explanation.feature.pixel.x, explanation.feature.pixel.y);
  const int last = log.rounds() - 1;
  for (const Stage& stage : log.stages) {
    if (stage.round >= 0 && stage.round != last) continue;
    for (const StageSide& side : stage.sides) {
      const Layer& layer = side.output;
      if (!layer.limit || layer.image.channels() != 1) continue;
      const auto place = scene_point_in(pair, layer.space, pixel);
      const auto value = place ? value_at(layer, place->pixel) : std::nullopt;
      if (!value) continue;
      std::string name = side.name.empty() ? layer.name : fmt::format("{}: {}", layer.name, side.name);
      if (stage.reference >= 0) name += fmt::format(", {} back", counted(stage.frames_back, "frame"));
      explanation.margins.push_back({std::move(name), *value, *layer.limit, layer.unit});
    }
  }
}

/// The region of the removing mask that holds the feature, from 1.
std::optional<int> region_of(const cv::Mat& mask, const cv::Point2f& pixel) {
  const cv::Point at(cvRound(pixel.x), cvRound(pixel.y));
  if (mask.empty() || !cv::Rect({0, 0}, mask.size()).contains(at)) return std::nullopt;
  const int region = find_regions(mask).labels.at<int>(at);
  return region > 0 ? std::optional(region) : std::nullopt;
}

/// Of another program's feature: what became of it, and nothing of why.
std::string outside_verdict(const FeatureExplanation& explanation) {
  switch (explanation.feature.fate) {
    case FeatureFate::removed:
      return "Removed by the program that made the run.";
    case FeatureFate::unmatched:
      return "Kept and not matched by the program that made the run.";
    case FeatureFate::inlier:
      return "Kept and used by the program that made the run.";
    case FeatureFate::outlier:
      return "Kept and not used by the program that made the run: an outlier.";
  }
  return {};
}

std::string verdict_of(const FeatureExplanation& explanation, const std::string& method) {
  if (!explanation.measured.solving) return outside_verdict(explanation);
  const FeatureRecord& feature = explanation.feature;
  switch (feature.fate) {
    case FeatureFate::removed:
      return explanation.region ? fmt::format("Removed: region {} of method {}'s mask holds it.",
                                              *explanation.region, method)
                                : fmt::format("Removed: method {}'s mask holds it.", method);
    case FeatureFate::unmatched:
      if (std::isnan(feature.residual_px)) return "Kept, but nothing of the last frame compares with it.";
      return "Kept, but no map point was found for it.";
    case FeatureFate::inlier:
      if (std::isnan(feature.residual_px)) return "Kept and used: its brightness agrees with the pose.";
      return fmt::format(
          "Kept and used: it agrees with the pose, {:.2f} px off{}.",
          static_cast<double>(feature.residual_px),
          feature.static_weight < kLowWeight
              ? fmt::format(", and weighs {:.0f} %, for it may move", 100.0 * feature.static_weight)
              : "");
    case FeatureFate::outlier:
      if (std::isnan(feature.residual_px))
        return "Kept and not used: its brightness does not agree with the pose.";
      return fmt::format("Kept and not used: matched to map point {}, but {:.1f} px off.", feature.map_point,
                         static_cast<double>(feature.residual_px));
  }
  return {};
}

/// Where it would be seen had it stood still: from its map point, else from where the flow says it was.
void explain_static_position(const FrameView& view, const PairGeometry& pair,
                             const std::vector<SavedPoint>& points, FeatureExplanation& explanation) {
  const auto point = std::lower_bound(points.begin(), points.end(), explanation.feature.map_point,
                                      [](const SavedPoint& saved, int id) { return saved.id < id; });
  const bool known = explanation.feature.map_point != kNone && point != points.end() &&
                     point->id == explanation.feature.map_point;
  if (known) {
    explanation.observations = point->observations;
    if (pair.world_from_target) {
      const Eigen::Vector3d seen = pair.world_from_target->inverse() * point->position;
      if (seen.z() > 0.05) {
        explanation.if_static = pair.camera.distort(pair.camera.project(seen));
        explanation.static_by = "its map point";
        return;
      }
    }
  }
  const auto from = flow_source(view, explanation.feature.pixel);
  if (!from) return;
  const auto carried = target_point(pair, FrameSpace::kReference,
                                    {static_cast<double>(from->x), static_cast<double>(from->y)});
  if (!carried) return;
  explanation.if_static = carried->pixel;
  explanation.static_by =
      carried->by == WarpedBy::kDepth ? "flow, depth and the camera's motion" : "flow and the homography";
}

}  // namespace

std::optional<double> FeatureExplanation::own_motion_px() const {
  if (!if_static) return std::nullopt;
  return (Eigen::Vector2d(feature.pixel.x, feature.pixel.y) - *if_static).norm();
}

FeatureExplanation explain_feature(const FrameView& view, const RunView& run, const Camera& camera,
                                   const std::vector<SavedPoint>& map_points, int index) {
  FeatureExplanation explanation;
  explanation.index = index;
  explanation.feature = view.record->features.at(static_cast<std::size_t>(index));
  explanation.measured = view.record->measured;
  const bool removed = explanation.feature.fate == FeatureFate::removed;
  const PairGeometry pair = pair_geometry(view, run, camera);
  const Eigen::Vector2d pixel(explanation.feature.pixel.x, explanation.feature.pixel.y);
  if (view.motion) {
    add_margins(*view.motion, pair, explanation);
    if (view.motion->explain) explanation.because = view.motion->explain(explanation.feature.pixel, removed);
  }
  if (removed) explanation.region = region_of(view.mask, explanation.feature.pixel);
  explanation.verdict = verdict_of(explanation, view.motion ? view.motion->method : std::string());
  explanation.mask_edge_px = distance_to_edge(view.mask, explanation.feature.pixel);
  explanation.trail = trail_of(view, index);
  explanation.in_camera = point_in_camera(pair, pixel);
  if (explanation.in_camera && pair.world_from_target)
    explanation.in_world = *pair.world_from_target * *explanation.in_camera;
  explain_static_position(view, pair, map_points, explanation);
  return explanation;
}

std::optional<double> distance_to_edge(const cv::Mat& mask, const cv::Point2f& pixel, int reach) {
  const int x = cvRound(pixel.x), y = cvRound(pixel.y);
  if (mask.empty() || x < 0 || y < 0 || x >= mask.cols || y >= mask.rows) return std::nullopt;
  const bool inside = mask.at<std::uint8_t>(y, x) != 0;
  double nearest = reach + 1.0;
  for (int v = std::max(0, y - reach); v <= std::min(mask.rows - 1, y + reach); ++v)
    for (int u = std::max(0, x - reach); u <= std::min(mask.cols - 1, x + reach); ++u)
      if ((mask.at<std::uint8_t>(v, u) != 0) != inside)
        nearest = std::min(nearest, std::hypot(static_cast<double>(u - x), static_cast<double>(v - y)));
  if (nearest > reach) return std::nullopt;
  return inside ? nearest : -nearest;
}

}  // namespace stillpoint
