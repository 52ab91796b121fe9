#include "core/check/time_calibration.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/geometry/normal_equations.hpp"
#include "core/median.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/with_camera.hpp"

namespace stillpoint {
namespace {

constexpr int kTimes = 3;  // unknown: colour's readout, depth's readout, depth's delay
using Vector3 = Eigen::Vector3d;
using Times = Eigen::Matrix<double, kTimes, 1>;
using TimesInformation = Eigen::Matrix<double, kTimes, kTimes>;

constexpr double kSettled = 0.1e-3, kSettledSigmas = 0.3;  // s and sigmas: a smaller change ends the runs
constexpr double kTold = 2.5e-3;                           // s: a larger standard deviation tells nothing
constexpr double kLongestTold = 0.06;  // s: a readout or a delay beyond two frames' time is no measurement
constexpr double kLongestStep = 0.1;   // s between neighbours that tell how the camera moves
constexpr int kBlock = 10;             // frames whose errors may hang together
constexpr int kFewestFrames = 3 * kBlock, kFewestObservations = 20;  // … the latter a frame
constexpr int kFewestSightings = 4;                                  // frames that see a point
constexpr int kIterations = 15;
constexpr double kHuber = 1.345;        // standard deviations
constexpr double kGross = 6.0;          // standard deviations, beyond which a residual takes no part
constexpr double kNearestUsed = 0.2;    // m
constexpr double kDepthUnits = 5000.0;  // a metre, of the depth images kept

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
  static constexpr int kReach = 2;  // frames to either side
  static constexpr std::size_t kFrames = 2 * kReach + 1;
  bool known = false;  ///< these frames are there, and near
  /// Coefficients of t, t² and t³: of the motion, and of each frame's part in it.
  Eigen::Matrix<double, 6, 3> cubic = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix<double, 3, kFrames> parts = Eigen::Matrix<double, 3, kFrames>::Zero();
};

struct SeenFrame {
  double timestamp = 0.0;  ///< s
  double lag = 0.0;        ///< s, from colour's stamp to depth's
  cv::Mat depth;           ///< CV_16UC1, kDepthUnits a metre, 0 = none; empty where the frame has none
  Pose camera_from_world = Pose::Identity();
  std::vector<Sighting> sightings;
  MotionAbout motion;
};

/// Least squares over the valid pixels about a feature; nothing at an outline or where little was measured.
std::optional<DepthPlane> plane_about(const cv::Mat& depth, const Eigen::Vector2d& pixel,
                                      double to_disparity) {
  constexpr int kReach = 8, kStep = 2;  // px
  constexpr double kRoughest = 0.15;    // px of disparity, RMS: a plane's own noise is at most that
  if (!(pixel.cwiseAbs().maxCoeff() < 1e5)) return std::nullopt;
  const int x0 = cvRound(pixel.x()), y0 = cvRound(pixel.y());
  if (x0 < kReach || y0 < kReach || x0 + kReach >= depth.cols || y0 + kReach >= depth.rows)
    return std::nullopt;
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Vector3 g = Vector3::Zero();
  double squares = 0.0;
  int count = 0, all = 0;
  for (int y = y0 - kReach; y <= y0 + kReach; y += kStep)
    for (int x = x0 - kReach; x <= x0 + kReach; x += kStep, ++all) {
      const auto z = depth.at<std::uint16_t>(y, x);
      if (z == 0) continue;
      const double w = kDepthUnits / static_cast<double>(z);
      const Vector3 a(1.0, x - pixel.x(), y - pixel.y());
      h += a * a.transpose(), g += w * a, squares += w * w, ++count;
    }
  if (count * 10 < all * 8) return std::nullopt;
  const Vector3 plane = solve_ldlt<3>(h, g);
  const double rms = std::sqrt(std::max(0.0, squares - plane.dot(g)) / count);
  if (plane[0] <= 0 || rms * to_disparity > kRoughest) return std::nullopt;
  return DepthPlane{{0, 0}, plane[0], plane.tail<2>()};
}

/// What one run of the odometry over the stretch leaves: bundle adjustment's problem.
struct Stretch {
  std::vector<SeenFrame> frames;
  Trajectory poses;
  std::vector<Vector3> points;  ///< m, world
  int observations = 0;
};

/// Keeps the depth of the frames that were read.
class KeepingDepth final : public WithCamera {
 public:
  using WithCamera::WithCamera;
  struct Kept {
    cv::Mat depth;       ///< CV_16UC1, kDepthUnits a metre
    double stamp = 0.0;  ///< s
  };

