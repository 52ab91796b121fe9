#include "core/odometry/dso/dso_window.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/normal_equations.hpp"
#include "core/odometry/row_blocks.hpp"

namespace stillpoint {
namespace {

constexpr int kFrameSize = 8;  // pose, gain, offset

/// What one point's residual in one frame says.
struct Block {
  bool in_view = false, good = false;
  double energy = 0.0, squares = 0.0, mean = 0.0;
  DsoTransfer::Place at;
  Eigen::Matrix4d q_q = Eigen::Matrix4d::Zero();  // of (slope x, slope y, by gain, by offset)
  Eigen::Vector4d q_r = Eigen::Vector4d::Zero();
};

float weight_at(const cv::Mat& weight, double x, double y) {
  return weight.empty()
             ? 1.0F
             : weight.at<float>(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x)));
}

/// Compares a point's pattern with where it falls in another frame.
Block compare(const DsoPoint& point, const DsoFrame& host, const DsoFrame& target,
              const DsoTransfer& transfer, const DsoConfig& config) {
  Block block;
  const cv::Mat& image = target.image->levels.front();
  const auto middle = transfer(point.u, point.v, point.inverse_depth);
  if (!middle || !inside(image, middle->x, middle->y, kDsoReach)) return block;
  const float weight = point.static_weight * weight_at(target.weight, middle->x, middle->y);
  if (weight <= 0.0F) return block;
  block.at = *middle;
  const double gain = std::exp(target.affine.a - host.affine.a);
  for (std::size_t i = 0; i < kDsoPattern.size(); ++i) {
    const auto place =
        transfer(point.u + kDsoPattern[i][0], point.v + kDsoPattern[i][1], point.inverse_depth);
    if (!place || !inside(image, place->x, place->y, 1)) return Block{};
    const cv::Vec3f shown = sample(image, place->x, place->y);
    const double was = static_cast<double>(point.brightness[i]);
    const double r = photometric_residual(static_cast<double>(shown[0]), target.affine, was, host.affine);
    const double huber = huber_weight(r, config.huber);
    const double w = huber * static_cast<double>(point.softness[i]) * static_cast<double>(weight);
    block.energy += w * r * r * (2.0 - huber);
    block.squares += r * r;
    block.mean += r / static_cast<double>(kDsoPattern.size());
    const Eigen::Vector4d q(static_cast<double>(shown[1]), static_cast<double>(shown[2]),
                            -gain * (was - host.affine.b), 1.0);
    block.q_q.noalias() += w * q * q.transpose();
    block.q_r.noalias() += w * r * q;
  }
  block.in_view = true;
  block.good = block.energy <= std::max(host.outlier_energy, target.outlier_energy);
  return block;
}

/// Normal equations of the frames, the points already eliminated.
struct Equations {
  Eigen::MatrixXd h;
  Eigen::VectorXd b;
  double energy = 0.0, squares = 0.0;
  int good = 0, outliers = 0;
  Equations& operator+=(const Equations& other) {
    if (h.size() == 0) {
      h = other.h, b = other.b;
    } else if (other.h.size() != 0) {
      h += other.h, b += other.b;
    }
    energy += other.energy, squares += other.squares;
    good += other.good, outliers += other.outliers;
    return *this;
  }
};

/// What a point's inverse depth owes to the frames: its own step follows from theirs.
struct PointPart {
  double h = 0.0, b = 0.0;
  Eigen::VectorXd by_frames;
};

/// One linearisation of the window.
class Linearisation {
 public:
  Linearisation(const DsoWindow& window, const Camera& camera, const DsoConfig& config, int threads)
      : window_(window),
        camera_(camera),
        config_(config),
        size_(kFrameSize * static_cast<Eigen::Index>(window.frames.size())),
        parts_(window.points.size()) {
    const std::size_t frames = window.frames.size();
    transfers_.reserve(frames * frames);
    for (const DsoFrame& host : window.frames)
      for (const DsoFrame& target : window.frames)
        transfers_.emplace_back(camera, target.camera_from_world * host.camera_from_world.inverse(),
                                host.velocity, target.velocity);
    sum_ = sum_in_blocks<Equations>(static_cast<int>(window.points.size()), threads,
                                    [this](int first, int end) { return of_points(first, end); });
  }
  [[nodiscard]] const Equations& sum() const { return sum_; }

  /// Steps of frames, damped; then of points. The oldest frame is held.
  [[nodiscard]] Eigen::VectorXd step(double damping, std::vector<double>& of_points) const {
    const Eigen::Index free = size_ - kFrameSize;
    Eigen::MatrixXd h = sum_.h.bottomRightCorner(free, free);
    const Eigen::VectorXd b = sum_.b.tail(free);
    for (Eigen::Index i = 0; i < free; ++i) h(i, i) = h(i, i) * (1.0 + damping) + 1e-6;
    // Metres, radians and grey levels differ by orders of magnitude.
    const Eigen::VectorXd scale = h.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * h * scale.asDiagonal();
    Eigen::VectorXd change = Eigen::VectorXd::Zero(size_);
    change.tail(free) = -(scale.asDiagonal() * solve_ldlt(scaled, Eigen::VectorXd(scale.asDiagonal() * b)));
    of_points.resize(parts_.size());
    for (std::size_t i = 0; i < parts_.size(); ++i)
      of_points[i] = -(parts_[i].b + parts_[i].by_frames.dot(change)) / parts_[i].h;
    return change;
  }

