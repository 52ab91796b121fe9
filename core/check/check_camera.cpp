#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "core/check/findings.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/with_camera.hpp"

namespace stillpoint {
namespace {

constexpr double kWorseResidual = 1.015;  // of the best camera's, to doubt the one that is used
constexpr double kCertain = 4.0;  // standard errors: several cameras are tried, and none is to win by chance
constexpr double kFewestTrackedByCamera = 0.85;  // of the frames, for a residual to mean anything
constexpr double kSameSides = 0.01;  // of the ratio of sides: rounding a small image to whole pixels

/// Frames at hand under another camera.
class UnderCamera final : public WithCamera {
 public:
  UnderCamera(const FrameSource& source, const std::vector<Frame>& frames, const Camera& camera)
      : WithCamera(source, camera), frames_(frames) {}

  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override { return read(index).timestamp; }
  [[nodiscard]] Frame read(int index) const override { return frames_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] bool has_masks() const override { return false; }

 private:
  const std::vector<Frame>& frames_;
};

/// The RMS of the reprojection error of each frame, px; 0 where it could not be tracked.
using Residuals = std::vector<double>;

Residuals residuals_under(const FrameSource& source, const std::vector<Frame>& frames, const Camera& camera,
                          const std::atomic<bool>* stop) {
  Config config;
  set_parameter(config, "run.method=none");
  config.run.threads = 1;
  RunOptions options;
  options.stop = stop;
  const RunResult run = run_sequence(UnderCamera(source, frames, camera), config, options);
  Residuals residuals;
  for (const FrameRecord& record : run.records) residuals.push_back(record.estimated ? record.rms_px : 0.0);
  return residuals;
}

/// By how much one camera's residuals exceed another's, frame by frame.
struct Excess {
  double ratio = 1.0;      ///< mean over the frames tracked under both
  double certainty = 0.0;  ///< (ratio - 1) by its standard error: people who walk about make frames disagree
  double used_px = 0.0, other_px = 0.0;  ///< means
};

Excess excess_of(const Residuals& used, const Residuals& other) {
  std::vector<double> ratios;
  Excess excess;
  for (std::size_t i = 0; i < std::min(used.size(), other.size()); ++i) {
    if (used[i] <= 0 || other[i] <= 0) continue;
    ratios.push_back(used[i] / other[i]);
    excess.used_px += used[i], excess.other_px += other[i];
  }
  const ErrorStatistics s = statistics_of(ratios);
  if (s.count < kFewestTrackedByCamera * static_cast<double>(used.size()) || s.stddev <= 0) return {};
  excess.ratio = s.mean;
  excess.certainty = (s.mean - 1.0) / (s.stddev / std::sqrt(s.count));
  excess.used_px /= s.count, excess.other_px /= s.count;
  return excess;
}

/// The known cameras of these sides, scaled to them, apart from the one that is used.
std::vector<Camera> others_than(const Camera& used) {
  std::vector<Camera> others;
  for (const Camera& known : known_cameras()) {
    const double sx = static_cast<double>(used.width) / known.width,
                 sy = static_cast<double>(used.height) / known.height;
    if (std::abs(sx / sy - 1.0) > kSameSides || known.name == "generated") continue;
    Camera scaled = known.scaled_to(used.width, used.height);
    const bool same = std::abs(scaled.fx - used.fx) < 1 && std::abs(scaled.fy - used.fy) < 1 &&
                      std::abs(scaled.cx - used.cx) < 1 && std::abs(scaled.cy - used.cy) < 1;
    if (!same) others.push_back(std::move(scaled));
  }
  return others;
}

}  // namespace

std::vector<Finding> check_camera(const FrameSource& source, int frames, const std::atomic<bool>* stop) {
  // A stereo pair is matched under its own calibration, and under another it has other depth.
  if (!source.has_depth() || source.camera().is_stereo()) return {};
  std::vector<Frame> at_hand;
  for (int i = 0; i < std::min(frames, source.size()); ++i) at_hand.push_back(source.read(i));
  std::vector<Camera> cameras = others_than(source.camera());
  cameras.insert(cameras.begin(), source.camera());
  std::vector<Residuals> residuals(cameras.size());
  const auto every_second = [&](std::size_t first) {
    for (std::size_t i = first; i < cameras.size(); i += 2)
      residuals[i] = residuals_under(source, at_hand, cameras[i], stop);
  };
  auto beside = std::async(std::launch::async, every_second, std::size_t{1});
  every_second(0);
  beside.get();
  if (stop != nullptr && *stop) return {};
  std::size_t best = 0;
  Excess most;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    const Excess excess = excess_of(residuals[0], residuals[i]);
    if (excess.ratio < kWorseResidual || excess.certainty < kCertain || excess.ratio <= most.ratio) continue;
    best = i, most = excess;
  }
  if (best == 0) return {};
  // Cameras as good as the best one, as far as these frames can tell.
  std::string names = cameras[best].name;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    const Excess over_used = excess_of(residuals[0], residuals[i]),
                 over_best = excess_of(residuals[i], residuals[best]);
    if (i != best && over_used.ratio >= kWorseResidual && over_used.certainty >= kCertain &&
        over_best.certainty < kCertain)
      names += fmt::format(" (or {}, which is alike)", cameras[i].name);
  }
  return {
      {"camera",
       fmt::format("{} fits better than {}: over {} frames reprojections miss by {:.3f} px instead of {:.3f} "
                   "px, {:.1f} standard errors apart (`--camera {}` uses it)",
                   names, cameras[0].name, at_hand.size(), most.other_px, most.used_px, most.certainty,
                   cameras[best].name)}};
}

}  // namespace stillpoint
