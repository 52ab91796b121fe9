// The motion stages of the paper and of method `stillpoint`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/median.hpp"
#include "core/motion/paper/homography.hpp"
#include "core/motion/regions.hpp"
#include "ui/session/stages.hpp"

namespace stillpoint {
namespace {

double percent_set(const cv::Mat& mask) {
  if (mask.empty()) return 0.0;
  return 100.0 * static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

double count_tracks(const DirectionTrace& direction, bool Track::*which) {
  return static_cast<double>(std::count_if(direction.tracks.begin(), direction.tracks.end(),
                                           [which](const Track& track) { return track.*which; }));
}

/// What a round's homography is held against: the round's before, or standing still.
void add_homography(const MotionRound& round, const MotionRound* last, StageInfo& stage) {
  const cv::Size size = round.forward.compensated.size();
  for (const bool forward : {true, false}) {
    const DirectionTrace& direction = forward ? round.forward : round.backward;
    const std::string name = forward ? "Forward" : "Backward";
    stage.ms += direction.ms.homography;
    if (!direction.homography.valid) {
      stage.note += fmt::format("{} no homography fits{}. ", name + ":",
                                direction.compensated.empty() ? "" : "; the last round's stands");
      continue;
    }
    add_figure(stage, name + ": inliers", direction.homography.ransac_inliers);
    add_figure(stage, name + ": RMS after RANSAC", direction.homography.ransac_error_px, "px", 3);
    add_figure(stage, name + ": RMS refined", direction.homography.refined_error_px, "px", 3);
    if (size.empty()) continue;
    add_figure(stage, name + ": furthest corner moves",
               corner_shift_px(cv::Matx33d::eye(), direction.homography.matrix, size), "px", 2);
    if (last == nullptr) continue;
    const DirectionTrace& old = forward ? last->forward : last->backward;
    if (!old.compensated.empty())
      add_figure(stage, name + ": corners differ from the round before",
                 corner_shift_px(old.homography.matrix, direction.homography.matrix, size), "px", 2);
  }
}

void add_direction_masks(const MotionRound& round, cv::Mat DirectionTrace::*mask, StageInfo& stage) {
  add_figure(stage, "Forward", percent_set(round.forward.*mask), "%", 2);
  add_figure(stage, "Backward", percent_set(round.backward.*mask), "%", 2);
}

/// A stage of one round, timed by both directions.
StageInfo& add_round_stage(std::vector<StageInfo>& stages, StageKind kind, int round, const char* name,
                           const char* what) {
  StageInfo& stage = add_stage(stages, kind, fmt::format("Round {}", round + 1), name, what);
  stage.round = round;
  return stage;
}

void add_warp_stages(const MotionRound& round, const MotionRound* last, int index,
                     std::vector<StageInfo>& stages) {
  StageInfo& homography = add_round_stage(
      stages, StageKind::kHomography, index, "Homography",
      "RANSAC over the static tracks, then Levenberg-Marquardt on the inliers: eqs. (3), (4).");
  homography.two_ways = true;
  add_homography(round, last, homography);

  StageInfo& compensation = add_round_stage(stages, StageKind::kCompensation, index, "Compensation",
                                            "Carries each frame into the other's camera by its homography.");
  compensation.two_ways = true;
  compensation.ms = round.forward.ms.compensation + round.backward.ms.compensation;
  add_direction_masks(round, &DirectionTrace::valid, compensation);
  for (StageFigure& figure : compensation.figures) figure.name += ": pixels with data";

  StageInfo& difference = add_round_stage(stages, StageKind::kDifference, index, "Difference",
                                          "What differs between a frame and the compensated one: eq. (1).");
  difference.two_ways = true;
  difference.ms = round.forward.ms.difference + round.backward.ms.difference;
  for (const bool forward : {true, false}) {
    const DirectionTrace& direction = forward ? round.forward : round.backward;
    if (direction.difference.empty()) continue;
    add_figure(difference, forward ? "Forward: mean" : "Backward: mean",
               cv::mean(direction.difference, direction.valid)[0], "grey levels", 2);
  }
}

void add_mask_stages(const MotionRound& round, int index, bool last_round, std::vector<StageInfo>& stages) {
  StageInfo& threshold = add_round_stage(stages, StageKind::kThreshold, index, "Threshold",
                                         "Binarises the difference at Otsu's threshold: eq. (2).");
  threshold.two_ways = true;
  threshold.ms = round.forward.ms.threshold + round.backward.ms.threshold;
  add_figure(threshold, "Forward: threshold", round.forward.threshold, "grey levels");
  add_figure(threshold, "Backward: threshold", round.backward.threshold, "grey levels");
  add_direction_masks(round, &DirectionTrace::raw_mask, threshold);

  StageInfo& cleaned = add_round_stage(stages, StageKind::kCleanUp, index, "Clean-up",
                                       "Erodes, dilates, and takes what has no data for not moving.");
  cleaned.two_ways = true;
  cleaned.ms = round.forward.ms.cleanup + round.backward.ms.cleanup;
  add_direction_masks(round, &DirectionTrace::mask, cleaned);

  StageInfo& united =
      add_round_stage(stages, StageKind::kUnion, index, "Union and regions",
                      "The backward mask carried to the target, united with the forward one.");
  united.ms = round.union_ms;
  add_figure(united, "Mask", 100.0 * round.mask_share, "%", 2);
  add_figure(united, "Regions", static_cast<double>(round.regions.size()));
  add_figure(united, "Forward alone", percent_set(round.forward.mask), "%", 2);
  add_figure(united, "Backward carried", percent_set(round.backward_mask_in_target), "%", 2);

  StageInfo& removal = add_round_stage(stages, StageKind::kTrackRemoval, index, "Removal of tracks",
                                       "Tracks in the mask do not enter the next round's homography.");
  removal.two_ways = true;
  removal.ms = round.removal_ms;
  add_figure(removal, "Tracks that change sides", round.changed_tracks);
  add_figure(removal, "Forward: tracks before",
             static_cast<double>(round.forward.tracks.size()) - count_tracks(round.forward, &Track::removed));
  if (last_round)
    removal.note = round.changed_tracks == 0 ? "Nothing changes any more: this was the last round."
                                             : "This was the last round.";
}

}  // namespace

void add_paper_stages(const FrameView& view, std::vector<StageInfo>& stages) {
  const PaperTrace& motion = view.motion;
  if (motion.rounds.empty()) return;
  StageInfo& tracks = add_stage(stages, StageKind::kTracks, "Tracks", "Tracks",
                                "Corners of one frame followed into the other by pyramidal Lucas-Kanade.");
  tracks.two_ways = true;
  tracks.ms = motion.tracks_ms;
  add_figure(tracks, "Forward", static_cast<double>(motion.rounds.front().forward.tracks.size()));
  add_figure(tracks, "Backward", static_cast<double>(motion.rounds.front().backward.tracks.size()));
  std::vector<double> lengths;
  for (const Track& track : motion.rounds.front().forward.tracks)
    lengths.push_back(std::hypot(static_cast<double>(track.to.x - track.from.x),
                                 static_cast<double>(track.to.y - track.from.y)));
  if (!lengths.empty()) add_figure(tracks, "Forward: median length", median_of(lengths), "px", 2);
  for (std::size_t i = 0; i < motion.rounds.size(); ++i) {
    const auto index = static_cast<int>(i);
    add_warp_stages(motion.rounds[i], i > 0 ? &motion.rounds[i - 1] : nullptr, index, stages);
    add_mask_stages(motion.rounds[i], index, i + 1 == motion.rounds.size(), stages);
  }
  stages.back().note += (stages.back().note.empty() || motion.note.empty() ? "" : " ") + motion.note;
}

namespace {

double share_above(const cv::Mat& values, double limit) {
  if (values.empty()) return 0.0;
  const int above = cv::countNonZero(values > limit);
  return 100.0 * above / static_cast<double>(values.total());
}

double share_known(const cv::Mat& values) {
  if (values.empty()) return 0.0;
  return 100.0 * cv::countNonZero(values == values) / static_cast<double>(values.total());
}

/// How patches shifted, of those that say something.
void add_patch_figures(const ReferenceEvidence& evidence, StageInfo& stage) {
  std::vector<double> shifts;
  int moving = 0;
  for (const PatchMotion& patch : evidence.patches) {
    if (patch.log_odds == 0.0F) continue;
    shifts.push_back(cv::norm(patch.shift));
    moving += patch.log_odds > 0.0F ? 1 : 0;
  }
  add_figure(stage, "Patches measured", static_cast<double>(shifts.size()));
  add_figure(stage, "Of them speak for moving", moving);
  if (shifts.empty()) {
    stage.note = "No patch has texture enough to say how far it shifted.";
    return;
  }
  std::sort(shifts.begin(), shifts.end());
  add_figure(stage, "Median shift", shifts[shifts.size() / 2], "small px", 2);
  add_figure(stage, "Largest shift", shifts.back(), "small px", 2);
}

void add_reference_stages(const ReferenceEvidence& evidence, int index, std::size_t count,
                          const StillpointConfig& config, std::vector<StageInfo>& stages) {
  const std::string group = count == 1 ? "Reference" : index == 0 ? "Near reference" : "Far reference";
  const auto add = [&](StageKind kind, const char* name, const char* what) -> StageInfo& {
    StageInfo& stage = add_stage(stages, kind, group, name, what);
    stage.reference = index;
    stage.timed = false;
    return stage;
  };
  const Pose& motion = evidence.reference.reference_from_current;
  StageInfo& warp = add(StageKind::kWarp, "Warp",
                        "Carries every pixel with depth into an earlier frame by the camera's own motion.");
  warp.ms = evidence.ms;
  warp.timed = true;
  add_figure(warp, "Frames back", evidence.reference.frames_back);
  add_figure(warp, "Camera moved", 1000.0 * motion.translation().norm(), "mm", 1);
  add_figure(warp, "Camera turned", rotation_angle(motion.linear()) * 180.0 / CV_PI, "°", 2);
  add_figure(warp, "Comparable", share_known(evidence.depth_residual), "%", 1);

  StageInfo& depth = add(StageKind::kDepthResidual, "Depth residual",
                         "Measured less expected depth there, in standard deviations of the sensor.");
  add_figure(depth, "Farther than the limit", share_above(evidence.depth_residual, config.depth_sigmas), "%",
             2);
  add_figure(depth, "Nearer than the limit", share_above(-evidence.depth_residual, config.depth_sigmas), "%",
             2);

  StageInfo& brightness = add(StageKind::kBrightnessResidual, "Brightness residual",
                              "Where the surface is the same: what gradient and exposure do not explain.");
  const double limit = config.intensity_sigmas * evidence.intensity_sigma;
  add_figure(brightness, "Noise", evidence.intensity_sigma, "grey levels", 2);
  add_figure(brightness, "Limit", limit, "grey levels", 1);
  add_figure(brightness, "Above the limit", share_above(evidence.intensity_residual, limit), "%", 2);

  StageInfo& said = add(StageKind::kEvidence, "Evidence", "Both residuals as log-odds of moving.");
  add_figure(said, "Speaks for moving", share_above(evidence.log_odds, 0.0), "%", 2);
  add_figure(said, "Speaks for still", share_above(-evidence.log_odds, 0.0), "%", 2);
  if (!evidence.patches.empty())
    add_patch_figures(evidence, add(StageKind::kPatchShifts, "Patch shifts",
                                    "Shifts each patch to where it fits best, and takes off the camera's "
                                    "motion that explains most: what is left tells slow movers."));
}

}  // namespace

void add_stillpoint_stages(const FrameView& view, const Config& config, std::vector<StageInfo>& stages) {
  const StillpointTrace& trace = view.depth_motion;
  if (trace.log_odds.empty()) return;
  const StillpointConfig& limits = config.depth_motion;
  StageInfo& small = add_stage(stages, StageKind::kSmallView, "Motion", "Small view",
                               "Grey, gradient and depth made smaller: where motion is judged.");
  small.timed = false;
  add_figure(small, "Width", trace.log_odds.cols, "px");
  add_figure(small, "Height", trace.log_odds.rows, "px");
  StageInfo& pose = add_stage(stages, StageKind::kFirstPose, "Motion", "Consensus pose",
                              "A first pose that most of the image agrees on, from samples and predictions.");
  if (view.record != nullptr) {
    pose.ms = view.record->ms.consensus;
    pose.note = fmt::format("Begun from: {}.", to_string(view.record->pose_start));
  }
  for (std::size_t i = 0; i < trace.references.size(); ++i)
    add_reference_stages(trace.references[i], static_cast<int>(i), trace.references.size(), limits, stages);

  StageInfo& memory =
      add_stage(stages, StageKind::kMemory, "Judgement", "Memory",
                "What the frame before held to move, carried along; all evidence added to it.");
  memory.ms = trace.ms.memory;
  add_figure(memory, "Remembered as moving", share_above(trace.prior, limits.moving_log_odds), "%", 2);
  if (!trace.slow.empty())
    add_figure(memory, "Patches' shifts speak for moving", share_above(trace.slow, 0.0), "%", 2);
  add_figure(memory, "With all evidence", share_above(trace.log_odds, limits.moving_log_odds), "%", 2);

  StageInfo& segments =
      add_stage(stages, StageKind::kSegments, "Judgement", "Segments",
                "Patches of one surface; each takes the mean of its pixels and listens to its "
                "neighbours.");
  segments.ms = trace.ms.segments;
  add_figure(segments, "Patches", static_cast<double>(trace.segments.size()));
  add_figure(segments, "Moving",
             static_cast<double>(std::count_if(trace.segments.begin(), trace.segments.end(),
                                               [](const Segment& s) { return s.moving; })));

  StageInfo& mask =
      add_stage(stages, StageKind::kMotionMask, "Judgement", "Mask",
                "Moving patches, small regions dropped, the outline fitted to the depth image.");
  mask.ms = trace.ms.mask;
  add_figure(mask, "Small mask", percent_set(trace.small_mask), "%", 2);
  add_figure(mask, "Mask", 100.0 * trace.mask_share, "%", 2);
  add_figure(mask, "Regions", static_cast<double>(find_regions(trace.mask).regions.size()));
  mask.note = trace.note;
}

}  // namespace stillpoint
