// The part of Session that shows a finished run: all that its records hold at once, and what
// they do not hold once odometry has seen the frames again.
#include <algorithm>
#include <chrono>

#include "core/inspect/run_view.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kSlice = std::chrono::milliseconds(100);  // of work between looks at what is asked

}  // namespace

void Session::open_recorded() {
  run_ = std::make_unique<ShownRun>(*source_, frames_, ReplayableRun(*source_, options_.recorded));
  run_->lay_beside(beside_);
  baseline_.reset();
  if (options_.recorded_baseline)
    baseline_ =
        std::make_unique<ShownRun>(*source_, frames_, ReplayableRun(*source_, options_.recorded_baseline));
  message_ = options_.no_images;
}

void Session::open_beside(const std::shared_ptr<const RecordedRun>& recorded) {
  Ghost ghost{.name = run_name(*recorded),
              .run = std::make_unique<ShownRun>(*source_, frames_, ReplayableRun(*source_, recorded))};
  compare(ghost);
  add(std::move(ghost));
}

bool Session::stages_are_missing() const {
  const int index = current_->index;
  return options_.no_images.empty() && index < run_->track().processed() && index >= run_->track().seen() &&
         !run_->track().can_repeat_motion(index);
}

void Session::catch_up() {
  const auto begin = Clock::now();
  while (stages_are_missing() && Clock::now() - begin < kSlice) run_->catch_up_one();
  if (!stages_are_missing()) show(current_->index);
}

}  // namespace stillpoint
