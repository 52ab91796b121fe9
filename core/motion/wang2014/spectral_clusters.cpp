#include "core/motion/wang2014/spectral_clusters.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/motion/wang2014/rigid_clusters.hpp"

namespace stillpoint {

double affinity(double speed, double distance, const Wang2014Config& config) {
  const double half = config.half_speed * config.half_distance_m, now = speed * distance;
  return std::exp(-std::numbers::ln2 * (now * now) / (half * half));
}

std::vector<Velocities> residual_velocities(const TrajectorySet& set, std::span<const int> chosen,
                                            const SceneFlowNoise& noise, const Wang2014Config& config) {
  const int frames = static_cast<int>(set.timestamps.size()), span = config.velocity_frames;
  std::vector<Velocities> all(chosen.size());
  for (int back = 0; back + span < frames; ++back) {
    const auto newest = static_cast<std::size_t>(frames - 1 - back);
    const double seconds = set.timestamps[newest] - set.timestamps[newest - static_cast<std::size_t>(span)];
    std::vector<ScenePair> pairs;
    std::vector<std::size_t> whose;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      all[i].emplace_back();
      const auto trajectory = static_cast<std::size_t>(chosen[i]);
      const TrajectoryPoint *now = set.back(trajectory, back), *before = set.back(trajectory, back + span);
      if (before == nullptr || !now->measured() || !before->measured()) continue;
      pairs.push_back({before->ray, now->ray, before->z, now->z});
      whose.push_back(i);
    }
    const RigidFit shared =
        fit_rigid(pairs, noise, config.merge_sigmas, config.ransac_samples, static_cast<std::uint32_t>(back));
    if (!shared.found || !(seconds > 0.0)) continue;
    const CameraMotion camera(shared.motion);
    const auto rate = static_cast<float>(1.0 / seconds);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const ResidualMotion residual = residual_motion(pairs[k], camera, noise);
      all[whose[k]].back() = {true, residual.motion * rate, residual.covariance * (rate * rate)};
    }
  }
  return all;
}

double speed_difference(const Velocities& a, const Velocities& b, double noise_sigmas) {
  double largest = -1.0;
  for (std::size_t t = 0; t < std::min(a.size(), b.size()); ++t) {
    if (!a[t].valid || !b[t].valid) continue;
    const Eigen::Vector3f apart = a[t].velocity - b[t].velocity;
    const float squared = apart.squaredNorm();
    double excess = 0.0;
    if (squared > 0.0F) {
      const float variance = apart.dot((a[t].covariance + b[t].covariance) * apart) / squared;
      excess =
          std::sqrt(static_cast<double>(squared)) - noise_sigmas * std::sqrt(static_cast<double>(variance));
    }
    largest = std::max({largest, excess, 0.0});
  }
  return largest;
}

double mean_distance(const PointTrajectory& a, const PointTrajectory& b) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t back = 1; back <= std::min(a.size(), b.size()); ++back) {
    const TrajectoryPoint &p = a[a.size() - back], &q = b[b.size() - back];
    if (!p.measured() || !q.measured()) continue;
    sum += static_cast<double>((p.position() - q.position()).norm());
    ++count;
  }
  return count == 0 ? -1.0 : sum / count;
}

