#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/trajectory.hpp"

namespace stillpoint {

// Bundle adjustment with a camera's times among its unknowns: what time_calibration solves.

/// Colour's readout, depth's readout, depth's delay: s, as Camera has them.
inline constexpr int kTimes = 3;
using Times = Eigen::Matrix<double, kTimes, 1>;

/// A metre's units in the depth images of SeenFrame.
inline constexpr double kKeptDepthUnits = 5000.0;

/// Inverse depth about a pixel, as a plane in the image: that of a plane in space.
struct DepthPlane {
  Eigen::Vector2d about{0, 0};  ///< px, undistorted
  double inverse_depth = 0.0;   ///< 1/m, there
  Eigen::Vector2d slope{0, 0};  ///< 1/m a px
};

/// A map point as a frame saw it.
struct Sighting {
  int point = 0;                ///< index into the stretch's
  Eigen::Vector2d undistorted;  ///< px, as its row had it
  double row = 0.0;             ///< px, in the image as it is
  double sigma = 1.0;           ///< of the pixel, in units of the finest level's
  double weight = 1.0;          ///< of being static
  std::optional<DepthPlane> depth;
};

/// How the camera moves about a frame: the cubic that fits log(camera_then_from_now) of five frames best. A
/// difference of neighbours would miss a sixth of a hand's tremor at 5 Hz; a curve through all of them would
/// take the poses' noise for motion.
struct MotionAbout {
  static constexpr int kReach = 2;                        // frames to either side
  static constexpr std::size_t kFrames = 2 * kReach + 1;  // with the frame itself
  bool known = false;                                     ///< these frames are there, and near
  /// Coefficients of t, t² and t³: of the motion, and of each frame's part in it.
  Eigen::Matrix<double, 6, 3> cubic = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix<double, 3, kFrames> parts = Eigen::Matrix<double, 3, kFrames>::Zero();
};

/// A frame with its sightings.
struct SeenFrame {
  double timestamp = 0.0;  ///< s
  double lag = 0.0;        ///< s, from the frame's time to depth's stamp
  cv::Mat depth;           ///< CV_16UC1, kKeptDepthUnits a metre, 0 = none; empty where the frame has none
  Pose camera_from_world = Pose::Identity();
  std::vector<Sighting> sightings;
  MotionAbout motion;
};

/// What one run of the odometry over a stretch of frames leaves: bundle adjustment's problem.
struct TrackedStretch {
  std::vector<SeenFrame> frames;
  Trajectory poses;                     ///< as the odometry had them
  std::vector<Eigen::Vector3d> points;  ///< m, world
  int observations = 0;
};

/// Robust standard deviations of both kinds of residual, px.
struct AdjustmentNoise {
  double pixel = 1.0, depth = 1.0;
};

/// Poses, points and times by Gauss-Newton, robustly (Huber). Points are eliminated by their Schur
/// complement, the times are the last unknowns; each residual knows what part each of the five frames about
/// has in the pose of its row's moment.
class TimedAdjustment {
 public:
  /// @param stretch is adjusted in place @param times to begin with
  /// @param sought which of them are unknowns; the others stand
  TimedAdjustment(TrackedStretch& stretch, const Camera& camera, const Times& times,
                  const std::array<bool, kTimes>& sought)
      : stretch_(stretch), camera_(camera), times_(times), sought_(sought) {}

  /// To its end, or until nothing can be solved any more.
  void solve();

  [[nodiscard]] const Times& times() const { return times_; }
  /// Standard deviations of the times, s: 0 of those that stand, not finite where nothing could be solved.
  [[nodiscard]] const Times& sigma() const { return sigma_; }
  [[nodiscard]] const AdjustmentNoise& noise() const { return noise_; }

 private:
  using Cross = Eigen::Matrix<double, 3, 6>;
  struct PointPart {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero(), inverse = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d by_times = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    std::vector<std::pair<std::size_t, Cross>> cross;  ///< by frame
    Cross& cross_with(std::size_t frame);
  };

  template <typename Visit>
  void each_row(const Visit& visit) const;
  void look_up_depth();
  void measure_noise();
  void linearise();
  [[nodiscard]] double step();
  void measure_uncertainty();

  TrackedStretch& stretch_;
  const Camera& camera_;
  Times times_, sigma_ = Times::Zero();
  std::array<bool, kTimes> sought_;
  AdjustmentNoise noise_;
  Eigen::MatrixXd h_;  // upper triangle
  Eigen::VectorXd g_;
  std::vector<PointPart> points_;
};

}  // namespace stillpoint
