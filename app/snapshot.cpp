#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "ui/panels/panel.hpp"
#include "ui/session/frame_ranges.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/settings.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWorkbench = "workbench";
constexpr const char* kWorkbenchSize = "1600x900";
constexpr const char* kPanelSize = "960x780";

struct SnapshotArguments {
  std::string sequence, out, frames = "-1", panels = "all", size, theme = "dark", layout;
  double scale = 1.0;
  bool force = false, no_baseline = false, timings = false;
  ConfigArguments config;
  SequenceArguments source;
};

/// What is to be drawn of each frame.
struct Pictures {
  bool workbench = false;
  std::vector<Panel*> panels;
};

Pictures chosen_pictures(const std::string& names, const std::vector<std::unique_ptr<Panel>>& panels) {
  Pictures pictures;
  std::vector<std::string> known;
  for (const auto& panel : panels) known.push_back(panel->name());
  for (const std::string& name : split_list(names)) {
    if (name == kWorkbench) {
      pictures.workbench = true;
      continue;
    }
    bool found = false;
    for (const auto& panel : panels) {
      if (name != "all" && name != panel->name()) continue;
      found = true;
      if (std::find(pictures.panels.begin(), pictures.panels.end(), panel.get()) == pictures.panels.end())
        pictures.panels.push_back(panel.get());
    }
    if (!found)
      throw InputError(fmt::format("--panels {}: there is no such panel; there are all, {}, {}", name,
                                   kWorkbench, fmt::join(known, ", ")));
  }
  if (!pictures.workbench && pictures.panels.empty()) throw InputError("--panels: names no panel");
  return pictures;
}

void write_png(const fs::path& path, const cv::Mat& image) {
  // Fast rather than small: packing would take longer than drawing.
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, {cv::IMWRITE_PNG_COMPRESSION, 3});
  } catch (const cv::Exception&) {
  }
  std::error_code error;
  if (!written || fs::file_size(path, error) == 0 || error)
    throw InputError(
        fmt::format("{}: cannot be written (no permission, or the disk is full)", path.string()));
}

/// Draws pictures of frames, in one GL context for all of them. It goes first, then the panels, whose
/// textures it holds.
class Painter {
 public:
  Painter(const SnapshotArguments& arguments, const std::string& method)
      : look_{parse_theme(arguments.theme), static_cast<float>(arguments.scale)},
        workbench_size_(parse_size(arguments.size.empty() ? kWorkbenchSize : arguments.size)),
        panel_size_(parse_size(arguments.size.empty() ? kPanelSize : arguments.size)),
        offscreen_({.width = workbench_size_.first, .height = workbench_size_.second, .look = look_}),
        panels_(make_panels()),
        workbench_(make_panels()),
        pictures_(chosen_pictures(arguments.panels, panels_)) {
    workbench_.set_layout(default_layout(method));
    if (!arguments.layout.empty())
      workbench_.set_layout(read_layout(arguments.layout, workbench_.panel_names()));
  }
  ~Painter() { offscreen_.make_current(); }
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Whether a panel holds frames against the ones before them.
  [[nodiscard]] bool compares_frames() const {
    return std::any_of(pictures_.panels.begin(), pictures_.panels.end(),
                       [](const Panel* panel) { return panel->name() == "stages"; }) ||
           (pictures_.workbench && contains(workbench_.layout(), "stages"));
  }

  /// Writes FRAME_PANEL.png for each picture of the frame shown. @returns how many
  int paint(const SessionView& view, const fs::path& folder) {
    int written = 0;
    if (pictures_.workbench) {
      offscreen_.resize(workbench_size_.first, workbench_size_.second);
      const cv::Mat image = offscreen_.render([&](UiFrame& frame) { workbench_.draw(frame, &view); });
      write_png(folder / fmt::format("{:06d}_{}.png", view.current->index, kWorkbench), image);
      ++written;
    }
    if (!pictures_.panels.empty()) offscreen_.resize(panel_size_.first, panel_size_.second);
    for (Panel* panel : pictures_.panels) {
      const cv::Mat image =
          offscreen_.render([&](UiFrame& frame) { Workbench::draw_alone(frame, view, *panel); });
      write_png(folder / fmt::format("{:06d}_{}.png", view.current->index, panel->name()), image);
      ++written;
    }
    return written;
  }

