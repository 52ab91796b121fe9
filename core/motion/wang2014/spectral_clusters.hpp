#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/motion/wang2014/trajectories.hpp"

namespace stillpoint {

// Spectral clustering of trajectories for method `wang2014`. (Ochs, Malik & Brox, TPAMI 2014.)

/// exp(-λ v² D²), with λ such that it is a half at half_speed and half_distance_m.
/// @param speed m/s, difference of two velocities; @param distance m, between the points
[[nodiscard]] double affinity(double speed, double distance, const Wang2014Config& config);

/// A trajectory's velocities beside the motion that most trajectories share: for each frame of the window,
/// newest first, what remains of its way over the velocity_frames before. Invalid where it was not measured
/// at both ends.
struct ResidualVelocity {
  bool valid = false;
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();    ///< m/s
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();  ///< (m/s)²
};
using Velocities = std::vector<ResidualVelocity>;
[[nodiscard]] std::vector<Velocities> residual_velocities(const TrajectorySet& set,
                                                          std::span<const int> chosen,
                                                          const SceneFlowNoise& noise,
                                                          const Wang2014Config& config);

/// The largest difference of two trajectories' velocities at one time, less noise_sigmas of its deviation and
/// not below 0, m/s; -1 where there is no time at which both are known.
[[nodiscard]] double speed_difference(const Velocities& a, const Velocities& b, double noise_sigmas);

/// Mean distance over the frames in which both were measured, m; -1 where there is none.
[[nodiscard]] double mean_distance(const PointTrajectory& a, const PointTrajectory& b);

/// Two neighbours by their places among the chosen ones, a < b.
struct AffinityEdge {
  int a = 0, b = 0;
  double weight = 0.0;
};

/// Each chosen trajectory's `neighbours` nearest in the image, and theirs; never below least_affinity.
[[nodiscard]] std::vector<AffinityEdge> affinity_edges(const TrajectorySet& set, std::span<const int> chosen,
                                                       std::span<const Velocities> velocities,
                                                       const Wang2014Config& config);

/// The smallest eigenvalues of I - D^-1/2 W D^-1/2 and their vectors, one a column, each with its largest
/// entry positive. @param count at most as many as there are points
struct Spectrum {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< points x values
};
[[nodiscard]] Spectrum laplacian_spectrum(int points, std::span<const AffinityEdge> edges, int count);

/// k from least to most, with the largest gap between the k-th eigenvalue and the next; the first of equals.
/// 1 where there are too few values to tell.
[[nodiscard]] int clusters_by_eigengap(const Eigen::VectorXd& values, int least, int most);

/// k-means of the rows of the first k vectors, each row of length 1. Begins with the row farthest from the
/// others' mean direction, then always the one farthest from those begun with: the same on every machine.
/// Clusters are numbered by size, the largest 0.
[[nodiscard]] std::vector<int> cluster_rows(const Eigen::MatrixXd& vectors, int k);

}  // namespace stillpoint