 private:
  [[nodiscard]] Equations of_points(int first, int end) {
    Equations sum;
    sum.h = Eigen::MatrixXd::Zero(size_, size_);
    sum.b = Eigen::VectorXd::Zero(size_);
    for (int i = first; i < end; ++i) add_point(static_cast<std::size_t>(i), sum);
    return sum;
  }

  void add_point(std::size_t index, Equations& sum) {
    const DsoPoint& point = window_.points[index];
    const auto host = static_cast<std::size_t>(window_.index_of(point.host));
    PointPart& part = parts_[index];
    part.by_frames = Eigen::VectorXd::Zero(sum.b.size());
    // The sensed depth, weighed against brightness by what either is off usually.
    const double sensed = config_.noise * config_.noise / (config_.depth_sigma * config_.depth_sigma);
    const double off = point.inverse_depth - point.sensed_inverse_depth;
    part.h = sensed;
    part.b = sensed * off;
    sum.energy += sensed * off * off;
    for (std::size_t target = 0; target < window_.frames.size(); ++target) {
      if (target == host) continue;
      const DsoTransfer& transfer = transfers_[host * window_.frames.size() + target];
      const Block block = compare(point, window_.frames[host], window_.frames[target], transfer, config_);
      if (!block.in_view) continue;
      if (!block.good) {
        ++sum.outliers;
        sum.energy += std::max(window_.frames[host].outlier_energy, window_.frames[target].outlier_energy);
        continue;
      }
      ++sum.good;
      sum.energy += block.energy;
      sum.squares += block.squares;
      add_block(point, host, target, block, part, sum);
    }
    const double inverse = 1.0 / part.h;
    sum.h.noalias() -= inverse * part.by_frames * part.by_frames.transpose();
    sum.b.noalias() -= inverse * part.b * part.by_frames;
  }

  void add_block(const DsoPoint& point, std::size_t host, std::size_t target, const Block& block,
                 PointPart& part, Equations& sum) const {
    const Pose target_from_host =
        window_.frames[target].camera_from_world * window_.frames[host].camera_from_world.inverse();
    const Eigen::Vector3d &p = block.at.in_target, &q = block.at.in_host;
    const double iz = 1.0 / p.z();
    Eigen::Matrix<double, 2, 3> by_target_point;
    by_target_point << camera_.fx * iz, 0, -camera_.fx * p.x() * iz * iz, 0, camera_.fy * iz,
        -camera_.fy * p.y() * iz * iz;
    const Eigen::Matrix<double, 2, 3> by_host_point = by_target_point * target_from_host.linear();
    // Rows: pixel sideways, down, gain, offset. Columns: the frame's six of the pose, gain, offset.
    Eigen::Matrix<double, 4, kFrameSize> by_host = Eigen::Matrix<double, 4, kFrameSize>::Zero(),
                                         by_target = by_host;
    by_target.topLeftCorner<2, 3>() = by_target_point;
    by_target.block<2, 3>(0, 3) = -by_target_point * hat(p);
    by_target(2, 6) = 1.0;
    by_target(3, 7) = -1.0;
    by_host.topLeftCorner<2, 3>() = -by_host_point;
    by_host.block<2, 3>(0, 3) = by_host_point * hat(q);
    by_host(2, 6) = -1.0;
    by_host(3, 7) = std::exp(window_.frames[target].affine.a - window_.frames[host].affine.a);
    Eigen::Vector4d by_depth = Eigen::Vector4d::Zero();
    by_depth.head<2>() = by_host_point * (-q / point.inverse_depth);

    const Eigen::Index h = kFrameSize * static_cast<Eigen::Index>(host),
                       t = kFrameSize * static_cast<Eigen::Index>(target);
    const Eigen::Matrix<double, 4, kFrameSize> qh = block.q_q * by_host, qt = block.q_q * by_target;
    sum.h.block<kFrameSize, kFrameSize>(h, h).noalias() += by_host.transpose() * qh;
    sum.h.block<kFrameSize, kFrameSize>(t, t).noalias() += by_target.transpose() * qt;
    const Eigen::Matrix<double, kFrameSize, kFrameSize> across = by_host.transpose() * qt;
    sum.h.block<kFrameSize, kFrameSize>(h, t) += across;
    sum.h.block<kFrameSize, kFrameSize>(t, h) += across.transpose();
    sum.b.segment<kFrameSize>(h).noalias() += by_host.transpose() * block.q_r;
    sum.b.segment<kFrameSize>(t).noalias() += by_target.transpose() * block.q_r;
    part.h += by_depth.dot(block.q_q * by_depth);
    part.b += by_depth.dot(block.q_r);
    part.by_frames.segment<kFrameSize>(h).noalias() += qh.transpose() * by_depth;
    part.by_frames.segment<kFrameSize>(t).noalias() += qt.transpose() * by_depth;
  }

