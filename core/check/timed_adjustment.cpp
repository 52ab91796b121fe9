#include "core/check/timed_adjustment.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/normal_equations.hpp"
#include "core/median.hpp"

namespace stillpoint {
namespace {

using Vector3 = Eigen::Vector3d;
using TimesInformation = Eigen::Matrix<double, kTimes, kTimes>;

constexpr double kLongestStep = 0.1;    // s between neighbours that tell how the camera moves
constexpr std::size_t kBlock = 10;      // frames whose errors may hang together
constexpr int kIterations = 15;         // at most: a step below kSmallestStep ends it
constexpr double kSmallestStep = 3e-5;  // s: a thousandth of a frame
// Standard deviations: 95 % as efficient as least squares where noise is normal.
constexpr double kHuber = 1.345;
constexpr double kGross = 6.0;        // standard deviations, beyond which a residual takes no part
constexpr double kNearestUsed = 0.2;  // m: nearer, no sensor measures

/// Least squares over the valid pixels about a feature; nothing at an outline or where little was measured.
std::optional<DepthPlane> plane_about(const cv::Mat& depth, const Eigen::Vector2d& pixel,
                                      double to_disparity) {
  // 81 places, over which depth's noise averages out, mostly on one surface.
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
      const double w = kKeptDepthUnits / static_cast<double>(z);
      const Vector3 a(1.0, x - pixel.x(), y - pixel.y());
      h += a * a.transpose(), g += w * a, squares += w * w, ++count;
    }
  if (count * 10 < all * 8) return std::nullopt;
  const Vector3 plane = solve_ldlt<3>(h, g);
  const double rms = std::sqrt(std::max(0.0, squares - plane.dot(g)) / count);
  if (plane[0] <= 0 || rms * to_disparity > kRoughest) return std::nullopt;
  return DepthPlane{{0, 0}, plane[0], plane.tail<2>()};
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
    frame.motion.parts = solve_ldlt(h, powers).bottomRows<3>();
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
  const double share = camera.row_share(s.row);  // of the readout, after the middle row
  const Vector3 p = frame.camera_from_world * point;
  if (!(p.z() >= kNearestUsed)) return std::nullopt;
  const Moved seen = moved(frame, p, share * times[0]);
  const Moved measured = moved(frame, p, frame.lag + times[2] + share * times[1]);
  if (!(seen.at.z() >= kNearestUsed && measured.at.z() >= kNearestUsed)) return std::nullopt;
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

}  // namespace

TimedAdjustment::Cross& TimedAdjustment::PointPart::cross_with(std::size_t frame) {
  for (auto back = cross.rbegin(); back != cross.rend(); ++back)
    if (back->first == frame) return back->second;
  return cross.emplace_back(frame, Cross::Zero()).second;
}

void TimedAdjustment::solve() {
  for (int i = 0; i < kIterations; ++i)
    if (step() < kSmallestStep) break;
  measure_uncertainty();
}

/// Calls `visit(frame index, sighting, row, weight)` for each residual that takes part.
template <typename Visit>
void TimedAdjustment::each_row(const Visit& visit) const {
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
void TimedAdjustment::look_up_depth() {
  const double to_disparity = camera_.fx * kKinectBaseline;
  for (SeenFrame& frame : stretch_.frames)
    for (Sighting& s : frame.sightings) {
      s.depth.reset();
      if (frame.depth.empty()) continue;
      const double share = camera_.row_share(s.row);
      const Vector3 p = frame.camera_from_world * stretch_.points[static_cast<std::size_t>(s.point)];
      const Vector3 then = moved(frame, p, frame.lag + times_[2] + share * times_[1]).at;
      if (!(then.z() >= kNearestUsed)) continue;
      const Eigen::Vector2d at = camera_.project(then);
      s.depth = plane_about(frame.depth, camera_.distort(at), to_disparity);
      if (s.depth) s.depth->about = at;
    }
}

void TimedAdjustment::measure_noise() {
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
void TimedAdjustment::linearise() {
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
double TimedAdjustment::step() {
  linearise();
  const Eigen::VectorXd x = -solve_ldlt(Eigen::MatrixXd(h_.selfadjointView<Eigen::Upper>()), g_);
  if (!x.allFinite()) return 0.0;
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
void TimedAdjustment::measure_uncertainty() {
  linearise();
  const auto frames = static_cast<Eigen::Index>(stretch_.frames.size());
  const Eigen::MatrixXd poses = h_.topLeftCorner(6 * frames, 6 * frames).selfadjointView<Eigen::Upper>();
  const Eigen::MatrixXd cross = h_.topRightCorner(6 * frames, kTimes);
  const Eigen::MatrixXd by_pose = solve_ldlt(poses, cross);
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

}  // namespace stillpoint
