#include "core/run/run_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/evaluation/tables.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/map_ply.hpp"

namespace stillpoint {
namespace {

/// What describes a frame in words, then every figure there is of any run or of this one's method and engine,
/// then the note.
void write_frames_csv(const RunResult& run, const RunReport& report, std::ostream& file) {
  const auto& infos = frame_figure_infos();
  std::vector<FigureInfo> own = method_of(run.config).figures;
  const std::vector<FigureInfo>& of_engine = engine_of(run.config).figures;
  own.insert(own.end(), of_engine.begin(), of_engine.end());
  std::vector<int> columns;
  for (int i = 0; i < static_cast<int>(infos.size()); ++i) {
    const FigureInfo& info = infos[static_cast<std::size_t>(i)];
    const bool of_any_run = i < first_method_figure();
    if (of_any_run ||
        std::any_of(own.begin(), own.end(), [&](const FigureInfo& one) { return one.name == info.name; }))
      columns.push_back(i);
  }
  std::vector<std::string> cells = {"timestamp_s", "status", "pose_start"};
  for (const int column : columns) cells.push_back(column_head(infos[static_cast<std::size_t>(column)]));
  cells.emplace_back("note");
  file << csv_line(cells);
  walk_figures({run.records, report.evaluation ? &*report.evaluation : nullptr, &run.scores},
               [&](const FrameRecord& record, const std::vector<double>& figures) {
                 cells = {fmt::format("{:.6f}", record.timestamp), std::string(to_string(record.status)),
                          record.measured.solving ? std::string(to_string(record.pose_start)) : ""};
                 for (const int column : columns) {
                   const auto at = static_cast<std::size_t>(column);
                   cells.push_back(std::isnan(figures[at])
                                       ? std::string()
                                       : fmt::format("{:.{}f}", figures[at], infos[at].digits));
                 }
                 cells.push_back(remarks_on(record));
                 file << csv_line(cells);
               });
}

}  // namespace

void prepare_run_folder(const std::filesystem::path& folder, bool force) {
  prepare_out_folder(folder,
                     {kSummaryName, "trajectory.txt", kRecordsName, "config.toml", "frames.csv",
                      "trajectory_live.txt", "keyframes.txt", "map.ply", "keyframes.ply"},
                     force);
}

void write_run(const std::filesystem::path& folder, const RunResult& run, const RunReport& report,
               const FrameSource& source, const SequenceOrigin& origin, RecordsWriter& records) {
  Trajectory keyframes;
  for (const SavedKeyframe& keyframe : run.keyframes) keyframes.push_back(keyframe.pose);
  WholeFiles files;
  files.add(folder / "trajectory.txt", tum_text(run.trajectory));
  files.add(folder / "trajectory_live.txt", tum_text(run.live));
  files.add(folder / "keyframes.txt", tum_text(keyframes));
  files.add(folder / "frames.csv", [&](std::ostream& file) { write_frames_csv(run, report, file); });
  files.add(folder / "config.toml", to_toml(run.config));
  files.add(folder / "map.ply", map_ply(run.points, {}, run.keyframes));
  files.add(folder / "keyframes.ply", keyframes_ply(run.keyframes, source.camera()));
  nlohmann::ordered_json summary = to_summary(report, run, source);
  summary["source"] = to_json(origin, folder);
  files.add(folder / kSummaryName,
            summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  records.finish(run, source.ground_truth());
  files.keep();
  records.keep();
}

std::string why_gone(const std::string& where, const RunResult& run) {
  std::error_code none;
  if (where.starts_with("generated:") || std::filesystem::exists(where, none)) return {};
  // Frames are read ahead of each other, so that the last one may have been read.
  const auto unread = std::count_if(run.records.begin(), run.records.end(), [](const FrameRecord& record) {
    return record.status == FrameStatus::unreadable;
  });
  if (unread == 0) return {};
  return fmt::format("{}: went away while it was read; {} of {} frames could not be read", where, unread,
                     run.records.size());
}

}  // namespace stillpoint
