#include "app/export_dense.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/media/image_codec.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/prefetch.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// What is left of an export that was stopped.
std::string stopped_text(const DenseExport& wanted, bool has_map, int images) {
  std::string left = "stopped before it was done; ";
  if (has_map) left += "the map was written";
  if (wanted.images.empty()) return left + (has_map ? "" : "nothing was written");
  return left + fmt::format("{}{} in {}", has_map ? ", and " : "", counted(images, "image"), wanted.images);
}

/// Calls `visit(frame, world_from_camera, mask)` for every `every`-th frame that has a pose.
template <typename Visit>
void visit_frames(const OpenedRun& run, int every, const std::string& what, Visit visit,
                  const std::function<std::string()>& left) {
  const FrameRecords& records = run.recorded->run.records;
  const int count = static_cast<int>(records.size());
  Progress progress(what, count);
  Prefetcher frames(*run.source, 0, count, 2);
  for (int i = 0; i < count; ++i) {
    const Frame frame = frames.next();
    const auto at = static_cast<std::size_t>(i);
    const auto pose =
        nearest_pose(run.recorded->run.trajectory, records[at].timestamp, kAssociationTolerance);
    if (i % every == 0 && records[at].estimated && pose && frame.readable())
      visit(frame, run.recorded->run.trajectory[*pose].world_from_camera, run.recorded->mask(at));
    progress.advance("");
    throw_if_interrupted(stop_requested() ? left() : "");
  }
}

std::string image_name(int frame) { return fmt::format("{:06}.png", frame); }

void write_png(const fs::path& path, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image, 1);
  write_text_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace

void export_dense(const DenseExport& wanted) {
  const NewFolders made(wanted.images);
  const OpenedRun run = open_run_and_tell(wanted.run, wanted.sequence);
  if (!run.no_images.empty()) throw InputError(run.no_images);
  if (!run.source->has_depth())
    throw InputError(fmt::format("{}: its sequence has no depth, and a dense map is made of it", wanted.run));
  if (!wanted.map.empty() && fs::path(wanted.map).extension() != ".ply")
    throw InputError(fmt::format("{}: expected a name that ends in .ply", wanted.map));
  if (!wanted.map.empty()) check_out_file(wanted.map, wanted.force);
  if (!wanted.images.empty() &&
      !run.recorded->run.records.empty())  // a sequence's own images have such names
    prepare_out_folder(wanted.images, {"unknown.csv", image_name(run.recorded->run.records.front().index)},
                       wanted.force);
  DenseMap map(run.source->camera(), wanted.options);
  BackgroundFiller filler(run.source->camera(), wanted.options);
  visit_frames(
      run, wanted.every, "depth images",
      [&](const Frame& frame, const Pose& pose, const cv::Mat& mask) {
        if (!wanted.map.empty()) map.add(frame, pose, mask);
        if (!wanted.images.empty()) filler.add(frame, pose, mask);
      },
      [&] { return stopped_text(wanted, false, 0); });
  if (!wanted.map.empty()) {
    const std::vector<DensePoint> points = map.points();
    write_dense_ply(wanted.map, points);
    fmt::print("{} written to {}\n", counted(points.size(), "point"), wanted.map);
  }
  if (wanted.images.empty()) return;
  int count = 0;
  std::string table = "frame,filled_share,unknown_share\n";
  visit_frames(
      run, 1, "background",
      [&](const Frame& frame, const Pose& pose, const cv::Mat& mask) {
        const FilledFrame filled = filler.fill(frame, pose, mask);
        write_png(fs::path(wanted.images) / image_name(frame.index), filled.image);
        table += fmt::format(
            "{},{:.4f},{:.4f}\n", frame.index,
            static_cast<double>(cv::countNonZero(filled.filled)) / static_cast<double>(filled.filled.total()),
            filled.unknown);
        ++count;
      },
      [&] { return stopped_text(wanted, !wanted.map.empty(), count); });
  write_text_file(fs::path(wanted.images) / "unknown.csv", table);
  fmt::print("{} without what moved written to {}; what no frame saw behind it is black\n",
             counted(count, "frame"), wanted.images);
}

}  // namespace stillpoint
