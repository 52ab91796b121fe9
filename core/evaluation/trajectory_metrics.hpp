#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/alignment.hpp"
#include "core/geometry/trajectory.hpp"

namespace stillpoint {

/// A sample of errors in a few figures; all 0 when there is none. Units are the sample's.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< of an even number, the mean of the middle two
  double stddev = 0.0;  ///< of the population: divided by count
  double min = 0.0;
  double max = 0.0;
  double lower_quartile = 0.0, upper_quartile = 0.0;  ///< between neighbours by their distance, as NumPy does
  int count = 0;                                      ///< errors in the sample
};

[[nodiscard]] ErrorStatistics statistics_of(std::vector<double> errors);

/// An estimated pose and the ground truth that belongs to it.
struct MatchedPose {
  double timestamp = 0.0;            ///< s, of the estimate
  double truth_timestamp = 0.0;      ///< s
  Pose estimate = Pose::Identity();  ///< world_from_camera in the estimate's own world
  Pose truth = Pose::Identity();     ///< world_from_camera in the truth's world
};

/// The error of one aligned pose.
struct AbsoluteError {
  double timestamp = 0.0;  ///< s, of the estimate
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

/// What a similarity (Sim(3)) instead of a rigid motion would make of the same positions.
struct SimilarityFit {
  double scale = 1.0;   ///< the estimate's lengths are multiplied by it
  double rmse_m = 0.0;  ///< ATE that is left
};

/// How the estimate's world is laid over the truth's before absolute errors are taken.
enum class AlignBy {
  nothing,     ///< as they are: both are in one world already
  origin,      ///< the first matched pose on the truth's
  first,       ///< a rigid motion by the first EvaluationOptions::align_first poses
  rigid,       ///< SE(3): a rigid motion by all positions
  similarity,  ///< Sim(3): the same with scale
};

/// How far apart the poses of a relative error are.
struct RpeDelta {
  enum class Unit { seconds, frames, metres };
  double value = 1.0;
  Unit unit = Unit::seconds;

  [[nodiscard]] std::string text() const;  ///< "1 s", "10 frames", "5 m"
};

/// "1s", "10f" or "5m".
/// @throws InputError for another text
[[nodiscard]] RpeDelta rpe_delta_of(const std::string& text);

/// Absolute trajectory error: what is left of the positions after the alignment that was asked for, which is
/// rigid and without scale where nothing else is.
struct AbsoluteTrajectoryError {
  Alignment alignment;
  std::vector<AbsoluteError> errors;  ///< one a matched pose, by time
  ErrorStatistics translation_m;      ///< its rmse is the ATE; empty where too few poses are matched to align
  ErrorStatistics rotation_deg;       ///< of the same aligned poses
  std::optional<SimilarityFit> similarity;  ///< nothing where positions do not fix one
  std::string why_none;                     ///< why there are no statistics; empty where there are
};

/// The error of one motion, E = (G_i⁻¹ G_j)⁻¹ (P_i⁻¹ P_j).
struct RelativeError {
  double from_timestamp = 0.0;  ///< s, of pose i
  double to_timestamp = 0.0;    ///< s, of pose j
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

/// Relative pose error over motions of one length.
struct RelativePoseError {
  std::string delta;                  ///< "1 s" or "1 frame"
  std::vector<RelativeError> errors;  ///< one a pair, by time of pose i
  int dropped = 0;                    ///< poses without a partner the right time away
  double limit_s = 0.0;  ///< s: how far off the delta, or for 1 frame how far apart, pairs may be
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
  std::string why_none;  ///< why there are no statistics; empty where there are
};

/// Whose habits figures follow (README.md).
enum class Protocol {
  stillpoint,  ///< one-to-one association, ATE after rigid alignment, RPE over 1 s and over neighbours
  evo,         ///< evo_ape and evo_rpe without options
  tum,         ///< the TUM benchmark's scripts without options: RPE over 10,000 random pairs
};

/// How trajectories are compared. The defaults are the ones all figures of this project are given in.
struct EvaluationOptions {
  Protocol protocol = Protocol::stillpoint;         ///< set by use_protocol(); to_text shows what it measures
  double max_difference_s = kAssociationTolerance;  ///< poses belong together when strictly closer than this
  double delta_s = 1.0;                             ///< of the RPE over time
  double delta_tolerance_s = 0.05;                  ///< pairs off the delta by more than this are dropped
  double neighbour_gap = 2.5;  ///< for the RPE of 1 frame, matched poses that follow one another are
                               ///< neighbours up to so many times the median gap apart: a frame the camera
                               ///< dropped is bridged, a stretch that was lost is not. The golden figures
                               ///< bridge all gaps, the largest being 2.2 times the median.
  int expected_frames = 0;     ///< frames that should have a pose; 0 = not known
  AlignBy align = AlignBy::rigid;  ///< similarity also multiplies the lengths that relative errors are of
  int align_first = 0;             ///< poses, for AlignBy::first
  bool nearest = false;  ///< each pose of the shorter trajectory with the nearest of the other, at most
                         ///< max_difference_s apart and not one to one: evo's association
  bool interpolate_truth = false;    ///< truth at the estimate's own stamps, between neighbours
  double interpolation_gap_s = 0.1;  ///< … that are at most so far apart
  std::vector<RpeDelta> deltas{};    ///< more relative errors
  std::vector<double> lengths_m{};   ///< errors of all parts of the path of these lengths
};

/// All that is said about an estimate.
struct TrajectoryEvaluation {
  int truth_poses = 0;
  int estimated_poses = 0;
  int expected_frames = 0;         ///< 0 = not known
  std::optional<double> coverage;  ///< share of the expected frames that have a pose, 0 to 1
  double truth_span_s = 0.0;       ///< first to last pose of the truth
  double matched_span_s = 0.0;     ///< first to last matched pose
  double applied_scale = 1.0;      ///< by which the estimate's lengths were multiplied
  std::vector<MatchedPose> matched;
  AbsoluteTrajectoryError ate;
  RelativePoseError rpe_time;                ///< over EvaluationOptions::delta_s
  RelativePoseError rpe_frame;               ///< from each matched pose to the next
  std::vector<RelativePoseError> rpe_more;   ///< over EvaluationOptions::deltas, and what a protocol adds
  std::vector<RelativePoseError> by_length;  ///< over EvaluationOptions::lengths_m

