#include "core/check/time_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/check/timed_adjustment.hpp"
#include "core/counted.hpp"
#include "core/media/stored_depth.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/with_camera.hpp"

namespace stillpoint {
namespace {

constexpr double kSettled = 0.1e-3, kSettledSigmas = 0.3;  // s and sigmas: a smaller change ends the runs
constexpr double kTold = 2.5e-3;                           // s: a larger standard deviation tells nothing
constexpr double kLongestTold = 0.06;  // s: a readout or a delay beyond two frames' time is no measurement
constexpr int kFewestFrames = 30, kFewestObservations = 20;  // … the latter a frame
constexpr int kFewestSightings = 4;                          // frames that see a point

/// Keeps the depth of the frames that were read.
class KeepingDepth final : public WithCamera {
 public:
  using WithCamera::WithCamera;
  struct Kept {
    cv::Mat depth;       ///< CV_16UC1, kKeptDepthUnits a metre
    double stamp = 0.0;  ///< s
  };

  [[nodiscard]] Frame read(int index) const override {
    Frame frame = WithCamera::read(index);
    if (frame.has_depth()) {
      Kept kept{stored_depth(frame.depth, kKeptDepthUnits).image, frame.depth_timestamp};
      const std::lock_guard lock(mutex_);
      kept_[index] = std::move(kept);
    }
    return frame;
  }
  /// Once all is read. @returns null for a frame without depth
  [[nodiscard]] const Kept* kept(int index) const {
    const auto found = kept_.find(index);
    return found == kept_.end() ? nullptr : &found->second;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<int, Kept> kept_;
};

/// Nothing where it was stopped.
TrackedStretch track(const FrameSource& source, const Camera& camera, const Config& config, int first,
                     int count, const std::atomic<bool>* stop) {
  const KeepingDepth seen_by(source, camera);
  RunOptions options;
  options.first = first, options.count = count;
  options.keep_features = true;
  options.stop = stop;
  const RunResult run = run_sequence(seen_by, config, options);
  if (run.interrupted) return {};
  std::unordered_map<int, int> seen_in;  // frames, by point
  for (const FrameRecord& record : run.records)
    for (const FeatureRecord& feature : record.features)
      if (feature.fate == FeatureFate::inlier) ++seen_in[feature.map_point];
  TrackedStretch stretch;
  std::unordered_map<int, int> points;
  for (const SavedPoint& point : run.points) {
    if (seen_in[point.id] < kFewestSightings) continue;
    points[point.id] = static_cast<int>(stretch.points.size());
    stretch.points.push_back(point.position);
  }
  std::map<double, Pose> poses;
  for (const StampedPose& pose : run.trajectory) poses[pose.timestamp] = pose.world_from_camera;

  stretch.poses = run.trajectory;
  for (const FrameRecord& record : run.records) {
    const auto pose = poses.find(record.timestamp);
    if (!record.estimated || pose == poses.end()) continue;
    SeenFrame frame;
    frame.timestamp = record.timestamp;
    if (const auto* kept = seen_by.kept(record.index))
      frame.depth = kept->depth, frame.lag = kept->stamp - record.timestamp;
    frame.camera_from_world = pose->second.inverse();
    for (const FeatureRecord& feature : record.features) {
      const auto point = points.find(feature.map_point);
      if (feature.fate != FeatureFate::inlier || point == points.end()) continue;
      Sighting sighting;
      sighting.point = point->second;
      sighting.undistorted =
          camera.undistorted({static_cast<double>(feature.pixel.x), static_cast<double>(feature.pixel.y)});
      sighting.row = static_cast<double>(feature.pixel.y);
      sighting.sigma = std::pow(config.features.scale_factor, feature.octave);
      sighting.weight = static_cast<double>(feature.static_weight);
      frame.sightings.push_back(sighting);
    }
    if (frame.sightings.size() < kFewestObservations) continue;
    stretch.observations += static_cast<int>(frame.sightings.size());
    stretch.frames.push_back(std::move(frame));
  }
  return stretch;
}

Times times_of(const Camera& camera) {
  return {camera.readout_s, camera.depth_readout_s.value_or(camera.readout_s), camera.depth_delay_s};
}

Camera with_times(Camera camera, const Times& times) {
  camera.readout_s = times[0];
  camera.depth_readout_s = times[1];
  camera.depth_delay_s = times[2];
  return camera;
}

TimeCalibration calibrate_stretch(const FrameSource& source, const Config& config, int first, int count,
                                  const TimeStretch& stretch) {
  TimeCalibration result;
  result.first_frame = first, result.frames = count;
  Camera camera = source.camera();
  const Times before = times_of(camera);
  std::array<bool, kTimes> sought{true, true, true};
  Times sigma = Times::Constant(1.0);
  Trajectory poses;
  while (result.runs < stretch.runs) {
    TrackedStretch tracked = track(source, camera, config, first, count, stretch.stop);
    ++result.runs;
    if (stretch.stop != nullptr && *stretch.stop) {
      result.why_not = "the calibration was stopped";
      return result;
    }
    result.observations = tracked.observations;
    poses = tracked.poses;
    if (static_cast<int>(tracked.frames.size()) < kFewestFrames) {
      result.why_not = fmt::format("of {} frames from frame {} on, {} could be tracked", count, first,
                                   tracked.frames.size());
      return result;
    }
    // What the stretch does not tell stands, and is no longer free to take up others' errors.
    Times times = times_of(camera);
    for (;;) {
      TimedAdjustment adjustment(tracked, camera, times, sought);
      adjustment.solve();
      times = adjustment.times(), sigma = adjustment.sigma();
      result.noise_px = adjustment.noise().pixel;
      const auto untold = [&](int k) {
        return sought[static_cast<std::size_t>(k)] &&
               !(sigma[k] < kTold && std::abs(times[k]) < kLongestTold);
      };
      const int order[] = {1, 2, 0};  // depth's readout is the hardest to tell
      const auto* const first_untold = std::find_if(std::begin(order), std::end(order), untold);
      if (first_untold == std::end(order)) break;
      sought[static_cast<std::size_t>(*first_untold)] = false;
      times[*first_untold] = before[*first_untold];
    }
    const Times change = times - times_of(camera);
    camera = with_times(camera, times);
    bool settled = true;
    for (int k = 0; k < kTimes; ++k)
      settled = settled && std::abs(change[k]) <= std::max(kSettled, kSettledSigmas * sigma[k]);
    if (settled) break;
  }
  if (!poses.empty()) result.after_truth = delay_beside_truth(source.ground_truth(), poses);
  const Times times = times_of(camera);
  TimeEstimate* const estimates[] = {&result.readout, &result.depth_readout, &result.depth_delay};
  for (int k = 0; k < kTimes; ++k) {
    const bool told = sought[static_cast<std::size_t>(k)];
    *estimates[k] = {told ? times[k] : before[k], told ? sigma[k] : 0.0, told};
  }
  if (!result.told())
    result.why_not = fmt::format(
        "in frames {} to {} the camera moves too little, or too evenly, for its residuals to tell", first,
        first + count - 1);
  return result;
}

}  // namespace

std::optional<TimeEstimate> delay_beside_truth(const Trajectory& truth, const Trajectory& estimate) {
  // Half a second at 30 Hz, over which motion outgrows noise; and pairs whose errors hang together.
  constexpr std::size_t kApart = 15, kPairsInBlock = 20;  // poses
  constexpr double kGap = 0.05, kDifference = 0.002;      // s: between truth's poses; for derivatives
  // The largest standard error that is told, and a delay that is more than a frame's.
  constexpr double kMostTold = 5e-3, kFarthest = 0.05;  // s
  constexpr double kMetresARadian = 1.0;                // rotation beside translation: a point 1 m away
  constexpr int kSteps = 10;  // of Gauss-Newton over one number: it settles in a few
  // How two motions over the same poses differ, truth read `delay` later.
  const auto difference = [&](std::size_t i, double delay) -> std::optional<Vector6d> {
    const auto a = interpolate(truth, estimate[i].timestamp + delay, kGap),
               b = interpolate(truth, estimate[i + kApart].timestamp + delay, kGap);
    if (!a || !b) return std::nullopt;
    Vector6d error = se3_log((a->inverse() * *b).inverse() * estimate[i].world_from_camera.inverse() *
                             estimate[i + kApart].world_from_camera);
    error.tail<3>() *= kMetresARadian;
    return error;
  };
  TimeEstimate result;
  for (int step = 0; step < kSteps; ++step) {
    double h = 0.0, g = 0.0, noise = 0.0;
    std::size_t pairs = 0;
    std::vector<double> blocks;
    for (std::size_t i = 0; i + kApart < estimate.size(); ++i) {
      const auto before = difference(i, result.seconds - kDifference),
                 after = difference(i, result.seconds + kDifference);
      if (!before || !after) continue;
      const Vector6d slope = (*after - *before) / (2.0 * kDifference), error = 0.5 * (*after + *before);
      if (pairs++ % kPairsInBlock == 0) blocks.push_back(0.0);
      h += slope.squaredNorm(), g += slope.dot(error), noise += error.squaredNorm();
      blocks.back() += slope.dot(error);
    }
    if (pairs < 2 * kPairsInBlock || h <= 0) return std::nullopt;
    double scatter = 0.0;
    for (const double block : blocks) scatter += block * block;
    result.sigma_s = std::sqrt(std::max(scatter, h * noise / (6.0 * static_cast<double>(pairs)))) / h;
    result.seconds -= g / h;
    if (!(std::abs(result.seconds) < kFarthest)) return std::nullopt;
  }
  result.told = result.sigma_s < kMostTold;
  return result.told ? std::optional(result) : std::nullopt;
}

Camera TimeCalibration::applied_to(Camera camera) const {
  if (readout.told) {
    // Depth's readout is as colour's where nothing else is known: it stays what it was.
    if (!camera.depth_readout_s && !depth_readout.told) camera.depth_readout_s = camera.readout_s;
    camera.readout_s = readout.seconds;
  }
  if (depth_readout.told) camera.depth_readout_s = depth_readout.seconds;
  if (depth_delay.told) camera.depth_delay_s = depth_delay.seconds;
  return camera;
}

std::vector<std::string> to_lines(const TimeCalibration& times, const Camera& camera) {
  if (!times.why_not.empty()) return {times.why_not};
  const Times had = times_of(camera);
  std::vector<std::string> lines;
  int k = 0;
  for (const auto& [name, estimate] :
       {std::pair("colour's readout", times.readout), std::pair("depth's readout", times.depth_readout),
        std::pair("depth's delay", times.depth_delay)}) {
    const double ms = 1e3 * had[k++];
    lines.push_back(estimate.told
                        ? fmt::format("{} {:.1f} ± {:.1f} ms (camera {}: {:.1f})", name,
                                      1e3 * estimate.seconds, 1e3 * estimate.sigma_s, camera.name, ms)
                        : fmt::format("{} is not told by these frames; {:.1f} ms stand", name, ms));
  }
  if (times.after_truth)
    lines.push_back(
        fmt::format("beside ground truth, poses are of {:.1f} ± {:.1f} ms after their frames' times",
                    1e3 * times.after_truth->seconds, 1e3 * times.after_truth->sigma_s));
  lines.push_back(fmt::format("over frames {} to {}, {} observations, which miss by {:.3f} px",
                              times.first_frame, times.first_frame + times.frames - 1, times.observations,
                              times.noise_px));
  return lines;
}

std::vector<Finding> check_times(const TimeCalibration& times, const Camera& camera) {
  constexpr double kOff = 4e-3, kCertain = 4.0;  // s, standard deviations
  const Times had = times_of(camera);
  std::vector<Finding> findings;
  int k = 0;
  for (const auto& [what, estimate] :
       {std::pair("colour's rows are read over", times.readout),
        std::pair("depth's rows are read over", times.depth_readout),
        std::pair("depth is measured after its stamp by", times.depth_delay)}) {
    const double of_camera = had[k++], off = std::abs(estimate.seconds - of_camera);
    if (!estimate.told || off < kOff || off < kCertain * estimate.sigma_s) continue;
    findings.push_back({"time", fmt::format("{} {:.1f} ± {:.1f} ms, and {:.1f} ms by camera {} "
                                            "(`--calibrate-time` goes by what was measured)",
                                            what, 1e3 * estimate.seconds, 1e3 * estimate.sigma_s,
                                            1e3 * of_camera, camera.name)});
  }
  return findings;
}

TimeCalibration calibrate_time(const FrameSource& source, const Config& config, const TimeStretch& stretch) {
  TimeCalibration result;
  if (!source.has_depth() || source.camera().is_stereo()) {
    result.why_not = "times are calibrated of sequences with a depth sensor";
    return result;
  }
  for (int i = 0; i < stretch.tries; ++i) {
    const int first = i * stretch.frames, count = std::min(stretch.frames, source.size() - first);
    if (count < kFewestFrames || (stretch.stop != nullptr && *stretch.stop)) break;
    result = calibrate_stretch(source, config, first, count, stretch);
    if (result.readout.told) return result;
  }
  if (result.frames == 0)
    result.why_not = fmt::format("{} {} too few: {} are needed", counted(source.size(), "frame"),
                                 source.size() == 1 ? "is" : "are", kFewestFrames);
  return result;
}

}  // namespace stillpoint
