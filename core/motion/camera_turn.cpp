#include "core/motion/camera_turn.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/se3.hpp"

namespace stillpoint {
namespace {

constexpr int kRotationSteps = 12, kRoughSteps = 5, kMotionSteps = 10;
constexpr std::size_t kBestStarts = 3;
constexpr int kBestDirections = 3;  // that Gauss-Newton starts from

double geman_mcclure_weight(double squared, double scale) {
  const double q = 1.0 + squared / (scale * scale);
  return 1.0 / (q * q);
}

double geman_mcclure_cost(double squared, double scale) { return squared / (squared + scale * scale); }

double cost_of(std::span<const BearingPair> pairs, const CameraTurn& motion, double scale) {
  double cost = 0.0;
  for (const BearingPair& pair : pairs) {
    const double d = sampson_distance(motion, pair);
    cost += pair.weight * geman_mcclure_cost(d * d, scale);
  }
  return cost;
}

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

struct Linearised {
  Vector5 jacobian;  ///< of the Sampson distance by the rotation and by the direction along u and v
  double distance;
};

Linearised sampson_jacobian(const BearingPair& pair, const Eigen::Matrix3d& rotation,
                            const Eigen::Matrix3d& essential, const Eigen::Vector3d& t,
                            const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const Eigen::Vector3d q = rotation * pair.now;
  const Eigen::Vector3d line = t.cross(q), other = essential.transpose() * pair.then;
  const double slope = std::sqrt(line.head<2>().squaredNorm() + other.head<2>().squaredNorm()) + 1e-12;
  const Eigen::Vector3d normal_of_plane = q.cross(pair.then);
  Linearised result;
  result.jacobian << q.cross(pair.then.cross(t)), u.dot(normal_of_plane), v.dot(normal_of_plane);
  result.jacobian /= slope;
  result.distance = pair.then.dot(line) / slope;
  return result;
}

/// Gauss-Newton over rotation and direction; the Sampson distance's denominator held fixed within a step.
void refine(std::span<const BearingPair> pairs, double first_scale, double last_scale, int steps,
            CameraTurn& motion) {
  double scale = first_scale;
  for (int step = 0; step < steps; ++step, scale = std::max(last_scale, scale * 0.7)) {
    const Eigen::Vector3d t = motion.direction;
    const Eigen::Vector3d u = t.unitOrthogonal(), v = t.cross(u);
    const Eigen::Matrix3d essential = hat(t) * motion.rotation;
    Matrix5 normal = Matrix5::Zero();
    Vector5 right = Vector5::Zero();
    for (const BearingPair& pair : pairs) {
      const auto [jacobian, d] = sampson_jacobian(pair, motion.rotation, essential, t, u, v);
      const double w = pair.weight * geman_mcclure_weight(d * d, scale);
      normal.noalias() += w * jacobian * jacobian.transpose();
      right.noalias() -= w * d * jacobian;
    }
    normal.diagonal().head<3>().array() += 1e-9;
    normal.diagonal().tail<2>().array() += 1e-9 + 1e-4 * normal.diagonal().maxCoeff();
    const Vector5 change = normal.ldlt().solve(right);
    if (!change.allFinite()) return;
    motion.rotation = so3_exp(change.head<3>()) * motion.rotation;
    motion.direction = (t + change(3) * u + change(4) * v).normalized();
  }
}

/// The covariance of the rotation, the direction being unknown as well.
Eigen::Matrix3d covariance_of_rotation(std::span<const BearingPair> pairs, const CameraTurn& motion,
                                       double sigma) {
  const Eigen::Vector3d t = motion.direction;
  const Eigen::Vector3d u = t.unitOrthogonal(), v = t.cross(u);
  const Eigen::Matrix3d essential = hat(t) * motion.rotation;
  Matrix5 normal = 1e-6 * Matrix5::Identity();
  double weights = 0.0;
  for (const BearingPair& pair : pairs) {
    const auto [jacobian, d] = sampson_jacobian(pair, motion.rotation, essential, t, u, v);
    normal.noalias() +=
        pair.weight * geman_mcclure_weight(d * d, 2.0 * sigma) * jacobian * jacobian.transpose();
    weights += pair.weight;
  }
  normal *= static_cast<double>(pairs.size()) / (weights * sigma * sigma);
  return normal.inverse().topLeftCorner<3, 3>();
}

/// Directions through two pairs each: a pair's own plane holds the direction, so two planes meet in it.
std::vector<Eigen::Vector3d> sample_directions(std::span<const BearingPair> pairs,
                                               const Eigen::Matrix3d& rotation,
                                               const CameraTurnOptions& options) {
  std::vector<std::size_t> shifted;
  std::vector<Eigen::Vector3d> planes;
  for (const BearingPair& pair : pairs) {
    const Eigen::Vector3d turned = rotation * pair.now;
    planes.push_back((turned / turned.z()).cross(pair.then));
    if (planes.back().norm() > 2.0 * options.sigma) shifted.push_back(planes.size() - 1);
  }
  std::vector<Eigen::Vector3d> best;
  if (shifted.size() < 8) return best;
  std::vector<std::pair<double, Eigen::Vector3d>> ranked;
  std::mt19937 random(1);
  for (int sample = 0; sample < options.samples; ++sample) {
    const Eigen::Vector3d& a = planes[shifted[random() % shifted.size()]];
    const Eigen::Vector3d& b = planes[shifted[random() % shifted.size()]];
    const Eigen::Vector3d meeting = a.cross(b);
    if (meeting.norm() < 1e-3 * a.norm() * b.norm() || meeting.norm() < 1e-15) continue;
    const CameraTurn motion{.rotation = rotation, .direction = meeting.normalized()};
    ranked.emplace_back(cost_of(pairs, motion, 2.0 * options.sigma), motion.direction);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < ranked.size() && i < kBestDirections; ++i) best.push_back(ranked[i].second);
  return best;
}

/// Points lie in front of the camera: their parallax goes along the direction, not against it.
void orient(std::span<const BearingPair> pairs, double sigma, CameraTurn& motion) {
  double along = 0.0;
  for (const BearingPair& pair : pairs) {
    if (std::abs(sampson_distance(motion, pair)) > 2.0 * sigma) continue;
    const Eigen::Vector3d turned = motion.rotation * pair.now;
    const Eigen::Vector2d p = turned.head<2>() / turned.z();
    const double d = parallax(motion, pair).dot(motion.direction.head<2>() - p * motion.direction.z());
    along += pair.weight * (d > 0 ? 1.0 : -1.0);
  }
  if (along < 0) motion.direction = -motion.direction;
}

/// Whether rotation alone does: most agree with it, and few disagree by as little as parallax would make
/// them.
bool only_turns(std::span<const BearingPair> pairs, const Eigen::Matrix3d& rotation,
                const CameraTurnOptions& options) {
  const CameraTurn turn{.rotation = rotation, .turns_only = true};
  double all = 0.0, agree = 0.0, between = 0.0;
  for (const BearingPair& pair : pairs) {
    const double off = parallax(turn, pair).norm();
    all += pair.weight;
    if (off < 3.0 * options.least_sigma)
      agree += pair.weight;
    else if (off < 12.0 * options.least_sigma)
      between += pair.weight;
  }
  return agree > options.turns_only_share * all && between < options.between_share * all;
}

}  // namespace

Eigen::Matrix3d estimate_rotation(std::span<const BearingPair> pairs, double sigma) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double scale = sigma * 40.0;
  for (int step = 0; step < kRotationSteps; ++step, scale = std::max(2.0 * sigma, scale * 0.6)) {
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const BearingPair& pair : pairs) {
      const Eigen::Vector3d turned = rotation * pair.now;
      const double x = turned.x() / turned.z(), y = turned.y() / turned.z();
      const Eigen::Vector2d off(pair.then.x() - x, pair.then.y() - y);
      const double w = pair.weight * geman_mcclure_weight(off.squaredNorm(), scale);
      Eigen::Matrix<double, 2, 3> jacobian;
      jacobian << -x * y, 1.0 + x * x, -y, -(1.0 + y * y), x * y, x;
      normal.noalias() += w * jacobian.transpose() * jacobian;
      right.noalias() += w * jacobian.transpose() * off;
    }
    rotation = so3_exp(normal.ldlt().solve(right)) * rotation;
  }
  return rotation;
}

