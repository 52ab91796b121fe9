#include "app/export_dense.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>

#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/media/image_codec.hpp"
#include "core/out_folder.hpp"
#include "core/run/open_run.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/prefetch.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Calls `visit(frame, world_from_camera, mask)` for every `every`-th frame that has a pose.
template <typename Visit>
void visit_frames(const OpenedRun& run, int every, const std::string& what, Visit visit) {
  const std::vector<FrameRecord>& records = run.recorded->run.records;
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
    throw_if_interrupted();
  }
}

void write_png(const fs::path& path, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image, 1);
  write_text_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace

void export_dense(const DenseExport& wanted) {
  const OpenedRun run = open_run(wanted.run, wanted.sequence);
  if (!run.no_images.empty()) throw InputError(run.no_images);
  if (!run.source->has_depth())
    throw InputError(fmt::format("{}: its sequence has no depth, and a dense map is made of it", wanted.run));
  std::error_code none;
  if (!wanted.map.empty() && !wanted.force && fs::exists(wanted.map, none))
    throw InputError(fmt::format("{}: is there already; --force replaces it", wanted.map));
  if (!wanted.images.empty()) prepare_out_folder(wanted.images, {"unknown.csv"}, wanted.force);
  DenseMap map(run.source->camera(), wanted.options);
  BackgroundFiller filler(run.source->camera(), wanted.options);
  visit_frames(run, wanted.every, "depth images",
               [&](const Frame& frame, const Pose& pose, const cv::Mat& mask) {
                 if (!wanted.map.empty()) map.add(frame, pose, mask);
                 if (!wanted.images.empty()) filler.add(frame, pose, mask);
               });
  if (!wanted.map.empty()) {
    const std::vector<DensePoint> points = map.points();
    write_dense_ply(wanted.map, points);
    fmt::print("{} points written to {}\n", points.size(), wanted.map);
  }
  if (wanted.images.empty()) return;
  int count = 0;
  std::string table = "frame,filled_share,unknown_share\n";
  visit_frames(run, 1, "background", [&](const Frame& frame, const Pose& pose, const cv::Mat& mask) {
    const FilledFrame filled = filler.fill(frame, pose, mask);
    write_png(fs::path(wanted.images) / fmt::format("{:06}.png", frame.index), filled.image);
    table += fmt::format(
        "{},{:.4f},{:.4f}\n", frame.index,
        static_cast<double>(cv::countNonZero(filled.filled)) / static_cast<double>(filled.filled.total()),
        filled.unknown);
    ++count;
  });
  write_text_file(fs::path(wanted.images) / "unknown.csv", table);
  fmt::print("{} frames without what moved written to {}; what no frame saw behind it is black\n", count,
             wanted.images);
}

}  // namespace stillpoint
