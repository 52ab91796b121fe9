#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "core/check/findings.hpp"
#include "core/evaluation/doubts.hpp"
#include "core/evaluation/time_offset.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

constexpr double kShiftStep = 0.005, kMostShift = 0.5 + kShiftStep;  // s; the last step is not told
constexpr double kShiftsApart = 0.015;                               // s, for holds_without_any_part
constexpr double kLeastShift = 0.015;  // s; below, sensors and clocks differ by as much anyway
constexpr double kShareLeft = 0.7;     // of the error, for a shift to be believed
constexpr double kWorthAWord = 0.002;  // m of motion
constexpr double kMostGap = 0.05;      // s, between truth poses that are interpolated
constexpr std::size_t kFewestPoses = 15, kFewestMotions = 8;  // below, a shift that fits is chance
constexpr double kFewestTracked = 0.8;  // of the frames: below, the odometry says nothing about its input

/// How motions over a few poses differ from the truth's when that is read at other times.
class ShiftedMotions {
 public:
  ShiftedMotions(const Trajectory& truth, const Trajectory& estimate, double most_s) {
    constexpr std::size_t kApart = 5;  // poses
    const OffsetSearch search = offset_search(truth, estimate, most_s);
    steps_ = static_cast<int>(std::floor(search.reach_s / kShiftStep + 1e-9));
    const std::set<std::size_t> inside(search.poses.begin(), search.poses.end());
    for (const std::size_t i : inside)
      if (inside.count(i + kApart) > 0) pairs_.push_back(i);
    for (std::size_t i = 0; i < pairs_.size(); ++i) samples_.push_back(i);
    for (int step = -steps_; step <= steps_; ++step) {
      std::vector<double>& squares = squares_.emplace_back();
      const auto at = [&](std::size_t pose) {
        return interpolate(truth, estimate[pose].timestamp - step * kShiftStep, kMostGap);
      };
      for (const std::size_t i : pairs_) {
        const auto from = at(i), to = at(i + kApart);
        if (!from || !to) {
          squares.push_back(-1.0);
          continue;
        }
        const Pose error = (from->inverse() * *to).inverse() *
                           (estimate[i].world_from_camera.inverse() * estimate[i + kApart].world_from_camera);
        squares.push_back(error.translation().squaredNorm() + std::pow(rotation_angle(error.linear()), 2));
      }
    }
  }

  /// All pairs, by their places.
  [[nodiscard]] const std::vector<std::size_t>& samples() const { return samples_; }

  /// The shift that leaves the least share of the error, both over the same pairs. Nothing where too few are
  /// left of them, where motions fit as they are, or where the best is the last one on its side.
  [[nodiscard]] std::optional<TimeShift> best(const std::vector<std::size_t>& samples) const {
    std::optional<TimeShift> best;
    double least = 1.0;
    for (int step = -steps_; step <= steps_; ++step) {
      const auto found = at(step, samples);
      if (found && found->as_is_m >= kWorthAWord && found->mended_m < least * found->as_is_m)
        best = found, least = found->mended_m / found->as_is_m;
    }
    if (best && std::lround(std::abs(best->seconds) / kShiftStep) == steps_) return std::nullopt;
    return best;
  }

 private:
  [[nodiscard]] std::optional<TimeShift> at(int step, const std::vector<std::size_t>& samples) const {
    const std::vector<double>&mended = squares_[static_cast<std::size_t>(step + steps_)],
          &as_is = squares_[static_cast<std::size_t>(steps_)];
    TimeShift shift{step * kShiftStep, 0.0, 0.0};
    std::size_t count = 0;
    for (const std::size_t i : samples) {
      if (mended[i] < 0 || as_is[i] < 0) continue;
      shift.as_is_m += as_is[i], shift.mended_m += mended[i];
      ++count;
    }
    if (count < kFewestMotions || 2 * count < samples.size()) return std::nullopt;
    shift.as_is_m = std::sqrt(shift.as_is_m / static_cast<double>(count));
    shift.mended_m = std::sqrt(shift.mended_m / static_cast<double>(count));
    return shift;
  }

