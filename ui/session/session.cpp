#include "ui/session/session.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <future>

#include "core/motion/detect_motion.hpp"
#include "ui/session/frame_neighbours.hpp"

namespace stillpoint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kExtrasKept = 12;
constexpr auto kProgressInterval = std::chrono::milliseconds(150);

}  // namespace

Session::Session(std::shared_ptr<const FrameSource> source, const Config& config,
                 const SessionOptions& options)
    : source_(std::move(source)), options_(options), frames_(*source_) {
  restart(config);
  show(0);
}

Session::~Session() {
  if (!worker_.joinable()) return;
  worker_.request_stop();
  asked_.notify_all();
  worker_.join();
}

std::shared_ptr<const SessionView> Session::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

RunTrack::ReadFrame Session::reader() {
  return [this](int index) { return frames_.read(index); };
}

void Session::restart(const Config& config) {
  run_ = std::make_unique<RunTrack>(*source_, config, RunTrackOptions{.keep_times = options_.keep_times});
  baseline_.reset();
  baseline_view_.reset();
  if (options_.baseline && config.run.method != "none" && source_->has_depth()) {
    Config plain = config;
    plain.run.method = "none";
    baseline_ = std::make_unique<RunTrack>(
        *source_, plain,
        RunTrackOptions{.max_checkpoints = 1, .keep_features = false, .keep_times = options_.keep_times});
  }
  extras_.clear();
  run_viewed_ = -1;
}

void Session::process_one() {
  const Frame frame = frames_.read(run_->processed());
  const RunTrack::ReadFrame read = [&frame](int) { return frame; };
  // The baseline sees the same frame at the same time; neither knows of the other.
  std::future<FrameResult> beside;
  if (baseline_) beside = std::async(std::launch::async, [&] { return baseline_->process_next(read); });
  FrameResult result = run_->process_next(read);
  if (beside.valid()) beside.get();
  keep({frame.index, std::move(result.motion), std::move(result.depth_motion), std::move(result.mask)});
}

void Session::keep(Extras extras) {
  extras_.push_front(std::move(extras));
  if (extras_.size() > kExtrasKept) extras_.pop_back();
}

Session::Extras Session::extras_of(int index) {
  if (index >= run_->processed()) return {.index = index};
  const auto kept =
      std::find_if(extras_.begin(), extras_.end(), [&](const Extras& e) { return e.index == index; });
  if (kept != extras_.end()) return *kept;
  const std::string& method = run_->config().run.method;
  if (method == "none" || method == "paper") return {.index = index};  // all there is, frame_view computes
  FrameResult again = run_->replay(index, reader());
  keep({index, std::move(again.motion), std::move(again.depth_motion), std::move(again.mask)});
  return extras_.front();
}

FrameView Session::frame_view(int index) {
  const Config& config = run_->config();
  FrameView view;
  view.index = index;
  view.frame = frames_.read(index);
  view.reference.index = index - config.motion.reference_gap;
  if (view.reference.index >= 0) view.reference = frames_.read(view.reference.index);
  view.truth = source_->truth(index);
  Extras extras = extras_of(index);
  view.motion = std::move(extras.motion);
  const bool pair = view.frame.readable() && view.reference.readable() &&
                    view.frame.gray.size() == view.reference.gray.size();
  if (view.motion.rounds.empty() && pair)
    view.motion = detect_motion(view.reference.gray, view.frame.gray, config.motion, config.run.threads);
  view.depth_motion = std::move(extras.depth_motion);
  view.mask = config.run.method == "paper" ? view.motion.mask() : std::move(extras.mask);
  if (!options_.keep_times) clear_times(view);
  return view;
}

std::shared_ptr<const FrameView> Session::held_view(int frame, std::shared_ptr<const FrameView> before) {
  /// A frame's view and the record it points to, kept alive together.
  struct Shown {
    FrameView view;
    FrameRecord record;
  };
  auto shown = std::make_shared<Shown>();
  shown->view = frame_view(frame);
  if (frame < run_->processed()) {
    shown->record = run_->record(frame);
    shown->view.record = &shown->record;
    shown->view.history = history_of(frame, [this](int index) { return run_->record(index); });
    shown->view.before = std::move(before);
  }
  const FrameView* view = &shown->view;
  return {std::move(shown), view};
}

void Session::show(int frame) {
  // Going forward, the frame before is the one shown until now.
  const bool follows = current_ && current_->index + 1 == frame && current_->record != nullptr;
  current_ = held_view(frame, follows ? alone(*current_) : nullptr);
  publish();
}

bool Session::lacks_before() const {
  return current_->record != nullptr && current_->index > 0 && current_->before == nullptr;
}

void Session::complete() {
  if (!lacks_before()) return;
  const int frame = current_->index;
  current_ = held_view(frame, alone(*held_view(frame - 1, nullptr)));
  publish();
}

