#include "ui/session/session.hpp"

#include <algorithm>
#include <future>
#include <iterator>
#include <utility>

#include "core/check/findings.hpp"
#include "core/inspect/frame_neighbours.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"

namespace stillpoint {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

Session::Session(std::shared_ptr<const FrameSource> source, const Config& config,
                 const SessionOptions& options)
    : source_(std::move(source)), options_(options), frames_(*source_) {
  restart(config);
  if (options_.recorded) open_recorded();
  for (const auto& recorded : options_.beside) open_beside(recorded);
  show(0);
  sidecar_due_ = options_.sidecar.has_value();
}

Session::~Session() {
  if (!worker_.joinable()) return;
  worker_.request_stop();
  asked_.notify_all();
  worker_.join();
  export_.reset();  // it tells this of its end
}

std::shared_ptr<const SessionView> Session::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

void Session::restart(const Config& config) {
  const ReplayableRunOptions keep{.keep_times = options_.keep_times};
  run_ = std::make_unique<ShownRun>(*source_, frames_, ReplayableRun(*source_, config, keep));
  run_->lay_beside(beside_);
  run_view_.reset();
  baseline_.reset();
  baseline_view_.reset();
  baseline_frame_ = {};
  if (options_.baseline && !method_of(config).baseline && source_->has_depth()) {
    Config plain = config;
    plain.run.method = baseline_method().name;
    // Its pictures are made from its records; an engine with stages of its own goes back by checkpoints.
    ReplayableRunOptions options{.keep_times = options_.keep_times, .score_masks = false};
    if (!engine_of(plain).has_stages) options.max_checkpoints = 1;
    baseline_ = std::make_unique<ShownRun>(*source_, frames_, ReplayableRun(*source_, plain, options));
  }
  for (Ghost& ghost : ghosts_) {
    ghost.diverged.reset();
    ghost.compared = 0;
  }
  breakpoints_due_ = true;
}

void Session::process_one() {
  if (run_->track().seen() < run_->track().processed()) {  // a finished run goes on from where it ended
    run_->catch_up_one();
    return;
  }
  const Frame frame = frames_.read_in_turn(run_->track().processed());
  // The baseline sees the same frame at the same time; neither knows of the other. A finished run's goes no
  // farther than it went.
  const int index = run_->track().processed();
  const bool level =
      baseline_ && baseline_->track().processed() == index && baseline_->track().seen() == index;
  std::future<void> beside;
  if (level) beside = std::async(std::launch::async, [&] { baseline_->process(frame); });
  run_->process(frame);
  if (beside.valid()) beside.get();
  begin_waiting_ghosts();
  // Of ghosts that are ahead of a run begun anew, this frame can be compared only now.
  for (Ghost& ghost : ghosts_) compare(ghost);
  breakpoints_due_ = true;
}

void Session::begin_waiting_ghosts() {
  const auto is_due = [this](const WaitingGhost& ghost) { return ghost.from < run_->track().processed(); };
  std::vector<WaitingGhost> due;
  std::copy_if(debug_.waiting.begin(), debug_.waiting.end(), std::back_inserter(due), is_due);
  std::erase_if(debug_.waiting, is_due);
  for (const WaitingGhost& ghost : due)
    attempt([&] { carry_out(request::AddGhost{ghost.config, ghost.name, ghost.from}); });
}

void Session::show_image_first() {
  if (playing_ || target_ == current_->index || run_->has_at_hand(target_)) return;
  auto image = run_->image_view(target_);
  if (!image->frame.readable()) return;
  if (!current_->image_alone) whole_ = current_;
  current_ = std::move(image);
  for (Ghost& ghost : ghosts_) ghost.current.reset(), ghost.other.reset();
  baseline_frame_ = {};
  debug_.other.reset();
  debug_.preview.reset();
  publish();
}

void Session::show(int frame) {
  // Going forward, the frame before is the one shown until now.
  const auto last = whole_ ? std::exchange(whole_, nullptr) : current_;
  const bool follows = last && last->index + 1 == frame && last->record != nullptr;
  current_ = run_->frame_view(frame, follows ? alone(*last) : nullptr);
  for (Ghost& ghost : ghosts_) {
    const ReplayableRun& track = ghost.run->track();
    if (frame >= track.processed())
      ghost.current.reset();
    else
      ghost.current = frame < track.begins_at() ? current_ : ghost.run->frame_view(frame);
  }
  baseline_frame_ = {};
  if (shows_baseline_ && lacks_baseline()) baseline_frame_.current = baseline_->frame_view(frame);
  choose_others();
  debug_.preview.reset();
  preview_due_ = motion_preview_due_ = debug_.preview_config.has_value();
  publish();
}

void Session::choose_others() {
  // In a window a second frame is read once somebody looks at two; pictures made without one have it always.
  if (!debug_.other_is && worker_.joinable()) return;
  debug_.other = other_of(*run_, current_.get());
  for (Ghost& ghost : ghosts_) ghost.other = other_of(*ghost.run, ghost.current.get());
  if (baseline_) baseline_frame_.other = other_of(*baseline_, baseline_frame_.current.get());
}

std::shared_ptr<const FrameView> Session::other_of(ShownRun& run, const FrameView* current) const {
  if (current == nullptr) return nullptr;
  const OtherFrame which = debug_.other_is.value_or(OtherFrame::before);
  const FrameRecord* record = current->record;
  std::optional<int> other;
  if (which == OtherFrame::before) other = current->index - 1;
  if (which == OtherFrame::kept) other = debug_.kept_frame;
  if (which == OtherFrame::keyframe && record != nullptr)
    for (const SavedKeyframe& keyframe : run.track().keyframes())
      if (keyframe.id == record->reference_keyframe) other = keyframe.frame_index;
  const bool there = other && *other >= 0 && *other < run.track().processed() && *other != current->index;
  return there ? run.record_view(*other) : nullptr;
}

bool Session::lacks_baseline() const {
  return baseline_ && !current_->image_alone && current_->index < baseline_->track().processed() &&
         (baseline_frame_.current == nullptr || baseline_frame_.current->index != current_->index);
}

void Session::show_baseline() {
  baseline_frame_.current = baseline_->frame_view(current_->index);
  choose_others();
  publish();
}

bool Session::lacks_before() const {
  return current_->record != nullptr && current_->index > run_->track().begins_at() &&
         current_->before == nullptr;
}

void Session::complete() {
  if (!lacks_before()) return;
  const int frame = current_->index;
  current_ = run_->frame_view(frame, alone(*run_->frame_view(frame - 1)));
  publish();
}

DebugView Session::debug_view() {
  DebugView debug = debug_;
  debug.breakpoints = breakpoints_.views();
  debug.run_hash = run_->track().hash();
  debug.masks_written = masks_written_;
  debug.undo_steps = static_cast<int>(undo_.size()), debug.redo_steps = static_cast<int>(redo_.size());
  if (export_) debug.exporting = export_->view();
  for (const Ghost& ghost : ghosts_)
    debug.ghosts.push_back({.name = ghost.name,
                            .config = ghost.run->track().config(),
                            .from = ghost.run->track().begins_at(),
                            .busy = ghost.run->track().processed() < run_->track().processed(),
                            .run = ghost.run_view,
                            .current = ghost.current,
                            .other = ghost.other,
                            .diverged = ghost.diverged,
                            .outside = !ghost.run->track().outside().empty(),
                            .look = ghost.look});
  return debug;
}

/// Whether the runs that are shown may stay as they were made last while frames are added. All poses are
/// evaluated anew each time, which of many takes longer than a frame.
bool Session::runs_may_wait() const {
  const int processed = run_->track().processed();
  const bool grow = playing_ || processed <= target_ || processed < wanted_;
  const bool all_were_made = run_view_ && std::all_of(ghosts_.begin(), ghosts_.end(), [](const Ghost& ghost) {
                               return ghost.run_view != nullptr;
                             });
  return worker_.joinable() && grow && all_were_made && Clock::now() < runs_due_;
}

/// @returns whether the session's own has grown
bool Session::renew_runs() {
  const auto begin = Clock::now();
  for (Ghost& ghost : ghosts_) ghost.run_view = ghost.run->run_view();
  const bool grown = run_view_ != run_->run_view();
  if (grown) {
    run_view_ = run_->run_view();
    debug_.removal = removal_errors(run_view_->records, run_view_->evaluation);
    if (baseline_) baseline_view_ = baseline_->run_view();
    ++revision_;
  }
  const auto end = Clock::now();
  runs_due_ = end + options_.runs_wait * (end - begin);
  return grown;
}

void Session::publish() {
  const auto last = this->view();
  update_breakpoints();
  const bool grown = !runs_may_wait() && renew_runs();
  auto view = std::make_shared<SessionView>();
  view->title = source_->name();
  view->camera = source_->camera();
  view->config = run_->track().config();
  view->frame_count = source_->size();
  view->processed = run_->track().processed();
  view->playing = playing_;
  view->busy = playing_ || current_->index != target_ || current_->image_alone || has_background();
  view->message = message_;
  view->current = current_;
  view->run = run_view_;
  view->outside = run_->track().outside();
  view->baseline = baseline_view_;
  if (baseline_) view->baseline_config = baseline_->track().config();
  view->baseline_frame = baseline_frame_;
  view->ground_truth = std::shared_ptr<const Trajectory>(source_, &source_->ground_truth());
  view->alignment = run_view_->evaluation.ate.alignment;
  view->debug = debug_view();
  view->revision = revision_;
  if (last && !grown) {
    view->keyframes = last->keyframes;
    view->map_points = last->map_points;
  } else {
    view->keyframes = run_->track().keyframes();
    view->map_points = run_->track().points();
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
  while (run_->track().processed() <= target_) {
    process_one();
    if (on_frame) on_frame(run_->track().records()[static_cast<std::size_t>(run_->track().seen() - 1)]);
  }
  while (options_.catch_up && options_.no_images.empty() && run_->track().seen() <= target_) {
    const int index = run_->track().seen();
    run_->catch_up_one();
    if (on_frame) on_frame(run_->track().records()[static_cast<std::size_t>(index)]);
  }
  show(target_);
  settle();
}

void Session::start(std::function<void()> on_change) {
  {
    const std::lock_guard lock(mutex_);
    on_change_ = std::move(on_change);
  }
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void Session::request_speed(double frames_per_second) {
  frames_per_second_ = std::clamp(frames_per_second, 0.1, 1000.0);
}

bool Session::idle() const {
  const std::lock_guard lock(mutex_);
  return resting_ && requests_.empty() && !exporting_ && !checking_ && !sweeping_ && !news_;
}

void Session::rest(const std::stop_token& stop, bool until_comparison) {
  std::unique_lock lock(mutex_);
  resting_ = true;
  asked_.wait(lock, stop, [&] {
    return !requests_.empty() || news_ ||
           (until_comparison && ((compares_ && lacks_before()) || (shows_baseline_ && lacks_baseline())));
  });
  resting_ = false;
}

void Session::request_comparison(bool wanted) {
  if (compares_.exchange(wanted) == wanted) return;
  const std::lock_guard lock(mutex_);
  asked_.notify_all();
}

void Session::request_baseline(bool wanted) {
  if (shows_baseline_.exchange(wanted) == wanted) return;
  if (!worker_.joinable()) return settle();
  const std::lock_guard lock(mutex_);
  asked_.notify_all();
}

}  // namespace stillpoint
