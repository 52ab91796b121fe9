#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <thread>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "ui/panels/panel.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/settings.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDemo = "generated:walking_static";

struct ViewArguments {
  std::string sequence;
  ConfigArguments config;
  SequenceArguments source;
};

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
      show(arguments_.source.open(where, config_), where);
    } catch (const InputError& error) {
      workbench_.say(error.what(), true);
    }
  }

  /// Shows an open sequence. @param where it was opened from
  void show(std::shared_ptr<const FrameSource> source, const std::string& where) {
    session_.reset();
    session_ = std::make_unique<Session>(std::move(source), config_);
    session_->start([] { Window::wake(); });
    // What moves shows from the first frame that has another to be compared with.
    session_->request_frame(config_.motion.reference_gap);
    if (where == kDemo) session_->request_play(true);
    window_.set_title(fmt::format("{} - Stillpoint", session_->source().name()));
    std::error_code ignored;
    remember(settings_.recent,
             fs::exists(where, ignored) ? fs::absolute(where).lexically_normal().string() : where);
    workbench_.set_recent(settings_.recent);
    const auto& warnings = session_->source().warnings();
    workbench_.say(warnings.empty() ? "" : warnings.front());
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
  const Config config = arguments.config.config();
  // What was named and cannot be opened is told before there is a window.
  std::shared_ptr<const FrameSource> source;
  if (!arguments.sequence.empty()) source = arguments.source.open(arguments.sequence, config);
  Viewer viewer(arguments, config);
  if (source)
    viewer.show(std::move(source), arguments.sequence);
  else if (const std::string last = viewer.last_sequence(); !last.empty())
    viewer.open(last);
  viewer.run();
}

}  // namespace

void view_demo() {
  ViewArguments arguments;
  arguments.sequence = kDemo;
  view(arguments);
}

void add_view_command(CLI::App& app) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command =
      app.add_subcommand("view", "Opens the workbench in a window, on a sequence or as it was left");
  command->add_option("SEQUENCE", arguments->sequence,
                      "A TUM RGB-D folder, a folder of colour frames, or generated:KIND");
  arguments->source.add_to(*command);
  arguments->config.add_to(*command, true);
  command->callback([arguments] { view(*arguments); });
}

}  // namespace stillpoint