  int steps_ = 0;
  std::vector<std::size_t> pairs_, samples_;  // the first pose of each pair; 0, 1, 2, …
  std::vector<std::vector<double>> squares_;  // of each step, from -steps_ on, and pair; -1: no truth there
};

}  // namespace

std::optional<TimeShift> find_time_shift(const Trajectory& truth, const Trajectory& estimate) {
  if (estimate.size() < kFewestPoses) return std::nullopt;
  const ShiftedMotions motions(truth, estimate, kMostShift);
  const auto best = motions.best(motions.samples());
  if (!best || std::abs(best->seconds) < kLeastShift || best->mended_m > kShareLeft * best->as_is_m)
    return std::nullopt;
  const auto find = [&motions](const std::vector<std::size_t>& samples) -> std::optional<double> {
    const auto found = motions.best(samples);
    return found ? std::optional(found->seconds) : std::nullopt;
  };
  return holds_without_any_part(best->seconds, kShiftsApart, motions.samples(), find) ? best : std::nullopt;
}

std::vector<Finding> check_truth(const Trajectory& truth, const Trajectory& estimate, bool estimate_may_err,
                                 double baseline_m) {
  std::vector<Finding> findings;
  const TrajectoryEvaluation evaluation = evaluate_trajectory(truth, estimate);
  if (estimate_may_err) {
    for (const Doubt& doubt :
         doubts_about(truth, estimate, evaluation, AlignBy::rigid, "stillpoint evaluate "))
      findings.push_back({doubt.of == Suspicion::Of::truth ? "truth" : "estimate", doubt.sentence});
    if (!findings.empty()) return findings;
  } else if (const auto suspicion = suspect_convention(evaluation.matched, false)) {
    findings.push_back({"truth", suspicion->sentence()});
    return findings;  // what else is off shows once this is mended
  } else if (const std::string scale = scale_sentence(evaluation); !scale.empty()) {
    findings.push_back({"depth", scale + ": " +
                                     (baseline_m > 0.0 ? scale_question(evaluation, baseline_m)
                                                       : "`--depth-scale` sets the depth's")});
  }
  if (const auto shift = find_time_shift(truth, estimate))
    findings.push_back(
        {"truth", fmt::format("the ground truth fits better {:.3f} s {}: motions then differ by {:.4f} m "
                              "instead of {:.4f} m (a "
                              "degree counting 1.7 cm)",
                              std::abs(shift->seconds), shift->seconds > 0 ? "later" : "earlier",
                              shift->mended_m, shift->as_is_m)});
  return findings;
}

std::vector<Finding> check_odometry(const FrameSource& source, int frames, const std::atomic<bool>* stop) {
  std::vector<Finding> findings;
  if (!source.has_depth()) return findings;
  Config config;
  set_parameter(config, "run.method=none");
  RunOptions options;
  options.count = std::min(frames, source.size());
  options.stop = stop;
  const RunResult run = run_sequence(source, config, options);
  if (run.interrupted) return findings;
  const auto all = static_cast<double>(run.records.size());
  if (run.tracked() < kFewestTracked * all) {
    const auto lost = std::find_if(run.records.begin(), run.records.end(),
                                   [](const FrameRecord& r) { return !r.estimated; });
    findings.push_back(
        {"odometry", fmt::format("{} of the first {} frames can be tracked; frame {} cannot: {}",
                                 run.tracked(), run.records.size(), lost->index, lost->note)});
  }
  if (source.ground_truth().empty()) return findings;
  auto truth = check_truth(source.ground_truth(), run.trajectory, false, source.camera().baseline_m);
  // Depth of another time makes lengths wrong as well: its clock comes first, and is a finding already.
  if (source.depth_late_s()) std::erase_if(truth, [](const Finding& f) { return f.about == "depth"; });
  findings.insert(findings.end(), truth.begin(), truth.end());
  return findings;
}

}  // namespace stillpoint
