#include "core/odometry/direct_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/normal_equations.hpp"
#include "core/motion/rgbd_view.hpp"
#include "core/odometry/direct_level.hpp"

namespace stillpoint {
namespace {

/// Gauss-Newton at one level, from a state to a better one. A step that makes it worse ends it.
DirectLevel::Comparison descend(DirectLevel& level, const Camera& camera, int most_steps, DirectState& state,
                                int& steps) {
  constexpr double kConverged = 0.01;  // px of the level
  constexpr double kUsualDepth = 2.0;  // m: turns a step of the camera into pixels; rooms have about that
  DirectLevel::Comparison current = level.compare(state);
  const double pixels_a_radian = std::ldexp(camera.fx, -level.level());
  for (int i = 0; i < most_steps && current.in_view > 0; ++i) {
    DirectLevel::Equations n = level.equations(state, current);
    n.h.diagonal() += 1e-6 * n.h.diagonal() + Vector8d::Constant(1e-9);
    const Vector8d step = -solve_ldlt(n.h, n.g);
    if (!step.allFinite()) break;
    DirectState next = state;
    // The step moves the reference's points; the target's pose takes its inverse.
    next.target_from_reference = state.target_from_reference * se3_exp(Vector6d(step.head<6>())).inverse();
    next.gain += step[6], next.bias += step[7];
    ++steps;
    const DirectLevel::Comparison then = level.compare(next);
    if (then.in_view < current.in_view / 2 || then.mean_difference >= current.mean_difference) {
      current = level.compare(state);
      break;
    }
    state = next;
    current = then;
    const double moved =
        pixels_a_radian * std::max(step.segment<3>(3).norm(), step.head<3>().norm() / kUsualDepth);
    if (moved < kConverged) break;
  }
  return current;
}

/// The turn about a pose, sideways and up or down, under which single pixels of the coarsest level go
/// together best.
Pose best_turn(const DirectLevel& level, const Camera& camera, const Pose& about) {
  constexpr double kFarthest = 0.2;  // rad: 11°, more than a hand turns between two frames
  const double step = std::ldexp(1.0, level.level()) / camera.fx;
  const int reach = static_cast<int>(kFarthest / step);
  double best = level.correlation_at(about);
  Pose turned = about;
  for (int up = -reach; up <= reach; ++up)
    for (int side = -reach; side <= reach; ++side) {
      Pose candidate = about;
      candidate.prerotate(so3_exp({step * up, step * side, 0.0}));
      const double correlation = level.correlation_at(candidate);
      if (correlation > best) best = correlation, turned = candidate;
    }
  return turned;
}

/// Share of the patches in view at whose place the target measured the depth that is expected there; 1 where
/// it measured none.
double depth_agreement(const std::vector<PatchPoint>& patches, const Pose& target_from_reference,
                       const cv::Mat& depth, const Camera& camera) {
  int measured = 0, agree = 0;
  for (const PatchPoint& patch : patches) {
    const Eigen::Vector3d p = target_from_reference * patch.point;
    if (depth.empty() || p.z() <= 0) continue;
    const Eigen::Vector2d pixel = camera.distort(camera.project(p));
    const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
    if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) continue;
    const float z = depth.at<float>(y, x);
    if (!(z > 0)) continue;
    ++measured;
    agree += same_surface(z, static_cast<float>(p.z())) ? 1 : 0;
  }
  return measured > 0 ? static_cast<double>(agree) / measured : 1.0;
}

/// Information about a perturbation from the right, after gain and bias are put to their best, carried to the
/// left.
Matrix6d information_of(const DirectLevel::Equations& n, const DirectState& state, double scale) {
  Eigen::Matrix2d light = n.h.bottomRightCorner<2, 2>();
  light.diagonal().array() += 1e-9;
  const Eigen::Matrix<double, 6, 2> cross = n.h.topRightCorner<6, 2>();
  const Matrix6d right = n.h.topLeftCorner<6, 6>() - cross * light.inverse() * cross.transpose();
  const Pose inverse = state.target_from_reference.inverse();
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = inverse.linear();
  adjoint.topRightCorner<3, 3>() = hat(inverse.translation()) * inverse.linear();
  const Matrix6d left = scale * adjoint.transpose() * right * adjoint;
  return 0.5 * (left + left.transpose());
}

}  // namespace

DirectAlignment align_directly(const DirectReference& reference, const DirectTarget& target,
                               const std::vector<Pose>& starts, const Camera& camera, const Config& config) {
  constexpr int kCheckLevel = 2;  // where likeness is judged: finer ones are blurred away first
  const DirectConfig& direct = config.direct;
  DirectAlignment result;
  DirectRecord& record = result.record;
  const auto patches = choose_patches(
      reference, camera, camera.readout_s != 0.0 && config.tracking.correct_rolling_shutter, direct.cell_px);
  record.patches = static_cast<int>(patches.size());
  if (record.patches < direct.min_patches || target.gray.size() != reference.gray.size()) return result;
  const GreyPyramid before = grey_pyramid(reference.gray, direct.coarsest_level);
  const GreyPyramid now = grey_pyramid(target.gray, direct.coarsest_level);
  const auto level_of = [&](int wanted) {
    const int level = std::clamp(wanted, 0, static_cast<int>(before.size()) - 1);
    const auto l = static_cast<std::size_t>(level);
    return DirectLevel(patches, before[l], now[l], level, camera, target);
  };

  DirectLevel coarsest = level_of(direct.coarsest_level);
  DirectState state;
  double best = -2.0;
  const auto begin_from = [&](const Pose& start) {
    DirectState candidate{start};
    const auto comparison = descend(coarsest, camera, direct.iterations, candidate, record.iterations);
    if (comparison.in_view == 0 || comparison.correlation <= best) return;
    best = comparison.correlation;
    state = candidate;
  };
  for (const Pose& start : starts) begin_from(start);
  if (best < -1.0) return result;  // none has anything in view
  constexpr double kPlain = 0.9;   // correlation beyond which there is no better place to look for
  if (best < kPlain) begin_from(best_turn(coarsest, camera, starts.back()));

  DirectLevel finest = level_of(direct.finest_level);
  record.rms_before = finest.compare({starts.front(), state.gain, state.bias}).rms;
  for (int level = coarsest.level() - 1; level > finest.level(); --level) {
    DirectLevel between = level_of(level);
    (void)descend(between, camera, direct.iterations, state, record.iterations);
  }
  const auto last = descend(finest, camera, direct.iterations, state, record.iterations);
  const auto checked = level_of(std::max(kCheckLevel, direct.finest_level)).compare(state);

  result.target_from_reference = normalised(state.target_from_reference);
  result.gain = state.gain, result.bias = state.bias;
  result.noise = last.noise;
  result.information =
      information_of(finest.equations(state, last), state, direct.pixel_share / (last.noise * last.noise));
  record.patches = last.in_view;
  record.rms_after = last.rms;
  record.correlation = checked.correlation;
  record.agreement = depth_agreement(patches, state.target_from_reference, target.depth, camera);
  record.seen = std::make_shared<const std::vector<DirectPatch>>(finest.seen(last));
  record.believed = record.patches >= direct.min_patches && record.correlation >= direct.min_correlation &&
                    record.agreement >= direct.min_agreement && result.information.allFinite();
  return result;
}

}  // namespace stillpoint
