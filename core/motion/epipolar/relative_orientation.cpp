#include "core/motion/epipolar/relative_orientation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/normal_equations.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {
namespace {

// Gauss-Newton steps: of a rotation, whose scale shrinks at each; of starts that are only compared; of the
// best, which are finished.
constexpr int kRotationSteps = 12, kRoughSteps = 5, kMotionSteps = 10;
constexpr std::size_t kBestStarts = 3;  // of the rough ones that are finished: the best need not end best
constexpr int kBestDirections = 3;      // that Gauss-Newton starts from

double geman_mcclure_weight(double squared, double scale) {
  const double q = 1.0 + squared / (scale * scale);
  return 1.0 / (q * q);
}

double geman_mcclure_cost(double squared, double scale) { return squared / (squared + scale * scale); }

using Vector8 = Eigen::Matrix<double, 8, 1>;
using Matrix8 = Eigen::Matrix<double, 8, 8>;

/// `now` as a frame taken all at once would show it, turned as `then` was.
Eigen::Vector3d turned(const RelativeOrientation& motion, const BearingPair& pair) {
  return motion.rotation * (pair.now - pair.after_middle * motion.rate.cross(pair.now));
}

/// What a small rotation and a small rate change, of which `by_turned` is the change with the turned bearing.
Eigen::Matrix<double, 6, 1> by_rotation_and_rate(const RelativeOrientation& motion, const BearingPair& pair,
                                                 const Eigen::Vector3d& turned,
                                                 const Eigen::Vector3d& by_turned) {
  Eigen::Matrix<double, 6, 1> result;
  result << turned.cross(by_turned),
      -pair.after_middle * pair.now.cross(motion.rotation.transpose() * by_turned);
  return result;
}

/// A residual and its change with rotation, rate, and the direction along two vectors across it.
struct Linearised {
  Vector8 jacobian = Vector8::Zero();
  double distance = 0.0;
};

/// Off the epipolar line; the Sampson distance's denominator is taken as fixed.
Linearised off_line(const BearingPair& pair, const RelativeOrientation& motion,
                    const Eigen::Matrix3d& essential, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const Eigen::Vector3d& t = motion.direction;
  const Eigen::Vector3d q = turned(motion, pair);
  const Eigen::Vector3d line = t.cross(q), other = essential.transpose() * pair.then;
  const double slope = std::sqrt(line.head<2>().squaredNorm() + other.head<2>().squaredNorm()) + 1e-12;
  const Eigen::Vector3d plane = q.cross(pair.then);
  Linearised result;
  result.jacobian << by_rotation_and_rate(motion, pair, q, pair.then.cross(t)), u.dot(plane), v.dot(plane);
  result.jacobian /= slope;
  result.distance = pair.then.dot(line) / slope;
  return result;
}

/// Along the epipolar line: the parallax, below 0 behind infinity. The direction is taken as fixed.
Linearised along_line(const BearingPair& pair, const RelativeOrientation& motion) {
  const Eigen::Vector3d q = turned(motion, pair);
  const Eigen::Vector2d at = q.head<2>() / q.z();
  const Eigen::Vector2d line = motion.direction.head<2>() - at * motion.direction.z();
  const double length = line.norm();
  if (length < 1e-12) return {};
  const Eigen::Vector2d along = line / length;
  const Eigen::Vector3d by_turned = Eigen::Vector3d(-along.x(), -along.y(), along.dot(at)) / q.z();
  Linearised result;
  result.distance = (pair.then.head<2>() - at).dot(along);
  result.jacobian.head<6>() = by_rotation_and_rate(motion, pair, q, by_turned);
  return result;
}

double weight_of(std::span<const BearingPair> pairs) {
  double all = 0.0;
  for (const BearingPair& pair : pairs) all += pair.weight;
  return all;
}

/// What is known of the rate beforehand, in the units of the pairs' own say.
double rate_stiffness(std::span<const BearingPair> pairs, const RelativeOrientationOptions& options) {
  if (options.rate_sigma <= 0.0) return 1e6;  // held where it is, whatever the pairs say
  const double ratio = options.sigma / options.rate_sigma;
  return weight_of(pairs) / static_cast<double>(pairs.size()) * ratio * ratio;
}

/// Places behind infinity count beside those off their lines: what is static lies before the camera.
double cost_of(std::span<const BearingPair> pairs, const RelativeOrientation& motion,
               const RelativeOrientationOptions& options) {
  double cost = rate_stiffness(pairs, options) * motion.rate.squaredNorm() / (options.sigma * options.sigma);
  for (const BearingPair& pair : pairs)
    cost +=
        pair.weight * geman_mcclure_cost(epipolar_residual(motion, pair, 0.0).squaredNorm(), options.sigma);
  return cost;
}

/// The normal equations of one step.
/// @param sided whether the sign of the direction is to be relied on, so that places behind infinity
/// count
void linearise(std::span<const BearingPair> pairs, const RelativeOrientation& motion, double scale,
               bool sided, const Eigen::Vector3d& u, const Eigen::Vector3d& v, Matrix8& normal,
               Vector8& right) {
  const Eigen::Matrix3d essential = hat(motion.direction) * motion.rotation;
  normal.setZero();
  right.setZero();
  for (const BearingPair& pair : pairs) {
    const Linearised off = off_line(pair, motion, essential, u, v);
    Linearised along;
    if (sided) along = along_line(pair, motion);
    const double behind = std::min(0.0, along.distance);
    const double w = pair.weight * geman_mcclure_weight(off.distance * off.distance + behind * behind, scale);
    normal.noalias() += w * off.jacobian * off.jacobian.transpose();
    right.noalias() -= w * off.distance * off.jacobian;
    if (behind == 0.0) continue;
    normal.noalias() += w * along.jacobian * along.jacobian.transpose();
    right.noalias() -= w * behind * along.jacobian;
  }
}

/// Gauss-Newton over rotation, rate and direction.
void refine(std::span<const BearingPair> pairs, double first_scale, double last_scale, int steps, bool sided,
            const RelativeOrientationOptions& options, RelativeOrientation& motion) {
  const double stiffness = rate_stiffness(pairs, options);
  double scale = first_scale;
  Matrix8 normal;
  Vector8 right;
  for (int step = 0; step < steps; ++step, scale = std::max(last_scale, scale * 0.7)) {
    const Eigen::Vector3d t = motion.direction;
    const Eigen::Vector3d u = t.unitOrthogonal(), v = t.cross(u);
    linearise(pairs, motion, scale, sided, u, v, normal, right);
    normal.diagonal().segment<3>(3).array() += stiffness;
    right.segment<3>(3) -= stiffness * motion.rate;
    normal.diagonal().head<3>().array() += 1e-9;
    normal.diagonal().tail<2>().array() += 1e-9 + 1e-4 * normal.diagonal().head<3>().maxCoeff();
    const Vector8 change = solve_ldlt(normal, right);
    if (!change.allFinite()) return;
    motion.rotation = so3_exp(change.head<3>()) * motion.rotation;
    if (options.rate_sigma > 0.0) motion.rate += change.segment<3>(3);
    motion.direction = (t + change(6) * u + change(7) * v).normalized();
  }
}

/// The covariance of rotation and rate, the direction being unknown as well.
Eigen::Matrix<double, 6, 6> covariance_of(std::span<const BearingPair> pairs,
                                          const RelativeOrientation& motion,
                                          const RelativeOrientationOptions& options) {
  const Eigen::Vector3d u = motion.direction.unitOrthogonal(), v = motion.direction.cross(u);
  Matrix8 normal;
  Vector8 right;
  linearise(pairs, motion, 2.0 * options.sigma, false, u, v, normal, right);
  normal.diagonal().segment<3>(3).array() += rate_stiffness(pairs, options);
  const double information =
      static_cast<double>(pairs.size()) / (weight_of(pairs) * options.sigma * options.sigma);
  normal = information * normal + Matrix8::Identity();  // none is off by a radian
  return normal.inverse().topLeftCorner<6, 6>();
}

/// Directions through two pairs each: a pair's own plane holds the direction, so two planes meet in it.
std::vector<Eigen::Vector3d> sample_directions(std::span<const BearingPair> pairs,
                                               const Eigen::Matrix3d& rotation,
                                               const RelativeOrientationOptions& options) {
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
    const RelativeOrientation motion{.rotation = rotation, .direction = meeting.normalized()};
    double cost = 0.0;
    for (const BearingPair& pair : pairs) {
      const double off = sampson_distance(motion, pair);
      cost += pair.weight * geman_mcclure_cost(off * off, 2.0 * options.sigma);
    }
    ranked.emplace_back(cost, motion.direction);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < ranked.size() && i < kBestDirections; ++i) best.push_back(ranked[i].second);
  return best;
}

