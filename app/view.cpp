#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>

#include "app/commands.hpp"
#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "app/replaying.hpp"
#include "core/error.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/open_run.hpp"
#include "ui/panels/panel.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/app_controller.hpp"
#include "ui/workbench/settings.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDemo = "generated:walking_static";

struct ViewArguments {
  SourceArguments place;
  std::string layout, record, replay, out = ".";
};

WindowOptions window_options(const Settings& settings) {
  WindowOptions options{.look = settings.look};
  if (settings.window_size) {
    options.width = (*settings.window_size)[0], options.height = (*settings.window_size)[1];
    options.grows_with_display = false;
  }
  return options;
}

/// The window, the controller in it, and what is kept from one time to the next.
class Viewer {
 public:
  Viewer(const ViewArguments& arguments, const Config& config)
      : settings_path_(settings_path()),
        settings_(read_settings(settings_path_, panel_names(), &problem_)),
        window_(window_options(settings_)),
        controller_(controller_options(config)) {
    if (!problem_.empty()) controller_.workbench().say(problem_, true);
    if (!arguments.layout.empty())
      controller_.workbench().set_layout(
          read_layout(arguments.layout, controller_.workbench().panel_names()));
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  [[nodiscard]] AppController& controller() { return controller_; }

  /// Records what is done from now on.
  void record(const std::string& file) {
    const auto [width, height] = window_.framebuffer_size();
    recorder_ = std::make_unique<Recorder>(file, controller_.recording_start({width, height}));
    window_.canvas().set_listener([this](const InputEvent& event) {
      recorder_->event(event, window_.canvas().time_s(), recorded_state());
    });
  }

  void run() {
    // A signal does not end the window's sleep.
    const std::jthread watcher([](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (stop_requested()) Window::wake();
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
    });
    window_.run([this](UiFrame& frame) { draw(frame); });
    save();
    if (recorder_) recorder_->finish();
    throw_if_interrupted();
  }

 private:
  static std::vector<std::string> panel_names() {
    std::vector<std::string> names;
    for (const auto& panel : make_panels()) names.push_back(panel->name());
    return names;
  }

  ControllerOptions controller_options(const Config& config) const {
    return {.open_source =
                [](const std::string& where, const Config& wanted, const std::vector<std::string>& reading) {
                  return open_source_as(where, reading, wanted);
                },
            .config = config,
            .settings = settings_,
            .marks_folder = settings_path_.empty() ? fs::path() : settings_path_.parent_path() / "sequences",
            .plays_when_opened = kDemo,
            .wake = [] { Window::wake(); }};
  }

  [[nodiscard]] RecordedState recorded_state() const {
    const auto view = controller_.view();
    return {view ? view->current->index : 0, view && view->playing, controller_.idle()};
  }

  void draw(UiFrame& frame) {
    controller_.draw(frame);
    if (const std::string title = controller_.title(); title != title_) window_.set_title(title_ = title);
    if (recorder_) {
      recorder_->size(static_cast<int>(frame.size.x), static_cast<int>(frame.size.y));
      recorder_->state(recorded_state());
      if (!recorder_->intact() && !std::exchange(recording_failed_, true))
        controller_.workbench().say("The recording cannot be written on (the disk is full?).", true);
    }
    if (frame.close_requested || stop_requested()) frame.quit = true;
  }

  void save() {
    settings_ = controller_.settings();
    const auto placement = window_.placement();
    settings_.window_size = std::array<int, 2>{placement[2], placement[3]};
    write_settings(settings_path_, settings_);
  }

  std::string problem_, title_;
  fs::path settings_path_;
  Settings settings_;
  Window window_;
  AppController controller_;
  std::unique_ptr<Recorder> recorder_;
  bool recording_failed_ = false;
};

/// Begins with the sequence named, else with the one open last, else with the start page.
void view(ViewArguments arguments) {
  // What was named and cannot be opened is told before there is a window.
  std::optional<OpenedSource> place;
  if (!arguments.place.place.empty()) {
    SequenceArguments& reading = arguments.place.source;
    if (!is_run_folder(arguments.place.place))
      reading = reading.fixed(arguments.place.place, arguments.place.config.config());
    place = open_source(arguments.place);
  }
  Viewer viewer(arguments, place ? place->config : arguments.place.config.config());
  if (place)
    viewer.controller().show(std::move(*place), arguments.place.place, arguments.place.words());
  else
    viewer.controller().open_last(arguments.place.config.given() ? &viewer.controller().config() : nullptr);
  if (!arguments.record.empty()) viewer.record(arguments.record);
  viewer.run();
}

/// Plays a recording in a window, which forgets it all afterwards.
void view_replay(const ViewArguments& arguments) {
  ReplayPlan plan(arguments.replay, arguments.place.place, arguments.place.source, arguments.place.config);
  plan.prepare_out(arguments.out, true);
  Window window(
      WindowOptions{.width = plan.start().size[0], .height = plan.start().size[1], .look = plan.look()});
  ReplayShell shell = replay_shell(window);
  plan.play(shell, [] { Window::wake(); });
}

}  // namespace

void view_demo() {
  ViewArguments arguments;
  arguments.place.place = kDemo;
  view(arguments);
}

void add_view_command(CLI::App& app) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command =
      app.add_subcommand("view", "Opens the workbench in a window, on a sequence or as it was left");
  command->add_option("SEQUENCE", arguments->place.place, kSequenceOrRunHelp);
  arguments->place.add_to(*command);
  command->add_option("--layout", arguments->layout, "The workbench's tiles, a JSON file");
  const auto* record =
      command->add_option("--record", arguments->record, "Writes what is done in the window to this file");
  command->add_option("--replay", arguments->replay, "Plays a file of --record in the window")
      ->excludes(const_cast<CLI::Option*>(record));
  command->add_option("--out", arguments->out, "Folder for a replay's screenshots")->capture_default_str();
  arguments->place.source.add_to(*command);
  arguments->place.config.add_to(*command, true);
  command->callback([arguments] {
    if (arguments->replay.empty())
      view(*arguments);
    else
      view_replay(*arguments);
  });
}

}  // namespace stillpoint