  [[nodiscard]] Frame read(int index) const override {
    Frame frame = WithCamera::read(index);
    if (frame.has_depth()) {
      Kept kept{{}, frame.depth_timestamp};
      frame.depth.convertTo(kept.depth, CV_16UC1, kDepthUnits);
      const std::lock_guard lock(mutex_);
      kept_[index] = std::move(kept);
    }
    return frame;
  }
  /// Once all is read. @returns null for a frame without depth
  [[nodiscard]] const Kept* kept(int index) const {
    const auto found = kept_.find(index);
    return found == kept_.end() ? nullptr : &found->second;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<int, Kept> kept_;
};

Stretch track(const FrameSource& source, const Camera& camera, Config config, int first, int count) {
  const KeepingDepth seen_by(source, camera);
  RunOptions options;
  options.first = first, options.count = count;
  options.keep_features = true;
  const RunResult run = run_sequence(seen_by, config, options);
  std::unordered_map<int, int> seen_in;  // frames, by point
  for (const FrameRecord& record : run.records)
    for (const FeatureRecord& feature : record.features)
      if (feature.fate == FeatureFate::inlier) ++seen_in[feature.map_point];
  Stretch stretch;
  std::unordered_map<int, int> points;
  for (const SavedPoint& point : run.points) {
    if (seen_in[point.id] < kFewestSightings) continue;
    points[point.id] = static_cast<int>(stretch.points.size());
    stretch.points.push_back(point.position);
  }
  std::map<double, Pose> poses;
  for (const StampedPose& pose : run.trajectory) poses[pose.timestamp] = pose.world_from_camera;

  stretch.poses = run.trajectory;
  for (const FrameRecord& record : run.records) {
    const auto pose = poses.find(record.timestamp);
    if (!record.estimated || pose == poses.end()) continue;
    SeenFrame frame;
    frame.timestamp = record.timestamp;
    if (const auto* kept = seen_by.kept(record.index))
      frame.depth = kept->depth, frame.lag = kept->stamp - record.timestamp;
    frame.camera_from_world = pose->second.inverse();
    for (const FeatureRecord& feature : record.features) {
      const auto point = points.find(feature.map_point);
      if (feature.fate != FeatureFate::inlier || point == points.end()) continue;
      Sighting sighting;
      sighting.point = point->second;
      sighting.undistorted =
          camera.undistorted({static_cast<double>(feature.pixel.x), static_cast<double>(feature.pixel.y)});
      sighting.row = static_cast<double>(feature.pixel.y);
      sighting.sigma = std::pow(config.features.scale_factor, feature.octave);
      sighting.weight = static_cast<double>(feature.static_weight);
      frame.sightings.push_back(sighting);
    }
    if (frame.sightings.size() < kFewestObservations) continue;
    stretch.observations += static_cast<int>(frame.sightings.size());
    stretch.frames.push_back(std::move(frame));
  }
  return stretch;
}

/// How the camera moves in each frame, by its neighbours' poses.
void measure_motion(std::vector<SeenFrame>& frames) {
  constexpr std::size_t kReach = MotionAbout::kReach;
  for (SeenFrame& frame : frames) frame.motion = {};
  for (std::size_t i = kReach; i + kReach < frames.size(); ++i) {
    SeenFrame& frame = frames[i];
    const Pose now_inverse = frame.camera_from_world.inverse();
    Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, MotionAbout::kFrames> powers;
    Eigen::Matrix<double, 6, MotionAbout::kFrames> motions;
    bool near = true;
    for (std::size_t k = 0; k < MotionAbout::kFrames; ++k) {
      const SeenFrame& other = frames[i + k - kReach];
      const double t = other.timestamp - frame.timestamp;
      near = near && std::abs(t) <= kReach * kLongestStep;
      const auto column = static_cast<Eigen::Index>(k);
      powers.col(column) << 1.0, t, t * t, t * t * t;
      motions.col(column) = se3_log(other.camera_from_world * now_inverse);
    }
    if (!near) continue;
    h = powers * powers.transpose();
    frame.motion.known = true;
    frame.motion.parts = h.fullPivLu().solve(powers).bottomRows<3>();
    frame.motion.cubic = motions * frame.motion.parts.transpose();
  }
}

/// A point as it is `t` s after the frame's middle row, how fast it goes then, and what part each of the
/// frames about has in the pose of that moment.
struct Moved {
  Vector3 at, speed;  ///< m, m/s; camera coordinates
  std::array<double, MotionAbout::kFrames> parts{};
};
Moved moved(const SeenFrame& frame, const Vector3& p, double t) {
  const MotionAbout& m = frame.motion;
  Moved result{p, Vector3::Zero(), {}};
  result.parts[MotionAbout::kReach] = 1.0;
  if (!m.known) return result;
  const Vector3 powers(t, t * t, t * t * t);
  const Vector6d by = m.cubic * powers, rate = m.cubic * Vector3(1.0, 2.0 * t, 3.0 * t * t);
  for (std::size_t k = 0; k < MotionAbout::kFrames; ++k) {
    if (k == MotionAbout::kReach) continue;
    result.parts[k] = m.parts.col(static_cast<Eigen::Index>(k)).dot(powers);
    result.parts[MotionAbout::kReach] -= result.parts[k];
  }
  result.at = se3_exp(by) * p;
  result.speed = rate.head<3>() + rate.tail<3>().cross(result.at);
  return result;
}

/// d project / d point, px a metre.
Eigen::Matrix<double, 2, 3> projection_slope(const Camera& camera, const Vector3& p) {
  const double w = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> slope;
  slope << camera.fx * w, 0.0, -camera.fx * p.x() * w * w, 0.0, camera.fy * w, -camera.fy * p.y() * w * w;
  return slope;
}

/// One number that should be 0, and how it hangs on the pose of its moment, on the point and on the times.
struct Row {
  double residual = 0.0;
  Vector6d by_pose = Vector6d::Zero();
  std::array<double, MotionAbout::kFrames> parts{};  ///< of the frames about, in that pose
  Vector3 by_point = Vector3::Zero();
  Times by_times = Times::Zero();
};

/// A sighting's residuals: the pixel's in px of the finest level, depth's in px of disparity.
struct SightingResiduals {
  std::array<Row, 2> pixel;
  std::optional<Row> depth;
};

std::optional<SightingResiduals> residuals_of(const Camera& camera, const SeenFrame& frame, const Sighting& s,
                                              const Vector3& point, const Times& times) {
  const double share = (s.row + 0.5) / camera.height - 0.5;  // of the readout, after the middle row
  const Vector3 p = frame.camera_from_world * point;
  if (p.z() < kNearestUsed) return std::nullopt;
  const Moved seen = moved(frame, p, share * times[0]);
  const Moved measured = moved(frame, p, frame.lag + times[2] + share * times[1]);
  if (seen.at.z() < kNearestUsed || measured.at.z() < kNearestUsed) return std::nullopt;
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << Eigen::Matrix3d::Identity(), -hat(p);
  const Eigen::Matrix3d by_point = frame.camera_from_world.linear();
  const auto row_of = [&](double residual, const Eigen::RowVector3d& slope, const Moved& then) {
    return Row{residual, (slope * by_pose).transpose(), then.parts, (slope * by_point).transpose(),
               Times::Zero()};
  };
  SightingResiduals residuals;
  const Eigen::Matrix<double, 2, 3> slope = projection_slope(camera, seen.at) / s.sigma;
  const Eigen::Vector2d miss = (camera.project(seen.at) - s.undistorted) / s.sigma;
  for (int k = 0; k < 2; ++k) {
    Row& row = residuals.pixel[static_cast<std::size_t>(k)];
    row = row_of(miss[k], slope.row(k), seen);
    row.by_times[0] = share * slope.row(k).dot(seen.speed);
  }
  if (!s.depth) return residuals;
  // The plane's inverse depth where the point was when its depth was measured, less the point's own.
  const double to_disparity = camera.fx * kKinectBaseline, w = 1.0 / measured.at.z();
  const Eigen::RowVector3d depth_slope =
      to_disparity * (Eigen::RowVector3d(s.depth->slope.transpose() * projection_slope(camera, measured.at)) +
                      Eigen::RowVector3d(0.0, 0.0, w * w));
  Row row = row_of(to_disparity * (s.depth->inverse_depth +
                                   s.depth->slope.dot(camera.project(measured.at) - s.depth->about) - w),
                   depth_slope, measured);
  const double by_time = depth_slope.dot(measured.speed);
  row.by_times = {0.0, share * by_time, by_time};
  residuals.depth = row;
  return residuals;
}

/// Robust standard deviations of both kinds of residual, px.
struct Noise {
  double pixel = 1.0, depth = 1.0;
};

/// Bundle adjustment with the times among its unknowns.
class TimedAdjustment {
 public:
  TimedAdjustment(Stretch& stretch, const Camera& camera, const Times& times,
                  const std::array<bool, kTimes>& sought)
      : stretch_(stretch), camera_(camera), times_(times), sought_(sought) {}

