#include <fmt/format.h>

#include "app/commands.hpp"
#include "app/progress.hpp"
#include "app/replaying.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/run/open_run.hpp"

namespace stillpoint {
namespace {

struct ReplayArguments {
  std::string file, out = ".";
  bool force = false;
  PlaceArguments place;
};

void replay_offscreen(const ReplayArguments& arguments) {
  ReplayPlan plan(arguments.file, arguments.place);
  plan.prepare_out(arguments.out, arguments.force);
  Offscreen offscreen({.width = plan.start().size[0], .height = plan.start().size[1], .look = plan.look()});
  plan.play(replay_shell(offscreen), [] {});
}

/// A place for the desk; nothing of a replay is kept with a sequence.
DeskPlace desk_place(OpenedPlace opened) {
  // Times differ from run to run; screenshots are not to.
  opened.options.keep_times = false;
  return {std::move(opened.source), std::move(opened.config), std::move(opened.options),
          std::move(opened.problem)};
}

}  // namespace

ReplayPlan::ReplayPlan(const std::string& file, PlaceArguments place)
    : recording_(read_recording(file)), arguments_(std::move(place)) {
  const RecordingStart& start = recording_.start;
  if (arguments_.place.empty())
    arguments_.place = start.opened_from.empty() ? start.sequence_name : start.opened_from;
  const bool finished_run = !arguments_.place.empty() && is_run_folder(arguments_.place);
  if (!finished_run) {
    auto& assignments = arguments_.config.assignments;
    assignments.insert(assignments.begin(), start.settings.begin(), start.settings.end());
    if (arguments_.source.frames == 0) arguments_.source.frames = start.sequence_frames;
  }
  config_ = arguments_.config.config();
  if (arguments_.place.empty()) return;
  opened_ = open_place(arguments_);
  config_ = opened_->config;
  require_same_sequence(recording_, *opened_->source);
}

Look ReplayPlan::look() const {
  return {parse_theme(recording_.start.theme), static_cast<float>(recording_.start.scale)};
}

void ReplayPlan::prepare_out(const std::string& folder, bool force) {
  out_ = folder;
  prepare_out_folder(out_, {}, force);
  for (const RecordedLine& line : recording_.lines) {
    const auto* screenshot = std::get_if<happening::Screenshot>(&line.what);
    std::error_code ignored;
    if (screenshot != nullptr && !force && std::filesystem::exists(out_ / screenshot->file, ignored))
      throw InputError(
          fmt::format("{}: is there already; --force overwrites it", (out_ / screenshot->file).string()));
  }
}

void ReplayPlan::play(const ReplayShell& shell, std::function<void()> wake) {
  Settings settings;
  settings.look = look();
  const auto open = [this](const std::string& where, const Config& config) {
    PlaceArguments other;
    other.place = where;
    other.source = arguments_.source;
    other.source.frames = 0;
    if (is_run_folder(where)) other.source = {};
    OpenedPlace opened = open_place(other);
    if (!opened.options.recorded) opened.config = config;
    return desk_place(std::move(opened));
  };
  Desk desk({.open_place = open,
             .config = config_,
             .settings = settings,
             .plays_when_opened = {},
             .wake = std::move(wake)});
  if (!recording_.start.layout.empty())
    desk.workbench().set_layout(
        parse_layout(recording_.start.layout, recording_.file, desk.workbench().panel_names()));
  if (opened_) desk.show(desk_place(std::move(*opened_)), arguments_.place);
  const ReplayResult result =
      replay(recording_, desk, shell, {.out = out_, .between = [] { throw_if_interrupted(); }});
  fmt::print("{} happenings of {} replayed, {} screenshots\n", result.happenings, recording_.file,
             result.screenshots);
  const UiPace& pace = shell.canvas->pace();
  if (pace.busy_frames > 0)
    fmt::print(
        "{} of {} frames of the interface drawn beside work, the longest in {:.1f} ms, {} in more than {:g} "
        "ms\n",
        pace.busy_frames, pace.frames, pace.longest_busy_ms, pace.busy_over_limit, UiPace::kLimitMs);
}

void add_replay_command(CLI::App& app) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand(
      "replay", "Plays a recording of `view --record` without a display; its screenshots go to a folder");
  command->add_option("FILE", arguments->file, "The recording")->required();
  command->add_option("SEQUENCE", arguments->place.place,
                      "Where its sequence lies; otherwise it says so itself");
  command->add_option("--out", arguments->out, "Folder for its screenshots")->capture_default_str();
  command->add_flag("--force", arguments->force, "Overwrite earlier screenshots");
  arguments->place.add_to(*command);
  arguments->place.source.add_to(*command);
  arguments->place.config.add_to(*command, true);
  command->callback([arguments] { replay_offscreen(*arguments); });
}

}  // namespace stillpoint
