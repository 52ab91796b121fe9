#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

struct GenerateOptions {
  std::string kind, out;
  int frames = 0;
  unsigned seed = 1;
  int threads = 2;
  bool force = false, stereo = false;
  std::string layout;
};

/// @throws InputError naming the layouts there are
void choose_layout(const GenerateOptions& options, WriteOptions& write) {
  const std::string& name = options.layout;
  if (name.empty()) return;
  if (!options.stereo) {
    if (name != "tum") write.rgbd = &rgbd_layout_by_name(name);
    return;
  }
  if (name == "left-right")
    write.layout = SequenceLayout::left_right;
  else if (name == "kitti")
    write.layout = SequenceLayout::kitti;
  else if (name == "euroc")
    write.layout = SequenceLayout::euroc;
  else
    throw InputError(fmt::format("--layout {}: expected left-right, kitti or euroc with --stereo", name));
}

void generate(const GenerateOptions& options) {
  WriteOptions write;
  choose_layout(options, write);
  throw_if_among_results(options.out);
  std::string kind = options.kind;
  if (options.stereo) kind += kStereoEnding;
  const auto sequence = make_generated_sequence(kind, options.frames, options.seed);
  write.force = options.force;
  write.threads = options.threads;
  Progress progress(sequence->name(), sequence->size());
  write.progress = [&progress](int, int) { progress.advance("rendered"); };
  write.stop = &stop_requested();
  const int written = write_sequence(*sequence, options.out, write).frames;
  fmt::print("{}: {} of {}, seed {}\n", options.out, counted(written, "frame"), sequence->name(),
             options.seed);
  throw_if_interrupted(written > 0 ? "stopped early; what was rendered is a sequence"
                                   : "stopped early; nothing was rendered");
}

}  // namespace

void add_generate_command(CLI::App& app) {
  auto options = std::make_shared<GenerateOptions>();
  CLI::App* command = app.add_subcommand("generate",
                                         "Film a generated room and write it as a TUM RGB-D folder, in "
                                         "another data set's layout, or as stereo pairs");
  command
      ->add_option("KIND", options->kind,
                   fmt::format("One of: {}; or, harder, {}", fmt::join(generated_kinds(), ", "),
                               fmt::join(hard_generated_kinds(), ", ")))
      ->required();
  command->add_option("--out", options->out, "Folder to write; made if missing")->required();
  command->add_option("--frames", options->frames, "How many frames; 0 = the kind's own length (300)");
  command->add_option("--seed", options->seed, "Another seed is another sequence of the same kind")
      ->capture_default_str();
  command
      ->add_option("--threads", options->threads, "Threads that make frames; any number gives the same files")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_flag("--stereo", options->stereo,
                    "Film it by a stereo pair of 0.12 m: left/ and right/ in place of rgb/ and depth/");
  std::vector<std::string> layouts;
  for (const RgbdLayout* layout : rgbd_layouts()) layouts.emplace_back(layout->name);
  command->add_option("--layout", options->layout,
                      fmt::format("As a data set lays it out: tum (otherwise), {}; with --stereo left-right "
                                  "(otherwise), kitti (KITTI odometry) or euroc (EuRoC/ASL)",
                                  fmt::join(layouts, ", ")));
  command->add_flag("--force", options->force, "Replace the sequence that the folder holds");
  command->callback([options] { generate(*options); });
}

}  // namespace stillpoint
