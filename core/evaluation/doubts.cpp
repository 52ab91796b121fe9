#include "core/evaluation/doubts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/evaluation/pose_pairs.hpp"
#include "core/evaluation/time_offset.hpp"
#include "core/geometry/rotation_fit.hpp"

namespace stillpoint {
namespace {

constexpr double kRemarkableScale = 0.03;  // log of it

/// RMS distance of the true positions from their mean, m.
double truth_spread_m(const std::vector<MatchedPose>& matched) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MatchedPose& pose : matched)
    mean += pose.truth.translation() / static_cast<double>(matched.size());
  double squares = 0;
  for (const MatchedPose& pose : matched) squares += (pose.truth.translation() - mean).squaredNorm();
  return matched.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(matched.size()));
}

/// RMS distance of the true positions from the line that fits them best, along their second axis, m.
double second_spread_m(const std::vector<MatchedPose>& matched) {
  if (matched.size() < 2) return 0.0;
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(matched.size()));
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    positions.col(i) = matched[static_cast<std::size_t>(i)].truth.translation();
  positions.colwise() -= Eigen::Vector3d(positions.rowwise().mean());
  const RotationFit fit = fit_rotation(positions * positions.transpose());
  return std::sqrt(std::max(0.0, fit.singular_values[1]) / static_cast<double>(matched.size()));
}

/// What is left of the positions after the best scale, m: orientations are no less right for a wrong one.
double left_after_scale_m(const TrajectoryEvaluation& evaluation) {
  const double rmse = evaluation.ate.translation_m.rmse;
  return evaluation.ate.similarity ? std::min(rmse, evaluation.ate.similarity->rmse_m) : rmse;
}

/// How far positions that miss lie beside a line: what is left of them over that is the angle, rad, by which
/// an alignment may be turned about the line.
struct BesideLine {
  double beside_m = 0.0, missing_m = 0.0;
  [[nodiscard]] bool explains(double angle_deg) const {
    constexpr double kTellsRotation = 3.0;  // times that angle
    return to_degrees(kTellsRotation * missing_m) >= angle_deg * beside_m;
  }
};

/// The mean ATE rotation, deg, where all poses have it alike and it is `far_deg` or more; otherwise 0.
double steady_rotation_deg(const TrajectoryEvaluation& evaluation, double far_deg) {
  constexpr double kSteady = 0.2;  // of the mean, how far a constant angle scatters
  const ErrorStatistics& rotation = evaluation.ate.rotation_deg;
  const bool is_one =
      rotation.count > 0 && rotation.mean >= far_deg && rotation.stddev <= kSteady * rotation.mean;
  return is_one ? rotation.mean : 0.0;
}

}  // namespace

std::string scale_sentence(const TrajectoryEvaluation& evaluation) {
  // Poses that have nothing to do with the truth also fit better when they are shrunk to a point.
  constexpr double kMostOfSpread = 0.2;
  constexpr double kCertain = 4.0;  // standard errors
  const auto& similarity = evaluation.ate.similarity;
  const std::size_t poses = evaluation.matched.size();
  if (!similarity || poses < kFewestPoses) return "";
  // Of a scale that is fitted to residuals of this size over a path of that spread.
  const double spread = truth_spread_m(evaluation.matched),
               standard_error = similarity->rmse_m / (spread * std::sqrt(static_cast<double>(poses)));
  if (!(std::abs(std::log(similarity->scale)) > kCertain * standard_error) ||
      std::abs(std::log(similarity->scale)) < kRemarkableScale ||
      similarity->rmse_m > 0.5 * evaluation.ate.translation_m.rmse ||
      similarity->rmse_m > kMostOfSpread * spread)
    return "";
  return fmt::format(
      "the estimate fits {:.4f} m instead of {:.4f} m when its lengths are multiplied by {:.3f}",
      similarity->rmse_m, evaluation.ate.translation_m.rmse, similarity->scale);
}

