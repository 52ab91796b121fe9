#include "core/evaluation/clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/counted.hpp"
#include "core/evaluation/suspicion.hpp"
#include "core/evaluation/trajectory_metrics.hpp"

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

/// Rows on every `step`-th frame, as far as there are frames.
Trajectory laid_on(const Trajectory& rows, const std::vector<double>& frame_stamps, std::size_t step) {
  Trajectory laid;
  for (const StampedPose& row : rows)
    if (const auto frame = static_cast<std::size_t>(row.timestamp) * step; frame < frame_stamps.size())
      laid.push_back({frame_stamps[frame], row.world_from_camera});
  return laid;
}

/// k where there is a row for every k-th of the frames, a row more or less; 1 where there is not.
std::size_t step_of_rows(std::size_t rows, std::size_t frames) {
  const std::size_t step = (frames + rows / 2) / rows;
  return step > 1 && step * rows < frames + 2 * step && frames < step * rows + step ? step : 1;
}

/// How well motions are the truth's where rows are laid on the first frames and on every k-th.
struct RowFits {
  MotionFit first, every;
  [[nodiscard]] bool is_every() const {
    return every.tells_motions() && 2 * every.combined_m() < first.combined_m();
  }
  [[nodiscard]] bool is_first() const {
    return first.tells_motions() && 2 * first.combined_m() < every.combined_m();
  }
};

/// By metres, or else up to a scale, which programs of one camera leave open. Nothing where neither tells.
std::optional<RowFits> telling_fits(const Trajectory& first, const Trajectory& every,
                                    const Trajectory& truth) {
  const auto on_first = match_trajectories(truth, first), on_every = match_trajectories(truth, every);
  for (const bool scale_is_free : {false, true}) {
    const RowFits fits{motion_fit(on_first, scale_is_free), motion_fit(on_every, scale_is_free)};
    if (fits.is_every() || fits.is_first()) return fits;
  }
  return std::nullopt;
}

std::string fit_text(const MotionFit& fit) {
  return fmt::format("{:.4f} m, {:.2f} deg", fit.translation_m, fit.rotation_deg);
}

std::string ordinal(std::size_t number) {
  return fmt::format("{}{}", number, number == 2 ? "nd" : number == 3 ? "rd" : "th");
}

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

std::string lay_rows_on_frames(TrajectoryFile& file, const std::vector<double>& frame_stamps,
                               const Trajectory& truth, const std::string& name) {
  if (file.has_stamps || file.rows <= 0 || frame_stamps.empty()) return "";
  const auto rows = static_cast<std::size_t>(file.rows);
  Trajectory first = laid_on(file.poses, frame_stamps, 1);
  const std::string unknown = fmt::format("{}: {} without stamps do not say which of the {} they are", name,
                                          counted(rows, "row"), counted(frame_stamps.size(), "frame")),
                    way_on = "a stamp or a frame's number before each row would say it";
  if (rows == frame_stamps.size()) {
    file.poses = std::move(first);
    return fmt::format("{}: the rows have no stamps; each was given its frame's time", name);
  }
  if (rows > frame_stamps.size()) {
    file.poses = std::move(first);
    return fmt::format("{}; the first {} were given the frames' times and the rest left out ({})", unknown,
                       frame_stamps.size(), way_on);
  }
  const std::size_t step = step_of_rows(rows, frame_stamps.size());
  Trajectory every = laid_on(file.poses, frame_stamps, step);
  const auto fits = step > 1 ? telling_fits(first, every, truth) : std::nullopt;
  const bool is_every = fits && fits->is_every();
  file.poses = std::move(is_every ? every : first);
  const std::string of_first = fmt::format("the first {}", rows), of_every = "every " + ordinal(step);
  if (fits)
    return fmt::format(
        "{}; they were given the times of {}, for motions then differ from the truth's by {}, "
        "and as {} by {} ({})",
        unknown, is_every ? of_every : of_first, fit_text(is_every ? fits->every : fits->first),
        is_every ? of_first : of_every, fit_text(is_every ? fits->first : fits->every), way_on);
  return fmt::format("{}; they were given the times of {}{} ({})", unknown, of_first,
                     step > 1 ? fmt::format(", and may as well be {}", of_every) : "", way_on);
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
