#include "core/inspect/frame_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/inspect/frame_view.hpp"
#include "core/odometry/engine_trace.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"

namespace stillpoint {
namespace {

constexpr const char* kOdometry = kOdometryGroup;

Stage& add_stage(std::vector<Stage>& stages, const char* id, std::string name, std::string what) {
  Stage stage;
  stage.id = id;
  stage.group = kOdometry;
  stage.name = std::move(name);
  stage.what = std::move(what);
  stages.push_back(std::move(stage));
  return stages.back();
}

void add_figure(Stage& stage, std::string name, double value, std::string unit = "", int digits = 0) {
  stage.figure(std::move(name), value, std::move(unit), digits);
}

std::vector<Mark> feature_marks(const FrameRecord& record, bool fates) {
  std::vector<Mark> marks;
  for (const FeatureRecord& feature : record.features) {
    const MarkKind kind = feature.fate == FeatureFate::removed   ? MarkKind::kRemoved
                          : !fates                               ? MarkKind::kKept
                          : feature.fate == FeatureFate::inlier  ? MarkKind::kInlier
                          : feature.fate == FeatureFate::outlier ? MarkKind::kOutlier
                                                                 : MarkKind::kUnmatched;
    marks.push_back({feature.pixel, std::nullopt, kind});
  }
  return marks;
}

/// Patches that were aligned directly, as squares of their residual.
Layer direct_layer(const FrameView& view, const DirectRecord& direct) {
  constexpr int kHalf = 4;  // px to each side: a square that can be seen and pointed at
  cv::Mat values(view.frame.gray.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  if (direct.seen)
    for (const DirectPatch& patch : *direct.seen) {
      const cv::Point middle(cvRound(patch.pixel.x), cvRound(patch.pixel.y));
      const cv::Rect square(middle.x - kHalf, middle.y - kHalf, 2 * kHalf + 1, 2 * kHalf + 1);
      values(square & cv::Rect({0, 0}, values.size())).setTo(patch.residual);
    }
  return signed_layer("Patches by their residual", values, std::max(10.0, std::ceil(2.0 * direct.rms_after)),
                      "grey levels", FrameSpace::kTarget);
}

void add_feature_stages(const FrameRecord& record, std::vector<Stage>& stages) {
  if (!record.measured.features) return;
  // What another program did is known by what it left alone.
  Stage& features = add_stage(stages, "features", "Features",
                              record.measured.solving ? "Finds ORB features spread over the image."
                                                      : "The features that the program left of the frame.");
  features.ms = record.ms.features;
  features.timed = record.measured.times;
  add_figure(features, "Found", record.features_found);
  const auto with_depth = std::count_if(record.features.begin(), record.features.end(),
                                        [](const FeatureRecord& f) { return f.depth > 0.0F; });
  if (!record.features.empty()) add_figure(features, "With depth", static_cast<double>(with_depth));
  Stage& removal = add_stage(stages, "feature_removal", "Removal",
                             "Removes the features inside the motion mask; the rest count as static.");
  removal.timed = false;
  add_figure(removal, "Removed", record.features_removed);
  add_figure(removal, "Kept", record.features_kept);
  if (record.features_found > 0)
    add_figure(removal, "Removed share", 100.0 * record.features_removed / record.features_found, "%", 1);
}

void add_matching(const FrameRecord& record, std::vector<Stage>& stages) {
  if (!record.measured.matches) return;
  Stage& matching =
      add_stage(stages, "matching", "Matching", "Matches the static features to points of the local map.");
  matching.ms = record.ms.matching;
  add_figure(matching, "Matches", record.matches);
  add_figure(matching, "Of the kept",
             record.features_kept > 0 ? 100.0 * record.matches / record.features_kept : 0.0, "%", 1);
  if (record.measured.solving) return;
  matching.timed = false;
  add_figure(matching, "Inliers", record.inliers);
  add_figure(matching, "Outliers", record.matches - record.inliers);
}

void add_pose_stages(const FrameRecord& record, std::vector<Stage>& stages) {
  if (!record.measured.solving) return;
  Stage& start = add_stage(stages, "initial_pose", "Initial pose",
                           "A first pose: by the motion model where it holds, else by EPnP inside RANSAC.");
  start.ms = record.ms.epnp;
  start.timed = record.ms.epnp > 0.0;
  start.note = record.pose_start == PoseStart::none
                   ? "No pose was come by."
                   : fmt::format("This frame's pose was begun from: {}.", to_string(record.pose_start));

  Stage& refined = add_stage(stages, "refinement", "Refinement",
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
void add_direct_stage(const FrameRecord& record, std::vector<Stage>& stages) {
  const DirectRecord& direct = record.direct;
  if (direct.reference_frame == kNone) return;
  Stage& stage = add_stage(stages, "direct_refinement", "Direct refinement",
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

void add_map_stages(const FrameRecord& record, std::vector<Stage>& stages) {
  if (!record.measured.points || !record.measured.bundle) return;
  Stage& mapping = add_stage(stages, "mapping", "Keyframe and map",
                             "Makes a keyframe where too little of the last one is left, and new points.");
  mapping.ms = record.ms.mapping;
  add_figure(mapping, "New points", record.new_points);
  add_figure(mapping, "Fused", record.fused_points);
  add_figure(mapping, "Culled", record.culled_points);
  add_figure(mapping, "Points in the map", record.map_points);
  add_figure(mapping, "Keyframes", record.map_keyframes);
  if (!record.keyframe) mapping.note = "This frame is no keyframe.";

  Stage& bundle =
      add_stage(stages, "bundle", "Bundle adjustment",
                "Refines the local keyframes and the points they share, after each new keyframe.");
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
void compare_matches(const FrameRecord& now, const FrameRecord& before, std::vector<Stage>& stages) {
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
  for (Stage& stage : stages)
    if (stage.id == "refinement") {
      add_figure(stage, "Points gained", static_cast<double>(seen.size()) - static_cast<double>(shared));
      add_figure(stage, "Points lost", static_cast<double>(seen_before.size()) - static_cast<double>(shared));
    }
}

/// A first pose, under which what is dynamic was judged.
void add_first_pose(const FrameRecord& record, std::vector<Stage>& stages) {
  if (!record.motion_pose) return;
  Stage& pose = add_stage(stages, "first_pose", "First pose",
                          "A first pose that most of the image agrees on, under which motion is judged.");
  pose.ms = record.ms.consensus;
  pose.note = fmt::format("Begun from: {}.", to_string(record.pose_start));
}

void add_odometry_stages(const FrameRecord& record, std::vector<Stage>& stages) {
  add_first_pose(record, stages);
  add_feature_stages(record, stages);
  add_matching(record, stages);
  add_pose_stages(record, stages);
  add_direct_stage(record, stages);
  add_map_stages(record, stages);
}

/// What each of the odometry's stages takes and makes.
void add_layers(const FrameView& view, Stage& stage) {
  const Layer plain = photo_layer(fmt::format("Frame {}", view.index), view.frame.gray);
  const Layer found = marked("Features", plain, feature_marks(*view.record, false));
  const Layer judged = marked("Inliers and outliers", plain, feature_marks(*view.record, true));
  if (stage.id == "features")
    stage.add_side({plain}, found);
  else if (stage.id == "feature_removal")
    stage.add_side({view.mask.empty() ? plain : mask_layer("Mask", view.mask, plain)},
                   marked("Kept and removed", plain, feature_marks(*view.record, false)));
  else if (stage.id == "matching")
    stage.add_side({found}, marked("Matched, and not", plain, feature_marks(*view.record, true)));
  else if (stage.id == "direct_refinement")
    stage.add_side({plain, judged}, direct_layer(view, view.record->direct));
  else
    stage.add_side({found}, judged);
}

std::vector<Stage> list_stages(const FrameView& view) {
  std::vector<Stage> stages;
  if (view.motion) stages = view.motion->stages;
  if (view.record == nullptr || !view.frame.readable()) return stages;
  if (view.odometry) {
    stages.insert(stages.end(), view.odometry->stages.begin(), view.odometry->stages.end());
    return stages;
  }
  const std::size_t first = stages.size();
  add_odometry_stages(*view.record, stages);
  for (std::size_t i = first; i < stages.size(); ++i) add_layers(view, stages[i]);
  return stages;
}

const StageFigure* figure_named(const Stage& stage, const std::string& name) {
  const auto it = std::find_if(stage.figures.begin(), stage.figures.end(),
                               [&](const StageFigure& figure) { return figure.name == name; });
  return it == stage.figures.end() ? nullptr : &*it;
}

void hold_against(std::vector<Stage>& stages, const std::vector<Stage>& others, int rounds_back,
                  std::optional<double> StageFigure::*into) {
  for (Stage& stage : stages) {
    if (rounds_back > 0 && stage.round < rounds_back) continue;
    Stage wanted = stage;
    wanted.round -= rounds_back;
    const auto other =
        std::find_if(others.begin(), others.end(), [&](const Stage& one) { return one.same_place(wanted); });
    if (other == others.end()) continue;
    for (StageFigure& figure : stage.figures)
      if (const StageFigure* same = figure_named(*other, figure.name)) figure.*into = same->value;
  }
}

}  // namespace

std::vector<Stage> stages_of(const FrameView& view) {
  std::vector<Stage> stages = list_stages(view);
  const std::vector<Stage> plain = stages;
  hold_against(stages, plain, 1, &StageFigure::round_before);
  if (view.before == nullptr) return stages;
  hold_against(stages, list_stages(*view.before), 0, &StageFigure::frame_before);
  if (view.record != nullptr && view.before->record != nullptr)
    compare_matches(*view.record, *view.before->record, stages);
  return stages;
}

bool of_odometry(const Stage& stage) { return stage.group == kOdometry; }

std::size_t telling_stage(const std::vector<Stage>& stages) {
  for (std::size_t i = stages.size(); i-- > 0;)
    if (!of_odometry(stages[i]) && !stages[i].sides.empty() &&
        stages[i].sides.back().output.kind == LayerKind::kMask)
      return i;
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (stages[i].id == "refinement") return i;
  for (std::size_t i = stages.size(); i-- > 0;)
    if (of_odometry(stages[i]) && stages[i].overview) return i;
  return 0;
}

}  // namespace stillpoint
