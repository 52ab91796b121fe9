#include "core/run/run_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/evaluation/tables.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

/// A frame's own errors, NaN where there is none.
struct FrameErrors {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double ate_m = kUnknown;
  double rpe_frame_m = kUnknown, rpe_frame_deg = kUnknown;    // of the motion that ends here
  double rpe_second_m = kUnknown, rpe_second_deg = kUnknown;  // … of the second that ends here
};

std::map<double, FrameErrors> errors_by_stamp(const RunReport& report) {
  std::map<double, FrameErrors> errors;
  if (!report.evaluation) return errors;
  for (const AbsoluteError& e : report.evaluation->ate.errors) errors[e.timestamp].ate_m = e.translation_m;
  for (const RelativeError& e : report.evaluation->rpe_frame.errors) {
    errors[e.to_timestamp].rpe_frame_m = e.translation_m;
    errors[e.to_timestamp].rpe_frame_deg = e.rotation_deg;
  }
  for (const RelativeError& e : report.evaluation->rpe_time.errors) {
    errors[e.to_timestamp].rpe_second_m = e.translation_m;
    errors[e.to_timestamp].rpe_second_deg = e.rotation_deg;
  }
  return errors;
}

/// Collects a row's cells beside their headings, so that the two cannot part.
class Row {
 public:
  void text(const char* name, std::string_view value) { add(name, std::string(value)); }
  void count(const char* name, std::int64_t value) { add(name, fmt::format("{}", value)); }
  void number(const char* name, double value, int digits = 4) {
    add(name, std::isnan(value) ? std::string() : fmt::format("{:.{}f}", value, digits));
  }
  void share(const char* name, const std::optional<double>& value) {
    number(name, value.value_or(FrameErrors::kUnknown));
  }
  std::vector<std::string> names, values;

 private:
  void add(const char* name, std::string value) {
    names.emplace_back(name);
    values.push_back(std::move(value));
  }
};

Row frame_row(const FrameRecord& r, const FrameScores& scores, const FrameErrors& errors,
              const std::vector<FigureInfo>& infos) {
  Row row;
  row.count("frame", r.index);
  row.number("timestamp_s", r.timestamp, 6);
  row.text("status", to_string(r.status));
  row.count("keyframe", r.keyframe ? 1 : 0);
  row.count("features_found", r.features_found);
  row.count("features_removed", r.features_removed);
  row.count("features_kept", r.features_kept);
  row.number("mask_share", r.mask_share);
  row.count("motion_rounds", r.motion_rounds);
  for (const FigureInfo& info : infos) {
    const auto figure = std::find_if(r.motion_figures.begin(), r.motion_figures.end(),
                                     [&](const MotionFigure& one) { return one.name == info.name; });
    row.number(info.name.c_str(), figure == r.motion_figures.end() ? FrameErrors::kUnknown : figure->value,
               info.digits);
  }
  row.text("pose_start", to_string(r.pose_start));
  row.count("matches", r.matches);
  row.count("inliers", r.inliers);
  row.number("rms_px", r.rms_px);
  row.count("refine_iterations", r.refine_iterations);
  row.count("direct_patches", r.direct.patches);
  row.number("direct_share", r.direct.share, 3);
  row.count("map_points", r.map_points);
  row.count("map_keyframes", r.map_keyframes);
  row.count("new_points", r.new_points);
  row.count("fused_points", r.fused_points);
  row.count("culled_points", r.culled_points);
  row.count("culled_keyframes", r.culled_keyframes);
  row.number("bundle_rms_before_px", r.bundle_rms_before_px);
  row.number("bundle_rms_px", r.bundle_rms_px);
  row.count("bundle_iterations", r.bundle_iterations);
  for (const auto& [name, ms] : {std::pair{"motion_ms", r.ms.motion},
                                 {"features_ms", r.ms.features},
                                 {"matching_ms", r.ms.matching},
                                 {"pose_ms", r.ms.pose},
                                 {"mapping_ms", r.ms.mapping},
                                 {"bundle_ms", r.ms.bundle},
                                 {"total_ms", r.ms.total}})
    row.number(name, ms, 3);
  row.number("ate_m", errors.ate_m, 6);
  row.number("rpe_frame_m", errors.rpe_frame_m, 6);
  row.number("rpe_frame_deg", errors.rpe_frame_deg);
  row.number("rpe_second_m", errors.rpe_second_m, 6);
  row.number("rpe_second_deg", errors.rpe_second_deg);
  row.share("mask_precision", scores.mask.precision());
  row.share("mask_recall", scores.mask.recall());
  row.share("mask_iou", scores.mask.iou());
  row.count("removed_rightly", scores.removal.removed_rightly);
  row.count("removed_wrongly", scores.removal.removed_wrongly);
  row.text("note", r.note);
  return row;
}

std::string frames_csv(const RunResult& run, const RunReport& report) {
  const auto errors = errors_by_stamp(report);
  Table table;
  std::vector<FigureInfo> infos = method_of(run.config).figures;
  const std::vector<FigureInfo>& of_engine = engine_of(run.config).figures;
  infos.insert(infos.end(), of_engine.begin(), of_engine.end());
  table.header = frame_row({}, {}, {}, infos).names;
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const FrameRecord& record = run.records[i];
    const auto known = errors.find(record.timestamp);
    const bool has_errors = record.estimated && known != errors.end();
    table.rows.push_back(
        frame_row(record, run.scores[i], has_errors ? known->second : FrameErrors{}, infos).values);
  }
  return to_csv(table);
}

/// Map points in white, keyframe centres in orange: any mesh viewer opens it.
std::string map_ply(const RunResult& run) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment world coordinates in metres: the first tracked frame's camera\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      run.points.size() + run.keyframes.size());
  const auto vertex = [&text](const Eigen::Vector3d& p, const char* colour) {
    text += fmt::format("{:.5f} {:.5f} {:.5f} {}\n", p.x(), p.y(), p.z(), colour);
  };
  for (const SavedPoint& point : run.points) vertex(point.position, "255 255 255");
  for (const SavedKeyframe& keyframe : run.keyframes)
    vertex(keyframe.pose.world_from_camera.translation(), "230 159 0");
  return text;
}

}  // namespace

void prepare_run_folder(const std::filesystem::path& folder, bool force) {
  prepare_out_folder(folder, {"summary.json", "trajectory.txt"}, force);
}

void write_run(const std::filesystem::path& folder, const RunResult& run, const RunReport& report,
               const FrameSource& source, const SequenceOrigin& origin) {
  Trajectory keyframes;
  for (const SavedKeyframe& keyframe : run.keyframes) keyframes.push_back(keyframe.pose);
  write_tum_trajectory((folder / "trajectory.txt").string(), run.trajectory);
  write_tum_trajectory((folder / "trajectory_live.txt").string(), run.live);
  write_tum_trajectory((folder / "keyframes.txt").string(), keyframes);
  write_text_file(folder / "frames.csv", frames_csv(run, report));
  write_text_file(folder / "config.toml", to_toml(run.config));
  write_text_file(folder / "map.ply", map_ply(run));
  nlohmann::ordered_json summary = to_summary(report, run, source);
  summary["source"] = to_json(origin, folder);
  write_text_file(folder / "summary.json",
                  summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace stillpoint
