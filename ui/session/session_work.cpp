// The part of Session that decides what is done next, on its worker or at once.
#include <algorithm>
#include <chrono>
#include <exception>
#include <set>

#include "core/check/findings.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/sweep.hpp"
#include "core/sequence/fingerprint.hpp"
#include "core/stopwatch.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kProgressInterval = std::chrono::milliseconds(150);  // so often that a bar moves evenly
// How long a slider rests before its value is taken for meant.
constexpr auto kSliderRests = std::chrono::milliseconds(250);

}  // namespace

bool Session::at_rest() const { return current_->index == target_ && current_->record != nullptr; }

int Session::next_while_playing() const {
  const bool loops = debug_.loop && debug_.span;
  if (loops && (target_ >= debug_.span->last || target_ < debug_.span->first)) return debug_.span->first;
  return std::min(target_ + 1, source_->size() - 1);
}

void Session::stop_playing_where_wanted() {
  if (!playing_) return;
  update_breakpoints();
  debug_.stopped_by = breakpoints_.stopping_at(target_);
  const bool loops = debug_.loop && debug_.span;
  if (debug_.stopped_by || (!loops && target_ + 1 >= source_->size())) playing_ = false;
}

void Session::work_step() {
  if (playing_ && at_rest()) target_ = next_while_playing();
  // What takes its time is not waited for to see the frame: its image stands there first.
  if (worker_.joinable() && !playing_) show_image_first();
  const auto begin = Clock::now();
  // Frames on the way to one far ahead are not shown one by one; how far it is, is.
  while (run_->track().processed() <= target_ && Clock::now() - begin < kProgressInterval) process_one();
  if (run_->track().processed() <= target_) {
    publish();
    return;
  }
  // Ghosts that keep level do so frame by frame; one that lags comes nearer with each frame shown, and
  // catches up when there is time, of which play may leave none.
  constexpr int kAtOnce = 2;
  for (Ghost& ghost : ghosts_)
    for (int i = 0; i < kAtOnce && ghost.run->track().processed() <= target_; ++i) advance(ghost);
  stop_playing_where_wanted();
  show(target_);
}

bool Session::has_background() const {
  const int processed = run_->track().processed();
  return preview_due_ || sidecar_due_ || (worker_.joinable() && !looked_over_) || processed < wanted_ ||
         (compares_ && lacks_before()) || (shows_baseline_ && lacks_baseline()) ||
         (worker_.joinable() && stages_are_missing()) ||
         std::any_of(ghosts_.begin(), ghosts_.end(),
                     [&](const Ghost& ghost) { return ghost.run->track().processed() < processed; });
}

void Session::background_step() {
  if (preview_due_) {
    preview_step();
    return;
  }
  if (compares_ && lacks_before()) {
    complete();
    return;
  }
  if (shows_baseline_ && lacks_baseline()) {
    show_baseline();
    return;
  }
  if (sidecar_due_) {
    attempt([this] { open_sidecar(); });
    publish();
    return;
  }
  if (worker_.joinable() && stages_are_missing()) {
    catch_up();
    return;
  }
  const auto lags = [&](const Ghost& ghost) {
    return ghost.run->track().processed() < run_->track().processed();
  };
  // One frame more at a time, so that what is asked for meanwhile is not kept waiting.
  const auto ghost = std::find_if(ghosts_.begin(), ghosts_.end(), lags);
  if (ghost != ghosts_.end()) {
    advance(*ghost);
  } else if (run_->track().processed() < wanted_ || !worker_.joinable() || looked_over_) {
    process_one();
  } else {
    looked_over_ = true;
    if (!options_.no_images.empty() || debug_.check.whole) return;
    debug_.check.findings = check_frames(*source_);
    debug_.check.looked = true;
  }
}

void Session::advance(Ghost& ghost) {
  const int index = ghost.run->track().processed();
  ghost.run->process(frames_.read(index));
  compare(ghost);
  if (index != current_->index) return;
  ghost.current = ghost.run->frame_view(index);
  choose_others();
}

void Session::add(Ghost ghost) {
  // The first look that no other ghost has.
  const auto taken = [&](std::size_t look) {
    return std::any_of(ghosts_.begin(), ghosts_.end(), [&](const Ghost& one) { return one.look == look; });
  };
  while (taken(ghost.look)) ++ghost.look;
  ghosts_.push_back(std::move(ghost));
}

void Session::compare(Ghost& ghost) {
  const auto &own = run_->track().records(), &other = ghost.run->track().records();
  const bool outside = !ghost.run->track().outside().empty() || !run_->track().outside().empty();
  for (; !ghost.diverged && ghost.compared < static_cast<int>(std::min(own.size(), other.size()));
       ++ghost.compared) {
    const auto i = static_cast<std::size_t>(ghost.compared);
    if (outside ? part_ways(own, other, i) : !computed_alike(own[i], other[i]))
      ghost.diverged = ghost.compared;
  }
}

