#include "core/evaluation/suspicion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/evaluation/time_offset.hpp"
#include "core/geometry/normal_equations.hpp"
#include "core/geometry/rotation_fit.hpp"
#include "core/median.hpp"

namespace stillpoint {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;  // degrees a radian
constexpr double kShareLeft = 0.4;                     // of the error, for a reading to be suspected
constexpr double kFarBetter =
    0.5;  // of the error a convention leaves, for six free numbers to be preferred to it
constexpr double kWorthAWord = 0.02;    // m, combined: what fits as well leaves no doubt about its convention
constexpr double kShareOfMotion = 0.4;  // of the true motions, that a reading which tells them may err by
constexpr std::size_t kFewestPoses = 8;  // below, anything fits

/// Pairs of poses some time apart: (i, i + step).
struct Pairs {
  std::size_t step = 1, count = 0;
};

Pairs pairs_of(const std::vector<MatchedPose>& matched) {
  if (matched.size() < 2) return {};
  std::size_t step = 1;
  while (step < matched.size() / 2 && matched[step].timestamp - matched[0].timestamp < 1.0) ++step;
  return {step, matched.size() - step};
}

Pose relative(const Pose& a, const Pose& b) { return a.inverse() * b; }

/// Pairs that are left out: `begin` to `end`, the latter not among them.
struct LeftOut {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] bool has(std::size_t pair) const { return pair >= begin && pair < end; }
};

/// The rotation X that carries the estimate's turns into the truth's, log(A) = X log(B); then the lever arm.
std::optional<Pose> hand_eye(const std::vector<MatchedPose>& matched, const LeftOut& left_out = {}) {
  const Pairs pairs = pairs_of(matched);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.count; ++i) {
    if (left_out.has(i)) continue;
    sum += so3_log(relative(matched[i].truth, matched[i + pairs.step].truth).linear()) *
           so3_log(relative(matched[i].estimate, matched[i + pairs.step].estimate).linear()).transpose();
  }
  const RotationFit fit = fit_rotation(sum);
  // Turns about one axis leave the rotation about it open.
  if (fit.singular_values[1] < 1e-3 * fit.singular_values[0] || fit.singular_values[0] <= 0)
    return std::nullopt;
  Pose body_from_camera = Pose::Identity();
  body_from_camera.linear() = fit.rotation;
  Eigen::Matrix3d normal = 1e-6 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.count; ++i) {
    if (left_out.has(i)) continue;
    const Pose a = relative(matched[i].truth, matched[i + pairs.step].truth);
    const Pose b = relative(matched[i].estimate, matched[i + pairs.step].estimate);
    const Eigen::Matrix3d lever = a.linear() - Eigen::Matrix3d::Identity();
    normal += lever.transpose() * lever;
    right += lever.transpose() * (body_from_camera.linear() * b.translation() - a.translation());
  }
  body_from_camera.translation() = solve_ldlt(normal, right);
  return body_from_camera;
}

/// Whether the body tells motions that it was not fitted to: six free numbers fit whatever a short stretch of
/// poor odometry has. Each fifth of the pairs is told by the others.
bool tells_what_was_left_out(const std::vector<MatchedPose>& matched, const MotionFit& as_is) {
  constexpr std::size_t kParts = 5;  // of the pairs: four fifths still tell a body
  const Pairs pairs = pairs_of(matched);
  double translation = 0.0, rotation = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const LeftOut left_out{part * pairs.count / kParts, (part + 1) * pairs.count / kParts};
    const auto body = hand_eye(matched, left_out);
    if (!body) return false;
    for (std::size_t i = left_out.begin; i < left_out.end; ++i) {
      const MatchedPose &a = matched[i], &b = matched[i + pairs.step];
      const Pose error =
          relative(a.truth * *body, b.truth * *body).inverse() * relative(a.estimate, b.estimate);
      translation += error.translation().squaredNorm();
      rotation += std::pow(rotation_angle(error.linear()), 2);
    }
  }
  const auto count = static_cast<double>(pairs.count);
  return std::sqrt(translation / count) + std::sqrt(rotation / count) < kShareLeft * as_is.combined_m();
}

/// The truth's body by hand_eye, and how well it fits then. Nothing of a stretch that is too short for it.
std::optional<Suspicion> suspect_body(const std::vector<MatchedPose>& matched, const MotionFit& as_is) {
  constexpr double kShortest =
      0.8;  // s, of a motion; half of the poses where they last less than two seconds
  if (as_is.delta_s < kShortest || !tells_what_was_left_out(matched, as_is)) return std::nullopt;
  Suspicion suspicion;
  suspicion.as_is = as_is;
  suspicion.body_from_camera = hand_eye(matched);
  if (!suspicion.body_from_camera) return std::nullopt;
  std::vector<MatchedPose> read = matched;
  for (MatchedPose& pose : read) pose.truth = pose.truth * *suspicion.body_from_camera;
  suspicion.mended = motion_fit(read);
  return suspicion;
}

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

}  // namespace

double MotionFit::combined_m() const { return translation_m + rotation_deg / kDegrees; }

MotionFit motion_fit(const std::vector<MatchedPose>& matched) {
  const Pairs pairs = pairs_of(matched);
  MotionFit fit;
  fit.pairs = static_cast<int>(pairs.count);
  if (pairs.count == 0) return fit;
  std::vector<double> deltas;
  for (std::size_t i = 0; i < pairs.count; ++i) {
    const MatchedPose &a = matched[i], &b = matched[i + pairs.step];
    const Pose error = relative(a.truth, b.truth).inverse() * relative(a.estimate, b.estimate);
    fit.translation_m += error.translation().squaredNorm();
    fit.rotation_deg += std::pow(kDegrees * rotation_angle(error.linear()), 2);
    deltas.push_back(b.timestamp - a.timestamp);
  }
  fit.translation_m = std::sqrt(fit.translation_m / fit.pairs);
  fit.rotation_deg = std::sqrt(fit.rotation_deg / fit.pairs);
  fit.delta_s = median_of(deltas);
  return fit;
}