std::string scale_question(const TrajectoryEvaluation& evaluation, double baseline_m) {
  if (baseline_m <= 0.0) return "is the depth scale right?";
  return fmt::format("is the pair's baseline right? It is {:.3g} m, and {:.3g} m would fit", baseline_m,
                     baseline_m * (evaluation.ate.similarity ? evaluation.ate.similarity->scale : 1.0));
}

std::string scale_drift_sentence(const std::vector<MatchedPose>& matched) {
  constexpr std::size_t kParts = 3;    // of the pairs: a change shows, and each still tells a scale
  constexpr double kLeft = 0.6;        // of the error under one scale
  constexpr double kRemarkable = 0.1;  // log of the last scale over the first
  const PosePairs pairs = pairs_of(matched);
  if (pairs.count < kParts * kFewestPoses) return "";
  const LengthFit whole(matched, pairs.step, 0, pairs.count);
  double left = 0.0;
  std::vector<double> scales;
  for (std::size_t part = 0; part < kParts; ++part) {
    const LengthFit fit(matched, pairs.step, part * pairs.count / kParts, (part + 1) * pairs.count / kParts);
    left += fit.left();
    scales.push_back(fit.scale());
  }
  const auto rms = [&pairs](double squares) { return std::sqrt(squares / static_cast<double>(pairs.count)); };
  if (rms(whole.left()) < kWorthAWord || rms(left) > kLeft * rms(whole.left()) ||
      rms(left) > kShareOfMotion * rms(whole.moved) ||
      !(std::abs(std::log(scales.back() / scales.front())) > kRemarkable))
    return "";
  return fmt::format(
      "the estimate's scale changes on the way: motions of its first third fit when their lengths are "
      "multiplied by {:.3g}, of its last by {:.3g}, and miss by {:.4f} m instead of {:.4f} m then",
      scales.front(), scales.back(), rms(left), rms(whole.left()));
}

std::string clock_sentence(const Trajectory& truth, const Trajectory& estimate,
                           const TrajectoryEvaluation& evaluation) {
  constexpr double kShareExplained = 0.3;  // of the squared errors, by speed times one delay: worth a search
  constexpr std::size_t kMost = 400;       // poses that are searched by
  constexpr double kRemarkable = 0.005;    // s
  constexpr double kMostLeft = 0.5;        // of the error
  const auto& matched = evaluation.matched;
  if (matched.size() < kFewestPoses) return "";
  // An estimate that is late lies behind, along the truth's velocity.
  double along = 0, speeds = 0, errors = 0;
  for (std::size_t i = 1; i + 1 < matched.size(); ++i) {
    const double dt = matched[i + 1].truth_timestamp - matched[i - 1].truth_timestamp;
    if (!(dt > 0)) continue;
    const Eigen::Vector3d velocity =
        (matched[i + 1].truth.translation() - matched[i - 1].truth.translation()) / dt;
    const Eigen::Vector3d error =
        (evaluation.ate.alignment.truth_from_estimate * matched[i].estimate).translation() -
        matched[i].truth.translation();
    along += error.dot(velocity), speeds += velocity.squaredNorm(), errors += error.squaredNorm();
  }
  if (!(along * along > kShareExplained * speeds * errors)) return "";
  Trajectory thinned;
  const std::size_t step = estimate.size() / kMost + 1;
  for (std::size_t i = 0; i < estimate.size(); i += step) thinned.push_back(estimate[i]);
  const auto found = estimate_time_offset(truth, thinned);
  if (!found || std::abs(found->offset_s) < kRemarkable ||
      found->rmse_after_m > kMostLeft * found->rmse_before_m)
    return "";
  return fmt::format("the estimate fits {:.4f} m instead of {:.4f} m when {:+.3f} s are added to its stamps",
                     found->rmse_after_m, found->rmse_before_m, found->offset_s);
}