/// Whether rotation alone does: most agree with it, and few disagree by as little as parallax would make
/// them.
bool rotates_only(std::span<const BearingPair> pairs, const Eigen::Matrix3d& rotation,
                  const RelativeOrientationOptions& options) {
  const RelativeOrientation turn{.rotation = rotation, .rotation_only = true};
  double all = 0.0, agree = 0.0, between = 0.0;
  for (const BearingPair& pair : pairs) {
    const double off = parallax(turn, pair).norm();
    all += pair.weight;
    if (off < 3.0 * options.least_sigma)
      agree += pair.weight;
    else if (off < 12.0 * options.least_sigma)
      between += pair.weight;
  }
  return agree > options.rotation_only_share * all && between < options.between_share * all;
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
    rotation = so3_exp(solve_ldlt(normal, right)) * rotation;
  }
  return rotation;
}

double sampson_distance(const RelativeOrientation& motion, const BearingPair& pair) {
  const Eigen::Vector3d line = motion.direction.cross(turned(motion, pair));
  const Eigen::Vector3d other = motion.rotation.transpose() * (pair.then.cross(motion.direction));
  return pair.then.dot(line) /
         (std::sqrt(line.head<2>().squaredNorm() + other.head<2>().squaredNorm()) + 1e-12);
}

