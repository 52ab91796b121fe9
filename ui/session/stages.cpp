#include "ui/session/stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace stillpoint {
namespace {

constexpr const char* kOdometry = "Odometry";

void add_known_mask(const FrameView& view, std::vector<StageInfo>& stages) {
  StageInfo& stage = add_stage(stages, StageKind::kTrueMask, "Motion", "True mask",
                               "Takes the mask of what truly moves: a reference, not a method.");
  stage.timed = false;
  add_figure(stage, "Mask", view.record != nullptr ? 100.0 * view.record->mask_share : 0.0, "%", 2);
}

void add_feature_stages(const FrameRecord& record, std::vector<StageInfo>& stages) {
  StageInfo& features = add_stage(stages, StageKind::kFeatures, kOdometry, "Features",
                                  "Finds ORB features spread over the image.");
  features.ms = record.ms.features;
  add_figure(features, "Found", record.features_found);
  const auto with_depth = std::count_if(record.features.begin(), record.features.end(),
                                        [](const FeatureRecord& f) { return f.depth > 0.0F; });
  if (!record.features.empty()) add_figure(features, "With depth", static_cast<double>(with_depth));
  StageInfo& removal = add_stage(stages, StageKind::kFeatureRemoval, kOdometry, "Removal",
                                 "Takes out the features inside the motion mask; the rest count as static.");
  removal.timed = false;
  add_figure(removal, "Removed", record.features_removed);
  add_figure(removal, "Kept", record.features_kept);
  if (record.features_found > 0)
    add_figure(removal, "Removed share", 100.0 * record.features_removed / record.features_found, "%", 1);
}

void add_pose_stages(const FrameRecord& record, std::vector<StageInfo>& stages) {
  StageInfo& matching = add_stage(stages, StageKind::kMatching, kOdometry, "Matching",
                                  "Matches the static features to points of the local map.");
  matching.ms = record.ms.matching;
  add_figure(matching, "Matches", record.matches);
  add_figure(matching, "Of the kept",
             record.features_kept > 0 ? 100.0 * record.matches / record.features_kept : 0.0, "%", 1);

  StageInfo& start =
      add_stage(stages, StageKind::kInitialPose, kOdometry, "Initial pose",
                "A first pose: by the motion model where it holds, else by EPnP inside RANSAC.");
  start.ms = record.ms.epnp;
  start.timed = record.ms.epnp > 0.0;
  start.note = record.pose_start == PoseStart::none
                   ? "No pose was come by."
                   : fmt::format("This frame's pose was begun from: {}.", to_string(record.pose_start));

  StageInfo& refined =
      add_stage(stages, StageKind::kRefinement, kOdometry, "Refinement",
                "Minimises the reprojection error over the pose in se(3), eq. (5), robustly.");
  refined.ms = record.ms.refine;
  add_figure(refined, "Inliers", record.inliers);
  add_figure(refined, "Outliers", record.matches - record.inliers);
  add_figure(refined, "Reprojection RMS", record.rms_px, "px", 3);
  add_figure(refined, "Weigh under half", weighing_little(record.features));
  add_figure(refined, "Steps", record.refine_iterations);
  if (!record.estimated) refined.note = record.note;
}

/// Of a frame whose corners starved; of all others there is nothing to tell.
void add_direct_stage(const FrameRecord& record, std::vector<StageInfo>& stages) {
  const DirectRecord& direct = record.direct;
  if (direct.reference_frame == kNone) return;
  StageInfo& stage = add_stage(stages, StageKind::kDirectRefinement, kOdometry, "Direct refinement",
                               "Too few corners: small patches of an earlier frame are laid where they look "
                               "alike, coarse to fine, outside the motion mask.");
  stage.ms = record.ms.direct;
  add_figure(stage, "Frames back", record.index - direct.reference_frame);
  add_figure(stage, "Patches in view", direct.patches);
  add_figure(stage, "Steps", direct.iterations);
  add_figure(stage, "Residual before", direct.rms_before, "grey levels", 2);
  add_figure(stage, "Residual after", direct.rms_after, "grey levels", 2);
  add_figure(stage, "Correlation", direct.correlation, "", 3);
  add_figure(stage, "At the depth expected", 100.0 * direct.agreement, "%", 1);
  add_figure(stage, "Share in the pose", 100.0 * direct.share, "%", 1);
  stage.note = !direct.believed      ? "It is not believed: the patches are too few, too unlike or elsewhere."
               : direct.share >= 1.0 ? "The pose is by patches alone."
               : direct.share > 0.0  ? "The pose is by corners and patches, each by its information."
                                     : "The first pose, under which motion is judged, is by patches.";
}

void add_map_stages(const FrameRecord& record, std::vector<StageInfo>& stages) {
  StageInfo& mapping =
      add_stage(stages, StageKind::kMapping, kOdometry, "Keyframe and map",
                "Makes a keyframe where too little of the last one is left, and new points.");
  mapping.ms = record.ms.mapping;
  add_figure(mapping, "New points", record.new_points);
  add_figure(mapping, "Fused", record.fused_points);
  add_figure(mapping, "Culled", record.culled_points);
  add_figure(mapping, "Points in the map", record.map_points);
  add_figure(mapping, "Keyframes", record.map_keyframes);
  if (!record.keyframe) mapping.note = "This frame is no keyframe.";

  StageInfo& bundle =
      add_stage(stages, StageKind::kBundle, kOdometry, "Bundle adjustment",
                "Refines the local keyframes and the points they share; enters the map at a fixed "
                "frame. The time is what this frame waited for it.");
  bundle.ms = record.ms.bundle;
  if (record.bundle_iterations == 0) {
    bundle.note = "None entered the map in this frame.";
    return;
  }
  add_figure(bundle, "RMS before", record.bundle_rms_before_px, "px", 3);
  add_figure(bundle, "RMS after", record.bundle_rms_px, "px", 3);
  add_figure(bundle, "Steps", record.bundle_iterations);
  add_figure(bundle, "Culled keyframes", record.culled_keyframes);
}

/// What changed among features since the frame before, by map point.
void compare_matches(const FrameRecord& now, const FrameRecord& before, std::vector<StageInfo>& stages) {
  const auto points_of = [](const FrameRecord& record) {
    std::set<int> points;
    for (const FeatureRecord& feature : record.features)
      if (feature.map_point != kNone && feature.fate == FeatureFate::inlier) points.insert(feature.map_point);
    return points;
  };
  const std::set<int> seen = points_of(now), seen_before = points_of(before);
  if (seen.empty() || seen_before.empty()) return;
  const auto shared =
      std::count_if(seen.begin(), seen.end(), [&](int id) { return seen_before.count(id) > 0; });
  for (StageInfo& stage : stages)
    if (stage.kind == StageKind::kRefinement) {
      add_figure(stage, "Points gained", static_cast<double>(seen.size()) - static_cast<double>(shared));
      add_figure(stage, "Points lost", static_cast<double>(seen_before.size()) - static_cast<double>(shared));
    }
}

void add_odometry_stages(const FrameRecord& record, std::vector<StageInfo>& stages) {
  add_feature_stages(record, stages);
  add_pose_stages(record, stages);
  add_direct_stage(record, stages);
  add_map_stages(record, stages);
}

std::vector<StageInfo> list_stages(const FrameView& view, const Config& config) {
  std::vector<StageInfo> stages;
  const std::string& method = config.run.method;
  if (method == "paper") add_paper_stages(view, stages);
  if (method == "stillpoint") add_stillpoint_stages(view, config, stages);
  if (method == "stillpoint" && !view.frame.has_depth()) add_colour_stages(view, config, stages);
  if (method == "oracle") add_known_mask(view, stages);
  if (view.record != nullptr && view.frame.readable()) add_odometry_stages(*view.record, stages);
  return stages;
}

const StageFigure* figure_named(const StageInfo& stage, const std::string& name) {
  const auto it = std::find_if(stage.figures.begin(), stage.figures.end(),
                               [&](const StageFigure& figure) { return figure.name == name; });
  return it == stage.figures.end() ? nullptr : &*it;
}

void hold_against(std::vector<StageInfo>& stages, const std::vector<StageInfo>& others, int rounds_back,
                  std::optional<double> StageFigure::*into) {
  for (StageInfo& stage : stages) {
    if (rounds_back > 0 && stage.round < rounds_back) continue;
    StageInfo wanted = stage;
    wanted.round -= rounds_back;
    const auto other = std::find_if(others.begin(), others.end(),
                                    [&](const StageInfo& one) { return one.same_place(wanted); });
    if (other == others.end()) continue;
    for (StageFigure& figure : stage.figures)
      if (const StageFigure* same = figure_named(*other, figure.name)) figure.*into = same->value;
  }
}

}  // namespace