  /// Whether there is any figure at all.
  [[nodiscard]] bool has_figures() const {
    return ate.translation_m.count > 0 || rpe_time.translation_m.count > 0 ||
           rpe_frame.translation_m.count > 0;
  }
};

/// Estimated poses with the ground truth that belongs to them: greedy one-to-one, nearest first.
[[nodiscard]] std::vector<MatchedPose> match_trajectories(const Trajectory& truth, const Trajectory& estimate,
                                                          double max_difference_s = kAssociationTolerance);

/// Each pose of the shorter trajectory with the nearest of the longer, at most `max_difference_s` apart; a
/// pose may be taken twice.
[[nodiscard]] std::vector<MatchedPose> match_nearest(const Trajectory& truth, const Trajectory& estimate,
                                                     double max_difference_s);

/// Each estimated pose with the truth at its own stamp, between neighbours at most `max_gap_s` apart.
[[nodiscard]] std::vector<MatchedPose> match_interpolated(const Trajectory& truth, const Trajectory& estimate,
                                                          double max_gap_s);

/// @param align similarity is rigid here: the caller has applied the scale
[[nodiscard]] AbsoluteTrajectoryError absolute_error(const std::vector<MatchedPose>& matched,
                                                     AlignBy align = AlignBy::rigid, int align_first = 0);

/// For each matched pose the one nearest to `delta_s` later, as the TUM benchmark's script does with a fixed
/// delta in seconds.
[[nodiscard]] RelativePoseError relative_error_over_time(const std::vector<MatchedPose>& matched,
                                                         double delta_s, double tolerance_s);

/// From each matched pose to the next, where they are at most `neighbour_gap` times the median gap apart.
[[nodiscard]] RelativePoseError relative_error_per_frame(const std::vector<MatchedPose>& matched,
                                                         double neighbour_gap);

/// From each matched pose to the one `frames` matched poses on.
[[nodiscard]] RelativePoseError relative_error_over_frames(const std::vector<MatchedPose>& matched,
                                                           int frames);

/// From each matched pose to the first that lies `metres` or more farther along the truth's path: the error
/// of every part of the path of that length, after Zhang & Scaramuzza (IROS 2018), who align each at its
/// start.
[[nodiscard]] RelativePoseError relative_error_over_distance(const std::vector<MatchedPose>& matched,
                                                             double metres);

/// The pairs of the TUM benchmark's evaluate_rpe.py without --fixed_delta: all of fewer than 100 poses, else
/// 10,000 that Python 2's random module draws from seed 0.
/// @param truth its median step says how far off a pose's truth may be: two steps
[[nodiscard]] RelativePoseError relative_error_of_random_pairs(const Trajectory& truth,
                                                               const Trajectory& estimate);

/// The options under which figures follow a protocol.
void use_protocol(Protocol protocol, EvaluationOptions& options);

/// A tenth to a half of the truth's path as far as it is matched, as Zhang & Scaramuzza take them.
[[nodiscard]] std::vector<double> usual_lengths_m(const std::vector<MatchedPose>& matched);

/// A statistic as people read it, or a dash where there is nothing to measure.
[[nodiscard]] std::string figure_text(const ErrorStatistics& statistics, int digits);

/// Everything at once. Without a single match the figures are empty and `matched` says so.
[[nodiscard]] TrajectoryEvaluation evaluate_trajectory(const Trajectory& truth, const Trajectory& estimate,
                                                       const EvaluationOptions& options = {});

/// The evaluation as people read it: counts, then a table with every delta, unit and number of pairs.
[[nodiscard]] std::string to_text(const TrajectoryEvaluation& evaluation,
                                  const EvaluationOptions& options = {});

}  // namespace stillpoint
