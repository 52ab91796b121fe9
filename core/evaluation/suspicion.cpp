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
constexpr double kRemarkableScale = 0.03;  // log of it
constexpr std::size_t kFewestPoses = 8;    // below, anything fits

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

/// What carries the estimate's motions into the truth's: A X = X B, B's lengths being multiplied.
struct Body {
  Pose body_from_camera = Pose::Identity();
  double scale = 1.0;
};

/// The rotation X that carries the estimate's turns into the truth's, log(A) = X log(B); then the lever arm.
std::optional<Body> hand_eye(const std::vector<MatchedPose>& matched, bool scale_is_free,
                             const LeftOut& left_out = {}) {
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
  Body body;
  body.body_from_camera.linear() = fit.rotation;
  // Of the lever arm p and the scale s: (R - I) p - s X b = -a.
  Eigen::Matrix4d normal = 1e-6 * Eigen::Matrix4d::Identity();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < pairs.count; ++i) {
    if (left_out.has(i)) continue;
    const Pose a = relative(matched[i].truth, matched[i + pairs.step].truth);
    const Pose b = relative(matched[i].estimate, matched[i + pairs.step].estimate);
    Eigen::Matrix<double, 3, 4> row;
    row << a.linear() - Eigen::Matrix3d::Identity(), -(fit.rotation * b.translation());
    normal += row.transpose() * row;
    right -= row.transpose() * a.translation();
  }
  if (scale_is_free) {
    const Eigen::Vector4d found = solve_ldlt(normal, right);
    body.body_from_camera.translation() = found.head<3>();
    body.scale = found[3];
    if (!(body.scale > 0)) return std::nullopt;
    return body;
  }
  const Eigen::Matrix3d of_lever = normal.topLeftCorner<3, 3>();
  const Eigen::Vector3d left = right.head<3>() - normal.topRightCorner<3, 1>();
  body.body_from_camera.translation() = solve_ldlt(of_lever, left);
  return body;
}

/// The poses as they would be if truth and estimate followed one body.
std::vector<MatchedPose> read_by(const Body& body, std::vector<MatchedPose> matched) {
  for (MatchedPose& pose : matched) {
    pose.truth = pose.truth * body.body_from_camera;
    pose.estimate.translation() *= body.scale;
  }
  return matched;
}

/// Whether the body tells motions that it was not fitted to: six free numbers fit whatever a short stretch of
/// poor odometry has. Each fifth of the pairs is told by the others.
bool tells_what_was_left_out(const std::vector<MatchedPose>& matched, const MotionFit& as_is,
                             bool scale_is_free) {
  constexpr std::size_t kParts = 5;  // of the pairs: four fifths still tell a body
  const Pairs pairs = pairs_of(matched);
  double translation = 0.0, rotation = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const LeftOut left_out{part * pairs.count / kParts, (part + 1) * pairs.count / kParts};
    const auto body = hand_eye(matched, scale_is_free, left_out);
    if (!body) return false;
    const std::vector<MatchedPose> read = read_by(*body, matched);
    for (std::size_t i = left_out.begin; i < left_out.end; ++i) {
      const MatchedPose &a = read[i], &b = read[i + pairs.step];
      const Pose error = relative(a.truth, b.truth).inverse() * relative(a.estimate, b.estimate);
      translation += error.translation().squaredNorm();
      rotation += std::pow(rotation_angle(error.linear()), 2);
    }
  }
  const auto count = static_cast<double>(pairs.count);
  return std::sqrt(translation / count) + std::sqrt(rotation / count) < kShareLeft * as_is.combined_m();
}

