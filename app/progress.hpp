#pragma once

#include <atomic>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>

#include "core/stopwatch.hpp"

namespace stillpoint {

class FrameSource;
struct Config;
struct RunOptions;
struct RunResult;

/// Turns true at the first Ctrl-C (or SIGTERM); a second one ends the program at once.
[[nodiscard]] const std::atomic<bool>& stop_requested();

/// The signal that asked for it; 0 before.
[[nodiscard]] int stop_signal_given();

/// Thrown by a command that ended early because it was asked to, once what was done is written: the program
/// then says so, and ends with status 128 + signal, as shells expect, so that no script takes a part for the
/// whole.
struct Interrupted {
  int signal = 0;
  std::string told;  ///< how far it came, and what is left of it
};

/// Throws Interrupted when a stop was requested.
/// @param told how far the command came, and what is left of it
void throw_if_interrupted(const std::string& told = "stopped before it was done");

/// The same for what is stopped by a token: the token's stop is requested soon after the signal.
class StopBySignal {
 public:
  StopBySignal();
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::jthread watcher_;
};

/// How far a long job is, on standard error: a bar with rate and remaining time on a terminal, a plain line
/// now and then otherwise.
class Progress {
 public:
  Progress(std::string title, int total);
  /// Clears the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// One more is done; `remark` says what state things are in, in a word or two.
  void advance(const std::string& remark);

 private:
  std::string title_;
  int total_, done_ = 0;
  bool terminal_;
  Stopwatch watch_;
  double last_shown_ms_ = 0.0;
};

/// How many frames of a sequence are run. @param asked 0 = all
[[nodiscard]] int frames_of(const FrameSource& source, int asked);

/// run_sequence() with a Progress, up to a stop that is requested.
[[nodiscard]] RunResult run_with_progress(const FrameSource& source, const Config& config,
                                          const std::string& title, RunOptions options);

/// What OpenOptions::progress is given: a line on a terminal, cleared at the end, and Ctrl-C ends what it
/// tells of.
[[nodiscard]] std::function<void(const std::string& what, double share)> opening_progress();

}  // namespace stillpoint
