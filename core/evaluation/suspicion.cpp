#include "core/evaluation/suspicion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/evaluation/pose_pairs.hpp"
#include "core/geometry/normal_equations.hpp"
#include "core/geometry/rotation_fit.hpp"
#include "core/median.hpp"

namespace stillpoint {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;  // degrees a radian
constexpr double kShareLeft = 0.4;                     // of the error, for a reading to be suspected
constexpr double kFarBetter =
    0.5;  // of the error a convention leaves, for six free numbers to be preferred to it

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
  const PosePairs pairs = pairs_of(matched);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.count; ++i) {
    if (left_out.has(i)) continue;
    sum +=
        so3_log(motion_between(matched[i].truth, matched[i + pairs.step].truth).linear()) *
        so3_log(motion_between(matched[i].estimate, matched[i + pairs.step].estimate).linear()).transpose();
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
    const Pose a = motion_between(matched[i].truth, matched[i + pairs.step].truth);
    const Pose b = motion_between(matched[i].estimate, matched[i + pairs.step].estimate);
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
  const PosePairs pairs = pairs_of(matched);
  double translation = 0.0, rotation = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const LeftOut left_out{part * pairs.count / kParts, (part + 1) * pairs.count / kParts};
    const auto body = hand_eye(matched, scale_is_free, left_out);
    if (!body) return false;
    const std::vector<MatchedPose> read = read_by(*body, matched);
    for (std::size_t i = left_out.begin; i < left_out.end; ++i) {
      const MatchedPose &a = read[i], &b = read[i + pairs.step];
      const Pose error = motion_between(a.truth, b.truth).inverse() * motion_between(a.estimate, b.estimate);
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

}  // namespace

double MotionFit::combined_m() const { return translation_m + rotation_deg / kDegrees; }

bool MotionFit::tells_motions() const { return pairs > 0 && combined_m() < kShareOfMotion * moved_m; }

MotionFit motion_fit(const std::vector<MatchedPose>& matched, bool scale_is_free) {
  const PosePairs pairs = pairs_of(matched);
  MotionFit fit;
  fit.pairs = static_cast<int>(pairs.count);
  if (pairs.count == 0) return fit;
  if (scale_is_free) fit.scale = LengthFit(matched, pairs.step, 0, pairs.count).scale();
  std::vector<double> deltas;
  double moved = 0.0, turned = 0.0;
  for (std::size_t i = 0; i < pairs.count; ++i) {
    const MatchedPose &a = matched[i], &b = matched[i + pairs.step];
    const Pose truth = motion_between(a.truth, b.truth);
    Pose estimate = motion_between(a.estimate, b.estimate);
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

}  // namespace stillpoint
