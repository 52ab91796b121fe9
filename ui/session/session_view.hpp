#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/motion/epipolar/colour_motion.hpp"
#include "core/motion/paper/paper_trace.hpp"
#include "core/motion/stillpoint/depth_motion.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/frame.hpp"
#include "ui/session/debug_view.hpp"

namespace stillpoint {

/// One frame as panels show it: its images, read or computed again, and its record. Images a sequence lacks
/// are empty.
struct FrameView {
  int index = 0;
  Frame frame;                   ///< t
  Frame reference;               ///< t - motion.reference_gap; unreadable (empty) for the first frames
  PaperTrace motion;             ///< the paper's stages on that pair, whatever the method run
  StillpointTrace depth_motion;  ///< method `stillpoint`'s stages; without references for other methods
  EpipolarTrace colour_motion;   ///< … of a frame without depth; without points elsewhere
  cv::Mat mask;                  ///< CV_8UC1: what the method removed; empty = nothing
  FrameTruth truth;              ///< for display and evaluation only
  const FrameRecord* record = nullptr;  ///< null while the frame has not been processed
  /// Records of the frames right before, newest first, with their features where these are kept.
  std::vector<std::shared_ptr<const FrameRecord>> history;
  /// The frame before, to be compared with; null where none was asked for or is known. Has none of its own.
  std::shared_ptr<const FrameView> before;
};

/// A run beside the session's own: the baseline, or a ghost with other parameters.
struct RunView {
  std::string name;                  ///< "none", "paper", …
  std::vector<FrameRecord> records;  ///< as far as processed, in order of frames
  std::vector<FrameScores> scores;   ///< one a record: masks against the true ones, where these are known
  Trajectory trajectory;             ///< estimated poses so far
  TrajectoryEvaluation evaluation;   ///< against ground truth, without matches where there is none
};

/// What panels draw: a snapshot of the session, plain data, made by the session once a frame of the interface
/// at most.
struct SessionView {
  std::string title;  ///< the sequence's name
  Camera camera;
  Config config;
  int frame_count = 0;                       ///< of the sequence
  int processed = 0;                         ///< frames with a record
  bool playing = false, busy = false;        ///< playing; the worker has something to do
  std::string message;                       ///< the last error, one sentence; empty when all is well
  std::shared_ptr<const FrameView> current;  ///< the frame shown; never null
  std::shared_ptr<const RunView> run;        ///< never null
  std::shared_ptr<const RunView> baseline;   ///< null where none is run
  Trajectory ground_truth;                   ///< empty where there is none
  Alignment alignment;  ///< truth_from_estimate over the poses so far, stated in the trajectory panel
  std::vector<SavedKeyframe> keyframes;
  std::vector<SavedPoint> map_points;  ///< and after them those that left the map because they moved
  DebugView debug;                     ///< bookmarks, breakpoints, ghost runs, …
  std::uint64_t revision = 0;          ///< grows when run, keyframes or points change: what caches go by
};

/// Whether the sliders' config, not the run's, made the motion stages that are shown.
[[nodiscard]] inline bool shows_preview(const SessionView& session) {
  return session.debug.preview != nullptr && session.debug.preview->index == session.current->index;
}

/// What panels of the frame shown draw while there is a preview of it: the same session, whose frame, config
/// and nothing else are the preview's. @pre shows_preview(session)
[[nodiscard]] SessionView with_preview(const SessionView& session);

}  // namespace stillpoint
