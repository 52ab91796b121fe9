#include "core/run/frame_figures.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <unordered_map>

#include "core/odometry/engines.hpp"
#include "core/run/removal_errors.hpp"

namespace stillpoint {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// All that is known of one frame.
struct Row {
  const FrameRecord& record;
  const FrameScores& scores;
  double rpe_m = kUnknown, rpe_deg = kUnknown;        // of the motion that ends here
  double rpe_1s_m = kUnknown, rpe_1s_deg = kUnknown;  // … of the second that ends here
  double ate_m = kUnknown;
  RemovalError removal{.with_removal_m = kUnknown, .without_removal_m = kUnknown, .oracle_m = kUnknown};
};

struct Figure {
  FigureInfo info;
  std::function<double(const Row&)> of;
};

double flag(bool is) { return is ? 1.0 : 0.0; }
double of_pose(const Row& row, double value) { return row.record.estimated ? value : kUnknown; }
double known(const std::optional<double>& value) { return value.value_or(kUnknown); }

using enum FigureUnit;

/// What a method measures of a frame, known in runs by that method alone.
Figure of_method(const FigureInfo& info) {
  return {info, [name = info.name](const Row& row) {
            for (const MotionFigure& figure : row.record.motion_figures)
              if (figure.name == name) return figure.value;
            return kUnknown;
          }};
}

std::vector<Figure> all_figures() {
  std::vector<Figure> all = {
      {{"frame", plain, "its index, from 0"}, [](const Row& r) { return double(r.record.index); }},
      {{"lost", truth, "no pose could be estimated"},
       [](const Row& r) { return flag(r.record.status == FrameStatus::lost); }},
      {{"unreadable", truth, "there was no image"},
       [](const Row& r) { return flag(r.record.status == FrameStatus::unreadable); }},
      {{"tracked", truth, "the pose was estimated against the map"},
       [](const Row& r) { return flag(r.record.status == FrameStatus::tracked); }},
      {{"relocalised", truth, "tracked for the first time after being lost"},
       [](const Row& r) { return flag(r.record.status == FrameStatus::relocalised); }},
      {{"initialised", truth, "the map began here"},
       [](const Row& r) { return flag(r.record.status == FrameStatus::initialised); }},
      {{"keyframe", truth, "kept in the map"}, [](const Row& r) { return flag(r.record.keyframe); }},
      {{"bundle", truth, "a bundle adjustment entered the map"},
       [](const Row& r) { return flag(r.record.bundle_iterations > 0); }},
      {{"rpe", metres, "error of the motion from the frame before; needs ground truth"},
       [](const Row& r) { return of_pose(r, r.rpe_m); }},
      {{"rpe_deg", degrees, "the same, rotation"}, [](const Row& r) { return of_pose(r, r.rpe_deg); }},
      {{"rpe_1s", metres, "error of the motion over the second that ends here"},
       [](const Row& r) { return of_pose(r, r.rpe_1s_m); }},
      {{"rpe_1s_deg", degrees, "the same, rotation"}, [](const Row& r) { return of_pose(r, r.rpe_1s_deg); }},
      {{"ate", metres, "distance from the aligned ground truth"},
       [](const Row& r) { return of_pose(r, r.ate_m); }},
      {{"step", metres, "error of the step from the pose before; this and the next need run.check_removal"},
       [](const Row& r) { return r.removal.with_removal_m; }},
      {{"step_without", metres, "the same step solved without removal"},
       [](const Row& r) { return r.removal.without_removal_m; }},
      {{"step_oracle", metres, "the same step solved with the true mask"},
       [](const Row& r) { return r.removal.oracle_m; }},
      {{"hurt", truth, "removal made the step worse"}, [](const Row& r) { return flag(r.removal.hurt); }},
      {{"mask", share, "of the image that was masked as moving"},
       [](const Row& r) { return r.record.mask_share; }},
      {{"mask_precision", share, "of the mask that truly moves; needs true masks"},
       [](const Row& r) { return known(r.scores.mask.precision()); }},
      {{"mask_recall", share, "of what truly moves that is in the mask"},
       [](const Row& r) { return known(r.scores.mask.recall()); }},
      {{"mask_iou", share, "overlap of the mask with what truly moves"},
       [](const Row& r) { return known(r.scores.mask.iou()); }},
      {{"features", plain, "features found"}, [](const Row& r) { return double(r.record.features_found); }},
      {{"removed", plain, "features inside the mask"},
       [](const Row& r) { return double(r.record.features_removed); }},
      {{"kept", plain, "features left"}, [](const Row& r) { return double(r.record.features_kept); }},
      {{"matches", plain, "features matched to map points"},
       [](const Row& r) { return double(r.record.matches); }},
      {{"inliers", plain, "matches that agree with the pose"},
       [](const Row& r) { return double(r.record.inliers); }},
      {{"outliers", plain, "matches that do not"},
       [](const Row& r) { return double(r.record.matches - r.record.inliers); }},
      {{"residual", pixels, "reprojection error of the inliers, RMS"},
       [](const Row& r) { return of_pose(r, r.record.rms_px); }},
      {{"refine_iterations", plain, "steps the refinement of the pose took"},
       [](const Row& r) { return double(r.record.refine_iterations); }},
      {{"wide_search", truth, "the motion model's window was too small"},
       [](const Row& r) { return flag(r.record.pose_start == PoseStart::wide_search); }},
      {{"epnp", truth, "the pose began with EPnP"},
       [](const Row& r) { return flag(r.record.pose_start == PoseStart::epnp); }},
      {{"direct", truth, "the pose has a share by direct alignment"},
       [](const Row& r) { return flag(r.record.direct.share > 0.0); }},
      {{"direct_patches", plain, "patches that were aligned directly"},
       [](const Row& r) { return double(r.record.direct.patches); }},
      {{"rounds", plain, "rounds of motion detection"},
       [](const Row& r) { return double(r.record.motion_rounds); }},
      {{"map_points", plain, "points in the map after the frame"},
       [](const Row& r) { return double(r.record.map_points); }},
      {{"map_keyframes", plain, "keyframes in the map after the frame"},
       [](const Row& r) { return double(r.record.map_keyframes); }},
      {{"new_points", plain, "points the keyframe added"},
       [](const Row& r) { return double(r.record.new_points); }},
      {{"fused_points", plain, "points found to be one"},
       [](const Row& r) { return double(r.record.fused_points); }},
      {{"culled_points", plain, "points dropped"},
       [](const Row& r) { return double(r.record.culled_points); }},
      {{"culled_keyframes", plain, "keyframes dropped"},
       [](const Row& r) { return double(r.record.culled_keyframes); }},
      {{"ms.motion", milliseconds, "time of motion detection"},
       [](const Row& r) { return r.record.ms.motion; }},
      {{"ms.features", milliseconds, "time of feature extraction"},
       [](const Row& r) { return r.record.ms.features; }},
      {{"ms.matching", milliseconds, "time of matching"}, [](const Row& r) { return r.record.ms.matching; }},
      {{"ms.pose", milliseconds, "time of solving the pose"}, [](const Row& r) { return r.record.ms.pose; }},
      {{"ms.mapping", milliseconds, "time of the map's upkeep"},
       [](const Row& r) { return r.record.ms.mapping; }},
      {{"ms.bundle", milliseconds, "time waited for bundle adjustment"},
       [](const Row& r) { return r.record.ms.bundle; }},
      {{"ms.total", milliseconds, "time of the whole frame"}, [](const Row& r) { return r.record.ms.total; }},
  };
  for (const MethodInfo& method : methods())
    for (const FigureInfo& info : method.figures)
      if (std::none_of(all.begin(), all.end(), [&](const Figure& one) { return one.info.name == info.name; }))
        all.push_back(of_method(info));
  for (const EngineInfo& engine : engines())
    for (const FigureInfo& info : engine.figures) all.push_back(of_method(info));
  return all;
}

const std::vector<Figure>& figures() {
  static const std::vector<Figure> all = all_figures();
  return all;
}

struct Errors {
  std::unordered_map<double, const RelativeError*> frame, second;  // by the stamp they end at
  std::unordered_map<double, double> ate_m;
};

Errors errors_of(const TrajectoryEvaluation* evaluation) {
  Errors errors;
  if (evaluation == nullptr) return errors;
  for (const RelativeError& error : evaluation->rpe_frame.errors)
    errors.frame.insert_or_assign(error.to_timestamp, &error);
  for (const RelativeError& error : evaluation->rpe_time.errors)
    errors.second.insert_or_assign(error.to_timestamp, &error);
  for (const AbsoluteError& error : evaluation->ate.errors)
    errors.ate_m.insert_or_assign(error.timestamp, error.translation_m);
  return errors;
}

void look_up(const std::unordered_map<double, const RelativeError*>& errors, double stamp, double& metres,
             double& degrees) {
  const auto found = errors.find(stamp);
  if (found == errors.end()) return;
  metres = found->second->translation_m;
  degrees = found->second->rotation_deg;
}

}  // namespace