 private:
  Look look_;
  std::pair<int, int> workbench_size_, panel_size_;
  Offscreen offscreen_;
  std::vector<std::unique_ptr<Panel>> panels_;
  Workbench workbench_;
  Pictures pictures_;
};

void snapshot(const SnapshotArguments& arguments) {
  const Config config = arguments.config.config();
  std::shared_ptr<const FrameSource> source = arguments.source.open(arguments.sequence, config);
  const std::vector<int> frames = parse_frame_ranges(arguments.frames, source->size());
  Painter painter(arguments, config.run.method);
  prepare_out_folder(arguments.out, {"snapshots.txt"}, arguments.force);

  Session session(source, config, {.baseline = !arguments.no_baseline, .keep_times = arguments.timings});
  int written = 0;
  std::string list;
  {
    Progress progress(fmt::format("{} ({})", source->name(), config.run.method), frames.back() + 1);
    for (const int frame : frames) {
      session.go_to(frame, [&](const FrameRecord& record) {
        progress.advance(std::string(to_string(record.status)));
        throw_if_interrupted();
      });
      if (painter.compares_frames()) session.complete();
      written += painter.paint(*session.view(), arguments.out);
      list += fmt::format("{:06d} {:.6f} {}\n", frame, session.view()->current->frame.timestamp,
                          to_string(session.view()->current->record->status));
    }
  }
  // What was drawn, and the sign that this folder is ours.
  write_text_file(fs::path(arguments.out) / "snapshots.txt", "# frame, timestamp in s, status\n" + list);
  fmt::print("{} images of {} frames written to {}\n", written, frames.size(), arguments.out);
}

}  // namespace

void add_snapshot_command(CLI::App& app) {
  const auto arguments = std::make_shared<SnapshotArguments>();
  CLI::App* command = app.add_subcommand(
      "snapshot", "Panels of the workbench as images, without a display: input, masks, trajectory, plots");
  command
      ->add_option("SEQUENCE", arguments->sequence,
                   "A TUM RGB-D folder, a folder of colour frames, or generated:KIND")
      ->required();
  command
      ->add_option("--frames", arguments->frames,
                   "Frames to draw: 10, 20:40:5 (40 not among them), -1 is the last; with commas between")
      ->capture_default_str();
  command->add_option("--panels", arguments->panels, "all, workbench, or panels' names with commas between")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Folder for the images, FRAME_PANEL.png; made if missing")
      ->required();
  command->add_option("--size", arguments->size,
                      fmt::format("Of an image, px; otherwise {} for the workbench and {} for a panel",
                                  kWorkbenchSize, kPanelSize));
  command->add_option("--scale", arguments->scale, "Of text and spacing")->check(CLI::Range(0.5, 4.0));
  command->add_option("--theme", arguments->theme, "dark or light")->capture_default_str();
  command->add_option("--layout", arguments->layout, "The workbench's tiles, a JSON file");
  command->add_flag("--no-baseline", arguments->no_baseline, "Do not run method none beside for comparison");
  command->add_flag("--timings", arguments->timings, "Show stage times, which differ from run to run");
  command->add_flag("--force", arguments->force, "Overwrite earlier images");
  command
      ->add_option("--length", arguments->source.frames,
                   "Only so many frames of the sequence, from the first on")
      ->check(CLI::Range(1, 10'000'000));
  command->add_option("--camera", arguments->source.camera,
                      "A camera's name or a TOML file; otherwise the folder tells");
  command->add_option("--seed", arguments->source.seed, "Seed of a generated sequence")
      ->check(CLI::Range(0, 1'000'000'000));
  arguments->config.add_to(*command, true);
  command->callback([arguments] { snapshot(*arguments); });
}

}  // namespace stillpoint