/// The truth's body by hand_eye, and how well it fits then. Nothing of a stretch that is too short for it.
std::optional<Suspicion> suspect_body(const std::vector<MatchedPose>& matched, const MotionFit& as_is,
                                      bool scale_is_free) {
  constexpr double kShortest =
      0.8;  // s, of a motion; half of the poses where they last less than two seconds
  if (as_is.delta_s < kShortest || !tells_what_was_left_out(matched, as_is, scale_is_free))
    return std::nullopt;
  const auto body = hand_eye(matched, scale_is_free);
  if (!body) return std::nullopt;
  Suspicion suspicion;
  suspicion.as_is = as_is;
  suspicion.body_from_camera = body->body_from_camera;
  suspicion.mended = motion_fit(read_by(*body, matched));
  suspicion.mended.scale = body->scale;
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

/// How the lengths of pairs `begin` to `end` fit, the latter not among them.
struct LengthFit {
  double along = 0.0, squares = 0.0, moved = 0.0;  // m², of estimate and truth, of the estimate, of the truth

  LengthFit(const std::vector<MatchedPose>& matched, std::size_t step, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d a = relative(matched[i].truth, matched[i + step].truth).translation(),
                            b = relative(matched[i].estimate, matched[i + step].estimate).translation();
      along += a.dot(b), squares += b.squaredNorm(), moved += a.squaredNorm();
    }
  }
  /// By what the estimate's lengths fit best; 0 where they point the other way.
  [[nodiscard]] double scale() const { return squares > 0 ? std::max(0.0, along / squares) : 1.0; }
  /// Sum of the squares that this scale leaves, m².
  [[nodiscard]] double left() const {
    return std::max(0.0, moved - 2.0 * scale() * along + scale() * scale() * squares);
  }
};