  /// Gauss-Newton to its end.
  void solve() {
    for (int i = 0; i < kIterations; ++i)
      if (step() < kSmallestStep) break;
    measure_uncertainty();
  }

  [[nodiscard]] const Times& times() const { return times_; }
  [[nodiscard]] const Times& sigma() const { return sigma_; }
  /// Robust standard deviations of the residuals.
  [[nodiscard]] const Noise& noise() const { return noise_; }

 private:
  using Cross = Eigen::Matrix<double, 3, 6>;
  static constexpr double kSmallestStep = 3e-5;  // s

  /// Calls `visit(frame index, frame, sighting, row, weight)` for each residual that takes part.
  template <typename Visit>
  void each_row(const Visit& visit) const {
    for (std::size_t f = 0; f < stretch_.frames.size(); ++f) {
      const SeenFrame& frame = stretch_.frames[f];
      for (const Sighting& s : frame.sightings) {
        const auto residuals =
            residuals_of(camera_, frame, s, stretch_.points[static_cast<std::size_t>(s.point)], times_);
        if (!residuals) continue;
        const auto give = [&](const Row& row, double sigma) {
          const double size = std::abs(row.residual) / sigma;
          if (size > kGross) return;
          visit(f, s, row, s.weight * (size > kHuber ? kHuber / size : 1.0) / (sigma * sigma));
        };
        for (const Row& row : residuals->pixel) give(row, noise_.pixel);
        if (residuals->depth) give(*residuals->depth, noise_.depth);
      }
    }
  }

