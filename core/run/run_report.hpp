#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {

class FrameSource;
struct RunResult;

/// Wall time a frame over a run.
struct SpeedFigures {
  double median_ms = 0.0, p99_ms = 0.0;  ///< of tracking; decoding excluded
  double orb_unit_ms = 0.0;  ///< median of the unit on the same frames; 0 when it was not measured
  double units = 0.0;        ///< median_ms / orb_unit_ms; 0 when it was not measured
  StageTimes mean;           ///< each stage's mean
};

/// What is said about a whole run.
struct RunReport {
  std::string sequence, method, odometry;
  int frames = 0, tracked = 0, lost = 0, keyframes = 0, map_points = 0;
  double coverage = 0.0;                           ///< share of the frames with an estimated pose
  std::optional<TrajectoryEvaluation> evaluation;  ///< of the final trajectory; nothing without ground truth
  std::optional<TrajectoryEvaluation> evaluation_live;  ///< of the poses as first estimated
  bool has_truth = false;       ///< the sequence has ground truth that meets its frames
  std::string truth_why_not;    ///< why ground truth that is there is of no use; empty otherwise
  std::string doubt;            ///< what lets truth and poses fit far better than as they stand; empty mostly
  std::string without_image;    ///< which frames could not be read and why, one sentence; empty where none
  std::string without_depth;    ///< which frames lacked depth and why, one sentence; empty where none did
  std::string without_pose;     ///< which frames were read and have no pose, and why; likewise
  std::string without_mask;     ///< which frames lacked the mask they were to be given, and why; likewise
  FrameScores scores;           ///< summed over the frames
  RecordParts measured{};       ///< what is known of any frame; the rest has no value
  SpeedFigures speed;           ///< where measured.times
  std::string hash;             ///< run_hash of the records
  double peak_memory_mb = 0.0;  ///< of the process so far
};

[[nodiscard]] RunReport report_on(const RunResult& run, const FrameSource& source);

/// Why a run has no RPE over 1 s: no ground truth, no poses, or none that far apart. Empty where it has one.
[[nodiscard]] std::string why_no_rpe(const RunReport& report);

/// A fingerprint of all that a run computed, 16 hex digits: equal for equal results, timings left out.
[[nodiscard]] std::string run_hash(const FrameRecords& records);

/// The report as `summary.json` holds it.
[[nodiscard]] nlohmann::ordered_json to_summary(const RunReport& report, const RunResult& run,
                                                const FrameSource& source);

/// The report as a person reads it at the end of a run: a few lines.
[[nodiscard]] std::string to_text(const RunReport& report);

}  // namespace stillpoint