double sampson_distance(const CameraTurn& motion, const BearingPair& pair) {
  const Eigen::Vector3d line = motion.direction.cross(motion.rotation * pair.now);
  const Eigen::Vector3d other = motion.rotation.transpose() * (pair.then.cross(motion.direction));
  return pair.then.dot(line) /
         (std::sqrt(line.head<2>().squaredNorm() + other.head<2>().squaredNorm()) + 1e-12);
}

Eigen::Vector2d parallax(const CameraTurn& motion, const BearingPair& pair) {
  const Eigen::Vector3d turned = motion.rotation * pair.now;
  return pair.then.head<2>() - turned.head<2>() / turned.z();
}

Eigen::Vector2d unexplained(const CameraTurn& motion, const BearingPair& pair, double tolerance) {
  const Eigen::Vector2d shift = parallax(motion, pair);
  if (motion.turns_only) return shift;
  const Eigen::Vector3d turned = motion.rotation * pair.now;
  const Eigen::Vector2d line =
      motion.direction.head<2>() - turned.head<2>() / turned.z() * motion.direction.z();
  const double length = line.norm();
  if (length < 1e-12) return shift;
  const Eigen::Vector2d along = line / length, across(-along.y(), along.x());
  const double beside = std::copysign(sampson_distance(motion, pair), shift.dot(across));
  const double behind = std::max(0.0, -shift.dot(along) - tolerance);
  return beside * across - behind * along;
}

