#include "app/export_mcap.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/export/mcap_export.hpp"
#include "core/inspect/shown_run.hpp"
#include "core/out_folder.hpp"
#include "core/run/open_run.hpp"
#include "core/sequence/prefetch.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Frames with the layers asked for, which stages must be worked out for.
class LayeredFrames {
 public:
  LayeredFrames(const OpenedRun& run, std::vector<std::string> layers)
      : cache_(*run.source),
        shown_(*run.source, cache_, ReplayableRun(*run.source, run.recorded)),
        wanted_(std::move(layers)) {}

  void add(int index, const FrameRecord& record, McapExport& file) {
    while (shown_.track().seen() <= index && !shown_.track().can_repeat_motion(index)) shown_.catch_up_one();
    const auto view = shown_.frame_view(index);
    std::vector<const Layer*> layers;
    for (const std::string& id : wanted_)
      if (const StageLog* log = stages_with(*view, id)) {
        layers.push_back(log->layer(id));
        found_.insert(id);
      }
    file.add(view->frame, record, view->mask, layers);
  }
  /// @throws InputError naming one that no frame had
  void check() const {
    for (const std::string& id : wanted_)
      if (found_.count(id) == 0)
        throw InputError(fmt::format("--layers {}: no stage of any frame has a layer of that id", id));
  }

 private:
  FrameCache cache_;
  ShownRun shown_;
  std::vector<std::string> wanted_;
  std::set<std::string> found_;
};

}  // namespace

McapFileName::McapFileName(std::string path, bool force) : path_(std::move(path)), file_(path_) {
  std::error_code none;
  if (fs::path(path_).extension() != ".mcap")
    throw InputError(fmt::format("{}: expected a name that ends in .mcap", path_));
  if (!force && fs::exists(path_, none))
    throw InputError(fmt::format("{}: is there already; --force replaces it", path_));
}

void McapFileName::finish() {
  file_.keep();
  write_text_file(fs::path(path_).replace_extension(".foxglove.json"), foxglove_layout());
}

void export_mcap(const std::string& run_folder, const std::string& sequence, const std::string& to,
                 bool force, const std::vector<std::string>& layers) {
  const OpenedRun run = open_run(run_folder, sequence);
  if (!layers.empty() && !run.no_images.empty()) throw InputError(run.no_images);
  McapFileName name(to, force);
  const std::vector<FrameRecord>& records = run.recorded->run.records;
  McapExport file(name.while_written(), run.source->camera());
  {
    Progress progress(run.source->name(), static_cast<int>(records.size()));
    std::optional<LayeredFrames> layered;
    if (!layers.empty()) layered.emplace(run, layers);
    Prefetcher frames(*run.source, 0, layered ? 0 : static_cast<int>(records.size()), 2);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (layered)
        layered->add(static_cast<int>(i), records[i], file);
      else
        file.add(frames.next(), records[i], unpack_mask(run.recorded->masks[i]));
      progress.advance("");
      throw_if_interrupted();
    }
    if (layered) layered->check();
  }
  file.finish(run.recorded->run, run.recorded->ground_truth);
  name.finish();
  fmt::print("{} frames, {} messages written to {}\n", records.size(), file.messages(), to);
}

}  // namespace stillpoint
