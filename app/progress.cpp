#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>

#include "core/config.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

std::atomic<bool> stop_flag{false};
std::atomic<int> stop_signal{0};

extern "C" void request_stop(int signal) {
  stop_signal = signal;
  stop_flag = true;
  std::signal(signal, SIG_DFL);
}

std::string clock_text(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

const std::atomic<bool>& stop_requested() {
  static const bool installed = [] {
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    return true;
  }();
  (void)installed;
  return stop_flag;
}

int stop_signal_given() { return stop_signal; }

void throw_if_interrupted(const std::string& told) {
  if (stop_requested()) throw Interrupted{stop_signal, told};
}

StopBySignal::StopBySignal()
    : watcher_([source = source_](const std::stop_token& done) mutable {
        constexpr auto kInterval = std::chrono::milliseconds(20);
        while (!done.stop_requested() && !stop_requested()) std::this_thread::sleep_for(kInterval);
        if (stop_requested()) source.request_stop();
      }) {}

std::function<void(const std::string&, double)> opening_progress() {
  struct Line {
    ~Line() {
      if (is_shown) std::fputs("\r\033[K", stderr);
    }
    Stopwatch watch;
    double last_ms = 0;
    bool is_shown = false;
  };
  return [line = std::make_shared<Line>(), terminal = isatty(STDERR_FILENO) != 0](const std::string& what,
                                                                                  double share) {
    constexpr double kInterval = 100.0;  // ms: often enough to look alive
    throw_if_interrupted();
    const double now = line->watch.milliseconds();
    if (!terminal || now - line->last_ms < kInterval) return;
    line->last_ms = now, line->is_shown = true;
    fmt::print(stderr, "\r\033[K{}: {:.0f} %", what, 100.0 * share);
    std::fflush(stderr);
  };
}

Progress::Progress(std::string title, int total)
    : title_(std::move(title)), total_(std::max(1, total)), terminal_(isatty(STDERR_FILENO) != 0) {
  (void)stop_requested();  // what shows how far it is can be stopped
}

Progress::~Progress() {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::advance(const std::string& remark) {
  // On a terminal, and in a file, where every line stays.
  constexpr double kBarInterval = 100.0, kLineInterval = 5000.0;  // ms
  constexpr int kBarWidth = 30;                                   // characters: figures have room beside
  ++done_;
  const double elapsed = watch_.milliseconds();
  if (done_ < total_ && elapsed - last_shown_ms_ < (terminal_ ? kBarInterval : kLineInterval)) return;
  last_shown_ms_ = elapsed;
  const double rate = done_ / (elapsed / 1000.0);
  const std::string figures = fmt::format("{}/{}  {:.1f} frames/s  {} left  {}", done_, total_, rate,
                                          clock_text((total_ - done_) / rate), remark);
  if (terminal_) {
    const auto filled = static_cast<std::size_t>(kBarWidth * done_ / total_);
    fmt::print(stderr, "\r\033[K{} [{}{}] {}", title_, std::string(filled, '#'),
               std::string(kBarWidth - filled, '.'), figures);
    std::fflush(stderr);
  } else {
    fmt::print(stderr, "{}: {}\n", title_, figures);
  }
}

int frames_of(const FrameSource& source, int asked) {
  return asked > 0 ? std::min(asked, source.size()) : source.size();
}

RunResult run_with_progress(const FrameSource& source, const Config& config, const std::string& title,
                            RunOptions options) {
  Progress progress(title, frames_of(source, options.count));
  options.stop = &stop_requested();
  options.on_frame = [&progress, take = std::move(options.on_frame)](const FrameResult& frame) {
    if (take) take(frame);
    progress.advance(std::string(to_string(frame.record.status)));
  };
  return run_sequence(source, config, options);
}

}  // namespace stillpoint