  const DsoWindow& window_;  // while it is made, and not afterwards
  const Camera& camera_;
  const DsoConfig& config_;
  Eigen::Index size_;
  std::vector<DsoTransfer> transfers_;
  std::vector<PointPart> parts_;
  Equations sum_;
};

double rmse(const Equations& sum) {
  return sum.good > 0 ? std::sqrt(sum.squares / (static_cast<double>(kDsoPattern.size()) * sum.good)) : 0.0;
}

/// DSO adapts a frame's bound to its own residuals: half of 1.5 times their 70th percentile, half of 26.
void adapt_outlier_energy(DsoWindow& window, std::size_t frame, const Camera& camera,
                          const DsoConfig& config) {
  // A share, a factor, and grey levels over a whole pattern.
  constexpr double kQuantile = 0.7, kTimes = 1.5, kConstant = 26.0;
  std::vector<double> energies;
  DsoFrame& target = window.frames[frame];
  for (const DsoPoint& point : window.points) {
    const int host = window.index_of(point.host);
    if (host < 0 || host == static_cast<int>(frame)) continue;
    const DsoFrame& from = window.frames[static_cast<std::size_t>(host)];
    const DsoTransfer transfer(camera, target.camera_from_world * from.camera_from_world.inverse(),
                               from.velocity, target.velocity);
    const Block block = compare(point, from, target, transfer, config);
    if (block.in_view) energies.push_back(block.energy);
  }
  if (energies.empty()) return;
  const auto at =
      energies.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(energies.size()));
  std::nth_element(energies.begin(), at, energies.end());
  const double bound = 0.5 * kConstant + 0.5 * kTimes * std::sqrt(*at);
  target.outlier_energy = bound * bound;
}

}  // namespace

DsoOptimisation DsoWindow::optimise(const Camera& camera, const DsoConfig& config, int threads) {
  DsoOptimisation done;
  if (frames.size() < 2 || points.empty()) return done;
  adapt_outlier_energy(*this, frames.size() - 1, camera, config);
  double damping = 0.1;
  auto now = std::make_unique<Linearisation>(*this, camera, config, threads);
  done.rmse_before = rmse(now->sum());
  for (int i = 0; i < config.iterations; ++i) {
    // The damping goes by factors, as in DSO, down to kLeast. A smaller step than kStill changes nothing.
    constexpr double kWorse = 100.0, kBetter = 0.25, kLeast = 1e-5, kStill = 1e-6;
    std::vector<double> of_points;
    const Eigen::VectorXd change = now->step(damping, of_points);
    if (!change.allFinite()) break;
    DsoWindow moved = *this;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const auto at = kFrameSize * static_cast<Eigen::Index>(f);
      const Vector6d pose = change.segment<6>(at);
      moved.frames[f].camera_from_world = normalised(se3_exp(pose) * frames[f].camera_from_world);
      moved.frames[f].affine.a += change[at + 6];
      moved.frames[f].affine.b += change[at + 7];
    }
    for (std::size_t p = 0; p < points.size(); ++p)
      moved.points[p].inverse_depth = std::max(1e-3, points[p].inverse_depth + of_points[p]);
    auto next = std::make_unique<Linearisation>(moved, camera, config, threads);
    if (next->sum().energy > now->sum().energy) {
      damping *= kWorse;
      continue;
    }
    frames = std::move(moved.frames);
    points = std::move(moved.points);
    now = std::move(next);
    damping = std::max(kLeast, kBetter * damping);
    ++done.iterations;
    if (change.norm() < kStill) break;
  }
  done.rmse_after = rmse(now->sum());
  done.residuals = now->sum().good;
  done.outliers = now->sum().outliers;
  for (DsoPoint& point : points) point.seen = 0;
  for (const DsoResidual& residual : residuals(camera, config))
    points[static_cast<std::size_t>(residual.point)].seen += residual.good ? 1 : 0;
  return done;
}

std::vector<DsoResidual> DsoWindow::residuals(const Camera& camera, const DsoConfig& config) const {
  std::vector<DsoResidual> all;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const int host = index_of(points[p].host);
    if (host < 0) continue;
    const DsoFrame& from = frames[static_cast<std::size_t>(host)];
    for (std::size_t f = 0; f < frames.size(); ++f) {
      if (static_cast<int>(f) == host) continue;
      const DsoTransfer transfer(camera, frames[f].camera_from_world * from.camera_from_world.inverse(),
                                 from.velocity, frames[f].velocity);
      const Block block = compare(points[p], from, frames[f], transfer, config);
      if (!block.in_view) continue;
      all.push_back({static_cast<int>(p), static_cast<int>(f), block.at.x, block.at.y,
                     static_cast<float>(block.mean), block.good});
    }
  }
  return all;
}

}  // namespace stillpoint
