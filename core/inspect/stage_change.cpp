#include "core/inspect/stage_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/frame_stages.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

constexpr double kGreyRange = 40.0;  // grey levels: what is shown as a change of them, at most

/// What is in `now` and not in `before`, CV_32FC1, in an image of its own: both stay as they are.
cv::Mat difference_of(const cv::Mat& before, const cv::Mat& now) {
  cv::Mat difference;
  cv::subtract(now, before, difference, cv::noArray(), CV_32F);
  return difference;
}

/// A layer to show a change in: in the place of another, without its image and marks.
Layer in_place_of(const Layer& now, LayerKind kind, const cv::Mat& image) {
  Layer layer = now;
  layer.kind = kind;
  layer.image = image;  // another header: now's pixels are the run's own
  layer.marks.clear();
  return layer;
}

bool is_grey(const Layer& layer) {
  return layer.kind == LayerKind::kPhoto || layer.kind == LayerKind::kLevels;
}

/// An image of the frame before in this frame's pixels, by depth and both poses; without these as it is.
cv::Mat warped_here(const FrameView& view, const Camera& camera, const Layer& old, int factor) {
  if (old.space != FrameSpace::kTarget && old.space != FrameSpace::kSmall) return old.image;
  if (view.frame.depth.empty() || view.record == nullptr || view.before->record == nullptr ||
      !view.record->estimated || !view.before->record->estimated)
    return old.image;
  PairGeometry pair;
  pair.camera = camera;
  pair.target_depth = view.frame.depth;
  pair.reference_from_target =
      view.before->record->world_from_camera.inverse() * view.record->world_from_camera;
  const double f = old.space == FrameSpace::kSmall ? factor : 1.0;
  cv::Mat places(old.image.size(), CV_32FC2);
  for (int y = 0; y < places.rows; ++y)
    for (int x = 0; x < places.cols; ++x) {
      const Eigen::Vector2d here = upsampled(Eigen::Vector2d(x, y), f);
      const auto there = scene_point_in(pair, FrameSpace::kReference, here);
      const Eigen::Vector2d from = downsampled(there ? there->pixel : here, f);
      places.at<cv::Vec2f>(y, x) = {static_cast<float>(from.x()), static_cast<float>(from.y())};
    }
  cv::Mat warped;
  cv::remap(old.image, warped, places, cv::Mat(), is_grey(old) ? cv::INTER_LINEAR : cv::INTER_NEAREST);
  return warped;
}

std::optional<StageChange> compare_images(const Layer& before, const Layer& now) {
  if (before.image.empty() || now.image.empty() || before.image.size() != now.image.size() ||
      before.image.type() != now.image.type() || now.image.channels() != 1)
    return std::nullopt;
  StageChange change;
  if (now.kind == LayerKind::kMask) {
    const cv::Mat image = mask_change(before.image, now.image);
    change.layer = in_place_of(now, LayerKind::kMaskChange, image);
    const auto count = [&](MaskChange kind) { return cv::countNonZero(image == kind); };
    change.text =
        fmt::format("{} px gained, {} px lost, {} px stay", count(kGained), count(kLost), count(kStays));
    return change;
  }
  if (now.kind == LayerKind::kClasses) {
    const cv::Mat other = before.image != now.image;
    cv::Mat where_other;
    cv::bitwise_and(now.image, other, where_other);
    change.layer = in_place_of(now, LayerKind::kClasses, where_other);
    change.text = fmt::format("{} px of another class", cv::countNonZero(other));
    return change;
  }
  const cv::Mat image = difference_of(before.image, now.image);
  change.layer = in_place_of(now, LayerKind::kSigned, image);
  if (is_grey(now)) change.layer.range = kGreyRange, change.layer.unit = "grey levels";
  const cv::Mat known = image == image;
  change.text = fmt::format("mean change {:.2f} {}", cv::mean(cv::abs(image), known)[0], change.layer.unit);
  return change;
}

bool speaks_for(MarkKind kind) { return kind == MarkKind::kInlier || kind == MarkKind::kKept; }

/// Marks that are inliers, or kept, now and were not, and the other way. Both lists are of the same points.
std::optional<StageChange> compare_marks(const Layer& before, const Layer& now) {
  if (now.marks.empty() || before.marks.size() != now.marks.size()) return std::nullopt;
  StageChange change;
  change.layer = now;
  change.layer.marks.clear();
  int gained = 0, lost = 0;
  for (std::size_t i = 0; i < now.marks.size(); ++i) {
    const bool was = speaks_for(before.marks[i].kind), is = speaks_for(now.marks[i].kind);
    if (was == is) continue;
    ++(is ? gained : lost);
    change.layer.marks.push_back(
        {now.marks[i].at, now.marks[i].from, is ? MarkKind::kGained : MarkKind::kLost});
  }
  change.text = fmt::format("{} inliers gained, {} lost", gained, lost);
  return change;
}