std::string Suspicion::sentence() const {
  const auto figures = [](const MotionFit& fit) {
    return fmt::format("{:.4f} m, {:.2f} deg", fit.translation_m, fit.rotation_deg);
  };
  const std::string better = fmt::format("motions over {:.2f} s then differ by {} instead of {}",
                                         as_is.delta_s, figures(mended), figures(as_is));
  if (convention == PoseConvention::as_written && body_from_camera)
    return fmt::format(
        "the ground truth seems to follow a body turned {:.1f} deg and set off {:.3f} m from the camera: {}",
        kDegrees * rotation_angle(body_from_camera->linear()), body_from_camera->translation().norm(),
        better);
  const char* whose = of == Of::truth      ? "the ground truth fits far better if"
                      : of == Of::estimate ? "the estimate fits far better if"
                                           : "ground truth and estimate fit far better if, in one of them,";
  const std::string mending = of == Of::estimate ? fmt::format("--estimate {}", to_string(convention))
                                                 : fmt::format("--truth {}", to_string(convention));
  return fmt::format("{} {}: {} (`{}` reads it so)", whose, meaning_of(convention), better, mending);
}

std::optional<Suspicion> suspect_convention(const std::vector<MatchedPose>& matched, bool estimate_may_err) {
  if (matched.size() < kFewestPoses) return std::nullopt;
  Suspicion best;
  best.as_is = best.mended = motion_fit(matched);
  if (best.as_is.combined_m() < kWorthAWord) return std::nullopt;
  const auto consider = [&](Suspicion::Of of, PoseConvention convention) {
    std::vector<MatchedPose> read = matched;
    for (MatchedPose& pose : read) {
      Pose& changed = of == Suspicion::Of::estimate ? pose.estimate : pose.truth;
      changed = camera_pose(changed, convention);
    }
    const MotionFit fit = motion_fit(read);
    if (fit.combined_m() >= best.mended.combined_m() * (1.0 - 1e-9)) return;
    best.of = of, best.convention = convention, best.mended = fit;
  };
  for (const PoseConvention convention : other_conventions()) {
    consider(Suspicion::Of::truth, convention);
    if (estimate_may_err && convention != PoseConvention::bonn) consider(Suspicion::Of::estimate, convention);
  }
  // Where the clocks are apart no reading tells the motions, and the least wrong one means nothing.
  std::vector<MatchedPose> still = matched;
  for (MatchedPose& pose : still) pose.estimate = Pose::Identity();
  const double most =
      std::min(kShareLeft * best.as_is.combined_m(), kShareOfMotion * motion_fit(still).combined_m());
  const auto is_worth_it = [most](const Suspicion& s) { return s.mended.combined_m() < most; };
  if (const auto body = suspect_body(matched, best.as_is);
      body && is_worth_it(*body) && body->mended.combined_m() < kFarBetter * best.mended.combined_m())
    return body;
  if (!is_worth_it(best)) return std::nullopt;
  const bool is_mirror = best.convention == PoseConvention::mirrored_x ||
                         best.convention == PoseConvention::mirrored_y ||
                         best.convention == PoseConvention::mirrored_z;
  if (is_mirror && estimate_may_err) best.of = Suspicion::Of::either;
  return best;
}

std::string scale_sentence(const TrajectoryEvaluation& evaluation) {
  // Poses that have nothing to do with the truth also fit better when they are shrunk to a point.
  constexpr double kMostOfSpread = 0.2;
  constexpr double kRemarkable = 0.03;
  constexpr double kCertain = 4.0;  // standard errors
  const auto& similarity = evaluation.ate.similarity;
  const std::size_t poses = evaluation.matched.size();
  if (!similarity || poses < kFewestPoses) return "";
  // Of a scale that is fitted to residuals of this size over a path of that spread.
  const double spread = truth_spread_m(evaluation.matched),
               standard_error = similarity->rmse_m / (spread * std::sqrt(static_cast<double>(poses)));
  if (!(std::abs(std::log(similarity->scale)) > kCertain * standard_error) ||
      std::abs(std::log(similarity->scale)) < kRemarkable ||
      similarity->rmse_m > 0.5 * evaluation.ate.translation_m.rmse ||
      similarity->rmse_m > kMostOfSpread * spread)
    return "";
  return fmt::format(
      "the estimate fits {:.4f} m instead of {:.4f} m when its lengths are multiplied by {:.3f}",
      similarity->rmse_m, evaluation.ate.translation_m.rmse, similarity->scale);
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
    const Pose moved = relative(matched[i - 1].truth, matched[i].truth);
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
  constexpr double kFarDeg = 20.0, kSteady = 0.2;  // deg; of the mean, how far a constant angle scatters
  constexpr double kTellsRotation = 3.0;           // times the error that positions lie beside a line
  const ErrorStatistics& rotation = evaluation.ate.rotation_deg;
  if (rotation.count == 0 || rotation.mean < kFarDeg || rotation.stddev > kSteady * rotation.mean) return "";
  const double beside = second_spread_m(evaluation.matched);
  if (beside > kTellsRotation * evaluation.ate.translation_m.rmse) return "";
  return fmt::format(
      "the positions lie within {:.3f} m of a line and miss by {:.3f} m: they do not tell the rotation about "
      "it, and an "
      "ATE rotation of {:.1f} deg means nothing (`--align origin` goes by the first pose)",
      beside, evaluation.ate.translation_m.rmse, rotation.mean);
}

}  // namespace stillpoint