std::vector<StageInfo> stages_of(const FrameView& view, const Config& config) {
  std::vector<StageInfo> stages = list_stages(view, config);
  const std::vector<StageInfo> plain = stages;
  hold_against(stages, plain, 1, &StageFigure::round_before);
  if (view.before == nullptr) return stages;
  hold_against(stages, list_stages(*view.before, config), 0, &StageFigure::frame_before);
  if (view.record != nullptr && view.before->record != nullptr)
    compare_matches(*view.record, *view.before->record, stages);
  return stages;
}

std::string figure_text(const StageFigure& figure) {
  return fmt::format("{:.{}f}{}{}", figure.value, figure.digits, figure.unit.empty() ? "" : " ", figure.unit);
}

std::string change_text(const StageFigure& figure, double before) {
  const double change = figure.value - before;
  const double least = 0.5 * std::pow(10.0, -figure.digits);
  if (std::abs(change) < least) return "±0";
  return fmt::format("{:+.{}f}{}{}", change, figure.digits, figure.unit.empty() ? "" : " ", figure.unit);
}

std::size_t find_stage(const std::vector<StageInfo>& stages, const StageInfo& wanted) {
  std::optional<std::size_t> like;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (stages[i].same_place(wanted)) return i;
    // Of a round this frame does not have, the last there is stands for it.
    if (stages[i].kind == wanted.kind) like = i;
  }
  return like.value_or(0);
}

StageInfo& add_stage(std::vector<StageInfo>& stages, StageKind kind, std::string group, std::string name,
                     std::string what) {
  StageInfo stage;
  stage.kind = kind;
  stage.group = std::move(group);
  stage.name = std::move(name);
  stage.what = std::move(what);
  stages.push_back(std::move(stage));
  return stages.back();
}

void add_figure(StageInfo& stage, std::string name, double value, std::string unit, int digits) {
  stage.figures.push_back({std::move(name), value, std::move(unit), digits, {}, {}});
}

}  // namespace stillpoint