std::string_view to_string(FigureUnit unit) {
  switch (unit) {
    case plain:
      return "";
    case metres:
      return "m";
    case degrees:
      return "deg";
    case pixels:
      return "px";
    case milliseconds:
      return "ms";
    case share:
      return "share";
    case FigureUnit::truth:
      return "yes/no";
  }
  return "";
}

const std::vector<FigureInfo>& frame_figure_infos() {
  static const std::vector<FigureInfo> infos = [] {
    std::vector<FigureInfo> all;
    for (const Figure& figure : figures()) all.push_back(figure.info);
    return all;
  }();
  return infos;
}

FrameFigures::FrameFigures(const std::vector<FrameRecord>& records, const TrajectoryEvaluation* evaluation,
                           const std::vector<FrameScores>& scores) {
  const Errors errors = errors_of(evaluation);
  std::unordered_map<int, RemovalError> removal;
  if (evaluation != nullptr)
    for (const RemovalError& error : removal_errors(records, *evaluation))
      removal.emplace(error.frame, error);
  const FrameScores none;
  columns_.assign(figures().size(), {});
  for (auto& column : columns_) column.reserve(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    Row row{records[i], i < scores.size() ? scores[i] : none};
    look_up(errors.frame, row.record.timestamp, row.rpe_m, row.rpe_deg);
    look_up(errors.second, row.record.timestamp, row.rpe_1s_m, row.rpe_1s_deg);
    if (const auto ate = errors.ate_m.find(row.record.timestamp); ate != errors.ate_m.end())
      row.ate_m = ate->second;
    if (const auto checked = removal.find(row.record.index); checked != removal.end())
      row.removal = checked->second;
    frames_.push_back(row.record.index);
    for (std::size_t column = 0; column < columns_.size(); ++column)
      columns_[column].push_back(figures()[column].of(row));
  }
}

}  // namespace stillpoint