void Session::publish() {
  const auto last = this->view();
  if (run_viewed_ != run_->processed()) {
    run_view_ = std::make_shared<const RunView>(run_->view());
    if (baseline_) baseline_view_ = std::make_shared<const RunView>(baseline_->view());
    run_viewed_ = run_->processed();
    ++revision_;
  }
  auto view = std::make_shared<SessionView>();
  view->title = source_->name();
  view->camera = source_->camera();
  view->config = run_->config();
  view->frame_count = source_->size();
  view->processed = run_->processed();
  view->playing = playing_;
  view->busy = playing_ || current_->index != target_;
  view->message = message_;
  view->current = current_;
  view->run = run_view_;
  view->baseline = baseline_view_;
  view->ground_truth = source_->ground_truth();
  view->alignment = run_view_->evaluation.ate.alignment;
  view->revision = revision_;
  if (last && last->revision == revision_) {
    view->keyframes = last->keyframes;
    view->map_points = last->map_points;
  } else {
    view->keyframes = saved_keyframes(run_->map());
    view->map_points = saved_points(run_->map());
  }
  std::function<void()> on_change;
  {
    const std::lock_guard lock(mutex_);
    view_ = std::move(view);
    on_change = on_change_;
  }
  if (on_change) on_change();
}

void Session::go_to(int frame, const std::function<void(const FrameRecord&)>& on_frame) {
  target_ = std::clamp(frame, 0, source_->size() - 1);
  while (run_->processed() <= target_) {
    process_one();
    if (on_frame) on_frame(run_->records().back());
  }
  show(target_);
}

void Session::start(std::function<void()> on_change) {
  {
    const std::lock_guard lock(mutex_);
    on_change_ = std::move(on_change);
  }
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void Session::request_frame(int frame) {
  const std::lock_guard lock(mutex_);
  requests_.frame = frame;
  asked_.notify_all();
}

void Session::request_play(bool play) {
  const std::lock_guard lock(mutex_);
  requests_.play = play;
  asked_.notify_all();
}

void Session::request_speed(double frames_per_second) {
  frames_per_second_ = std::clamp(frames_per_second, 0.1, 1000.0);
}

void Session::request_comparison(bool wanted) {
  if (compares_.exchange(wanted) == wanted) return;
  const std::lock_guard lock(mutex_);
  asked_.notify_all();
}

void Session::request_config(const Config& config) {
  const std::lock_guard lock(mutex_);
  requests_.config = config;
  asked_.notify_all();
}

bool Session::take_requests() {
  Requests taken;
  {
    const std::lock_guard lock(mutex_);
    taken = std::exchange(requests_, {});
  }
  if (taken.config) {
    restart(*taken.config);
    target_ = current_->index;
    show(target_);
  }
  if (taken.frame) target_ = std::clamp(*taken.frame, 0, source_->size() - 1);
  if (taken.play) {
    playing_ = *taken.play && current_->index + 1 < source_->size();
    if (!playing_ && !taken.frame) target_ = current_->index;
  }
  return taken.config || taken.frame || taken.play;
}

void Session::work_step() {
  if (playing_ && current_->index == target_) ++target_;
  const auto begin = Clock::now();
  // Frames on the way to one far ahead are not shown one by one; how far it is, is.
  while (run_->processed() <= target_ && Clock::now() - begin < kProgressInterval) process_one();
  if (run_->processed() <= target_) {
    publish();
    return;
  }
  if (playing_ && target_ + 1 >= source_->size()) playing_ = false;
  show(target_);
}

void Session::work(const std::stop_token& stop) {
  target_ = std::max(target_, current_->index);
  if (current_->record == nullptr) target_ = 0;
  auto due = Clock::now();
  while (!stop.stop_requested()) {
    try {
      const bool asked = take_requests();
      const bool at_rest = current_->index == target_ && current_->record != nullptr;
      if (!playing_ && at_rest) {
        if (asked) publish();
        if (compares_ && lacks_before()) {
          complete();
          continue;
        }
        std::unique_lock lock(mutex_);
        asked_.wait(lock, stop, [this] {
          return requests_.frame || requests_.play || requests_.config || (compares_ && lacks_before());
        });
        continue;
      }
      if (playing_ && at_rest && Clock::now() < due) {
        std::unique_lock lock(mutex_);
        asked_.wait_until(lock, stop, due,
                          [this] { return requests_.frame || requests_.play || requests_.config; });
        continue;
      }
      due = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(1.0 / frames_per_second_.load()));
      work_step();
    } catch (const std::exception& error) {
      message_ = error.what();
      playing_ = false;
      target_ = current_->index;
      publish();
      // Without a frame to rest at, trying again at once would fail again at once.
      std::unique_lock lock(mutex_);
      asked_.wait(lock, stop, [this] { return requests_.frame || requests_.play || requests_.config; });
    }
  }
}

}  // namespace stillpoint
