#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/open_place.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/run/open_run.hpp"
#include "ui/panels/panel.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/settings.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDemo = "generated:walking_static";

using ViewArguments = PlaceArguments;

WindowOptions window_options(const Settings& settings) {
  return {.width = settings.window_size[0], .height = settings.window_size[1], .look = settings.look};
}

/// The window and what it shows: the one place where sessions come and go.
class Viewer {
 public:
  Viewer(const ViewArguments& arguments, const Config& config)
      : arguments_(arguments),
        config_(config),
        settings_path_(settings_path()),
        settings_(read_settings(settings_path_, names_of(make_panels()), &problem_)),
        window_(window_options(settings_)),
        workbench_(make_panels(), host()) {
    workbench_.set_layout(settings_.layout ? *settings_.layout : default_layout(config.run.method));
    if (!problem_.empty()) workbench_.say(problem_, true);
    workbench_.set_recent(settings_.recent);
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Opens a sequence; when that fails the one open stays, and the window says why.
  void open(const std::string& where) {
    try {
      if (is_run_folder(where)) {
        PlaceArguments run;
        run.place = where;
        show(open_place(run), where);
      } else {
        show(open_sequence_at(where), where);
      }
    } catch (const InputError& error) {
      workbench_.say(error.what(), true);
    }
  }

  /// Shows an open sequence or a finished run. @param where it was opened from
  void show(OpenedPlace place, const std::string& where) {
    config_ = place.config;
    session_.reset();
    std::error_code none;
    place.options.sidecar = SidecarPlaces{
        .folder = fs::is_directory(where, none) ? fs::path(where) : fs::path(),
        .user_folder = settings_path_.empty() ? fs::path() : settings_path_.parent_path() / "sequences"};
    session_ = std::make_unique<Session>(std::move(place.source), config_, place.options);
    session_->start([] { Window::wake(); });
    // What moves shows from the first frame that has another to be compared with.
    session_->request_frame(config_.motion.reference_gap);
    if (where == kDemo) session_->request_play(true);
    window_.set_title(fmt::format("{} - Stillpoint", session_->source().name()));
    std::error_code ignored;
    remember(settings_.recent,
             fs::exists(where, ignored) ? fs::absolute(where).lexically_normal().string() : where);
    workbench_.set_recent(settings_.recent);
    workbench_.say(place.problem, !place.options.no_images.empty());
  }

  /// The sequence that was open when the window was last closed; empty when none was.
  [[nodiscard]] std::string last_sequence() const {
    return settings_.recent.empty() ? "" : settings_.recent.front();
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
    throw_if_interrupted();
  }

 private:
  /// A sequence, to be run with the config as it stands now.
  [[nodiscard]] OpenedPlace open_sequence_at(const std::string& where) const {
    OpenedPlace opened;
    opened.config = config_;
    opened.source = arguments_.source.open(where, config_);
    if (!opened.source->warnings().empty()) opened.problem = opened.source->warnings().front();
    return opened;
  }

  static std::vector<std::string> names_of(const std::vector<std::unique_ptr<Panel>>& panels) {
    std::vector<std::string> names;
    for (const auto& panel : panels) names.push_back(panel->name());
    return names;
  }

  WorkbenchHost host() {
    return {.go_to_frame = [this](int frame) { session_->request_frame(frame); },
            .play = [this](bool play) { session_->request_play(play); },
            .speed = [this](double fps) { session_->request_speed(fps); },
            .configure =
                [this](const Config& config) {
                  config_ = config;
                  session_->request_config(config);
                },
            .open = [this](const std::string& where) { open(where); },
            .request = [this](SessionRequest wanted) { session_->request(std::move(wanted)); },
            .compare = [this](bool compare) { session_->request_comparison(compare); }};
  }

  void draw(UiFrame& frame) {
    for (const std::string& path : frame.dropped_files) open(path);
    const auto view = session_ ? session_->view() : nullptr;
    workbench_.draw(frame, view.get());
    settings_.look = frame.wanted_look;
    if (frame.close_requested || stop_requested()) frame.quit = true;
  }

  void save() {
    settings_.layout = workbench_.layout();
    const auto placement = window_.placement();
    settings_.window_size = {placement[2], placement[3]};
    write_settings(settings_path_, settings_);
  }

  ViewArguments arguments_;
  Config config_;
  std::string problem_;
  fs::path settings_path_;
  Settings settings_;
  Window window_;
  Workbench workbench_;
  std::unique_ptr<Session> session_;
};

/// Begins with the sequence named, else with the one open last, else with the start page.
void view(const ViewArguments& arguments) {
  // What was named and cannot be opened is told before there is a window.
  std::optional<OpenedPlace> place;
  if (!arguments.place.empty()) place = open_place(arguments);
  Viewer viewer(arguments, place ? place->config : arguments.config.config());
  if (place)
    viewer.show(std::move(*place), arguments.place);
  else if (const std::string last = viewer.last_sequence(); !last.empty())
    viewer.open(last);
  viewer.run();
}

}  // namespace

void view_demo() {
  ViewArguments arguments;
  arguments.place = kDemo;
  view(arguments);
}

void add_view_command(CLI::App& app) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command =
      app.add_subcommand("view", "Opens the workbench in a window, on a sequence or as it was left");
  command->add_option(
      "SEQUENCE", arguments->place,
      "A TUM RGB-D folder, a folder of colour frames, generated:KIND, or a finished run's folder");
  arguments->add_to(*command);
  arguments->source.add_to(*command);
  arguments->config.add_to(*command, true);
  command->callback([arguments] { view(*arguments); });
}

}  // namespace stillpoint
