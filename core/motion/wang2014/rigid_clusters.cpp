#include "core/motion/wang2014/rigid_clusters.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <opencv2/core.hpp>

#include "core/geometry/rotation_fit.hpp"

namespace stillpoint {
namespace {

Eigen::Vector3f at(const Eigen::Vector2f& ray, float z) { return {ray.x() * z, ray.y() * z, z}; }

/// Whether three points span a plane well enough to fix a rotation.
bool well_spread(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  constexpr float kLeastArea = 1e-4F;  // m²: a centimetre square
  return (b - a).cross(c - a).norm() > kLeastArea;
}

int count_of(const std::vector<std::uint8_t>& set) {
  return static_cast<int>(std::count(set.begin(), set.end(), std::uint8_t{1}));
}

}  // namespace

std::optional<Pose> rigid_motion(std::span<const Eigen::Vector3f> from, std::span<const Eigen::Vector3f> to) {
  if (from.size() < 3) return std::nullopt;
  Eigen::Vector3d middle_from = Eigen::Vector3d::Zero(), middle_to = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    middle_from += from[i].cast<double>(), middle_to += to[i].cast<double>();
  middle_from /= static_cast<double>(from.size()), middle_to /= static_cast<double>(from.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    spread += (to[i].cast<double>() - middle_to) * (from[i].cast<double>() - middle_from).transpose();
  Pose motion = Pose::Identity();
  motion.linear() = fit_rotation(spread).rotation;
  motion.translation() = middle_to - motion.linear() * middle_from;
  if (!motion.matrix().allFinite()) return std::nullopt;
  return motion;
}

std::vector<std::uint8_t> explained_by(const Pose& motion, std::span<const ScenePair> pairs,
                                       const SceneFlowNoise& noise, double sigmas) {
  const CameraMotion camera(motion);
  std::vector<std::uint8_t> explained;
  explained.reserve(pairs.size());
  for (const ScenePair& pair : pairs) {
    const ResidualMotion residual = residual_motion(pair, camera, noise);
    explained.push_back(residual.motion.norm() <= static_cast<float>(sigmas) * residual.sigma() ? 1 : 0);
  }
  return explained;
}

RigidFit fit_rigid(std::span<const ScenePair> pairs, const SceneFlowNoise& noise, double sigmas, int samples,
                   std::uint32_t seed) {
  RigidFit best;
  if (pairs.size() < 3) return best;
  std::vector<Eigen::Vector3f> from, to;
  for (const ScenePair& pair : pairs)
    from.push_back(at(pair.ray_last, pair.z_last)), to.push_back(at(pair.ray_here, pair.z_here));
  // Some of the pairs, evenly chosen, tell samples apart; all of them count in the end.
  constexpr std::size_t kAsked = 150;
  std::vector<ScenePair> asked;
  for (std::size_t i = 0; i < pairs.size(); i += 1 + (pairs.size() - 1) / kAsked) asked.push_back(pairs[i]);
  const auto offer = [&](std::span<const Eigen::Vector3f> some_from, std::span<const Eigen::Vector3f> some_to,
                         std::span<const ScenePair> by) {
    const auto motion = rigid_motion(some_from, some_to);
    if (!motion) return;
    const int count = count_of(explained_by(*motion, by, noise, sigmas));
    if (!best.found || count > best.explained) best = {true, *motion, count};
  };
  cv::RNG random(seed + 1U);
  for (int sample = 0; sample < samples; ++sample) {
    std::array<Eigen::Vector3f, 3> a, b;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(random.uniform(0, static_cast<int>(pairs.size())));
      a[k] = from[i], b[k] = to[i];
    }
    if (well_spread(a[0], a[1], a[2])) offer(a, b, asked);
  }
  if (best.found) best.explained = count_of(explained_by(best.motion, pairs, noise, sigmas));
  for (int round = 0; round < 2 && best.found; ++round) {
    const std::vector<std::uint8_t> explained = explained_by(best.motion, pairs, noise, sigmas);
    std::vector<Eigen::Vector3f> agreeing_from, agreeing_to;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (explained[i] != 0) agreeing_from.push_back(from[i]), agreeing_to.push_back(to[i]);
    offer(agreeing_from, agreeing_to, pairs);
  }
  return best;
}

double explained_share(const Pose& motion, std::span<const ScenePair> pairs, std::span<const int> cluster,
                       int which, const SceneFlowNoise& noise, double sigmas) {
  const std::vector<std::uint8_t> explained = explained_by(motion, pairs, noise, sigmas);
  int all = 0, good = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (cluster[i] == which) ++all, good += explained[i];
  return all == 0 ? 0.0 : static_cast<double>(good) / all;
}

MergedClusters merge_clusters(std::span<const ScenePair> pairs, std::span<const int> cluster, int clusters,
                              const SceneFlowNoise& noise, const Wang2014Config& config) {
  MergedClusters result;
  for (int c = 0; c < clusters; ++c) {
    std::vector<ScenePair> own;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (cluster[i] == c) own.push_back(pairs[i]);
    result.motions.push_back(
        fit_rigid(own, noise, config.merge_sigmas, config.ransac_samples, static_cast<std::uint32_t>(c)));
  }
  result.merged.resize(static_cast<std::size_t>(clusters));
  std::iota(result.merged.begin(), result.merged.end(), 0);
  for (int a = 0; a < clusters; ++a)
    for (int b = a + 1; b < clusters; ++b) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      if (!result.motions[i].found || !result.motions[j].found || result.merged[i] == result.merged[j])
        continue;
      const double b_by_a = explained_share(result.motions[i].motion, pairs, cluster, b, noise,
                                            config.merge_sigmas),
                   a_by_b = explained_share(result.motions[j].motion, pairs, cluster, a, noise,
                                            config.merge_sigmas);
      if (b_by_a <= config.merge_share || a_by_b <= config.merge_share) continue;
      const int first = std::min(result.merged[i], result.merged[j]),
                other = std::max(result.merged[i], result.merged[j]);
      std::replace(result.merged.begin(), result.merged.end(), other, first);
    }
  return result;
}

}  // namespace stillpoint
