#include "core/odometry/direct_level.hpp"

#include <algorithm>
#include <cmath>

#include "core/median.hpp"

namespace stillpoint {
namespace {

constexpr double kNearestAligned = 0.1;  // m: nearer, nothing is measured, and pixels run off to infinity
constexpr double kLeastNoise = 1.0;      // grey levels: images are rounded to whole ones
constexpr int kHalf = DirectLevel::kSide / 2;  // px from a patch's middle to its last ones

/// A CV_8UC1 image between its pixels, over a square block; the block lies inside.
template <int kBlock>
void sample_block(const cv::Mat& image, float u, float v, std::array<float, kBlock * kBlock>& values) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const float w00 = (1 - a) * (1 - b), w01 = a * (1 - b), w10 = (1 - a) * b, w11 = a * b;
  for (int r = 0; r < kBlock; ++r) {
    const auto* top = image.ptr<std::uint8_t>(y - kBlock / 2 + r) + x - kBlock / 2;
    const auto* bottom = image.ptr<std::uint8_t>(y - kBlock / 2 + r + 1) + x - kBlock / 2;
    for (int c = 0; c < kBlock; ++c)
      values[static_cast<std::size_t>(r * kBlock + c)] =
          w00 * static_cast<float>(top[c]) + w01 * static_cast<float>(top[c + 1]) +
          w10 * static_cast<float>(bottom[c]) + w11 * static_cast<float>(bottom[c + 1]);
  }
}

bool block_inside(const cv::Mat& image, const cv::Point2f& at, int half) {
  const auto least = static_cast<float>(half);
  return at.x >= least && at.y >= least && at.x < static_cast<float>(image.cols - half - 1) &&
         at.y < static_cast<float>(image.rows - half - 1);
}

/// Of a pixel of the level by a perturbation of the point: rotation and translation, the latter first. A
/// lens's distortion is left out: it bends directions by some per cent, which only costs steps.
Eigen::Matrix<double, 2, 6> pixel_by_pose(const Camera& camera, const Eigen::Vector3d& p, double scale) {
  const double iz = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << camera.fx * iz, 0, -camera.fx * p.x() * iz * iz, 0, camera.fy * iz,
      -camera.fy * p.y() * iz * iz;
  Eigen::Matrix<double, 2, 6> j;
  j << scale * by_point, -scale * by_point * hat(p);
  return j;
}

}  // namespace

DirectLevel::DirectLevel(const std::vector<PatchPoint>& patches, const cv::Mat& reference,
                         const cv::Mat& target, int level, const Camera& camera, const DirectTarget& frame)
    : camera_(camera), frame_(frame), image_(target), level_(level), scale_(std::ldexp(1.0, -level)) {
  // Cells closer than two pixels of a coarse level tell the same.
  const int every = std::max(1, (1 << level) / 8);
  for (const PatchPoint& from : patches) {
    if (from.column % every != 0 || from.row % every != 0) continue;
    const cv::Point2f at = from.pixel * static_cast<float>(scale_);
    if (!block_inside(reference, at, kHalf + 1)) continue;
    std::array<float, (kSide + 2) * (kSide + 2)> block{};
    sample_block<kSide + 2>(reference, at.x, at.y, block);
    Patch patch;
    patch.point = from.point;
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const auto i = static_cast<std::size_t>(r * kSide + c);
        const auto b = static_cast<std::size_t>((r + 1) * (kSide + 2) + c + 1);
        patch.value[i] = block[b];
        patch.slope_x[i] = 0.5F * (block[b + 1] - block[b - 1]);
        patch.slope_y[i] = 0.5F * (block[b + kSide + 2] - block[b - kSide - 2]);
      }
    patch.by_pose = pixel_by_pose(camera, from.point, scale_);
    patches_.push_back(patch);
  }
}

bool DirectLevel::place(const Eigen::Vector3d& in_target, const Vector6d& velocity, cv::Point2f& full) const {
  Eigen::Vector3d p = in_target;
  if (p.z() < kNearestAligned) return false;
  Eigen::Vector2d pixel = camera_.has_distortion() ? camera_.distort(camera_.project(p)) : camera_.project(p);
  if (camera_.readout_s != 0.0) {
    // Where its row, exposed before or after the middle one, shows it.
    const double after_middle = camera_.row_time(pixel.y());
    p += after_middle * (velocity.head<3>() + velocity.tail<3>().cross(p));
    if (p.z() < kNearestAligned) return false;
    pixel = camera_.has_distortion() ? camera_.distort(camera_.project(p)) : camera_.project(p);
  }
  full = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  return block_inside(image_, full * static_cast<float>(scale_), kHalf) && !covers(frame_.moving, full);
}