double nearness(const CameraTurn& motion, const BearingPair& pair, double& sigma) {
  const Eigen::Vector3d turned = motion.rotation * pair.now;
  const double x = turned.x() / turned.z(), y = turned.y() / turned.z();
  const Eigen::Vector2d line = motion.direction.head<2>() - Eigen::Vector2d(x, y) * motion.direction.z();
  const double length = line.norm();
  sigma = 0.0;
  if (length < 1e-12) return 0.0;
  const Eigen::Vector2d along = line / length;
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << -x * y, 1.0 + x * x, -y, -(1.0 + y * y), x * y, x;
  const Eigen::RowVector3d by_rotation = along.transpose() * jacobian;
  sigma = std::sqrt((by_rotation * motion.rotation_covariance).dot(by_rotation));
  return parallax(motion, pair).dot(along);
}

CameraTurn estimate_camera_turn(std::span<const BearingPair> pairs, const CameraTurnOptions& options,
                                const CameraTurn* hint) {
  CameraTurn best;
  if (pairs.empty()) return best;
  best.rotation = estimate_rotation(pairs, options.sigma);
  best.turns_only = only_turns(pairs, best.rotation, options);
  if (!best.turns_only) {
    const Eigen::Matrix3d rotation = best.rotation;
    std::vector<BearingPair> few;
    for (std::size_t i = 0; i < pairs.size(); i += 2) few.push_back(pairs[i]);
    std::vector<Eigen::Vector3d> starts = sample_directions(few, rotation, options);
    if (hint && !hint->turns_only) starts.push_back(hint->direction);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = 0; z <= 1; ++z)
          if (z == 1 || x == 1 || (x == 0 && y == 1)) starts.push_back(Eigen::Vector3d(x, y, z).normalized());
    std::vector<std::pair<double, CameraTurn>> rough;
    for (const Eigen::Vector3d& start : starts) {
      CameraTurn motion{.rotation = rotation, .direction = start};
      refine(few, 4.0 * options.sigma, 2.0 * options.sigma, kRoughSteps, motion);
      rough.emplace_back(cost_of(few, motion, options.sigma), motion);
    }
    std::stable_sort(rough.begin(), rough.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < rough.size() && i < kBestStarts; ++i) {
      CameraTurn motion = rough[i].second;
      refine(pairs, 3.0 * options.sigma, options.sigma, kMotionSteps, motion);
      const double cost = cost_of(pairs, motion, options.sigma);
      if (cost < least) least = cost, best = motion;
    }
    orient(pairs, options.sigma, best);
    best.rotation_covariance = covariance_of_rotation(pairs, best, options.sigma);
  }
  double all = 0.0, agree = 0.0;
  for (const BearingPair& pair : pairs) {
    all += pair.weight;
    if (unexplained(best, pair, 3.0 * options.sigma).norm() < 3.0 * options.sigma) agree += pair.weight;
  }
  best.explained = all > 0 ? agree / all : 0.0;
  return best;
}

}  // namespace stillpoint