std::vector<AffinityEdge> affinity_edges(const TrajectorySet& set, std::span<const int> chosen,
                                         std::span<const Velocities> velocities,
                                         const Wang2014Config& config) {
  const int n = static_cast<int>(chosen.size());
  const auto trajectory = [&](int i) -> const PointTrajectory& {
    return set.all[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
  };
  std::vector<std::pair<int, int>> pairs;
  std::vector<std::pair<float, int>> near;
  for (int i = 0; i < n; ++i) {
    near.clear();
    for (int j = 0; j < n; ++j) {
      const cv::Point2f apart = trajectory(i).back().small - trajectory(j).back().small;
      if (j != i) near.emplace_back(apart.dot(apart), j);
    }
    const auto kept =
        static_cast<std::ptrdiff_t>(std::min(near.size(), static_cast<std::size_t>(config.neighbours)));
    std::partial_sort(near.begin(), near.begin() + kept, near.end());
    for (auto other = near.begin(); other != near.begin() + kept; ++other)
      pairs.emplace_back(std::min(i, other->second), std::max(i, other->second));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<AffinityEdge> edges;
  for (const auto& [a, b] : pairs) {
    const double speed = speed_difference(velocities[static_cast<std::size_t>(a)],
                                          velocities[static_cast<std::size_t>(b)], config.noise_sigmas);
    const double distance = mean_distance(trajectory(a), trajectory(b));
    const double weight = speed < 0.0 || distance < 0.0 ? 0.0 : affinity(speed, distance, config);
    edges.push_back({a, b, std::max(weight, config.least_affinity)});
  }
  return edges;
}

Spectrum laplacian_spectrum(int points, std::span<const AffinityEdge> edges, int count) {
  Eigen::VectorXd degree = Eigen::VectorXd::Zero(points);
  for (const AffinityEdge& edge : edges) degree[edge.a] += edge.weight, degree[edge.b] += edge.weight;
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Identity(points, points);
  for (const AffinityEdge& edge : edges)
    if (edge.weight > 0.0)
      laplacian(edge.a, edge.b) = laplacian(edge.b, edge.a) =
          -edge.weight / std::sqrt(degree[edge.a] * degree[edge.b]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian);
  const int kept = std::min(count, points);
  Spectrum spectrum{solver.eigenvalues().head(kept), solver.eigenvectors().leftCols(kept)};
  for (int c = 0; c < kept; ++c) {
    Eigen::Index largest = 0;
    spectrum.vectors.col(c).cwiseAbs().maxCoeff(&largest);
    if (spectrum.vectors(largest, c) < 0.0) spectrum.vectors.col(c) *= -1.0;
  }
  return spectrum;
}

int clusters_by_eigengap(const Eigen::VectorXd& values, int least, int most) {
  int best = 1;
  double widest = -1.0;
  for (int k = std::max(1, least); k <= most && k < values.size(); ++k)
    if (const double gap = values[k] - values[k - 1]; gap > widest) widest = gap, best = k;
  return best;
}

std::vector<int> cluster_rows(const Eigen::MatrixXd& vectors, int k) {
  constexpr int kRounds = 50;  // of k-means at most: it ends where no row changes its cluster
  const Eigen::Index n = vectors.rows();
  std::vector<int> cluster(static_cast<std::size_t>(n), 0);
  if (n == 0 || k <= 1) return cluster;
  Eigen::MatrixXd rows = vectors.leftCols(k);
  for (Eigen::Index i = 0; i < n; ++i)
    if (const double length = rows.row(i).norm(); length > 0.0) rows.row(i) /= length;
  Eigen::MatrixXd centres(k, k);
  Eigen::VectorXd distance = (rows.rowwise() - rows.colwise().mean()).rowwise().squaredNorm();
  for (int c = 0; c < k; ++c) {
    Eigen::Index farthest = 0;
    distance.maxCoeff(&farthest);
    centres.row(c) = rows.row(farthest);
    const Eigen::VectorXd to_it = (rows.rowwise() - centres.row(c)).rowwise().squaredNorm();
    distance = c == 0 ? to_it : distance.cwiseMin(to_it);
  }
  for (int round = 0; round < kRounds; ++round) {
    bool changed = round == 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::Index nearest = 0;
      (centres.rowwise() - rows.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
      int& own = cluster[static_cast<std::size_t>(i)];
      changed = changed || own != static_cast<int>(nearest);
      own = static_cast<int>(nearest);
    }
    if (!changed) break;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(k, k);
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(k);
    for (Eigen::Index i = 0; i < n; ++i) {
      const int own = cluster[static_cast<std::size_t>(i)];
      sums.row(own) += rows.row(i);
      counts[own] += 1.0;
    }
    for (int c = 0; c < k; ++c)
      if (counts[c] > 0.0) centres.row(c) = sums.row(c) / counts[c];
  }
  std::vector<int> size(static_cast<std::size_t>(k), 0), order(static_cast<std::size_t>(k)),
      number(order.size());
  for (const int own : cluster) ++size[static_cast<std::size_t>(own)];
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return size[static_cast<std::size_t>(a)] > size[static_cast<std::size_t>(b)];
  });
  for (int c = 0; c < k; ++c) number[static_cast<std::size_t>(order[static_cast<std::size_t>(c)])] = c;
  for (int& own : cluster) own = number[static_cast<std::size_t>(own)];
  return cluster;
}

}  // namespace stillpoint
