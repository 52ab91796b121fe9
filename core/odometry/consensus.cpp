#include "core/odometry/consensus.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace stillpoint {
namespace {

constexpr int kCell = 80;              // px: a part of the image that shares its vote
constexpr double kFairShare = 6.0;     // observations a part may have before they weigh less each
constexpr double kNearestShare = 0.3;  // of a vote, for what is much nearer than the rest
constexpr double kBoundPx = 1.5;       // at octave 0: beyond it an observation disagrees, however far
constexpr double kRigidTolerance =
    0.01;                             // m, and this share of the distance: three points of one rigid scene
constexpr double kRigidShare = 0.02;  // … this one
constexpr double kRigidSigmas = 2.0;  // … and of a stereo pair's depths, standard deviations

/// The depth (m) on either side of which lies half of the votes, which the parts of the image share: most
/// observations may well be on one thing.
double usual_depth(const std::vector<PoseObservation>& observations, const std::vector<double>& votes) {
  std::vector<std::pair<double, double>> by_depth;  // with its vote
  by_depth.reserve(observations.size());
  double all = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (observations[i].depth <= 0) continue;
    by_depth.emplace_back(observations[i].depth, votes[i]);
    all += votes[i];
  }
  std::sort(by_depth.begin(), by_depth.end());
  double nearer = 0.0;
  for (const auto& [depth, vote] : by_depth) {
    nearer += vote;
    if (2 * nearer >= all) return depth;
  }
  return 1.0;
}

std::vector<double> weights_by_place(const Camera& camera, const std::vector<PoseObservation>& observations) {
  const int columns = camera.width / kCell + 1, rows = camera.height / kCell + 1;
  const auto cell = [&](const PoseObservation& o) {
    const int c = std::clamp(static_cast<int>(o.pixel.x()) / kCell, 0, columns - 1);
    const int r = std::clamp(static_cast<int>(o.pixel.y()) / kCell, 0, rows - 1);
    return static_cast<std::size_t>(r * columns + c);
  };
  std::vector<int> counts(static_cast<std::size_t>(columns * rows), 0);
  for (const auto& o : observations) ++counts[cell(o)];
  std::vector<double> weights;
  weights.reserve(observations.size());
  for (const auto& o : observations) weights.push_back(std::min(1.0, kFairShare / counts[cell(o)]));
  const double usual = usual_depth(observations, weights);
  double sum = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    // Movers stand before the background, hardly ever behind it.
    const double depth = observations[i].depth;
    if (depth > 0) weights[i] *= std::clamp(depth / usual, kNearestShare, 1.0);
    sum += weights[i];
  }
  for (double& w : weights) w /= sum;
  return weights;
}

/// Squared error over the squared bound, at most 1.
double truncated(const Camera& camera, const PoseObservation& o, const Pose& pose) {
  const Eigen::Vector3d p = pose * o.point_in_world;
  if (p.z() < 0.05) return 1.0;
  const double bound = kBoundPx * std::sqrt(o.sigma_px);
  return std::min(1.0, (camera.project(p) - o.pixel).squaredNorm() / (bound * bound));
}

double cost_of(const Camera& camera, const std::vector<PoseObservation>& observations,
               const std::vector<double>& weights, const Pose& pose, double give_up) {
  double cost = 0.0;
  for (std::size_t i = 0; i < observations.size() && cost < give_up; ++i)
    cost += weights[i] * truncated(camera, observations[i], pose);
  return cost;
}

/// The rigid motion that lays three points on three others (Kabsch).
Pose align_three(const std::array<Eigen::Vector3d, 3>& from, const std::array<Eigen::Vector3d, 3>& to) {
  const Eigen::Vector3d from_mean = (from[0] + from[1] + from[2]) / 3.0,
                        to_mean = (to[0] + to[1] + to[2]) / 3.0;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) spread += (to[i] - to_mean) * (from[i] - from_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  Pose pose = Pose::Identity();
  pose.linear() = svd.matrixU() * mirror * svd.matrixV().transpose();
  pose.translation() = to_mean - pose.linear() * from_mean;
  return pose;
}

/// Three points keep their distances only if they move together: mixed samples are refused before they cost
/// anything.
bool rigid(const Camera& camera, const std::array<Eigen::Vector3d, 3>& world,
           const std::array<Eigen::Vector3d, 3>& seen) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double a = (world[i] - world[j]).norm(), b = (seen[i] - seen[j]).norm();
    const double noise = kRigidSigmas * (camera.stereo_sigma(seen[i].z()) + camera.stereo_sigma(seen[j].z()));
    if (a < 0.05 || std::abs(a - b) > kRigidTolerance + kRigidShare * a + noise) return false;
  }
  return true;
}

/// Least squares over what agrees, a few times: from a rough sample to the pose it stands for.
Pose polished(const Camera& camera, const std::vector<PoseObservation>& observations, Pose pose) {
  TrackingConfig plain;
  plain.refine_rounds = 1;
  plain.refine_iterations = 3;
  for (const double loosened : {2.5, 1.3}) {
    std::vector<PoseObservation> agreeing;
    agreeing.reserve(observations.size());
    for (const PoseObservation& o : observations) {
      const Eigen::Vector3d p = pose * o.point_in_world;
      const double bound = loosened * kBoundPx * std::sqrt(o.sigma_px);
      if (p.z() > 0.05 && (camera.project(p) - o.pixel).norm() < bound) agreeing.push_back(o);
    }
    if (agreeing.size() < 6) return pose;
    pose = refine_pose(camera, agreeing, pose, plain).camera_from_world;
  }
  return pose;
}

}  // namespace

Consensus consensus_pose(const Camera& camera, const std::vector<PoseObservation>& observations,
                         const std::vector<Pose>& guesses, int samples, std::uint32_t seed) {
  constexpr double kPromising =
      1.25;  // a rough sample this much worse than the best may still polish to better
  Consensus best;
  best.cost = std::numeric_limits<double>::infinity();
  if (observations.empty()) return best;
  const std::vector<double> weights = weights_by_place(camera, observations);
  const auto offer = [&](const Pose& pose) {
    const double cost = cost_of(camera, observations, weights, pose, best.cost);
    if (cost >= best.cost) return;
    best.camera_from_world = pose;
    best.cost = cost;
  };
  for (const Pose& guess : guesses) {
    offer(guess);
    offer(polished(camera, observations, guess));
  }

  std::vector<std::size_t> with_depth;
  with_depth.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (observations[i].depth > 0) with_depth.push_back(i);
  std::mt19937 random(seed);
  for (int s = 0; s < samples && with_depth.size() >= 3; ++s) {
    std::array<Eigen::Vector3d, 3> world, in_camera;
    for (std::size_t k = 0; k < 3; ++k) {
      const PoseObservation& o = observations[with_depth[random() % with_depth.size()]];
      world[k] = o.point_in_world;
      in_camera[k] = camera.back_project(o.pixel, o.depth);
    }
    if (!rigid(camera, world, in_camera)) continue;
    const Pose rough = align_three(world, in_camera);
    if (cost_of(camera, observations, weights, rough, kPromising * best.cost) >= kPromising * best.cost)
      continue;
    offer(polished(camera, observations, rough));
  }
  best.inlier.reserve(observations.size());
  for (const PoseObservation& o : observations) {
    best.inlier.push_back(truncated(camera, o, best.camera_from_world) < 1.0);
    best.inliers += best.inlier.back();
  }
  return best;
}

}  // namespace stillpoint