  /// Reads depth where each point was when its row of depth was measured.
  void look_up_depth() {
    const double to_disparity = camera_.fx * kKinectBaseline;
    for (SeenFrame& frame : stretch_.frames)
      for (Sighting& s : frame.sightings) {
        s.depth.reset();
        if (frame.depth.empty()) continue;
        const double share = (s.row + 0.5) / camera_.height - 0.5;
        const Vector3 p = frame.camera_from_world * stretch_.points[static_cast<std::size_t>(s.point)];
        const Vector3 then = moved(frame, p, frame.lag + times_[2] + share * times_[1]).at;
        if (then.z() < kNearestUsed) continue;
        const Eigen::Vector2d at = camera_.project(then);
        s.depth = plane_about(frame.depth, camera_.distort(at), to_disparity);
        if (s.depth) s.depth->about = at;
      }
  }

  void measure_noise() {
    constexpr double kOfMedian = 1.4826;  // standard deviations of a normal distribution in a median's unit
    std::vector<double> pixel, depth;
    for (const SeenFrame& frame : stretch_.frames)
      for (const Sighting& s : frame.sightings)
        if (const auto residuals =
                residuals_of(camera_, frame, s, stretch_.points[static_cast<std::size_t>(s.point)], times_)) {
          for (const Row& row : residuals->pixel) pixel.push_back(std::abs(row.residual));
          if (residuals->depth) depth.push_back(std::abs(residuals->depth->residual));
        }
    noise_ = {std::max(1e-3, kOfMedian * median_of(pixel)), std::max(1e-3, kOfMedian * median_of(depth))};
  }

