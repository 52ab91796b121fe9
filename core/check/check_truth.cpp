#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/check/findings.hpp"
#include "core/evaluation/suspicion.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

// The farthest shift that is tried, to either side, and from one to the next.
constexpr double kMostShift = 0.5, kShiftStep = 0.005;  // s
constexpr double kLeastShift = 0.015;     // s; below, sensors and clocks differ by as much anyway
constexpr double kShareLeft = 0.7;        // of the error, for a shift to be believed
constexpr double kWorthAWord = 0.002;     // m of motion
constexpr double kMostGap = 0.05;         // s, between truth poses that are interpolated
constexpr std::size_t kFewestPoses = 15;  // poses: below, a shift that fits is chance
constexpr double kFewestTracked = 0.8;    // of the frames: below, the odometry says nothing about its input

/// RMSE of motions over a few poses when the truth is read `shift` seconds earlier; nothing where too few
/// poses have truth.
std::optional<double> motion_error(const Trajectory& truth, const Trajectory& estimate, double shift,
                                   std::size_t needed) {
  constexpr std::size_t kStep = 5;  // poses: over a few frames motion outgrows noise
  double squares = 0;
  std::size_t pairs = 0;
  std::vector<std::optional<Pose>> poses;
  for (const StampedPose& pose : estimate)
    poses.push_back(interpolate(truth, pose.timestamp - shift, kMostGap));
  for (std::size_t i = 0; i + kStep < estimate.size(); ++i) {
    if (!poses[i] || !poses[i + kStep]) continue;
    const Pose error = (poses[i]->inverse() * *poses[i + kStep]).inverse() *
                       (estimate[i].world_from_camera.inverse() * estimate[i + kStep].world_from_camera);
    squares += error.translation().squaredNorm() + std::pow(rotation_angle(error.linear()), 2);
    ++pairs;
  }
  if (pairs < needed) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(pairs));
}

}  // namespace

std::optional<TimeShift> find_time_shift(const Trajectory& truth, const Trajectory& estimate) {
  if (estimate.size() < kFewestPoses) return std::nullopt;
  const std::size_t needed = estimate.size() / 3;
  const auto as_is = motion_error(truth, estimate, 0.0, needed);
  if (!as_is || *as_is < kWorthAWord) return std::nullopt;
  TimeShift best{0.0, *as_is, *as_is};
  const int steps = static_cast<int>(std::lround(kMostShift / kShiftStep));
  for (int i = -steps; i <= steps; ++i) {
    const auto error = motion_error(truth, estimate, i * kShiftStep, needed);
    if (error && *error < best.mended_m) best.seconds = i * kShiftStep, best.mended_m = *error;
  }
  if (std::abs(best.seconds) < kLeastShift || best.mended_m > kShareLeft * best.as_is_m) return std::nullopt;
  return best;
}

std::vector<Finding> check_truth(const Trajectory& truth, const Trajectory& estimate, bool estimate_may_err) {
  std::vector<Finding> findings;
  const TrajectoryEvaluation evaluation = evaluate_trajectory(truth, estimate);
  if (const auto suspicion = suspect_convention(evaluation.matched, estimate_may_err)) {
    findings.push_back(
        {suspicion->of == Suspicion::Of::estimate ? "estimate" : "truth", suspicion->sentence()});
    return findings;  // what else is off shows once this is mended
  }
  if (const std::string scale = scale_sentence(evaluation); !scale.empty())
    findings.push_back(
        {estimate_may_err ? "estimate" : "depth",
         scale + (estimate_may_err ? " (`--scale` does so)" : ": `--depth-scale` sets the depth's")});
  if (const auto shift = find_time_shift(truth, estimate))
    findings.push_back(
        {"truth", fmt::format("the ground truth fits better {:.3f} s {}: motions then differ by {:.4f} m "
                              "instead of {:.4f} m (a "
                              "degree counting 1.7 cm)",
                              std::abs(shift->seconds), shift->seconds > 0 ? "later" : "earlier",
                              shift->mended_m, shift->as_is_m)});
  return findings;
}

std::vector<Finding> check_odometry(const FrameSource& source, int frames) {
  std::vector<Finding> findings;
  if (!source.has_depth()) return findings;
  Config config;
  set_parameter(config, "run.method=none");
  RunOptions options;
  options.count = std::min(frames, source.size());
  const RunResult run = run_sequence(source, config, options);
  const auto all = static_cast<double>(run.records.size());
  if (run.tracked() < kFewestTracked * all) {
    const auto lost = std::find_if(run.records.begin(), run.records.end(),
                                   [](const FrameRecord& r) { return !r.estimated; });
    findings.push_back(
        {"odometry", fmt::format("{} of the first {} frames can be tracked; frame {} cannot: {}",
                                 run.tracked(), run.records.size(), lost->index, lost->note)});
  }
  if (source.ground_truth().empty()) return findings;
  const auto truth = check_truth(source.ground_truth(), run.trajectory, false);
  findings.insert(findings.end(), truth.begin(), truth.end());
  return findings;
}

}  // namespace stillpoint
