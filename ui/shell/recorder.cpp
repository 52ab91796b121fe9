#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "ui/shell/recording.hpp"

namespace stillpoint {
namespace {

// s: pauses shorter than the first are none; longer ones than the second were for thinking.
constexpr double kShortestPause = 0.04, kLongestPause = 1.0;

}  // namespace

Recorder::Recorder(const std::filesystem::path& path, const RecordingStart& start)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc), size_(start.size) {
  file_ << to_text(start) << std::flush;
  if (!file_) throw InputError(fmt::format("{}: the recording cannot be written", path.string()));
}

void Recorder::write(const RecordedEvent& event) {
  if (!intact_) return;
  file_ << to_line(event) << std::endl;
  intact_ = file_.good();
}

void Recorder::flush_move() {
  for (const InputEvent& move : std::exchange(move_, {})) write(move);
}

void Recorder::state(const RecordedState& state) {
  was_busy_ = was_busy_ || !state.idle;
  was_playing_ = was_playing_ || state.playing;
}

void Recorder::event(const InputEvent& event, double time_s, const RecordedState& state) {
  this->state(state);
  const double pause = time_s - last_s_;
  const bool moved = std::holds_alternative<MouseMoved>(event);
  // Of movements that come one after another the last one counts, unless a button may drag with them.
  if (moved && move_.size() == 1 && pause < kShortestPause) {
    move_.front() = event;
    return;
  }
  flush_move();
  if (state.playing) {
    write(event::Until{state.frame});
  } else if (state.idle && was_busy_) {
    write(event::Idle{});
    // Where playing stopped is chance; where it stopped in the recording is not.
    if (was_playing_) write(event::Frame{state.frame});
    was_busy_ = was_playing_ = false;
  }
  if (pause >= kShortestPause) write(event::Wait{std::min(pause, kLongestPause)});
  last_s_ = time_s;
  if (moved)
    move_ = {event};
  else
    write(event);
}

void Recorder::size(int width, int height) {
  if (size_ == std::array{width, height}) return;
  size_ = {width, height};
  flush_move();
  write(event::Resize{width, height});
}

void Recorder::finish() {
  flush_move();
  if (was_busy_) write(event::Idle{});
  if (!intact_)
    throw InputError(
        fmt::format("{}: the recording could not be written to its end (the disk is full?)", path_.string()));
}

}  // namespace stillpoint