  /// The equations with the points eliminated: of all poses, then of the times.
  void linearise() {
    measure_motion(stretch_.frames);
    look_up_depth();
    measure_noise();
    const auto frames = static_cast<Eigen::Index>(stretch_.frames.size()), size = 6 * frames + kTimes;
    h_ = Eigen::MatrixXd::Zero(size, size);
    g_ = Eigen::VectorXd::Zero(size);
    points_.assign(stretch_.points.size(), {});
    each_row([&](std::size_t f, const Sighting& s, const Row& row, double w) {
      PointPart& point = points_[static_cast<std::size_t>(s.point)];
      const Matrix6d square = w * row.by_pose * row.by_pose.transpose();
      const Eigen::Matrix<double, 6, kTimes> times_cross = w * row.by_pose * row.by_times.transpose();
      const Cross point_cross = w * row.by_point * row.by_pose.transpose();
      for (std::size_t a = 0; a < row.parts.size(); ++a) {
        const double part = row.parts[a];
        if (part == 0.0) continue;
        const std::size_t other = f + a - MotionAbout::kReach;
        const auto at = 6 * static_cast<Eigen::Index>(other);
        for (std::size_t b = a; b < row.parts.size(); ++b)
          if (row.parts[b] != 0.0)
            h_.block<6, 6>(at, at + 6 * static_cast<Eigen::Index>(b - a)) += part * row.parts[b] * square;
        h_.block<6, kTimes>(at, 6 * frames) += part * times_cross;
        g_.segment<6>(at) += part * w * row.residual * row.by_pose;
        point.cross_with(other) += part * point_cross;
      }
      h_.bottomRightCorner<kTimes, kTimes>() += w * row.by_times * row.by_times.transpose();
      g_.tail<kTimes>() += w * row.residual * row.by_times;
      point.by_times += w * row.by_point * row.by_times.transpose();
      point.h += w * row.by_point * row.by_point.transpose();
      point.g += w * row.residual * row.by_point;
    });
    for (PointPart& point : points_) {
      if (point.cross.empty()) continue;
      point.h.diagonal() *= 1.0 + 1e-9;
      point.inverse = point.h.inverse();
      for (const auto& [a, cross_a] : point.cross) {
        const auto at_a = 6 * static_cast<Eigen::Index>(a);
        const Eigen::Matrix<double, 6, 3> through = cross_a.transpose() * point.inverse;
        for (const auto& [b, cross_b] : point.cross)
          if (b >= a) h_.block<6, 6>(at_a, 6 * static_cast<Eigen::Index>(b)) -= through * cross_b;
        h_.block<6, kTimes>(at_a, 6 * frames) -= through * point.by_times;
        g_.segment<6>(at_a) -= through * point.g;
      }
      h_.bottomRightCorner<kTimes, kTimes>() -= point.by_times.transpose() * point.inverse * point.by_times;
      g_.tail<kTimes>() -= point.by_times.transpose() * (point.inverse * point.g);
    }
    // The world stays where the first pose has it.
    h_.topLeftCorner<6, 6>().diagonal().array() += 1e3 * h_.diagonal().maxCoeff();
    for (int k = 0; k < kTimes; ++k) {
      const Eigen::Index at = 6 * frames + k;
      if (sought_[static_cast<std::size_t>(k)] && h_(at, at) > 0) continue;
      h_.col(at).setZero(), h_.row(at).setZero();
      h_(at, at) = 1.0, g_[at] = 0.0;
    }
  }

  /// @returns the largest change of a time, s
  double step() {
    linearise();
    const Eigen::VectorXd x = -h_.selfadjointView<Eigen::Upper>().ldlt().solve(g_);
    for (std::size_t f = 0; f < stretch_.frames.size(); ++f) {
      Pose& pose = stretch_.frames[f].camera_from_world;
      pose = se3_exp(x.segment<6>(6 * static_cast<Eigen::Index>(f))) * pose;
    }
    const Times change = x.tail<kTimes>();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const PointPart& point = points_[i];
      if (point.cross.empty()) continue;
      Vector3 g = point.g + point.by_times * change;
      for (const auto& [f, cross] : point.cross) g += cross * x.segment<6>(6 * static_cast<Eigen::Index>(f));
      stretch_.points[i] -= point.inverse * g;
    }
    times_ += change;
    return change.cwiseAbs().maxCoeff();
  }

