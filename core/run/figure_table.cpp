#include "core/run/figure_table.hpp"

#include <algorithm>
#include <limits>

#include "core/geometry/normal_equations.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {
namespace {

constexpr double kSameTime = 1e-6;  // s: stamps have microseconds, and printing rounds

double flag(bool is) { return is ? 1.0 : 0.0; }
double known(const std::optional<double>& value) { return value.value_or(kUnknownFigure); }
double of_pose(const MeasuredFrame& row, double value) {
  return row.record.estimated ? value : kUnknownFigure;
}
double of_image(const MeasuredFrame& row, double value) {
  return row.record.status == FrameStatus::unreadable ? kUnknownFigure : value;
}
/// Of a part that somebody measured (RecordParts); elsewhere a field's 0 says nothing.
double of_part(bool RecordParts::*part, const MeasuredFrame& row, double value) {
  return row.record.measured.*part ? value : kUnknownFigure;
}
/// Of features that are there and of which the truth is known.
double of_scores(const MeasuredFrame& row, double value) {
  return row.scores.known ? of_part(&RecordParts::features, row, value) : kUnknownFigure;
}
double time(double ms) { return ms > 0.0 ? ms : kUnknownFigure; }  // 0: not measured

/// Of a frame among errors in order of time, or null. @param stamp the one of an error
template <typename Error>
const Error* error_at(const std::vector<Error>& errors, double Error::*stamp, const FrameOutline& frame) {
  if (!frame.estimated) return nullptr;
  const auto at = std::lower_bound(errors.begin(), errors.end(), frame.timestamp - kSameTime,
                                   [stamp](const Error& error, double time) { return error.*stamp < time; });
  return at != errors.end() && (*at).*stamp < frame.timestamp + kSameTime ? &*at : nullptr;
}

/// Of the motion that ends at the frame.
double motion_error(const std::vector<RelativeError>& errors, const FrameOutline& frame,
                    double RelativeError::*part) {
  const RelativeError* error = error_at(errors, &RelativeError::to_timestamp, frame);
  return error == nullptr ? kUnknownFigure : error->*part;
}

/// @param block 0 = position, 3 = rotation
double sigma_of(const FrameRecord& record, int block) {
  const double sigma = largest_deviation(record.pose_covariance.block<3, 3>(block, block));
  return record.estimated && sigma > 0 ? sigma : kUnknownFigure;
}

double ate(const FrameOutline& frame, const TrajectoryEvaluation& evaluation) {
  const AbsoluteError* error = error_at(evaluation.ate.errors, &AbsoluteError::timestamp, frame);
  return error == nullptr ? kUnknownFigure : error->translation_m;
}

std::vector<FrameFigure> all_figures() {
  using enum FigureUnit;
  using enum WorseWhen;
  const auto is_status = [](const char* name, const char* help, double (*of)(const MeasuredFrame&)) {
    return FrameFigure{{.name = name, .unit = FigureUnit::truth, .help = help, .digits = 0}, of};
  };
  const auto count = [](const char* name, const char* title, const char* column, const char* help,
                        double (*of)(const MeasuredFrame&), WorseWhen worse = neither) {
    return FrameFigure{
        {.name = name, .help = help, .digits = 0, .worse = worse, .title = title, .column = column}, of};
  };
  const auto stage_time = [](const char* name, const char* title, const char* column, const char* help,
                             double (*of)(const MeasuredFrame&)) {
    return FrameFigure{{.name = name,
                        .unit = milliseconds,
                        .help = help,
                        .digits = 3,
                        .worse = high,
                        .title = title,
                        .column = column},
                       of};
  };
  std::vector<FrameFigure> all = {
      count("frame", "", "", "its index, from 0",
            [](const MeasuredFrame& r) { return double(r.record.index); }),
      is_status("lost", "no pose could be estimated",
                [](const MeasuredFrame& r) { return flag(r.record.status == FrameStatus::lost); }),
      is_status("unreadable", "there was no image",
                [](const MeasuredFrame& r) { return flag(r.record.status == FrameStatus::unreadable); }),
      is_status("tracked", "the pose was estimated against the map",
                [](const MeasuredFrame& r) { return flag(r.record.status == FrameStatus::tracked); }),
      is_status("relocalised", "tracked for the first time after being lost",
                [](const MeasuredFrame& r) { return flag(r.record.status == FrameStatus::relocalised); }),
      is_status("initialised", "the map began here",
                [](const MeasuredFrame& r) { return flag(r.record.status == FrameStatus::initialised); }),
      is_status("keyframe", "kept in the map",
                [](const MeasuredFrame& r) {
                  return of_part(&RecordParts::keyframes, r, flag(r.record.keyframe));
                }),
      is_status("bundle", "the map was adjusted",
                [](const MeasuredFrame& r) {
                  return of_part(&RecordParts::bundle, r, flag(r.record.bundle_iterations > 0));
                }),
      {.info = {.name = "rpe",
                .unit = metres,
                .help = "error of the motion from the frame before, against ground truth",
                .digits = 6,
                .worse = high,
                .title = "Step error",
                .column = "rpe_frame_m"},
       .of_evaluation =
           [](const FrameOutline& frame, const TrajectoryEvaluation& of) {
             return motion_error(of.rpe_frame.errors, frame, &RelativeError::translation_m);
           }},
      {.info = {.name = "rpe_deg",
                .unit = degrees,
                .help = "the same, rotation",
                .worse = high,
                .title = "Step rotation",
                .column = "rpe_frame_deg"},
       .of_evaluation =
           [](const FrameOutline& frame, const TrajectoryEvaluation& of) {
             return motion_error(of.rpe_frame.errors, frame, &RelativeError::rotation_deg);
           }},
      {.info = {.name = "rpe_1s",
                .unit = metres,
                .help = "error of the motion over the second that ends here",
                .digits = 6,
                .worse = high,
                .title = "1 s error",
                .column = "rpe_second_m"},
       .of_evaluation =
           [](const FrameOutline& frame, const TrajectoryEvaluation& of) {
             return motion_error(of.rpe_time.errors, frame, &RelativeError::translation_m);
           }},
      {.info = {.name = "rpe_1s_deg",
                .unit = degrees,
                .help = "the same, rotation",
                .worse = high,
                .title = "1 s rotation",
                .column = "rpe_second_deg"},
       .of_evaluation =
           [](const FrameOutline& frame, const TrajectoryEvaluation& of) {
             return motion_error(of.rpe_time.errors, frame, &RelativeError::rotation_deg);
           }},
      {.info = {.name = "ate",
                .unit = metres,
                .help = "distance from ground truth after alignment of the whole trajectory",
                .digits = 6,
                .worse = high,
                .title = "Absolute error",
                .column = "ate_m"},
       .of_evaluation = ate},
      {.info = {.name = "step",
                .unit = metres,
                .help =
                    "error of the step from the pose before; this and the next three need run.check_removal",
                .digits = 6,
                .worse = high,
                .title = "Step, with removal",
                .column = "step_m"},
       .of_removal = [](const RemovalError& error) { return error.with_removal_m; }},
      {.info = {.name = "step_without",
                .unit = metres,
                .help = "the same step solved without removal",
                .digits = 6,
                .worse = high,
                .title = "Step, without removal",
                .column = "step_without_m"},
       .of_removal = [](const RemovalError& error) { return error.without_removal_m; }},
      {.info = {.name = "step_oracle",
                .unit = metres,
                .help = "the same step solved with the ground-truth mask",
                .digits = 6,
                .worse = high,
                .title = "Step, ground-truth mask",
                .column = "step_oracle_m",
                .old_name = "step_told"},
       .of_removal = [](const RemovalError& error) { return error.oracle_m; }},
      {.info =
           {.name = "widened",
            .help =
                "the position's standard deviation, as many times as with nothing removed: information that "
                "removal cost",
            .digits = 3,
            .worse = high,
            .title = "Position σ, by removal",
            .column = "sigma_by_removal"},
       .of_removal = [](const RemovalError& error) { return error.widened; }},
      {.info = {.name = "hurt", .unit = truth, .help = "removal made the step worse", .digits = 0},
       .of_removal = [](const RemovalError& error) { return flag(error.hurt); }},
      {{.name = "mask",
        .unit = share,
        .help = "of the image, classified as dynamic",
        .worse = high,
        .title = "Mask",
        .column = "mask_share"},
       [](const MeasuredFrame& r) {
         return of_part(&RecordParts::mask, r, of_image(r, r.record.mask_share));
       }},
      {{.name = "mask_precision",
        .unit = share,
        .help = "of the mask that is truly dynamic; this and the next four need ground-truth masks",
        .worse = low,
        .title = "Mask precision"},
       [](const MeasuredFrame& r) { return known(r.scores.mask.precision()); }},
      {{.name = "mask_recall",
        .unit = share,
        .help = "of what is truly dynamic that is in the mask",
        .worse = low,
        .title = "Mask recall"},
       [](const MeasuredFrame& r) { return known(r.scores.mask.recall()); }},
      {{.name = "mask_iou",
        .unit = share,
        .help = "intersection over union of the mask and the ground-truth mask",
        .worse = low,
        .title = "Mask IoU"},
       [](const MeasuredFrame& r) { return known(r.scores.mask.iou()); }},
      count("removed_rightly", "Removed rightly", "", "features removed that are truly dynamic",
            [](const MeasuredFrame& r) { return of_scores(r, double(r.scores.removal.removed_rightly)); }),
      count(
          "removed_wrongly", "Removed wrongly", "", "features removed that are truly static",
          [](const MeasuredFrame& r) { return of_scores(r, double(r.scores.removal.removed_wrongly)); },
          high),
      count(
          "dynamic_inliers", "Dynamic inliers", "",
          "inliers that lie on what is truly dynamic; needs ground-truth masks",
          [](const MeasuredFrame& r) { return of_scores(r, double(r.scores.dynamic_inliers)); }, high),
      count(
          "features", "Features", "features_found", "features found",
          [](const MeasuredFrame& r) {
            return of_part(&RecordParts::features, r, of_image(r, r.record.features_found));
          },
          low),
      count("removed", "Features removed", "features_removed", "features inside the mask",
            [](const MeasuredFrame& r) {
              return of_part(&RecordParts::features, r, of_image(r, r.record.features_removed));
            }),
      count(
          "kept", "Features kept", "features_kept", "features outside the mask",
          [](const MeasuredFrame& r) {
            return of_part(&RecordParts::features, r, of_image(r, r.record.features_kept));
          },
          low),
      count(
          "matches", "Matches", "", "features matched to map points",
          [](const MeasuredFrame& r) {
            return of_part(&RecordParts::matches, r, of_image(r, r.record.matches));
          },
          low),
      count(
          "inliers", "Inliers", "", "matches that agree with the pose",
          [](const MeasuredFrame& r) {
            return of_part(&RecordParts::matches, r, of_image(r, r.record.inliers));
          },
          low),
      count(
          "outliers", "Outliers", "", "matches that do not",
          [](const MeasuredFrame& r) {
            return of_part(&RecordParts::matches, r, of_image(r, r.record.matches - r.record.inliers));
          },
          high),
      {{.name = "residual",
        .unit = pixels,
        .help = "reprojection error of the inliers, RMS",
        .worse = high,
        .title = "Residual",
        .column = "rms_px"},
       [](const MeasuredFrame& r) {
         return r.record.inliers > 0 ? of_part(&RecordParts::solving, r, of_pose(r, r.record.rms_px))
                                     : kUnknownFigure;
       }},
      {{.name = "position_sigma",
        .unit = metres,
        .help = "standard deviation of the position in the direction least known, by the pose's covariance",
        .digits = 6,
        .worse = high,
        .title = "Position, σ",
        .column = "position_sigma_m"},
       [](const MeasuredFrame& r) { return sigma_of(r.record, 0); }},
      {{.name = "rotation_sigma",
        .unit = degrees,
        .help = "standard deviation of the rotation about the axis least known",
        .digits = 6,
        .worse = high,
        .title = "Rotation, σ",
        .column = "rotation_sigma_deg"},
       [](const MeasuredFrame& r) { return to_degrees(sigma_of(r.record, 3)); }},
      count("refine_iterations", "Refinement steps", "", "steps the refinement of the pose took",
            [](const MeasuredFrame& r) {
              return of_part(&RecordParts::solving, r, r.record.refine_iterations);
            }),
      is_status("wide_search", "the motion model's window was too small",
                [](const MeasuredFrame& r) {
                  return of_part(&RecordParts::solving, r,
                                 flag(r.record.pose_start == PoseStart::wide_search));
                }),
      is_status("epnp", "the pose began with EPnP",
                [](const MeasuredFrame& r) {
                  return of_part(&RecordParts::solving, r, flag(r.record.pose_start == PoseStart::epnp));
                }),
      is_status("direct", "the pose has a share by direct alignment",
                [](const MeasuredFrame& r) {
                  return of_part(&RecordParts::direct, r, flag(r.record.direct.share > 0.0));
                }),
      count("direct_patches", "Direct patches", "", "patches that were aligned directly",
            [](const MeasuredFrame& r) { return of_part(&RecordParts::direct, r, r.record.direct.patches); }),
      {{.name = "direct_share",
        .unit = share,
        .help = "of the pose's information that direct alignment gave",
        .digits = 3,
        .title = "Direct share"},
       [](const MeasuredFrame& r) { return of_part(&RecordParts::direct, r, r.record.direct.share); }},
      count("rounds", "Motion rounds", "motion_rounds", "rounds of motion detection",
            [](const MeasuredFrame& r) { return of_part(&RecordParts::rounds, r, r.record.motion_rounds); }),
      count("map_points", "Map points", "", "points in the map after the frame",
            [](const MeasuredFrame& r) { return of_part(&RecordParts::points, r, r.record.map_points); }),
      count(
          "map_keyframes", "Map keyframes", "", "keyframes in the map after the frame",
          [](const MeasuredFrame& r) { return of_part(&RecordParts::keyframes, r, r.record.map_keyframes); }),
      count("new_points", "New points", "", "points the keyframe added",
            [](const MeasuredFrame& r) { return of_part(&RecordParts::points, r, r.record.new_points); }),
      count("fused_points", "Fused points", "", "points found to be one",
            [](const MeasuredFrame& r) {
              return of_part(&RecordParts::fused_points, r, r.record.fused_points);
            }),
      count("culled_points", "Culled points", "", "points dropped",
            [](const MeasuredFrame& r) { return of_part(&RecordParts::points, r, r.record.culled_points); }),
      count("culled_keyframes", "Culled keyframes", "", "keyframes dropped",
            [](const MeasuredFrame& r) {
              return of_part(&RecordParts::culled_keyframes, r, r.record.culled_keyframes);
            }),
      {{.name = "bundle_rms_before_px",
        .unit = pixels,
        .help = "residual before bundle adjustment",
        .worse = high,
        .title = "Bundle before"},
       [](const MeasuredFrame& r) {
         return r.record.bundle_iterations > 0 ? r.record.bundle_rms_before_px : kUnknownFigure;
       }},
      {{.name = "bundle_rms_px",
        .unit = pixels,
        .help = "… and after it",
        .worse = high,
        .title = "Bundle residual"},
       [](const MeasuredFrame& r) {
         return r.record.bundle_iterations > 0 ? r.record.bundle_rms_px : kUnknownFigure;
       }},
      count("bundle_iterations", "Bundle steps", "", "steps that bundle adjustment took",
            [](const MeasuredFrame& r) {
              return of_part(&RecordParts::bundle, r, r.record.bundle_iterations);
            }),
      stage_time("ms.total", "Time", "total_ms", "time of the whole frame",
                 [](const MeasuredFrame& r) { return time(r.record.ms.total); }),
      stage_time("ms.motion", "Motion time", "motion_ms", "time of motion detection",
                 [](const MeasuredFrame& r) { return time(r.record.ms.motion); }),
      stage_time("ms.features", "Features time", "features_ms", "time of feature extraction",
                 [](const MeasuredFrame& r) { return time(r.record.ms.features); }),
      stage_time("ms.matching", "Matching time", "matching_ms", "time of matching",
                 [](const MeasuredFrame& r) { return time(r.record.ms.matching); }),
      stage_time("ms.pose", "Pose time", "pose_ms", "time of solving the pose",
                 [](const MeasuredFrame& r) { return time(r.record.ms.pose); }),
      stage_time("ms.mapping", "Mapping time", "mapping_ms", "time of the map's upkeep",
                 [](const MeasuredFrame& r) { return time(r.record.ms.mapping); }),
      stage_time("ms.bundle", "Bundle time", "bundle_ms", "time of bundle adjustment",
                 [](const MeasuredFrame& r) { return time(r.record.ms.bundle); }),
      stage_time("ms.stereo", "Stereo time", "stereo_ms",
                 "time of matching a stereo pair, no part of the total",
                 [](const MeasuredFrame& r) { return time(r.record.ms.stereo); }),
  };
  const auto add_own = [&all](const std::vector<FigureInfo>& infos) {
    for (const FigureInfo& info : infos)
      if (std::none_of(all.begin(), all.end(),
                       [&](const FrameFigure& one) { return one.info.name == info.name; }))
        all.push_back({info});
  };
  for (const MethodInfo& method : methods()) add_own(method.figures);
  for (const EngineInfo& engine : engines()) add_own(engine.figures);
  return all;
}

}  // namespace

const std::vector<FrameFigure>& figure_table() {
  static const std::vector<FrameFigure> all = all_figures();
  return all;
}

}  // namespace stillpoint
