#include <fmt/format.h>

#include "app/commands.hpp"
#include "app/progress.hpp"
#include "app/replaying.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/inspect/run_view.hpp"
#include "core/out_folder.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/shell/warm_up.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

struct ReplayArguments {
  std::string file, sequence, out = ".";
  bool force = false;
  ConfigArguments config;
  SequenceArguments source;
};

void replay_offscreen(const ReplayArguments& arguments) {
  ReplayPlan plan(arguments.file, arguments.sequence, arguments.source, arguments.config);
  plan.prepare_out(arguments.out, arguments.force);
  const auto [width, height] = plan.start().size;
  Offscreen offscreen({.width = width, .height = height, .look = plan.look()});
  warm_up(offscreen.canvas(), width, height);
  plan.play(replay_shell(offscreen), [] {});
}

}  // namespace

ReplayPlan::ReplayPlan(const std::string& file, const std::string& sequence, SequenceArguments source,
                       const ConfigArguments& config)
    : recording_(read_recording(file)), source_arguments_(std::move(source)) {
  // What the command line says goes over what the recording says.
  ConfigArguments settings = config;
  settings.assignments = recording_.start.settings;
  settings.assignments.insert(settings.assignments.end(), config.assignments.begin(),
                              config.assignments.end());
  config_ = settings.config();
  if (source_arguments_.frames == 0) source_arguments_.frames = recording_.start.sequence_frames;
  where_ = !sequence.empty()                       ? sequence
           : !recording_.start.opened_from.empty() ? recording_.start.opened_from
                                                   : recording_.start.sequence_name;
  if (where_.empty()) return;
  place_ = open_untimed(where_);
  require_same_sequence(recording_, *place_->source);
}

OpenedSource ReplayPlan::open_untimed(const std::string& where) const {
  OpenedSource place = open_source_as(where, source_arguments_.words(), config_);
  // Times differ from run to run; screenshots are not to.
  place.options.keep_times = false;
  return place;
}

Look ReplayPlan::look() const {
  return {parse_theme(recording_.start.theme), static_cast<float>(recording_.start.scale)};
}

void ReplayPlan::prepare_out(const std::string& folder, bool force) {
  out_ = folder;
  prepare_out_folder(out_, {}, force);
  for (const RecordedLine& line : recording_.lines) {
    const auto* screenshot = std::get_if<event::Screenshot>(&line.what);
    std::error_code ignored;
    if (screenshot != nullptr && !force && std::filesystem::exists(out_ / screenshot->file, ignored))
      throw InputError(
          fmt::format("{}: is there already; --force replaces it", (out_ / screenshot->file).string()));
  }
}

void ReplayPlan::play(const ReplayShell& shell, std::function<void()> wake) {
  Settings settings;
  settings.look = look();
  AppController desk({.open_source = [this](const std::string& where, const Config&,
                                            const std::vector<std::string>&) { return open_untimed(where); },
                      .config = config_,
                      .settings = settings,
                      .marks_folder = {},
                      .plays_when_opened = {},
                      .wake = std::move(wake)});
  if (!recording_.start.layout.empty())
    desk.workbench().set_layout(
        parse_layout(recording_.start.layout, recording_.file, desk.workbench().panel_names()));
  if (place_) desk.show(*place_, where_);
  const ReplayResult result =
      replay(recording_, desk, shell, {.out = out_, .between = [] { throw_if_interrupted(); }});
  fmt::print("{} of {} replayed, {}\n", counted(result.events, "event"), recording_.file,
             counted(result.screenshots, "screenshot"));
  const UiPace& pace = shell.canvas->pace();
  if (pace.busy_frames > 0)
    fmt::print(
        "{} of {} frames of the interface drawn beside work, 95 % within {:.1f} ms, the longest in {:.1f} "
        "ms, {} "
        "in more than {:g} ms\n",
        pace.busy_frames, pace.frames, pace.busy_within_ms(0.95), pace.longest_busy_ms, pace.busy_over_limit,
        UiPace::kLimitMs);
}

void add_replay_command(CLI::App& app) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand(
      "replay", "Plays a recording of `view --record` without a display; its screenshots go to a folder");
  command->add_option("FILE", arguments->file, "The recording")->required();
  command->add_option("SEQUENCE", arguments->sequence,
                      "Where its sequence lies; otherwise it says so itself");
  command->add_option("--out", arguments->out, "Folder for its screenshots")->capture_default_str();
  command->add_flag("--force", arguments->force, "Overwrite earlier screenshots");
  arguments->source.add_to(*command);
  arguments->config.add_to(*command, true);
  command->callback([arguments] { replay_offscreen(*arguments); });
}

}  // namespace stillpoint