void Session::preview_step() {
  const int index = current_->index;
  const Config& config = *debug_.preview_config;
  const bool motion_alone = std::exchange(motion_preview_due_, false);
  const auto rests = preview_asked_ + kSliderRests;
  if (!motion_alone && worker_.joinable() && Clock::now() < rests) {
    // While the slider still moves, the worker is kept free for the next motion stages.
    std::unique_lock lock(mutex_);
    asked_.wait_until(lock, rests, [this] { return !requests_.empty() || news_; });
    return;
  }
  const Stopwatch watch;
  if (motion_alone) {
    // Motion stages come first, and at once: that is what one looks at while a slider moves.
    auto motion = run_->motion_preview(index, config);
    if (motion == nullptr) return;
    debug_.preview = std::move(motion);
  } else {
    // A finished run's frames are seen here first, and the way to this one is gone again, frame by frame.
    if (run_->track().seen() < std::min(index, run_->track().processed())) {
      run_->catch_up_one();
      return;
    }
    if (!run_->prepare_preview(index)) return;
    debug_.preview = run_->preview(index, config);
    preview_due_ = false;
  }
  debug_.previewed = config;
  debug_.preview_whole = !motion_alone;
  debug_.preview_ms = options_.keep_times ? watch.milliseconds() : 0.0;
  publish();
}

void Session::update_breakpoints() {
  if (!breakpoints_due_ || breakpoints_.empty()) return;
  const std::set<int> figures = breakpoints_.figures();
  // All poses are evaluated anew only where a condition is about their errors.
  const bool of_errors = std::any_of(figures.begin(), figures.end(), needs_evaluation);
  breakpoints_.update(
      FrameFigures(of_errors ? run_->run_view()->measured() : run_->track().measured(), figures));
  breakpoints_due_ = false;
}

void Session::open_sidecar() {
  sidecar_due_ = false;
  // A finished run may be shown without its images.
  debug_.sequence_hash =
      options_.recorded ? options_.recorded->origin.fingerprint : sequence_fingerprint(*source_);
  sidecar_.emplace(*options_.sidecar, MarkedSequence{source_->name(), debug_.sequence_hash, source_->size()});
  Marks kept = sidecar_->load();
  // What was marked before there was time to look stays.
  if (debug_.bookmarks.empty()) debug_.bookmarks = std::move(kept.bookmarks);
  if (debug_.pins.empty()) debug_.pins = std::move(kept.pins);
  if (debug_.drawn.empty()) debug_.drawn = std::move(kept.drawn);
  if (breakpoints_.empty()) breakpoints_.set(kept.breakpoints);
  if (!debug_.span) debug_.span = kept.span, debug_.loop = kept.loop;
  breakpoints_due_ = true;
  save_marks();
}

Marks Session::marks() const {
  return {debug_.bookmarks, debug_.pins, breakpoints_.breakpoints(), debug_.drawn, debug_.span, debug_.loop};
}

void Session::save_marks() {
  if (sidecar_) sidecar_->save(marks());
}

bool Session::take_requests() {
  std::deque<SessionRequest> taken;
  {
    const std::lock_guard lock(mutex_);
    taken = std::exchange(requests_, {});
  }
  if (!taken.empty()) message_.clear();
  frame_asked_ = false;
  for (const SessionRequest& wanted : taken) attempt([&] { carry_out(wanted); });
  return !taken.empty();
}

void Session::attempt(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    message_ = error.what();
  }
}

/// @returns whether something is to be told of what goes on beside the session
bool Session::take_news() {
  if (!news_.exchange(false)) return false;
  {
    const std::lock_guard lock(mutex_);
    if (checked_) {
      debug_.check = std::move(*checked_);
      checked_.reset();
      checking_ = false;
    }
    if (debug_.sweep) {
      for (SweepPoint& point : swept_) debug_.sweep->points.push_back(std::move(point));
      debug_.sweep->busy = sweeping_;
      debug_.sweep->problem = sweep_problem_;
    }
    swept_.clear();
  }
  if (!export_) return true;
  if (const auto outcome = export_->outcome()) {
    (outcome->failed ? message_ : debug_.notice) = outcome->told;
    export_.reset();
    exporting_ = false;
  }
  return true;
}

void Session::settle() {
  while (has_background()) background_step();
  publish();
}

void Session::work(const std::stop_token& stop) {
  target_ = std::max(target_, current_->index);
  if (current_->record == nullptr) target_ = 0;
  auto due = Clock::now(), published = due;
  while (!stop.stop_requested()) {
    try {
      const bool news = take_news(), asked = take_requests();
      if ((asked || news) && at_rest()) publish();
      const bool waits = at_rest() && (!playing_ || Clock::now() < due);
      if (waits && has_background()) {
        background_step();
        if (Clock::now() - published > kProgressInterval || !has_background()) {
          publish();
          published = Clock::now();
        }
        continue;
      }
      if (waits && !playing_) {
        rest(stop, true);
        continue;
      }
      if (waits) {
        std::unique_lock lock(mutex_);
        asked_.wait_until(lock, stop, due, [this] { return !requests_.empty() || news_; });
        continue;
      }
      due = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(1.0 / frames_per_second_.load()));
      work_step();
    } catch (const std::exception& error) {
      message_ = error.what();
      playing_ = false;
      preview_due_ = false;
      wanted_ = 0;
      if (whole_) current_ = std::exchange(whole_, nullptr);
      target_ = current_->index;
      runs_due_ = {};
      publish();
      // Without a frame to rest at, trying again at once would fail again at once.
      rest(stop, false);
    }
  }
}

}  // namespace stillpoint
