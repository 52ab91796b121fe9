#include "app/export_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/export/map_export.hpp"
#include "core/out_folder.hpp"
#include "core/run/map_ply.hpp"
#include "core/sequence/association.hpp"

namespace stillpoint {
namespace {

/// None where no depth image can be had.
std::vector<Eigen::Vector3f> normals_of_map(const OpenedRun& opened, int every) {
  const RunResult& run = opened.recorded->run;
  if (!opened.no_images.empty() || !opened.source->has_depth()) return {};
  PointNormals normals(opened.source->camera());
  Progress progress("normals", static_cast<int>(run.records.size()));
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const FrameRecord& record = run.records[i];
    progress.advance("");
    throw_if_interrupted("stopped before it was done; nothing was written");
    const auto pose = nearest_pose(run.trajectory, record.timestamp, kAssociationTolerance);
    if (!record.estimated || !pose || (!record.keyframe && record.index % every != 0)) continue;
    normals.add(opened.source->read(record.index), opened.recorded->record(i),
                run.trajectory[*pose].world_from_camera);
  }
  return normals.of(run.points);
}

}  // namespace

void export_map(const MapExport& wanted) {
  const std::filesystem::path map = wanted.to, keyframes = std::filesystem::path(map).replace_filename(
                                                   map.stem().string() + "_keyframes.ply");
  const OpenedRun opened = open_run_and_tell(wanted.run, wanted.sequence);
  const RunResult& run = opened.recorded->run;
  if (run.points.empty()) throw InputError(fmt::format("{}: the run left no map", wanted.run));
  for (const auto& file : {map, keyframes}) check_out_file(file, wanted.force);
  const std::vector<Eigen::Vector3f> normals = normals_of_map(opened, wanted.every);
  WholeFiles files;
  files.add(map, map_ply(run.points, normals, {}));
  files.add(keyframes, keyframes_ply(run.keyframes, opened.source->camera()));
  files.keep();
  const auto known =
      std::count_if(normals.begin(), normals.end(), [](const auto& n) { return !n.isZero(0.0F); });
  fmt::print("{}, {} of them with a normal, written to {}; {} to {}\n", counted(run.points.size(), "point"),
             known, map.string(), counted(run.keyframes.size(), "keyframe"), keyframes.string());
  if (normals.empty())
    fmt::print("no normals: {}\n", opened.no_images.empty() ? "the sequence has no depth" : opened.no_images);
}

}  // namespace stillpoint
