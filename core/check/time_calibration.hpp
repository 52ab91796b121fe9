#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "core/check/findings.hpp"
#include "core/config.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// A time as a sequence's own frames tell it.
struct TimeEstimate {
  double seconds = 0.0;
  double sigma_s = 0.0;  ///< standard deviation; of blocks of ten frames, so that what they share counts
  bool told = false;     ///< the stretch has motion enough; otherwise `seconds` is what the camera had
};

/// When a camera takes the rows of its images, by the odometry's own residuals.
struct TimeCalibration {
  TimeEstimate readout, depth_readout, depth_delay;  ///< as Camera has them
  /// How long after its frame's time a pose fits the ground truth best, where there is any: what stamps mean,
  /// and how the clocks of camera and motion capture stand. For reading: nothing is moved by it.
  std::optional<TimeEstimate> after_truth;
  int first_frame = 0, frames = 0;  ///< the stretch it was measured on
  int observations = 0;             ///< of map points in its frames
  double noise_px = 0.0;            ///< of their pixels, robust
  int runs = 0;                     ///< of the odometry over the stretch
  std::string why_not;              ///< one sentence where nothing was told; empty otherwise

  [[nodiscard]] bool told() const { return readout.told || depth_readout.told || depth_delay.told; }
  /// The camera with the times that were told.
  [[nodiscard]] Camera applied_to(Camera camera) const;
};

/// Times that are surely others than the camera's (by 4 ms and 4 standard deviations).
[[nodiscard]] std::vector<Finding> check_times(const TimeCalibration& times, const Camera& camera);

/// "colour's readout 24.7 ± 0.3 ms (camera freiburg1: 25.0)", …: a line a time, in brackets what the camera
/// has.
[[nodiscard]] std::vector<std::string> to_lines(const TimeCalibration& times, const Camera& camera);

struct TimeStretch {
  int frames = 150;  ///< at most, in one stretch
  int tries = 3;     ///< stretches, one after the other, until one has motion enough for the readout
  int runs = 4;      ///< of the odometry over a stretch, at most
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true, nothing is told
};

/// How long (s) after their stamps poses fit the ground truth best: the time under which motions over half a
/// second differ least, by Gauss-Newton, truth interpolated; nothing where too few poses have truth, or the
/// path is too even to tell to 5 ms.
[[nodiscard]] std::optional<TimeEstimate> delay_beside_truth(const Trajectory& truth,
                                                             const Trajectory& estimate);

/// Colour's readout and its direction, depth's own readout, and how late depth is, without ground truth:
/// where the residuals of the odometry are least. The configured method tracks a stretch; its map points, and
/// where its frames saw them, then give poses, points and times together (timed_adjustment.hpp), and the
/// stretch is tracked again under these times until they stand. Depth is compared with the plane of inverse
/// depth about the place where the point was seen when its row was measured.
/// @param source with depth; its camera's times are the start
[[nodiscard]] TimeCalibration calibrate_time(const FrameSource& source, const Config& config,
                                             const TimeStretch& stretch = {});

}  // namespace stillpoint