Eigen::Vector2d parallax(const RelativeOrientation& motion, const BearingPair& pair) {
  const Eigen::Vector3d q = turned(motion, pair);
  return pair.then.head<2>() - q.head<2>() / q.z();
}

Eigen::Vector2d epipolar_residual(const RelativeOrientation& motion, const BearingPair& pair,
                                  double tolerance) {
  const Eigen::Vector2d shift = parallax(motion, pair);
  if (motion.rotation_only) return shift;
  const Eigen::Vector2d at = pair.then.head<2>() - shift;
  const Eigen::Vector2d line = motion.direction.head<2>() - at * motion.direction.z();
  const double length = line.norm();
  if (length < 1e-12) return shift;
  const Eigen::Vector2d along = line / length, across(-along.y(), along.x());
  const double beside = std::copysign(sampson_distance(motion, pair), shift.dot(across));
  const double behind = std::max(0.0, -shift.dot(along) - tolerance);
  return beside * across - behind * along;
}

double nearness(const RelativeOrientation& motion, const BearingPair& pair, double& sigma) {
  const Linearised along = along_line(pair, motion);
  const Eigen::Matrix<double, 6, 1> by = along.jacobian.head<6>();
  sigma = std::sqrt(std::max(0.0, by.dot(motion.covariance * by)));
  return along.distance;
}

RelativeOrientation estimate_relative_orientation(std::span<const BearingPair> pairs,
                                                  const RelativeOrientationOptions& options,
                                                  const RelativeOrientation* hint) {
  RelativeOrientation best;
  if (pairs.empty()) return best;
  best.rotation = estimate_rotation(pairs, options.sigma);
  best.rotation_only = rotates_only(pairs, best.rotation, options);
  if (!best.rotation_only) {
    const Eigen::Matrix3d rotation = best.rotation;
    std::vector<BearingPair> few;
    for (std::size_t i = 0; i < pairs.size(); i += 2) few.push_back(pairs[i]);
    std::vector<Eigen::Vector3d> starts = sample_directions(few, rotation, options);
    if (hint && !hint->rotation_only) starts.push_back(hint->direction);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = 0; z <= 1; ++z)
          if (z == 1 || x == 1 || (x == 0 && y == 1)) starts.push_back(Eigen::Vector3d(x, y, z).normalized());
    std::vector<std::pair<double, RelativeOrientation>> rough;
    for (const Eigen::Vector3d& start : starts) {
      RelativeOrientation motion{.rotation = rotation, .direction = start};
      refine(few, 4.0 * options.sigma, 2.0 * options.sigma, kRoughSteps, false, options, motion);
      rough.emplace_back(cost_of(few, motion, options), motion);
      motion.direction = -motion.direction;
      rough.emplace_back(cost_of(few, motion, options), motion);
    }
    std::stable_sort(rough.begin(), rough.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < rough.size() && i < kBestStarts; ++i) {
      RelativeOrientation motion = rough[i].second;
      refine(pairs, 3.0 * options.sigma, options.sigma, kMotionSteps, true, options, motion);
      const double cost = cost_of(pairs, motion, options);
      if (cost < least) least = cost, best = motion;
    }
    best.covariance = covariance_of(pairs, best, options);
  }
  double all = 0.0, agree = 0.0;
  for (const BearingPair& pair : pairs) {
    all += pair.weight;
    if (epipolar_residual(best, pair, 3.0 * options.sigma).norm() < 3.0 * options.sigma) agree += pair.weight;
  }
  best.explained = all > 0 ? agree / all : 0.0;
  return best;
}

}  // namespace stillpoint