  /// Each block of frames pulls at the times, about 0 in sum: how these pulls scatter tells the deviation,
  /// with what the noise within a block has in common.
  void measure_uncertainty() {
    linearise();
    const auto frames = static_cast<Eigen::Index>(stretch_.frames.size());
    const auto poses = h_.topLeftCorner(6 * frames, 6 * frames).selfadjointView<Eigen::Upper>().ldlt();
    const Eigen::MatrixXd cross = h_.topRightCorner(6 * frames, kTimes);
    const Eigen::MatrixXd by_pose = poses.solve(cross);
    const TimesInformation information = h_.bottomRightCorner<kTimes, kTimes>() - cross.transpose() * by_pose;
    std::vector<Eigen::Matrix3d> by_point(points_.size(), Eigen::Matrix3d::Zero());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i].cross.empty()) continue;
      Eigen::Matrix3d e = points_[i].by_times;
      for (const auto& [f, pose_cross] : points_[i].cross)
        e -= pose_cross * by_pose.middleRows<6>(6 * static_cast<Eigen::Index>(f));
      by_point[i] = points_[i].inverse * e;
    }
    std::vector<Times> pulls(stretch_.frames.size() / kBlock + 1, Times::Zero());
    each_row([&](std::size_t f, const Sighting& s, const Row& row, double w) {
      Times pull = row.by_times - by_point[static_cast<std::size_t>(s.point)].transpose() * row.by_point;
      for (std::size_t a = 0; a < row.parts.size(); ++a)
        if (row.parts[a] != 0.0)
          pull -=
              row.parts[a] *
              by_pose.middleRows<6>(6 * static_cast<Eigen::Index>(f + a - MotionAbout::kReach)).transpose() *
              row.by_pose;
      pulls[f / kBlock] += w * row.residual * pull;
    });
    TimesInformation scatter = TimesInformation::Zero();
    for (const Times& pull : pulls) scatter += pull * pull.transpose();
    const TimesInformation inverse = information.inverse();
    const TimesInformation covariance = inverse * scatter * inverse;
    for (int k = 0; k < kTimes; ++k)
      sigma_[k] = sought_[static_cast<std::size_t>(k)]
                      ? std::sqrt(std::max({covariance(k, k), inverse(k, k), 0.0}))
                      : 0.0;
  }

  struct PointPart {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero(), inverse = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d by_times = Eigen::Matrix3d::Zero();
    Vector3 g = Vector3::Zero();
    std::vector<std::pair<std::size_t, Cross>> cross;  ///< by frame
    Cross& cross_with(std::size_t frame) {
      for (auto back = cross.rbegin(); back != cross.rend(); ++back)
        if (back->first == frame) return back->second;
      return cross.emplace_back(frame, Cross::Zero()).second;
    }
  };

  Stretch& stretch_;
  const Camera& camera_;
  Times times_, sigma_ = Times::Zero();
  std::array<bool, kTimes> sought_;
  Noise noise_;
  Eigen::MatrixXd h_;  // upper triangle
  Eigen::VectorXd g_;
  std::vector<PointPart> points_;
};

Times times_of(const Camera& camera) {
  return {camera.readout_s, camera.depth_readout_s.value_or(camera.readout_s), camera.depth_delay_s};
}

Camera with_times(Camera camera, const Times& times) {
  camera.readout_s = times[0];
  camera.depth_readout_s = times[1];
  camera.depth_delay_s = times[2];
  return camera;
}

