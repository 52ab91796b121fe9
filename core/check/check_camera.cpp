#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <optional>

#include "core/check/findings.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {
namespace {

constexpr double kWorseResidual = 1.015;  // of the best camera's, to doubt the one that is used
constexpr double kFewestTracked = 0.9;    // of the frames, for a residual to mean anything
constexpr double kSameSides = 0.01;

/// Frames at hand under another camera.
class UnderCamera final : public FrameSource {
 public:
  UnderCamera(const FrameSource& source, const std::vector<Frame>& frames, const Camera& camera)
      : source_(source), frames_(frames), camera_(camera) {}

  [[nodiscard]] const std::string& name() const override { return source_.name(); }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override { return read(index).timestamp; }
  [[nodiscard]] Frame read(int index) const override { return frames_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return none_; }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return no_warnings_; }

 private:
  const FrameSource& source_;
  const std::vector<Frame>& frames_;
  Camera camera_;
  Trajectory none_;
  std::vector<std::string> no_warnings_;
};

/// The mean over tracked frames of the reprojection error's RMS, px; nothing where too few are tracked.
std::optional<double> residual_under(const FrameSource& source, const std::vector<Frame>& frames,
                                     const Camera& camera) {
  Config config;
  set_parameter(config, "run.method=none");
  config.run.threads = 1;
  const RunResult run = run_sequence(UnderCamera(source, frames, camera), config, {});
  double sum = 0;
  int count = 0;
  for (const FrameRecord& record : run.records)
    if (record.estimated && record.rms_px > 0) sum += record.rms_px, ++count;
  if (count == 0 || run.tracked() < kFewestTracked * static_cast<double>(run.records.size()))
    return std::nullopt;
  return sum / count;
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

std::vector<Finding> check_camera(const FrameSource& source, int frames) {
  if (!source.has_depth()) return {};
  std::vector<Frame> at_hand;
  for (int i = 0; i < std::min(frames, source.size()); ++i) at_hand.push_back(source.read(i));
  std::vector<Camera> cameras = others_than(source.camera());
  cameras.insert(cameras.begin(), source.camera());
  std::vector<std::optional<double>> residuals(cameras.size());
  const auto every_second = [&](std::size_t first) {
    for (std::size_t i = first; i < cameras.size(); i += 2)
      residuals[i] = residual_under(source, at_hand, cameras[i]);
  };
  auto beside = std::async(std::launch::async, every_second, std::size_t{1});
  every_second(0);
  beside.get();
  if (!residuals[0]) return {};
  std::size_t best = 0;
  for (std::size_t i = 1; i < cameras.size(); ++i)
    if (residuals[i] && *residuals[i] < *residuals[best]) best = i;
  if (best == 0 || *residuals[0] < kWorseResidual * *residuals[best]) return {};
  std::string all;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (residuals[i])
      all += fmt::format("{}{} {:.3f}", all.empty() ? "" : ", ", cameras[i].name, *residuals[i]);
  return {{"camera", fmt::format("{} fits better than {}: over {} frames reprojections miss by {:.3f} px "
                                 "instead of {:.3f} px (`--camera "
                                 "{}` uses it; all: {})",
                                 cameras[best].name, cameras[0].name, at_hand.size(), *residuals[best],
                                 *residuals[0], cameras[best].name, all)}};
}

}  // namespace stillpoint
