#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/saved_map.hpp"

namespace stillpoint {

class FrameSource;
class Odometry;

/// The estimated poses among `records`, revised where odometry has looked back at them, hung on their
/// reference keyframes as these stand in the map now.
[[nodiscard]] Trajectory trajectory_so_far(const Odometry& odometry, const FrameRecords& records);

/// A frame that could be read but came without depth, in a sequence that has it.
struct DepthGap {
  int index = 0;
  std::string why;  ///< one sentence
};

/// A whole sequence by one method.
struct RunResult {
  Config config;
  FrameRecords records;   ///< one a frame processed, in order
  ScoreList scores;       ///< one a record; without figures where no mask is known
  Trajectory live;        ///< poses as estimated when each frame was tracked; estimated ones only
  Trajectory trajectory;  ///< the same frames, hung on their reference keyframes as these stand at the end
  std::vector<SavedKeyframe> keyframes;  ///< in order of time, those culled meanwhile included
  std::vector<SavedPoint> points;
  std::vector<SavedPoint> moved;        ///< those that left the map because they moved, oldest first
  std::vector<DepthGap> without_depth;  ///< in order; empty in a run read from its records
  int frames_in_sequence = 0;
  double orb_unit_ms = 0.0;  ///< the unit of speed, median over the frames; 0 when it was not measured
  bool interrupted = false;  ///< stopped before the last frame

  /// Frames with an estimated pose.
  [[nodiscard]] int tracked() const { return static_cast<int>(live.size()); }
};

struct RunOptions {
  int first = 0;                            ///< frame to begin with
  int count = 0;                            ///< frames to process; 0 = to the end
  const std::atomic<bool>* stop = nullptr;  ///< when it turns true the run ends after the frame at hand
  bool keep_features = false;     ///< leave each record its features: 25 kB a frame, for who shows them
  bool measure_orb_unit = false;  ///< also time one cv::ORB::detectAndCompute every few frames
                                  ///< (EVALUATION.md, "Speed"), and read no frames beside tracking
  std::function<void(const FrameResult&)> on_frame{};  ///< called after each frame, from the calling thread
};

/// Runs the configured method over a sequence; frames are read ahead on other threads. However long it is, it
/// holds a pose a frame and the map: records and scores are put by, and read back by who asks for them.
[[nodiscard]] RunResult run_sequence(const FrameSource& source, const Config& config,
                                     const RunOptions& options = {});

}  // namespace stillpoint