std::string held_pose_sentence(const std::vector<MatchedPose>& matched) {
  constexpr int kFewest = 3;           // poses: one may be a frame that was read twice
  constexpr double kMovedM = 1e-3;     // m; a camera that stands still may well be told to
  constexpr double kTurnedRad = 2e-3;  // rad, a tenth of a degree
  int held = 0;
  double from = 0, to = 0;
  for (std::size_t i = 1; i < matched.size(); ++i) {
    const Pose moved = motion_between(matched[i - 1].truth, matched[i].truth);
    if (matched[i].estimate.matrix() != matched[i - 1].estimate.matrix() ||
        (moved.translation().norm() < kMovedM && rotation_angle(moved.linear()) < kTurnedRad))
      continue;
    if (held++ == 0) from = matched[i].timestamp;
    to = matched[i].timestamp;
  }
  if (held < kFewest) return "";
  return fmt::format(
      "{} of its poses are the same number for number as the one before, while the truth moves ({:.3f} s to "
      "{:.3f} s): a program that lost the camera may write so, and they count as poses until they are taken "
      "out",
      held, from, to);
}

std::string open_rotation_sentence(const TrajectoryEvaluation& evaluation) {
  constexpr double kFarDeg = 5.0;  // deg: below, it is an error as any
  const double rotation = steady_rotation_deg(evaluation, kFarDeg);
  const BesideLine line{second_spread_m(evaluation.matched), left_after_scale_m(evaluation)};
  if (rotation == 0.0 || !line.explains(rotation)) return "";
  return fmt::format(
      "the positions lie within {:.3f} m of a line and miss by {:.3f} m: they do not tell the rotation about "
      "it, and an ATE rotation of {:.1f} deg means nothing (`--align origin` goes by the first pose)",
      line.beside_m, line.missing_m, rotation);
}

std::string turned_axes_sentence(const TrajectoryEvaluation& evaluation) {
  constexpr double kFarDeg = 20.0;  // deg: no camera is mounted or calibrated so far off unnoticed
  const double rotation = steady_rotation_deg(evaluation, kFarDeg);
  const BesideLine line{second_spread_m(evaluation.matched), left_after_scale_m(evaluation)};
  if (rotation == 0.0 || line.explains(rotation)) return "";
  return fmt::format(
      "where the positions fit by {:.4f} m all orientations are off by {:.1f} deg: ground truth and estimate "
      "are poses of two bodies, or of other axes",
      line.missing_m, rotation);
}

std::string no_better_than_rest_sentence(const TrajectoryEvaluation& evaluation) {
  constexpr double kNearlyAll = 0.8;  // of what an estimate at rest misses by
  const double spread = truth_spread_m(evaluation.matched), missing = left_after_scale_m(evaluation);
  if (evaluation.matched.size() < kFewestPoses || missing < kWorthAWord || missing < kNearlyAll * spread)
    return "";
  return fmt::format(
      "the estimate misses by {:.4f} m even after the best scale, and one that never moves would by {:.4f} "
      "m: "
      "it tells next to nothing of the path",
      missing, spread);
}

std::vector<Doubt> doubts_about(const Trajectory& truth, const Trajectory& estimate,
                                const TrajectoryEvaluation& evaluation, AlignBy align,
                                const std::string& command) {
  const bool by_positions =
      align == AlignBy::rigid || align == AlignBy::similarity || align == AlignBy::first;
  std::vector<Doubt> doubts;
  const auto add = [&doubts](const std::string& sentence, const std::string& way_on = "") {
    if (!sentence.empty()) doubts.push_back({Suspicion::Of::estimate, sentence + way_on});
    return !sentence.empty();
  };
  const bool is_held = add(held_pose_sentence(evaluation.matched));
  if (const auto suspicion = suspect_convention(evaluation.matched, true)) {
    doubts.push_back({suspicion->of, suspicion->sentence()});
    return doubts;  // what else is off shows once this is mended
  }
  if (by_positions && add(clock_sentence(truth, estimate, evaluation),
                          fmt::format(" (`{}--time-offset auto` finds how much)", command)))
    return doubts;
  if (align == AlignBy::rigid)
    add(scale_sentence(evaluation), fmt::format(" (`{}--align sim3` does so)", command));
  if (!is_held) add(scale_drift_sentence(evaluation.matched));
  if (by_positions) add(turned_axes_sentence(evaluation));
  if (doubts.empty() && by_positions) add(no_better_than_rest_sentence(evaluation));
  return doubts;
}

}  // namespace stillpoint
