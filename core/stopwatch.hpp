#pragma once

#include <chrono>

namespace stillpoint {

/// Milliseconds of wall time since it was made or last restarted. For the timing figures; no result depends
/// on it.
class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

  /// The time so far, counting anew from here.
  double lap() {
    const double elapsed = milliseconds();
    start_ = Clock::now();
    return elapsed;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace stillpoint
