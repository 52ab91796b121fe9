#include "core/evaluation/clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr double kSameSpan = 0.7;  // log of a ratio of durations: less than twice as long

std::vector<double> stamps_of(const Trajectory& trajectory) {
  std::vector<double> stamps;
  stamps.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) stamps.push_back(pose.timestamp);
  return stamps;
}

double span_of(const std::vector<double>& stamps) {
  return stamps.empty() ? 0.0 : stamps.back() - stamps.front();
}

/// What is said about stamps in a unit other than seconds.
std::string sentence(const std::string& name, StampUnit unit, double frame_rate) {
  if (unit == StampUnit::frames)
    return fmt::format(
        "{}: the stamps are frame numbers; they were read as frames at {} Hz (--frame-rate says otherwise)",
        name, frame_rate);
  return fmt::format("{}: the stamps are {}; they were read as such", name, to_string(unit));
}

std::vector<double> in_seconds(std::vector<double> stamps, StampUnit unit, double frame_rate) {
  for (double& stamp : stamps) stamp *= seconds_per(unit, frame_rate);
  return stamps;
}

void set_stamps(Trajectory& trajectory, const std::vector<double>& stamps) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) trajectory[i].timestamp = stamps[i];
}

/// A way to read both.
struct Reading {
  StampUnit truth = StampUnit::seconds, estimate = StampUnit::seconds;
  bool by_index = false;  ///< the estimate's stamps are indices of the sequence's frames
  int first_index = 0;    ///< the first frame's
  int met = 0;
  double span_mismatch = 0.0;  ///< |log| of the ratio of what both last
};

class Readings {
 public:
  Readings(const Trajectory& truth, const Trajectory& estimate, const ClockOptions& options)
      : truth_(stamps_of(truth)), estimate_(stamps_of(estimate)), options_(options) {}

  [[nodiscard]] Reading best() const {
    const StampUnit truth = options_.truth_in_seconds ? StampUnit::seconds : unit_of(truth_);
    Reading best = with(truth);
    if (truth == StampUnit::frames) {
      const Reading as_seconds = with(StampUnit::seconds);
      const bool lasts_as_long = as_seconds.span_mismatch < best.span_mismatch - kSameSpan;
      if (as_seconds.met > 2 * best.met ||
          (lasts_as_long && 2 * as_seconds.met >= best.met && as_seconds.met > 0))
        best = as_seconds;
    }
    // From 1 where from 0 there would be no frame of the last number, or fewer would meet.
    for (const int first : {0, 1})
      if (const Reading index = by_index(truth, first); index.met > best.met) best = index;
    return best;
  }

  [[nodiscard]] std::vector<double> truth(StampUnit unit) const {
    return in_seconds(truth_, unit, options_.frame_rate);
  }
  [[nodiscard]] std::vector<double> estimate(const Reading& reading) const {
    std::vector<double> stamps = in_seconds(estimate_, reading.estimate, options_.frame_rate);
    if (reading.by_index)
      for (std::size_t i = 0; i < stamps.size(); ++i)
        stamps[i] = options_.frame_stamps[static_cast<std::size_t>(estimate_[i] - reading.first_index)];
    for (double& stamp : stamps) stamp += options_.estimate_offset_s;
    return stamps;
  }

 private:
  void weigh(Reading& reading, const std::vector<double>& truth_s) const {
    const auto stamps = estimate(reading);
    reading.met = std::min(meetings(stamps, truth_s, options_.tolerance_s),
                           meetings(truth_s, stamps, options_.tolerance_s));
    const double a = span_of(truth_s), b = span_of(stamps);
    reading.span_mismatch = a > 0 && b > 0 ? std::abs(std::log(a / b)) : 0.0;
  }

  [[nodiscard]] Reading with(StampUnit truth_unit) const {
    const auto truth_s = truth(truth_unit);
    std::vector<double> reference = truth_s;
    for (double& stamp : reference) stamp -= options_.estimate_offset_s;
    Reading reading{.truth = truth_unit};
    reading.estimate =
        unit_beside(estimate_, reference, truth_unit, options_.frame_rate, options_.tolerance_s);
    weigh(reading, truth_s);
    return reading;
  }

  [[nodiscard]] Reading by_index(StampUnit truth_unit, int first) const {
    Reading reading{.truth = truth_unit, .by_index = true, .first_index = first};
    for (const double stamp : estimate_)
      if (stamp != std::floor(stamp) || stamp < first ||
          stamp - first >= static_cast<double>(options_.frame_stamps.size()))
        return reading;
    weigh(reading, truth(truth_unit));
    return reading;
  }

  std::vector<double> truth_, estimate_;
  const ClockOptions& options_;
};

}  // namespace

std::vector<std::string> settle_clocks(Trajectory& truth, Trajectory& estimate, const ClockOptions& options) {
  const Readings readings(truth, estimate, options);
  const Reading reading = readings.best();
  std::vector<std::string> notes;
  if (reading.truth != StampUnit::seconds)
    notes.push_back(sentence(options.truth_name, reading.truth, options.frame_rate));
  if (reading.by_index)
    notes.push_back(fmt::format("{}: the stamps are frame numbers{}; each was given its frame's time",
                                options.estimate_name, reading.first_index == 1 ? " from 1" : ""));
  else if (reading.estimate != StampUnit::seconds)
    notes.push_back(sentence(options.estimate_name, reading.estimate, options.frame_rate));
  if (options.frame_rate != kFrameNumberRate && reading.truth != StampUnit::frames &&
      (reading.by_index || reading.estimate != StampUnit::frames))
    notes.push_back(fmt::format("{}: has no frame numbers to be given times, so --frame-rate changes nothing",
                                options.estimate_name));
  set_stamps(truth, readings.truth(reading.truth));
  set_stamps(estimate, readings.estimate(reading));
  return notes;
}

std::string why_apart(const Trajectory& truth, const Trajectory& estimate, const ClockOptions& options) {
  if (truth.empty() || estimate.empty()) return "";
  const auto truth_s = stamps_of(truth), estimate_s = stamps_of(estimate);
  // Settled as frames they are multiples of a frame's time, exactly.
  const bool whole = std::all_of(estimate_s.begin(), estimate_s.end(), [&options](double t) {
    const double frame = (t - options.estimate_offset_s) * options.frame_rate;
    return std::abs(frame - std::round(frame)) < 1e-7;
  });
  const double offset = truth_s.front() - estimate_s.front();
  const std::string numbers = whole && estimate_s.size() > 1 && options.frame_stamps.empty()
                                  ? "; if the estimate's stamps are frame numbers, give the sequence's "
                                    "folder in place of its ground truth"
                                  : "";
  if (estimate_s.front() > truth_s.back() || estimate_s.back() < truth_s.front())
    return fmt::format(
               "they last {:.3f} s and {:.3f} s and begin {:.3f} s apart: if one clock began elsewhere, "
               "`--time-offset "
               "{:.6f}` lays beginning on beginning",
               span_of(estimate_s), span_of(truth_s), std::abs(offset), offset + options.estimate_offset_s) +
           numbers;
  return "they cover the same time but not the same moments: `--max-difference` lets poses farther apart "
         "belong together" +
         numbers;
}

}  // namespace stillpoint
