#include "core/inspect/feature_story.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/inspect/feature_trail.hpp"
#include "core/motion/regions.hpp"

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
void add_margins(const StageLog& log, const PairGeometry& pair, FeatureStory& story) {
  const Eigen::Vector2d pixel(story.feature.pixel.x, story.feature.pixel.y);
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
      if (stage.reference >= 0) name += fmt::format(", {} frames back", stage.frames_back);
      story.margins.push_back({std::move(name), *value, *layer.limit, layer.unit});
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

std::string verdict_of(const FeatureStory& story, const std::string& method) {
  const FeatureRecord& feature = story.feature;
  switch (feature.fate) {
    case FeatureFate::removed:
      return story.region
                 ? fmt::format("Removed: region {} of method {}'s mask holds it.", *story.region, method)
                 : fmt::format("Removed: method {}'s mask holds it.", method);
    case FeatureFate::unmatched:
      return "Kept, but no map point was found for it.";
    case FeatureFate::inlier:
      return fmt::format("Kept and used: it agrees with the pose, {:.2f} px off{}.",
                         static_cast<double>(feature.residual_px),
                         feature.trust < kLittleTrust
                             ? fmt::format(", and weighs {:.0f} %, for it may move", 100.0 * feature.trust)
                             : "");
    case FeatureFate::outlier:
      return fmt::format("Kept and not used: matched to map point {}, but {:.1f} px off.", feature.map_point,
                         static_cast<double>(feature.residual_px));
  }
  return {};
}

/// Where it would be seen had it stood still: from its map point, else from where the flow says it was.
void tell_static_place(const FrameView& view, const PairGeometry& pair, const std::vector<SavedPoint>& points,
                       FeatureStory& story) {
  const auto point = std::lower_bound(points.begin(), points.end(), story.feature.map_point,
                                      [](const SavedPoint& saved, int id) { return saved.id < id; });
  const bool known =
      story.feature.map_point != kNone && point != points.end() && point->id == story.feature.map_point;
  if (known) {
    story.observations = point->observations;
    if (pair.world_from_target) {
      const Eigen::Vector3d seen = pair.world_from_target->inverse() * point->position;
      if (seen.z() > 0.05) {
        story.if_static = pair.camera.distort(pair.camera.project(seen));
        story.static_by = "its map point";
        return;
      }
    }
  }
  const auto from = flow_source(view, story.feature.pixel);
  if (!from) return;
  const auto carried = target_point(pair, FrameSpace::kReference,
                                    {static_cast<double>(from->x), static_cast<double>(from->y)});
  if (!carried) return;
  story.if_static = carried->pixel;
  story.static_by =
      carried->by == CarriedBy::kDepth ? "flow, depth and the camera's motion" : "flow and the homography";
}

}  // namespace

std::optional<double> FeatureStory::own_motion_px() const {
  if (!if_static) return std::nullopt;
  return (Eigen::Vector2d(feature.pixel.x, feature.pixel.y) - *if_static).norm();
}

FeatureStory explain_feature(const FrameView& view, const RunView& run, const Camera& camera,
                             const std::vector<SavedPoint>& map_points, int index) {
  FeatureStory story;
  story.index = index;
  story.feature = view.record->features.at(static_cast<std::size_t>(index));
  const bool removed = story.feature.fate == FeatureFate::removed;
  const PairGeometry pair = pair_geometry(view, run, camera);
  const Eigen::Vector2d pixel(story.feature.pixel.x, story.feature.pixel.y);
  if (view.motion) {
    add_margins(*view.motion, pair, story);
    if (view.motion->explain) story.because = view.motion->explain(story.feature.pixel, removed);
  }
  if (removed) story.region = region_of(view.mask, story.feature.pixel);
  story.verdict = verdict_of(story, view.motion ? view.motion->method : std::string());
  story.mask_edge_px = distance_to_edge(view.mask, story.feature.pixel);
  story.trail = trail_of(view, index);
  story.in_camera = point_in_camera(pair, pixel);
  if (story.in_camera && pair.world_from_target) story.in_world = *pair.world_from_target * *story.in_camera;
  tell_static_place(view, pair, map_points, story);
  return story;
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
