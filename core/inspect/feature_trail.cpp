#include "core/inspect/feature_trail.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/inspect/feature_selection.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/motion/stage_log.hpp"

namespace stillpoint {
namespace {

constexpr float kFlowReach = 16.0F;    // px between a feature and the track that speaks for it
constexpr double kFlowRadius = 3.0;    // px about where the flow leads
constexpr double kNearbyRadius = 6.0;  // px about where the last step leads
constexpr float kLikeDepth = 0.1F;     // share of the distance

float distance(const cv::Point2f& a, const cv::Point2f& b) { return std::hypot(a.x - b.x, a.y - b.y); }

bool alike(const FeatureRecord& a, const FeatureRecord& b) {
  if (std::abs(static_cast<int>(a.octave) - static_cast<int>(b.octave)) > 1) return false;
  return a.depth <= 0.0F || b.depth <= 0.0F ||
         std::abs(a.depth - b.depth) < kLikeDepth * std::max(a.depth, b.depth);
}

/// The feature most like `feature` about `place`.
std::optional<int> like_near(const FrameRecord& record, const FeatureRecord& feature,
                             const cv::Point2f& place, double radius) {
  std::optional<int> best;
  auto nearest = static_cast<float>(radius);
  for (std::size_t i = 0; i < record.features.size(); ++i) {
    const float away = distance(record.features[i].pixel, place);
    if (away > nearest || !alike(record.features[i], feature)) continue;
    nearest = away;
    best = static_cast<int>(i);
  }
  return best;
}

std::optional<int> with_map_point(const FrameRecord& record, int map_point) {
  if (map_point == kNone) return std::nullopt;
  const auto it = std::find_if(record.features.begin(), record.features.end(),
                               [&](const FeatureRecord& f) { return f.map_point == map_point; });
  if (it == record.features.end()) return std::nullopt;
  return static_cast<int>(it - record.features.begin());
}

/// The flow track, of the run's method or the one laid beside, whose end (or, with `from`, start) is nearest
/// to a place.
const Mark* nearest_track(const FrameView& view, const cv::Point2f& place, bool from) {
  const StageLog* log = stages_with(view, "flow_tracks");
  const Layer* flow = log == nullptr ? nullptr : log->layer("flow_tracks");
  if (flow == nullptr) return nullptr;
  const Mark* best = nullptr;
  float nearest = kFlowReach;
  for (const Mark& track : flow->marks) {
    if (!track.from) continue;
    const float away = distance(from ? *track.from : track.at, place);
    if (away > nearest) continue;
    nearest = away;
    best = &track;
  }
  return best;
}

}  // namespace

std::optional<cv::Point2f> flow_source(const FrameView& view, const cv::Point2f& pixel) {
  const Mark* track = nearest_track(view, pixel, false);
  if (track == nullptr) return std::nullopt;
  return pixel + *track->from - track->at;
}

std::vector<TrailPoint> trail_of(const FrameView& view, int index) {
  std::vector<TrailPoint> trail;
  trail.push_back(
      {view.index, view.record->features.at(static_cast<std::size_t>(index)), TrailLink::kItself});
  for (std::size_t back = 0; back < view.history.size(); ++back) {
    const FrameRecord& record = *view.history[back];
    const FeatureRecord& last = trail.back().feature;
    TrailLink link = TrailLink::kMapPoint;
    std::optional<int> found = with_map_point(record, last.map_point);
    const bool has_flow = back == 0 && view.reference.index == record.index;
    if (const auto from = has_flow ? flow_source(view, last.pixel) : std::nullopt; !found && from) {
      link = TrailLink::kFlow;
      found = like_near(record, last, *from, kFlowRadius);
    } else if (!found) {
      link = TrailLink::kNearby;
      cv::Point2f place = last.pixel;
      if (trail.size() > 1) place += last.pixel - trail[trail.size() - 2].feature.pixel;
      found = like_near(record, last, place, kNearbyRadius);
    }
    if (!found) break;
    trail.push_back({record.index, record.features[static_cast<std::size_t>(*found)], link});
  }
  return trail;
}

std::optional<int> feature_near(const FrameRecord& record, const Eigen::Vector2d& pixel, double radius) {
  std::optional<int> best;
  double nearest = radius;
  for (std::size_t i = 0; i < record.features.size(); ++i) {
    const cv::Point2f& place = record.features[i].pixel;
    const double away =
        std::hypot(static_cast<double>(place.x) - pixel.x(), static_cast<double>(place.y) - pixel.y());
    if (away > nearest) continue;
    nearest = away;
    best = static_cast<int>(i);
  }
  return best;
}

std::optional<int> telling_feature(const FrameRecord& record, const cv::Size& image) {
  std::optional<int> removed, worst;
  float nearest = std::numeric_limits<float>::max(), largest = -1.0F;
  const cv::Point2f middle(0.5F * static_cast<float>(image.width), 0.5F * static_cast<float>(image.height));
  for (std::size_t i = 0; i < record.features.size(); ++i) {
    const FeatureRecord& feature = record.features[i];
    const float away = distance(feature.pixel, middle);
    if (feature.fate == FeatureFate::removed && away < nearest) {
      nearest = away;
      removed = static_cast<int>(i);
    }
    if (feature.residual_px > largest) {
      largest = feature.residual_px;
      worst = static_cast<int>(i);
    }
  }
  return removed ? removed : worst;
}

std::optional<int> find_selected(const FrameView& view, const FeatureSelection& selected) {
  if (view.record == nullptr) return std::nullopt;
  const FrameRecord& record = *view.record;
  if (selected.frame == view.index) {
    if (selected.index < 0 || selected.index >= static_cast<int>(record.features.size())) return std::nullopt;
    return selected.index;
  }
  if (const auto found = with_map_point(record, selected.feature.map_point)) return found;
  const cv::Point2f& was = selected.feature.pixel;
  if (selected.frame == view.reference.index && view.reference.readable())
    if (const Mark* track = nearest_track(view, was, true))
      return like_near(record, selected.feature, was + track->at - *track->from, kFlowRadius);
  // A frame or so away little moves by more than this.
  if (std::abs(selected.frame - view.index) > 2) return std::nullopt;
  return like_near(record, selected.feature, was, kNearbyRadius);
}

}  // namespace stillpoint