TimeCalibration calibrate_stretch(const FrameSource& source, const Config& config, int first, int count,
                                  const TimeStretch& stretch) {
  TimeCalibration result;
  result.first_frame = first, result.frames = count;
  Camera camera = source.camera();
  const Times before = times_of(camera);
  std::array<bool, kTimes> sought{true, true, true};
  Times sigma = Times::Constant(1.0);
  Trajectory poses;
  while (result.runs < stretch.runs) {
    Stretch tracked = track(source, camera, config, first, count);
    ++result.runs;
    result.observations = tracked.observations;
    poses = tracked.poses;
    if (static_cast<int>(tracked.frames.size()) < kFewestFrames) {
      result.why_not = fmt::format("of {} frames from frame {} on, {} could be tracked", count, first,
                                   tracked.frames.size());
      return result;
    }
    // What the stretch does not tell stands, and is no longer free to take up others' errors.
    Times times = times_of(camera);
    for (;;) {
      TimedAdjustment adjustment(tracked, camera, times, sought);
      adjustment.solve();
      times = adjustment.times(), sigma = adjustment.sigma();
      result.noise_px = adjustment.noise().pixel;
      const auto untold = [&](int k) {
        return sought[static_cast<std::size_t>(k)] &&
               !(sigma[k] < kTold && std::abs(times[k]) < kLongestTold);
      };
      const int order[] = {1, 2, 0};  // depth's readout is the hardest to tell
      const auto* const first_untold = std::find_if(std::begin(order), std::end(order), untold);
      if (first_untold == std::end(order)) break;
      sought[static_cast<std::size_t>(*first_untold)] = false;
      times[*first_untold] = before[*first_untold];
    }
    const Times change = times - times_of(camera);
    camera = with_times(camera, times);
    bool settled = true;
    for (int k = 0; k < kTimes; ++k)
      settled = settled && std::abs(change[k]) <= std::max(kSettled, kSettledSigmas * sigma[k]);
    if (settled) break;
  }
  if (!poses.empty()) result.after_truth = delay_beside_truth(source.ground_truth(), poses);
  const Times times = times_of(camera);
  TimeEstimate* const estimates[] = {&result.readout, &result.depth_readout, &result.depth_delay};
  for (int k = 0; k < kTimes; ++k) {
    const bool told = sought[static_cast<std::size_t>(k)];
    *estimates[k] = {told ? times[k] : before[k], told ? sigma[k] : 0.0, told};
  }
  if (!result.told())
    result.why_not = fmt::format(
        "in frames {} to {} the camera moves too little, or too evenly, for its residuals to tell", first,
        first + count - 1);
  return result;
}

}  // namespace

std::optional<TimeEstimate> delay_beside_truth(const Trajectory& truth, const Trajectory& estimate) {
  constexpr std::size_t kApart = 15, kPairsInBlock = 20;  // poses
  constexpr double kGap = 0.05, kDifference = 0.002;      // s: between truth's poses; for derivatives
  constexpr double kMostTold = 5e-3, kFarthest = 0.05;    // s
  constexpr double kMetresARadian = 1.0;                  // rotation beside translation: a point 1 m away
  constexpr int kSteps = 10;
  // How two motions over the same poses differ, truth read `delay` later.
  const auto difference = [&](std::size_t i, double delay) -> std::optional<Vector6d> {
    const auto a = interpolate(truth, estimate[i].timestamp + delay, kGap),
               b = interpolate(truth, estimate[i + kApart].timestamp + delay, kGap);
    if (!a || !b) return std::nullopt;
    Vector6d error = se3_log((a->inverse() * *b).inverse() * estimate[i].world_from_camera.inverse() *
                             estimate[i + kApart].world_from_camera);
    error.tail<3>() *= kMetresARadian;
    return error;
  };
  TimeEstimate result;
  for (int step = 0; step < kSteps; ++step) {
    double h = 0.0, g = 0.0, noise = 0.0;
    std::size_t pairs = 0;
    std::vector<double> blocks;
    for (std::size_t i = 0; i + kApart < estimate.size(); ++i) {
      const auto before = difference(i, result.seconds - kDifference),
                 after = difference(i, result.seconds + kDifference);
      if (!before || !after) continue;
      const Vector6d slope = (*after - *before) / (2.0 * kDifference), error = 0.5 * (*after + *before);
      if (pairs++ % kPairsInBlock == 0) blocks.push_back(0.0);
      h += slope.squaredNorm(), g += slope.dot(error), noise += error.squaredNorm();
      blocks.back() += slope.dot(error);
    }
    if (pairs < 2 * kPairsInBlock || h <= 0) return std::nullopt;
    double scatter = 0.0;
    for (const double block : blocks) scatter += block * block;
    result.sigma_s = std::sqrt(std::max(scatter, h * noise / (6.0 * static_cast<double>(pairs)))) / h;
    result.seconds -= g / h;
    if (!(std::abs(result.seconds) < kFarthest)) return std::nullopt;
  }
  result.told = result.sigma_s < kMostTold;
  return result.told ? std::optional(result) : std::nullopt;
}