/// Map points seen now and not in the frame before, and the other way.
StageChange compare_features(const FrameRecord& before, const FrameRecord& now, const Layer& ground) {
  std::map<int, cv::Point2f> old;
  for (const FeatureRecord& feature : before.features)
    if (feature.fate == FeatureFate::inlier && feature.map_point != kNone)
      old.emplace(feature.map_point, feature.pixel);
  StageChange change;
  change.layer = ground;
  change.layer.marks.clear();
  int gained = 0, stays = 0;
  for (const FeatureRecord& feature : now.features) {
    if (feature.fate != FeatureFate::inlier || feature.map_point == kNone) continue;
    if (old.erase(feature.map_point) > 0) {
      ++stays;
      continue;
    }
    ++gained;
    change.layer.marks.push_back({feature.pixel, std::nullopt, MarkKind::kGained});
  }
  for (const auto& [point, pixel] : old) change.layer.marks.push_back({pixel, std::nullopt, MarkKind::kLost});
  change.text =
      fmt::format("{} map points gained, {} lost, {} seen in both frames", gained, old.size(), stays);
  return change;
}

std::optional<StageChange> against_stage_before(const StageSide& side) {
  if (side.inputs.empty()) return std::nullopt;
  const Layer& before = side.inputs.front();
  const Layer& now = side.output;
  const bool comparable = before.kind == now.kind && before.space == now.space && before.unit == now.unit &&
                          before.marks.empty() && now.marks.empty() && !before.elsewhere;
  if (!comparable) return std::nullopt;
  std::optional<StageChange> change = compare_images(before, now);
  if (change) change->against = before.name;
  return change;
}

const Stage* same_stage(const std::vector<Stage>& stages, const Stage& wanted, int round) {
  const auto it = std::find_if(stages.begin(), stages.end(), [&](const Stage& one) {
    return one.id == wanted.id && one.reference == wanted.reference && one.round == round;
  });
  return it == stages.end() ? nullptr : &*it;
}

std::optional<StageChange> against_round_before(const std::vector<Stage>& stages, const Stage& stage,
                                                std::size_t side) {
  if (stage.round < 1) return std::nullopt;
  const Stage* old = same_stage(stages, stage, stage.round - 1);
  if (old == nullptr || side >= old->sides.size()) return std::nullopt;
  const Layer &before = old->sides[side].output, &now = stage.sides[side].output;
  std::optional<StageChange> change =
      now.marks.empty() ? compare_images(before, now) : compare_marks(before, now);
  if (change) change->against = fmt::format("Round {}", stage.round);
  return change;
}

std::optional<StageChange> against_frame_before(const FrameView& view, const Camera& camera,
                                                const Stage& stage, std::size_t side) {
  // Frames of unlike gaps differ by their references: what changes from one to the other would be these.
  constexpr int kFrames = 2;  // as many may be missing
  if (view.before == nullptr) return std::nullopt;
  const Layer& now = stage.sides[side].output;
  std::optional<StageChange> change;
  const bool of_engine = of_odometry(stage) && view.odometry && now.marks.empty();
  if (of_engine) {
    if (!view.before->odometry) return std::nullopt;
    const Stage* old = same_stage(view.before->odometry->stages, stage, stage.round);
    if (old == nullptr || side >= old->sides.size() || old->sides[side].output.image.empty())
      return std::nullopt;
    change = compare_images(old->sides[side].output, now);
  } else if (of_odometry(stage)) {
    if (view.before->record == nullptr || view.record == nullptr) return std::nullopt;
    change = compare_features(*view.before->record, *view.record, now);
  } else {
    if (!view.before->motion || !now.marks.empty()) return std::nullopt;
    const Stage* old = same_stage(view.before->motion->stages, stage, stage.round);
    if (old == nullptr || side >= old->sides.size() ||
        std::abs(old->frames_back - stage.frames_back) > kFrames)
      return std::nullopt;
    Layer before = old->sides[side].output;
    if (before.image.empty()) return std::nullopt;
    before.image = warped_here(view, camera, before, view.motion->small_factor);
    change = compare_images(before, now);
  }
  if (change) change->against = fmt::format("Frame {}", view.before->index);
  return change;
}

}  // namespace

std::optional<StageChange> stage_change(const FrameView& view, const Camera& camera,
                                        const std::vector<Stage>& stages, std::size_t index, std::size_t side,
                                        ChangeAgainst against) {
  const Stage& stage = stages[index];
  if (side >= stage.sides.size()) return std::nullopt;
  switch (against) {
    case ChangeAgainst::kStageBefore:
      return against_stage_before(stage.sides[side]);
    case ChangeAgainst::kRoundBefore:
      return against_round_before(stages, stage, side);
    case ChangeAgainst::kFrameBefore:
      return against_frame_before(view, camera, stage, side);
  }
  return std::nullopt;
}

cv::Mat mask_change(const cv::Mat& before, const cv::Mat& after) {
  if (after.empty()) return {};
  cv::Mat change(after.size(), CV_8UC1, cv::Scalar(kClear));
  const cv::Mat old = before.empty() ? cv::Mat::zeros(after.size(), CV_8UC1) : before;
  for (int y = 0; y < after.rows; ++y)
    for (int x = 0; x < after.cols; ++x) {
      const bool was = old.at<std::uint8_t>(y, x) != 0, is = after.at<std::uint8_t>(y, x) != 0;
      change.at<std::uint8_t>(y, x) = was ? (is ? kStays : kLost) : (is ? kGained : kClear);
    }
  return change;
}

}  // namespace stillpoint
