#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/export_dense.hpp"
#include "app/export_map.hpp"
#include "app/export_mcap.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/inspect/frame_ranges.hpp"
#include "core/media/stored_depth.hpp"
#include "core/run/condition.hpp"
#include "core/sequence/excerpt.hpp"

namespace stillpoint {
namespace {

struct ExportArguments {
  std::string sequence, out, frames = "0:", to, sequence_now;
  std::vector<std::string> layers;
  DenseExport dense;
  bool force = false;
  SequenceArguments source;
};

void export_sequence(const ExportArguments& arguments) {
  const auto source = arguments.source.open(arguments.sequence, Config());
  std::error_code none;
  if (std::filesystem::equivalent(arguments.sequence, arguments.out, none))
    throw InputError(fmt::format(
        "--out {}: is the sequence itself, of which only the frames chosen would be left", arguments.out));
  throw_if_among_results(arguments.out);
  const std::vector<int> frames = parse_frame_ranges(arguments.frames, source->size());
  ExportedFrames exported;
  {
    Progress progress(source->name(), static_cast<int>(frames.size()));
    exported = export_frames(*source, frames, arguments.out, arguments.force, [&](int, int) {
      progress.advance("");
      throw_if_interrupted("stopped before it was done; nothing was written");
    });
  }
  fmt::print("{} written to {}\n", counted(exported.written, "frame"), arguments.out);
  if (!exported.unreadable.empty())
    fmt::print("cannot be read, and have places without images: {}\n", frames_text(exported.unreadable));
  if (exported.too_far > 0) fmt::print("{}\n", too_far_told(exported.too_far, exported.depth_units));
}

/// An option that the chosen export would pass over in silence is refused.
void throw_if_of_no_use(const CLI::App& command, const ExportArguments& arguments) {
  const bool to = !arguments.to.empty(), map = !arguments.dense.map.empty(),
             images = !arguments.dense.images.empty(), of_run = to || map || images;
  const auto refuse = [&command](const char* option, bool useful, const char* goes_with) {
    if (command.count(option) > 0 && !useful)
      throw_usage(fmt::format("{}: goes with {}, and is of no use here", option, goes_with));
  };
  refuse("--out", !of_run, "a sequence, whose frames it takes");
  refuse("--frames", !of_run, "--out");
  refuse("--layers", to, "--to");
  refuse("--voxel", map || images, "--dense and --without-movers");
  refuse("--every", of_run, "--to, --dense and --without-movers");
  refuse("--sequence", of_run, "--to, --dense and --without-movers");
  if (of_run && arguments.source.given())
    throw_usage(
        fmt::format("{}: a finished run has its own frames; options that change them go with its "
                    "sequence",
                    arguments.sequence));
}

}  // namespace

void add_export_command(CLI::App& app) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export",
                                         "Some frames of a sequence as a small TUM RGB-D folder that shows "
                                         "the same problem; or a finished run as "
                                         "an MCAP file, its map, a dense map, or the room without people");
  command->add_option("SEQUENCE", arguments->sequence, kSequenceOrRunHelp)->required();
  command
      ->add_option("--frames", arguments->frames,
                   "Frames to write: 10:40 (40 not among them), -1 is the last; with commas between")
      ->capture_default_str();
  auto* out = command->add_option("--out", arguments->out, "Folder for the sequence; made if missing");
  command
      ->add_option(
          "--to", arguments->to,
          "A finished run goes to this .mcap file, or its map to this .ply file, and its keyframes to "
          "NAME_keyframes.ply beside it")
      ->excludes(out);
  command
      ->add_option(
          "--layers", arguments->layers,
          "Ids of stages' layers that go into the file too, with commas between: difference,forward_mask")
      ->delimiter(',');
  command->add_option("--dense", arguments->dense.map,
                      "A finished run's depth images, fused without what moved, go to this .ply file");
  command->add_option(
      "--without-movers", arguments->dense.images,
      "Its frames with the background filled in where somebody was, as other frames saw it, go to "
      "this folder");
  command->add_option("--voxel", arguments->dense.options.voxel_m, "Of the dense map [m]")
      ->check(number_between(0.001, 1.0))
      ->capture_default_str();
  command
      ->add_option("--every", arguments->dense.every,
                   "Every so many frames are fused, or looked at for normals")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--sequence", arguments->sequence_now, "Where the run's sequence lies now");
  command->add_flag("--force", arguments->force, "Replace a sequence in that folder, or the file");
  arguments->source.add_to(*command, "--length");
  command->callback([arguments, command] {
    throw_if_of_no_use(*command, *arguments);
    const std::string ending = std::filesystem::path(arguments->to).extension().string();
    const bool map = ending == ".ply";
    if (!arguments->to.empty() && !map && ending != ".mcap")
      throw InputError(
          fmt::format("{}: expected a name that ends in .mcap, or in .ply for its map", arguments->to));
    if (map && !arguments->layers.empty())
      throw_usage("--layers: go into an .mcap file, not into a .ply file");
    if (map)
      export_map({arguments->sequence, arguments->sequence_now, arguments->to, arguments->dense.every,
                  arguments->force});
    else if (!arguments->to.empty())
      export_mcap(arguments->sequence, arguments->sequence_now, arguments->to, arguments->force,
                  arguments->layers);
    DenseExport& dense = arguments->dense;
    if (!dense.map.empty() || !dense.images.empty()) {
      dense.run = arguments->sequence, dense.sequence = arguments->sequence_now,
      dense.force = arguments->force;
      export_dense(dense);
    } else if (!arguments->out.empty()) {
      export_sequence(*arguments);
    } else if (arguments->to.empty()) {
      throw CLI::RequiredError("--out, --to, --dense or --without-movers");
    }
  });
}

}  // namespace stillpoint