Camera TimeCalibration::applied_to(Camera camera) const {
  if (readout.told) {
    // Depth's readout is as colour's where nothing else is known: it stays what it was.
    if (!camera.depth_readout_s && !depth_readout.told) camera.depth_readout_s = camera.readout_s;
    camera.readout_s = readout.seconds;
  }
  if (depth_readout.told) camera.depth_readout_s = depth_readout.seconds;
  if (depth_delay.told) camera.depth_delay_s = depth_delay.seconds;
  return camera;
}

std::vector<std::string> to_lines(const TimeCalibration& times, const Camera& camera) {
  if (!times.why_not.empty()) return {times.why_not};
  const Times had = times_of(camera);
  std::vector<std::string> lines;
  int k = 0;
  for (const auto& [name, estimate] :
       {std::pair("colour's readout", times.readout), std::pair("depth's readout", times.depth_readout),
        std::pair("depth's delay", times.depth_delay)}) {
    const double ms = 1e3 * had[k++];
    lines.push_back(estimate.told
                        ? fmt::format("{} {:.1f} ± {:.1f} ms (camera {}: {:.1f})", name,
                                      1e3 * estimate.seconds, 1e3 * estimate.sigma_s, camera.name, ms)
                        : fmt::format("{} is not told by these frames; {:.1f} ms stand", name, ms));
  }
  if (times.after_truth)
    lines.push_back(
        fmt::format("beside ground truth, poses are of {:.1f} ± {:.1f} ms after their frames' times",
                    1e3 * times.after_truth->seconds, 1e3 * times.after_truth->sigma_s));
  lines.push_back(fmt::format("over frames {} to {}, {} observations, which miss by {:.3f} px",
                              times.first_frame, times.first_frame + times.frames - 1, times.observations,
                              times.noise_px));
  return lines;
}

std::vector<Finding> check_times(const TimeCalibration& times, const Camera& camera) {
  constexpr double kOff = 4e-3, kCertain = 4.0;  // s, standard deviations
  const Times had = times_of(camera);
  std::vector<Finding> findings;
  int k = 0;
  for (const auto& [what, estimate] :
       {std::pair("colour's rows are read over", times.readout),
        std::pair("depth's rows are read over", times.depth_readout),
        std::pair("depth is measured after its stamp by", times.depth_delay)}) {
    const double of_camera = had[k++], off = std::abs(estimate.seconds - of_camera);
    if (!estimate.told || off < kOff || off < kCertain * estimate.sigma_s) continue;
    findings.push_back({"time", fmt::format("{} {:.1f} ± {:.1f} ms, and {:.1f} ms by camera {} "
                                            "(`--calibrate-time` goes by what was measured)",
                                            what, 1e3 * estimate.seconds, 1e3 * estimate.sigma_s,
                                            1e3 * of_camera, camera.name)});
  }
  return findings;
}

TimeCalibration calibrate_time(const FrameSource& source, const Config& config, const TimeStretch& stretch) {
  TimeCalibration result;
  if (!source.has_depth() || source.camera().is_stereo()) {
    result.why_not = "times are calibrated of sequences with a depth sensor";
    return result;
  }
  for (int i = 0; i < stretch.tries; ++i) {
    const int first = i * stretch.frames, count = std::min(stretch.frames, source.size() - first);
    if (count < kFewestFrames) break;
    result = calibrate_stretch(source, config, first, count, stretch);
    if (result.readout.told) return result;
  }
  if (result.frames == 0)
    result.why_not = fmt::format("{} frames are too few: {} are needed", source.size(), kFewestFrames);
  return result;
}

}  // namespace stillpoint
