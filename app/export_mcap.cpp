#include "app/export_mcap.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "app/layered_frames.hpp"
#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/export/mcap_export.hpp"
#include "core/inspect/run_view.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/prefetch.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

}  // namespace

McapFileName::McapFileName(std::string path, bool force) : path_(std::move(path)), file_(path_) {
  if (fs::path(path_).extension() != ".mcap")
    throw InputError(fmt::format("{}: expected a name that ends in .mcap", path_));
  check_out_file(path_, force);
}

void McapFileName::finish() {
  file_.keep();
  write_text_file(fs::path(path_).replace_extension(".foxglove.json"), foxglove_layout());
}

void export_mcap(const std::string& run_folder, const std::string& sequence, const std::string& to,
                 bool force, const std::vector<std::string>& layers) {
  const OpenedRun run = open_run_and_tell(run_folder, sequence);
  if (!layers.empty() && !run.no_images.empty()) throw InputError(run.no_images);
  McapFileName name(to, force);
  const FrameRecords& records = run.recorded->run.records;
  McapExport file(name.while_written(), run.source->camera());
  {
    Progress progress(run.source->name(), static_cast<int>(records.size()));
    std::optional<LayeredFrames> layered;
    if (!layers.empty()) layered.emplace(run, layers);
    Prefetcher frames(*run.source, 0, layered ? 0 : static_cast<int>(records.size()), 2);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (layered) {
        const auto view = layered->view(static_cast<int>(i));
        file.add(view->frame, run.recorded->record(i), view->mask, layered->layers_of(*view));
      } else {
        file.add(frames.next(), run.recorded->record(i), run.recorded->mask(i));
      }
      progress.advance("");
      throw_if_interrupted("stopped before it was done; nothing was written");
    }
    if (layered) check_layers(layers, layered->found());
  }
  file.finish(run.recorded->run, run.recorded->ground_truth);
  name.finish();
  fmt::print("{}, {} written to {}\n", counted(records.size(), "frame"), counted(file.messages(), "message"),
             to);
  if (!file.too_far().empty()) fmt::print("{}\n", file.too_far());
}

}  // namespace stillpoint
