#include "core/geometry/schur_equations.hpp"

#include <Eigen/LU>
#include <cassert>

#include "core/geometry/normal_equations.hpp"

namespace stillpoint {
namespace {

constexpr double kLeastDamped =
    1e-9;  // in the diagonal's unit: an entry that is 0 still decides, for a step of 0

}  // namespace

void SchurEquations::reset(int poses, int points) {
  poses_.assign(static_cast<std::size_t>(poses), {});
  points_.assign(static_cast<std::size_t>(points), {});
  crosses_.clear();
  last_point_ = 0;
}

void SchurEquations::add(int pose, int point, const Eigen::Matrix3d& rotation, const SightEquations& sight) {
  assert(point >= last_point_);
  last_point_ = point;
  PointPart& part = points_[static_cast<std::size_t>(point)];
  const Eigen::Matrix3d h_rotation = sight.h * rotation;
  part.h.noalias() += rotation.transpose() * h_rotation;
  part.g.noalias() += rotation.transpose() * sight.g;
  if (pose == kFixed) return;
  // ∂p/∂ξ = [I, -hat(p)], and hat(p) is skew: hat(p)ᵀ = -hat(p).
  PosePart& own = poses_[static_cast<std::size_t>(pose)];
  const Eigen::Matrix3d hat_p = hat(sight.p);
  const Eigen::Matrix3d turned = hat_p * sight.h;
  own.h.topLeftCorner<3, 3>() += sight.h;
  own.h.bottomLeftCorner<3, 3>() += turned;
  own.h.bottomRightCorner<3, 3>().noalias() -= turned * hat_p;
  own.g.head<3>() += sight.g;
  own.g.tail<3>() += sight.p.cross(sight.g);
  Cross& cross = crosses_.emplace_back(pose, Cross()).second;
  cross.topRows<3>() = h_rotation;
  cross.bottomRows<3>().noalias() = hat_p * h_rotation;
  ++part.crosses;
}

bool SchurEquations::solve(double damping, Step& step) const {
  const auto size = 6 * static_cast<Eigen::Index>(poses_.size());
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);  // its lower triangle
  Eigen::VectorXd g(size);
  const auto damp = [&](auto& block) {
    block.diagonal().array() += damping * block.diagonal().array() + kLeastDamped;
  };
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    Matrix6d own = poses_[i].h;
    damp(own);
    const auto at = 6 * static_cast<Eigen::Index>(i);
    h.block<6, 6>(at, at) = own;
    g.segment<6>(at) = poses_[i].g;
  }
  std::vector<Eigen::Matrix3d> inverses(points_.size());
  std::size_t begin = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::size_t end = begin + points_[i].crosses;
    Eigen::Matrix3d own = points_[i].h;
    damp(own);
    inverses[i] = own.inverse();
    for (std::size_t a = begin; a < end; ++a) {
      const auto at = 6 * static_cast<Eigen::Index>(crosses_[a].first);
      const Cross gain = crosses_[a].second * inverses[i];
      g.segment<6>(at).noalias() -= gain * points_[i].g;
      for (std::size_t b = begin; b < end; ++b)
        if (crosses_[b].first <= crosses_[a].first)
          h.block<6, 6>(at, 6 * static_cast<Eigen::Index>(crosses_[b].first)).noalias() -=
              gain * crosses_[b].second.transpose();
    }
    begin = end;
  }
  const Eigen::VectorXd change = size > 0 ? Eigen::VectorXd(-solve_ldlt(h, g)) : Eigen::VectorXd();
  bool finite = change.allFinite();
  // With (H + D) δ = -g the equations foresee δᵀHδ + 2 gᵀδ = gᵀδ - δᵀDδ.
  double change_of_cost = 0.0;
  const auto foresee = [&](const auto& part, const auto& delta) {
    change_of_cost += part.g.dot(delta) -
                      (damping * part.h.diagonal().array() + kLeastDamped).matrix().dot(delta.cwiseAbs2());
  };
  step.poses.resize(poses_.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    step.poses[i] = change.segment<6>(6 * static_cast<Eigen::Index>(i));
    foresee(poses_[i], step.poses[i]);
  }
  step.points.resize(points_.size());
  begin = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::size_t end = begin + points_[i].crosses;
    Eigen::Vector3d right = points_[i].g;
    for (std::size_t a = begin; a < end; ++a)
      right.noalias() +=
          crosses_[a].second.transpose() * step.poses[static_cast<std::size_t>(crosses_[a].first)];
    step.points[i] = -(inverses[i] * right);
    finite = finite && step.points[i].allFinite();
    foresee(points_[i], step.points[i]);
    begin = end;
  }
  step.cost_change = change_of_cost;
  return finite;
}

}  // namespace stillpoint