/// suspect_convention, the estimate's scale being as it is or free.
std::optional<Suspicion> suspect_reading(const std::vector<MatchedPose>& matched, bool estimate_may_err,
                                         bool scale_is_free) {
  Suspicion best;
  best.as_is = best.mended = motion_fit(matched, scale_is_free);
  if (best.as_is.combined_m() < kWorthAWord) return std::nullopt;
  const auto consider = [&](Suspicion::Of of, PoseConvention convention) {
    std::vector<MatchedPose> read = matched;
    for (MatchedPose& pose : read) {
      Pose& changed = of == Suspicion::Of::estimate ? pose.estimate : pose.truth;
      changed = camera_pose(changed, convention);
    }
    const MotionFit fit = motion_fit(read, scale_is_free);
    if (fit.combined_m() >= best.mended.combined_m() * (1.0 - 1e-9)) return;
    best.of = of, best.convention = convention, best.mended = fit;
  };
  for (const PoseConvention convention : other_conventions()) {
    consider(Suspicion::Of::truth, convention);
    if (estimate_may_err && convention != PoseConvention::bonn) consider(Suspicion::Of::estimate, convention);
  }
  // Where the clocks are apart no reading tells the motions, and the least wrong one means nothing.
  const double most = std::min(kShareLeft * best.as_is.combined_m(), kShareOfMotion * best.as_is.moved_m);
  const auto is_worth_it = [most](const Suspicion& s) { return s.mended.combined_m() < most; };
  if (auto body = suspect_body(matched, best.as_is, scale_is_free);
      body && is_worth_it(*body) && body->mended.combined_m() < kFarBetter * best.mended.combined_m()) {
    if (estimate_may_err) body->of = Suspicion::Of::either;
    return body;
  }
  if (!is_worth_it(best)) return std::nullopt;
  // The motions are the same whichever of the two is read so.
  const bool is_of_both =
      best.convention == PoseConvention::mirrored_x || best.convention == PoseConvention::mirrored_y ||
      best.convention == PoseConvention::mirrored_z || best.convention == PoseConvention::opengl;
  if (is_of_both && estimate_may_err) best.of = Suspicion::Of::either;
  return best;
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
    return kDegrees * kTellsRotation * missing_m >= angle_deg * beside_m;
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

double MotionFit::combined_m() const { return translation_m + rotation_deg / kDegrees; }

bool MotionFit::tells_motions() const { return pairs > 0 && combined_m() < kShareOfMotion * moved_m; }

MotionFit motion_fit(const std::vector<MatchedPose>& matched, bool scale_is_free) {
  const Pairs pairs = pairs_of(matched);
  MotionFit fit;
  fit.pairs = static_cast<int>(pairs.count);
  if (pairs.count == 0) return fit;
  if (scale_is_free) fit.scale = LengthFit(matched, pairs.step, 0, pairs.count).scale();
  std::vector<double> deltas;
  double moved = 0.0, turned = 0.0;
  for (std::size_t i = 0; i < pairs.count; ++i) {
    const MatchedPose &a = matched[i], &b = matched[i + pairs.step];
    const Pose truth = relative(a.truth, b.truth);
    Pose estimate = relative(a.estimate, b.estimate);
    estimate.translation() *= fit.scale;
    const Pose error = truth.inverse() * estimate;
    fit.translation_m += error.translation().squaredNorm();
    fit.rotation_deg += std::pow(kDegrees * rotation_angle(error.linear()), 2);
    moved += truth.translation().squaredNorm(), turned += std::pow(rotation_angle(truth.linear()), 2);
    deltas.push_back(b.timestamp - a.timestamp);
  }
  fit.translation_m = std::sqrt(fit.translation_m / fit.pairs);
  fit.rotation_deg = std::sqrt(fit.rotation_deg / fit.pairs);
  fit.moved_m = std::sqrt(moved / fit.pairs) + std::sqrt(turned / fit.pairs);
  fit.delta_s = median_of(deltas);
  return fit;
}

std::string Suspicion::sentence() const {
  const auto figures = [](const MotionFit& fit) {
    return fmt::format("{:.4f} m, {:.2f} deg", fit.translation_m, fit.rotation_deg);
  };
  const std::string better = fmt::format("motions over {:.2f} s then differ by {} instead of {}",
                                         as_is.delta_s, figures(mended), figures(as_is));
  const bool is_scaled = std::abs(std::log(mended.scale)) > kRemarkableScale;
  const std::string scaled =
      is_scaled ? fmt::format(", and the estimate's lengths are multiplied by {:.3g}", mended.scale) : "";
  if (convention == PoseConvention::as_written && body_from_camera)
    return fmt::format(
        "{} turned {:.1f} deg and set off {:.3f} m from {}{}: {}",
        of == Of::either ? "ground truth and estimate seem to follow two bodies, or axes, that are"
                         : "the ground truth seems to follow a body",
        kDegrees * rotation_angle(body_from_camera->linear()), body_from_camera->translation().norm(),
        of == Of::either ? "one another" : "the camera",
        is_scaled ? fmt::format(", the estimate's lengths being multiplied by {:.3g}", mended.scale) : "",
        better + (of == Of::either ? " (no option reads one as the other)" : ""));
  const char* whose = of == Of::truth      ? "the ground truth fits far better if"
                      : of == Of::estimate ? "the estimate fits far better if"
                                           : "ground truth and estimate fit far better if, in one of them,";
  const std::string_view name = to_string(convention);
  const std::string mending =
      of == Of::either
          ? fmt::format("`--estimate {}` reads the estimate so, `--truth {}` the truth", name, name)
      : of == Of::estimate ? fmt::format("`--estimate {}` reads it so", name)
                           : fmt::format("`--truth {}` reads it so", name);
  return fmt::format("{} {}{}: {} ({})", whose, meaning_of(convention), scaled, better, mending);
}

std::optional<Suspicion> suspect_convention(const std::vector<MatchedPose>& matched, bool estimate_may_err) {
  if (matched.size() < kFewestPoses) return std::nullopt;
  if (auto found = suspect_reading(matched, estimate_may_err, false)) return found;
  return estimate_may_err ? suspect_reading(matched, true, true) : std::nullopt;
}

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

std::string scale_drift_sentence(const std::vector<MatchedPose>& matched) {
  constexpr std::size_t kParts = 3;    // of the pairs: a change shows, and each still tells a scale
  constexpr double kLeft = 0.6;        // of the error under one scale
  constexpr double kRemarkable = 0.1;  // log of the last scale over the first
  const Pairs pairs = pairs_of(matched);
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
