// What changed in a stage against the stage, the round or the frame before.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

#include "ui/session/stage_pictures.hpp"

namespace stillpoint {
namespace {

cv::Mat as_float(const cv::Mat& image) {
  cv::Mat floats;
  image.convertTo(floats, CV_32F);
  return floats;
}

/// H for small images: those have their pixels' middles elsewhere.
cv::Matx33d for_small(const cv::Matx33d& homography, int factor) {
  const double f = factor, shift = (1.0 - f) / (2.0 * f);
  const cv::Matx33d small(1.0 / f, 0.0, shift, 0.0, 1.0 / f, shift, 0.0, 0.0, 1.0);
  return small * homography * small.inv();
}

/// The frame before's picture where this frame has its camera.
cv::Mat carried_here(const FrameView& view, const StagePicture& old, int factor) {
  // The reference's camera is the target's of the frame before: its own pair tells what came between.
  const PaperTrace& between = old.space == FrameSpace::kReference ? view.before->motion : view.motion;
  if (between.rounds.empty()) return old.image;
  cv::Matx33d homography = between.rounds.back().forward.homography.matrix;
  if (old.space == FrameSpace::kSmall) homography = for_small(homography, factor);
  const bool is_mask = old.look == PictureLook::kMask;
  cv::Mat carried;
  cv::warpPerspective(old.image, carried, homography, old.image.size(),
                      is_mask || old.look == PictureLook::kSigned ? cv::INTER_NEAREST : cv::INTER_LINEAR);
  return carried;
}

StageChange compare_pictures(const StagePicture& before, const StagePicture& now) {
  StageChange change;
  change.picture = now;
  change.picture.dots.clear();
  if (now.look == PictureLook::kMask) {
    change.picture.image = mask_change(before.image, now.image);
    change.picture.look = PictureLook::kMaskChange;
    const auto count = [&](MaskChange kind) { return cv::countNonZero(change.picture.image == kind); };
    change.text =
        fmt::format("{} px gained, {} px lost, {} px stay", count(kGained), count(kLost), count(kStays));
    return change;
  }
  change.picture.look = PictureLook::kSigned;
  change.picture.image = as_float(now.image) - as_float(before.image);
  const bool photo = now.look == PictureLook::kPhoto || now.look == PictureLook::kLevels;
  change.picture.range = photo ? 40.0 : now.range;
  if (photo) change.picture.unit = "grey levels";
  cv::Mat known = change.picture.image == change.picture.image;
  change.text = fmt::format("mean change {:.2f} {}", cv::mean(cv::abs(change.picture.image), known)[0],
                            change.picture.unit);
  return change;
}

/// Tracks that are inliers now and were not, and the other way.
StageChange compare_tracks(const DirectionTrace& before, const DirectionTrace& now,
                           const StagePicture& ground) {
  StageChange change;
  change.picture = ground;
  change.picture.dots.clear();
  int gained = 0, lost = 0;
  for (std::size_t i = 0; i < now.tracks.size() && i < before.tracks.size(); ++i) {
    if (now.tracks[i].inlier == before.tracks[i].inlier) continue;
    ++(now.tracks[i].inlier ? gained : lost);
    change.picture.dots.push_back(
        {now.tracks[i].to, now.tracks[i].from, now.tracks[i].inlier ? DotKind::kGained : DotKind::kLost});
  }
  change.text = fmt::format("{} inliers gained, {} lost", gained, lost);
  return change;
}

/// Map points seen now and not in the frame before, and the other way.
StageChange compare_features(const FrameRecord& before, const FrameRecord& now, const StagePicture& ground) {
  std::map<int, cv::Point2f> old;
  for (const FeatureRecord& feature : before.features)
    if (feature.fate == FeatureFate::inlier) old.emplace(feature.map_point, feature.pixel);
  StageChange change;
  change.picture = ground;
  change.picture.dots.clear();
  int gained = 0, stays = 0;
  for (const FeatureRecord& feature : now.features) {
    if (feature.fate != FeatureFate::inlier) continue;
    if (old.erase(feature.map_point) > 0) {
      ++stays;
      continue;
    }
    ++gained;
    change.picture.dots.push_back({feature.pixel, std::nullopt, DotKind::kGained});
  }
  for (const auto& [point, pixel] : old) change.picture.dots.push_back({pixel, std::nullopt, DotKind::kLost});
  change.text =
      fmt::format("{} map points gained, {} lost, {} seen in both frames", gained, old.size(), stays);
  return change;
}

bool judges_tracks(StageKind kind) {
  return kind == StageKind::kTracks || kind == StageKind::kHomography || kind == StageKind::kTrackRemoval;
}

std::optional<StageChange> against_stage_before(const StagePictures& pictures, StageKind kind) {
  const bool comparable = kind == StageKind::kCleanUp || kind == StageKind::kUnion ||
                          kind == StageKind::kMemory || kind == StageKind::kSegments ||
                          kind == StageKind::kWarp;
  if (!comparable || pictures.inputs.empty()) return std::nullopt;
  const StagePicture& before = pictures.inputs.front();
  if (before.image.empty() || before.image.size() != pictures.output.image.size()) return std::nullopt;
  StageChange change = compare_pictures(before, pictures.output);
  change.against = before.heading;
  return change;
}

/// Whether a stage's reference lies about as far back in both frames: far ones take turns, and what changes
/// from one to the other would be the reference.
bool same_reference(const FrameView& view, const FrameView& other, const StageInfo& stage) {
  constexpr int kFrames = 2;  // as many may be missing
  const auto at = static_cast<std::size_t>(std::max(0, stage.reference));
  const auto &now = view.depth_motion.references, &then = other.depth_motion.references;
  if (stage.reference < 0 || at >= now.size() || at >= then.size()) return true;
  return std::abs(now[at].reference.frames_back - then[at].reference.frames_back) <= kFrames;
}

}  // namespace

std::optional<StageChange> stage_change(const FrameView& view, const Camera& camera, const Config& config,
                                        const StageInfo& stage, bool backward, ChangeAgainst against) {
  const StagePictures now = stage_pictures(view, camera, config, stage, backward);
  if (against == ChangeAgainst::kStageBefore) return against_stage_before(now, stage.kind);
  const bool rounds = against == ChangeAgainst::kRoundBefore;
  if (rounds && stage.round < 1) return std::nullopt;
  if (!rounds && view.before == nullptr) return std::nullopt;
  // Of followed points the figures tell the change; the picture below them is the frame's own.
  if (of_colour(stage.kind) && now.output.look == PictureLook::kPhoto) return std::nullopt;
  StageChange change;
  const FrameView& other = rounds ? view : *view.before;
  if (of_odometry(stage.kind)) {
    if (other.record == nullptr || view.record == nullptr) return std::nullopt;
    change = compare_features(*other.record, *view.record, now.output);
  } else if (judges_tracks(stage.kind)) {
    if (!rounds) return std::nullopt;
    const MotionRound& last = view.motion.rounds[static_cast<std::size_t>(stage.round - 1)];
    const MotionRound& round = view.motion.rounds[static_cast<std::size_t>(stage.round)];
    change = compare_tracks(backward ? last.backward : last.forward,
                            backward ? round.backward : round.forward, now.output);
  } else {
    StageInfo place = stage;
    if (rounds) --place.round;
    if (place.round >= static_cast<int>(other.motion.rounds.size()) ||
        place.reference >= static_cast<int>(std::max(other.depth_motion.references.size(),
                                                     other.colour_motion.references.size())))
      return std::nullopt;
    if (!rounds && !same_reference(view, other, stage)) return std::nullopt;
    StagePicture before = stage_pictures(other, camera, config, place, backward).output;
    if (before.image.empty() || now.output.image.empty() || before.image.size() != now.output.image.size() ||
        before.image.type() != now.output.image.type())
      return std::nullopt;
    if (!rounds) before.image = carried_here(view, before, config.depth_motion.factor);
    change = compare_pictures(before, now.output);
  }
  change.against = rounds ? fmt::format("Round {}", stage.round) : fmt::format("Frame {}", other.index);
  return change;
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