DirectLevel::Comparison DirectLevel::compare(const DirectState& state) {
  const Vector6d velocity =
      frame_.velocity ? frame_.velocity(state.target_from_reference) : Vector6d(Vector6d::Zero());
  const auto gain = static_cast<float>(state.gain), bias = static_cast<float>(state.bias);
  Comparison result;
  std::vector<float> sizes;
  sizes.reserve(patches_.size() * kPixels);
  double both = 0.0, own = 0.0, theirs = 0.0;
  for (Patch& patch : patches_) {
    patch.in_view = place(state.target_from_reference * patch.point, velocity, patch.pixel);
    if (!patch.in_view) continue;
    ++result.in_view;
    std::array<float, kPixels> values{};
    const cv::Point2f at = patch.pixel * static_cast<float>(scale_);
    sample_block<kSide>(image_, at.x, at.y, values);
    float mean = 0.0F, reference_mean = 0.0F;
    for (std::size_t i = 0; i < kPixels; ++i) mean += values[i], reference_mean += patch.value[i];
    mean /= kPixels, reference_mean /= kPixels;
    for (std::size_t i = 0; i < kPixels; ++i) {
      patch.residual[i] = values[i] - (gain * patch.value[i] + bias);
      sizes.push_back(std::abs(patch.residual[i]));
      result.mean_difference += static_cast<double>(sizes.back());
      const auto a = static_cast<double>(values[i] - mean),
                 b = static_cast<double>(patch.value[i] - reference_mean);
      both += a * b, own += a * a, theirs += b * b;
    }
  }
  if (sizes.empty()) return result;
  result.mean_difference /= static_cast<double>(sizes.size());
  result.noise = std::max(kLeastNoise, 1.4826 * static_cast<double>(median_of(sizes)));
  if (own > 0 && theirs > 0) result.correlation = both / std::sqrt(own * theirs);
  double squares = 0.0, weights = 0.0;
  for (const float size : sizes) {
    const double weight = student_weight(static_cast<double>(size) / result.noise);
    squares += weight * static_cast<double>(size) * static_cast<double>(size);
    weights += weight;
  }
  result.rms = std::sqrt(squares / weights);
  return result;
}

DirectLevel::Equations DirectLevel::equations(const DirectState& state, const Comparison& comparison) const {
  Equations n;
  for (const Patch& patch : patches_) {
    if (!patch.in_view) continue;
    // Within a patch the Jacobian by the pose differs by the slopes alone: their sums suffice.
    double xx = 0, xy = 0, yy = 0, x_value = 0, y_value = 0, x_one = 0, y_one = 0, x_residual = 0,
           y_residual = 0;
    double value_value = 0, value_one = 0, one_one = 0, value_residual = 0, one_residual = 0;
    for (std::size_t i = 0; i < kPixels; ++i) {
      const auto r = static_cast<double>(patch.residual[i]), value = static_cast<double>(patch.value[i]);
      const double w = student_weight(r / comparison.noise);
      const double x = state.gain * static_cast<double>(patch.slope_x[i]),
                   y = state.gain * static_cast<double>(patch.slope_y[i]);
      xx += w * x * x, xy += w * x * y, yy += w * y * y;
      x_value += w * x * value, y_value += w * y * value, x_one += w * x, y_one += w * y;
      x_residual += w * x * r, y_residual += w * y * r;
      value_value += w * value * value, value_one += w * value, one_one += w;
      value_residual += w * value * r, one_residual += w * r;
    }
    const Eigen::Matrix<double, 2, 6>& j = patch.by_pose;
    const Eigen::Matrix2d slopes = (Eigen::Matrix2d() << xx, xy, xy, yy).finished();
    n.h.topLeftCorner<6, 6>() += j.transpose() * (slopes * j);
    n.h.block<6, 1>(0, 6) += j.transpose() * Eigen::Vector2d(x_value, y_value);
    n.h.block<6, 1>(0, 7) += j.transpose() * Eigen::Vector2d(x_one, y_one);
    n.h(6, 6) += value_value, n.h(6, 7) += value_one, n.h(7, 7) += one_one;
    n.g.head<6>() -= j.transpose() * Eigen::Vector2d(x_residual, y_residual);
    n.g[6] -= value_residual, n.g[7] -= one_residual;
  }
  n.h = n.h.selfadjointView<Eigen::Upper>();
  return n;
}

std::vector<DirectPatch> DirectLevel::seen(const Comparison& comparison) const {
  std::vector<DirectPatch> all;
  for (const Patch& patch : patches_) {
    if (!patch.in_view) continue;
    DirectPatch one{patch.pixel};
    for (const float r : patch.residual) {
      one.residual += r / static_cast<float>(kPixels);
      one.weight += static_cast<float>(student_weight(static_cast<double>(r) / comparison.noise) / kPixels);
    }
    all.push_back(one);
  }
  return all;
}

double DirectLevel::correlation_at(const Pose& target_from_reference) const {
  constexpr std::size_t kMiddle = kPixels / 2;  // the place of the middle pixel in a patch
  double count = 0, a_sum = 0, b_sum = 0, aa = 0, bb = 0, ab = 0;
  for (const Patch& patch : patches_) {
    cv::Point2f full;
    if (!place(target_from_reference * patch.point, Vector6d::Zero(), full)) continue;
    const cv::Point2f at = full * static_cast<float>(scale_);
    std::array<float, 1> value{};
    sample_block<1>(image_, at.x, at.y, value);
    const auto a = static_cast<double>(value[0]), b = static_cast<double>(patch.value[kMiddle]);
    count += 1, a_sum += a, b_sum += b, aa += a * a, bb += b * b, ab += a * b;
  }
  if (count < 0.5 * static_cast<double>(patches_.size()) || count < 2) return 0.0;
  const double spread = (aa - a_sum * a_sum / count) * (bb - b_sum * b_sum / count);
  return spread > 0 ? (ab - a_sum * b_sum / count) / std::sqrt(spread) : 0.0;
}

}  // namespace stillpoint
