#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/odometry/direct_alignment.hpp"

namespace stillpoint {

using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

/// Where alignment stands: a pose, and how the target's grey levels go with the reference's.
struct DirectState {
  Pose target_from_reference = Pose::Identity();
  double gain = 1.0, bias = 0.0;
};

/// The patches of one pyramid level, to be compared with the target's image of that level. One patch is kSide
/// pixels a side; its Jacobians are the reference's and computed once (inverse compositional).
class DirectLevel {
 public:
  static constexpr int kSide = 3;  // px of a patch: one pixel and its neighbours
  static constexpr std::size_t kPixels = kSide * kSide;

  DirectLevel(const std::vector<PatchPoint>& patches, const cv::Mat& reference, const cv::Mat& target,
              int level, const Camera& camera, const DirectTarget& frame);

  /// What comparing under a state says.
  struct Comparison {
    int in_view = 0;               ///< patches
    double mean_difference = 0.0;  ///< grey levels, mean of absolute residuals
    double noise = 1.0;            ///< grey levels: standard deviation by the median absolute residual
    double rms = 0.0;              ///< grey levels, by the weights that Student's t gives with that noise
    double correlation = 0.0;      ///< within patches: of target against reference, their means taken off
  };
  /// Reads the target where the state has the patches lie.
  Comparison compare(const DirectState& state);

  /// Gauss-Newton's equations of the last comparison: pose (a perturbation of the reference's points,
  /// translation first), gain, bias.
  struct Equations {
    Matrix8d h = Matrix8d::Zero();
    Vector8d g = Vector8d::Zero();
  };
  [[nodiscard]] Equations equations(const DirectState& state, const Comparison& comparison) const;

  /// The patches of the last comparison that lie in view.
  [[nodiscard]] std::vector<DirectPatch> seen(const Comparison& comparison) const;

  /// Correlation of single pixels, all patches taken together, where they would lie after a turn alone:
  /// quick, for trying many. 0 where fewer than half of them lie in view.
  [[nodiscard]] double correlation_at(const Pose& target_from_reference) const;

  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] std::size_t size() const { return patches_.size(); }

 private:
  struct Patch {
    Eigen::Vector3d point;               // m, reference camera
    std::array<float, kPixels> value{};  // of the reference, grey levels
    std::array<float, kPixels> slope_x{}, slope_y{};
    Eigen::Matrix<double, 2, 6> by_pose;  // px of this level
    // Of the last comparison:
    bool in_view = false;
    cv::Point2f pixel;  // full size
    std::array<float, kPixels> residual{};
  };

  [[nodiscard]] bool place(const Eigen::Vector3d& in_target, const Vector6d& velocity,
                           cv::Point2f& full) const;

  const Camera& camera_;
  const DirectTarget& frame_;
  cv::Mat image_;  // of the target
  int level_ = 0;
  double scale_ = 1.0;  // px of this level a full-size one
  std::vector<Patch> patches_;
};

/// Student's t: the weight of a residual in noises, 1 at most.
[[nodiscard]] inline double student_weight(double residual_over_noise) {
  constexpr double kFreedom = 5.0;  // degrees, as Kerl et al. find residuals to be
  return kFreedom / (kFreedom + residual_over_noise * residual_over_noise);
}

}  // namespace stillpoint
