#include "ui/workbench/app_controller.hpp"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "core/counted.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"
#include "ui/panels/panel.hpp"
#include "ui/shell/event_log.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

template <typename T>
bool is_ready(const std::future<T>& future) {
  return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// A path that means the same wherever the program is started.
std::string lasting_name(const std::string& where) {
  std::error_code ignored;
  return fs::exists(where, ignored) ? fs::absolute(where, ignored).lexically_normal().string() : where;
}

/// Parameters that are not at their defaults, as --set takes them.
std::vector<std::string> changed_settings(Config config) {
  Config defaults;
  const auto now = parameters(config), plain = parameters(defaults);
  std::vector<std::string> changed;
  for (std::size_t i = 0; i < now.size(); ++i) {
    std::visit(
        [&](auto* value) {
          const auto* other = std::get<decltype(value)>(plain[i].value);
          if (*value != *other) changed.push_back(fmt::format("{}={}", now[i].key, *value));
        },
        now[i].value);
  }
  return changed;
}

/// Has the calling thread, and those it begins, give way to the interface: it draws at once while frames are
/// processed on every processor.
void give_way() {
#ifdef __linux__
  constexpr int kNicer = 5;  // of nice's 20 steps: drawing comes first, and work still goes on
  // On Linux 0 is the calling thread alone. Where it is refused, work goes on as before.
  (void)setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kNicer);
#endif
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

AppController::AppController(ControllerOptions options)
    : options_(std::move(options)), workbench_(make_panels(), host()) {
  workbench_.set_layout(options_.settings.layout ? *options_.settings.layout
                                                 : default_layout(options_.config.run.method));
  tell_recent();
}

AppController::~AppController() {
  if (opening_.valid()) opening_.wait();
}

WorkbenchHost AppController::host() {
  // Between sequences there is nobody to ask.
  const auto ask = [this](auto request) {
    return [this, request](auto value) {
      if (session_) request(*session_, value);
    };
  };
  return {.go_to_frame = ask([](Session& session, int frame) { session.request_frame(frame); }),
          .step = ask([](Session& session, int by) { session.request_step(by); }),
          .play = ask([](Session& session, bool play) { session.request_play(play); }),
          .speed = ask([](Session& session, double fps) { session.request_speed(fps); }),
          .open = [this](const std::string& where) { open(where); },
          .open_as = [this](const OpenAs& place) { open_as(place); },
          .look =
              [open = options_.open_source, config = options_.config](const OpenAs& place) {
                return look_at_place(place,
                                     [&](const OpenAs& as) { return open(as.where, config, as.reading); });
              },
          .reopen = [this](const std::string& with) { reopen(with); },
          .request = [this](SessionRequest wanted) { request(std::move(wanted)); },
          .compare = ask([](Session& session, bool compare) { session.request_comparison(compare); }),
          .baseline = ask([](Session& session, bool wanted) { session.request_baseline(wanted); })};
}

void AppController::request(SessionRequest wanted) {
  // What is opened next is run as this one is.
  if (const auto* all = std::get_if<request::RunAll>(&wanted)) {
    options_.config = all->config;
    ++configured_;
    refit_ = true;
  }
  if (session_) session_->request(std::move(wanted));
}

std::unique_ptr<Session> AppController::make_session(const OpenedSource& place,
                                                     const RecentSequence& sequence) const {
  const std::string& where = sequence.where;
  SessionOptions options = place.options;
  std::error_code none;
  if (options_.marks_folder)
    options.sidecar = SidecarPlaces{.folder = fs::is_directory(where, none) ? fs::path(where) : fs::path(),
                                    .user_folder = *options_.marks_folder};
  auto session = std::make_unique<Session>(place.source, place.config, options);
  session->start(options_.wake ? options_.wake : [] {});
  // What is dynamic shows from the first frame that has another to be compared with.
  session->request_frame(std::clamp(sequence.frame, 0, std::max(place.source->size() - 1, 1)));
  if (!where.empty() && where == options_.plays_when_opened) session->request_play(true);
  return session;
}

void AppController::begin_opening(RecentSequence sequence, const Config& config,
                                  std::optional<OpenedSource> place) {
  workbench_.set_opening(sequence.where);
  Opened begun{.sequence = std::move(sequence),
               .problem = {},
               .place = std::move(place),
               .session = nullptr,
               .configured = configured_};
  opening_ = std::async(std::launch::async, [this, opened = std::move(begun), config]() mutable {
    give_way();
    try {
      if (!opened.place)
        opened.place = options_.open_source(opened.sequence.where, config, opened.sequence.reading);
      opened.session = make_session(*opened.place, opened.sequence);
    } catch (const std::exception& error) {
      opened.problem = error.what();
    }
    if (options_.wake) options_.wake();
    return std::move(opened);
  });
}

RecentSequence AppController::known_as(const std::string& where) const {
  const std::string name = lasting_name(where);
  for (const RecentSequence& one : options_.settings.recent)
    if (one.where == name) return one;
  return {.where = where, .reading = {}, .settings = {}};
}

std::optional<Config> AppController::config_of(const RecentSequence& sequence) {
  const auto& recent = options_.settings.recent;
  if (std::find(recent.begin(), recent.end(), sequence) == recent.end()) return std::nullopt;
  return config_as_left(sequence.where, sequence.settings);
}

Config AppController::config_as_left(const std::string& where, const std::vector<std::string>& settings) {
  Config config;
  config.run.threads = options_.config.run.threads;
  for (const std::string& setting : settings) {
    try {
      set_parameter(config, setting);
    } catch (const InputError& error) {
      workbench_.say(fmt::format("{}: {} is not as it was left: {}", where, setting, error.what()));
    }
  }
  return config;
}

void AppController::bring_back(const std::vector<KeptGhost>& ghosts) {
  for (const KeptGhost& ghost : ghosts) {
    session_->request(request::AddGhost{.config = config_as_left(ghost.name, ghost.settings),
                                        .name = ghost.name,
                                        .from = ghost.from,
                                        .waits = true});
    if (ghost.from > 0)
      workbench_.say(fmt::format("{} comes back once the run has come to frame {}, where it begins",
                                 ghost.name, ghost.from));
  }
}

void AppController::open(const std::string& where) {
  if (opening_.valid()) {
    next_ = where;
    return;
  }
  const RecentSequence sequence = known_as(where);
  // A sequence that was never open is run as the one before it is.
  if (const auto config = config_of(sequence)) options_.config = *config, ++configured_;
  begin_opening(sequence, options_.config, std::nullopt);
}

void AppController::open_as(const OpenAs& place) {
  if (opening_.valid()) {
    workbench_.say(fmt::format("{}: another sequence is being opened", place.where), true);
    return;
  }
  Config config = options_.config;
  try {
    if (!place.method.empty()) set_parameter(config, "run.method=" + place.method);
  } catch (const InputError& error) {
    workbench_.say(error.what(), true);
    return;
  }
  options_.config = config, ++configured_;
  begin_opening({.where = place.where, .reading = place.reading, .settings = {}}, config, std::nullopt);
}

void AppController::reopen(const std::string& with) {
  if (!session_ || opening_.valid()) return;
  RecentSequence sequence = as_left();
  if (!with.empty()) {
    const std::string name = with.substr(0, with.find('=') + 1);
    std::erase_if(sequence.reading, [&name](const std::string& word) { return word.starts_with(name); });
    sequence.reading.push_back(with);
  }
  begin_opening(std::move(sequence), options_.config, std::nullopt);
}

void AppController::open_last(const Config* config) {
  if (options_.settings.recent.empty()) return;
  const RecentSequence last = options_.settings.recent.front();
  if (config != nullptr)
    options_.config = *config;
  else if (const auto left = config_of(last))
    options_.config = *left;
  begin_opening(last, options_.config, std::nullopt);
}

void AppController::show(OpenedSource place, const std::string& where, std::vector<std::string> reading) {
  if (opening_.valid()) opening_.get();
  given_ = place.source;
  open_ = {.where = where, .reading = std::move(reading), .settings = {}};
  begin_opening(open_, options_.config, std::move(place));
}

void AppController::take_opened() {
  std::erase_if(retiring_, is_ready<void>);
  if (!opening_.valid() || !is_ready(opening_)) return;
  Opened opened = opening_.get();
  workbench_.set_opening("");
  if (next_) {
    // Another was asked for meanwhile: this one ends unseen.
    open(*std::exchange(next_, std::nullopt));
  } else if (!opened.problem.empty()) {
    workbench_.say(opened.problem, true);
    return;
  } else {
    if (session_ && !open_.where.empty()) remember(options_.settings.recent, as_left());
    std::swap(session_, opened.session);
    // A finished run comes with a config of its own.
    if (opened.place->options.recorded)
      options_.config = opened.place->config;
    else if (opened.configured != configured_)
      session_->request_config(options_.config);
    open_ = opened.sequence;
    workbench_.set_runs(open_.runs);
    open_.where = lasting_name(open_.where);
    open_.settings = changed_settings(options_.config);
    remember(options_.settings.recent, open_);
    tell_recent();
    const FrameSource& source = *opened.place->source;
    fit_layout(opened.place->config.run.method, source.camera().is_stereo());
    workbench_.say(fmt::format("{}: {}", source.name(), counted(source.size(), "frame")));
    for (const std::string& warning : source.warnings()) workbench_.say(warning);
    for (const std::string& run : opened.place->runs_missing) workbench_.say(run, true);
    if (const auto& recorded = opened.place->options.recorded; recorded && !recorded->cut_short.empty())
      workbench_.say(recorded->cut_short, true);
    if (!opened.place->options.no_images.empty())
      workbench_.say(opened.place->options.no_images, true);
    else
      bring_back(opened.sequence.ghosts);
  }
  // Its worker finishes the frame at hand first, which must not hold up the interface.
  if (opened.session)
    retiring_.push_back(
        std::async(std::launch::async,
                   [last = std::shared_ptr<Session>(std::move(opened.session))]() mutable { last.reset(); }));
}

void AppController::fit_layout(const std::string& method, bool stereo) {
  LayoutNode layout = fitted(workbench_.layout(), method, stereo);
  if (panels_of(layout) != panels_of(workbench_.layout())) workbench_.set_layout(std::move(layout));
}

void AppController::draw(UiFrame& frame) {
  take_opened();
  if (std::exchange(refit_, false) && session_)
    fit_layout(options_.config.run.method, session_->source().camera().is_stereo());
  for (const std::string& path : frame.dropped_files) open(path);
  const auto view = this->view();
  // The masks that were drawn are the sequence's from now on.
  if (view && view->debug.masks_written && std::exchange(renewed_, session_.get()) != session_.get())
    reopen();
  workbench_.draw_in_turn(frame, view);
  frame.busy = frame.busy || !idle();
  options_.settings.look = frame.wanted_look;
}

bool AppController::idle() const {
  if (opening_.valid() || next_ || !workbench_.is_level()) return false;
  return !session_ || session_->idle();
}

std::string AppController::title() const {
  return session_ ? fmt::format("{} - Stillpoint", session_->source().name()) : "Stillpoint";
}

void AppController::tell_recent() {
  std::vector<std::string> names;
  for (const RecentSequence& one : options_.settings.recent) names.push_back(one.where);
  workbench_.set_recent(std::move(names));
}

RecentSequence AppController::as_left() const {
  RecentSequence left = open_;
  left.settings = changed_settings(options_.config);
  const auto view = session_->view();
  left.frame = view->current->index;
  left.runs = workbench_.runs();
  left.ghosts.clear();
  for (const GhostView& ghost : view->debug.ghosts)
    if (!ghost.outside) left.ghosts.push_back({ghost.name, changed_settings(ghost.config), ghost.from});
  // One that had no time to come back is not lost for it.
  for (const WaitingGhost& ghost : view->debug.waiting)
    left.ghosts.push_back({ghost.name, changed_settings(ghost.config), ghost.from});
  return left;
}

Settings AppController::settings() const {
  Settings settings = options_.settings;
  settings.layout = workbench_.layout();
  if (session_ && !open_.where.empty()) remember(settings.recent, as_left());
  return settings;
}

RecordingStart AppController::recording_start(std::array<int, 2> size) const {
  RecordingStart start;
  if (const FrameSource* source = session_ ? &session_->source() : given_.get()) {
    start.sequence_name = source->name();
    start.sequence_frames = source->size();
    start.opened_from = open_.where;
  }
  start.size = size;
  start.theme = options_.settings.look.theme == ThemeName::kDark ? "dark" : "light";
  start.scale = static_cast<double>(options_.settings.look.scale);
  start.layout = one_line(to_json(workbench_.layout()));
  start.settings = changed_settings(options_.config);
  return start;
}

}  // namespace stillpoint
