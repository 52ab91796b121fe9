#include "core/odometry/bamvo/dense_alignment.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/geometry/normal_equations.hpp"
#include "core/motion/rgbd_view.hpp"
#include "core/odometry/row_blocks.hpp"

namespace stillpoint {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Residuals' distribution as the last step found it; infinite sigma before the first.
struct Spread {
  double mean = 0.0, sigma = std::numeric_limits<double>::infinity();
  /// Student's t weight of a residual.
  [[nodiscard]] double weight(double residual, double freedom) const {
    const double off = (residual - mean) / sigma;
    return (freedom + 1.0) / (freedom + off * off);
  }
};

struct NormalEquations {
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  NormalEquations& operator+=(const NormalEquations& other) {
    h += other.h, b += other.b;
    return *this;
  }
};

struct Moments {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  Moments& operator+=(const Moments& other) {
    sum += other.sum, squares += other.squares, count += other.count;
    return *this;
  }
};

/// A level's way: residuals under a pose, then a step from them.
class Level {
 public:
  Level(const DenseView& reference, const DenseView& target, const BamvoConfig& config, int threads)
      : reference_(reference), target_(target), config_(config), threads_(threads) {
    cv::Sobel(reference.gray, slope_x_, CV_32F, 1, 0, 3, 1.0 / 8.0);
    cv::Sobel(reference.gray, slope_y_, CV_32F, 0, 1, 3, 1.0 / 8.0);
    residual_.create(reference.gray.size(), CV_32FC1);
    weight_.create(reference.gray.size(), CV_32FC1);
  }

  /// r(x) = I_ref(x) - I_target(w(x, T)) of every pixel that counts; NaN of the others.
  [[nodiscard]] Moments compare(const Pose& target_from_reference) {
    return sum_in_blocks<Moments>(reference_.gray.rows, threads_, [&](int first, int end) {
      Moments moments;
      for (int y = first; y < end; ++y) compare_row(target_from_reference, y, moments);
      return moments;
    });
  }

  /// The next distribution of residuals, by one step of its fixed point.
  [[nodiscard]] Spread spread(const Moments& moments, const Spread& last) const {
    const double mean = moments.sum / moments.count;
    const Spread about{mean, last.sigma};
    const Moments squares = sum_in_blocks<Moments>(residual_.rows, threads_, [&](int first, int end) {
      Moments block;
      for (int y = first; y < end; ++y)
        for (int x = 0; x < residual_.cols; ++x) {
          const double r = static_cast<double>(residual_.at<float>(y, x));
          if (std::isnan(r)) continue;
          block.squares += (r - mean) * (r - mean) * about.weight(r, config_.student_freedom);
        }
      return block;
    });
    constexpr double kLeastSigma = 1e-5;  // of brightness: images are rounded to 1/255
    return {mean, std::max(kLeastSigma, std::sqrt(squares.squares / moments.count))};
  }

  [[nodiscard]] NormalEquations equations(const Spread& spread) {
    return sum_in_blocks<NormalEquations>(residual_.rows, threads_, [&](int first, int end) {
      NormalEquations sum;
      for (int y = first; y < end; ++y) add_row(spread, y, sum);
      return sum;
    });
  }

  [[nodiscard]] const cv::Mat& residual() const { return residual_; }
  [[nodiscard]] const cv::Mat& weight() const { return weight_; }

 private:
  [[nodiscard]] bool in_range(float z) const {
    return z >= static_cast<float>(config_.nearest_m) && z <= static_cast<float>(config_.farthest_m);
  }

  void compare_row(const Pose& pose, int y, Moments& moments) {
    const Camera& camera = reference_.camera;
    const cv::Mat& gray = target_.gray;
    const float* depth = reference_.depth.ptr<float>(y);
    const float* brightness = reference_.gray.ptr<float>(y);
    const float* background = reference_.weight.empty() ? nullptr : reference_.weight.ptr<float>(y);
    float* residual = residual_.ptr<float>(y);
    float* weight = weight_.ptr<float>(y);
    for (int x = 0; x < residual_.cols; ++x) {
      residual[x] = weight[x] = kNone;
      const float prior = background == nullptr ? 1.0F : background[x];
      if (prior <= 0.0F || !in_range(depth[x])) continue;
      const Eigen::Vector3d p = pose * camera.back_project({x, y}, static_cast<double>(depth[x]));
      if (p.z() <= 0.0) continue;
      const Eigen::Vector2d at = camera.project(p);
      if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < gray.cols - 1 && at.y() < gray.rows - 1)) continue;
      const int u = static_cast<int>(at.x()), v = static_cast<int>(at.y());
      const int near_u = static_cast<int>(std::lround(at.x())),
                near_v = static_cast<int>(std::lround(at.y()));
      const float met = target_.depth.at<float>(near_v, near_u);
      if (!in_range(met) || std::abs(static_cast<double>(met) - p.z()) >
                                config_.max_depth_difference_m + 2.0 * camera.stereo_sigma(p.z()))
        continue;
      const float theirs = target_.weight.empty() ? 1.0F : target_.weight.at<float>(near_v, near_u);
      if (theirs <= 0.0F) continue;
      const auto a = static_cast<float>(at.x() - u), b = static_cast<float>(at.y() - v);
      const float* top = gray.ptr<float>(v) + u;
      const float* bottom = gray.ptr<float>(v + 1) + u;
      const float shown =
          (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
      residual[x] = brightness[x] - shown;
      weight[x] = prior * theirs;
      moments.sum += static_cast<double>(residual[x]);
      ++moments.count;
    }
  }

  /// Turns the row's background weights into whole ones.
  void add_row(const Spread& spread, int y, NormalEquations& sum) {
    const Camera& camera = reference_.camera;
    for (int x = 0; x < residual_.cols; ++x) {
      const float r = residual_.at<float>(y, x);
      if (std::isnan(r)) continue;
      const double residual = static_cast<double>(r);
      float& weight = weight_.at<float>(y, x);
      weight *= static_cast<float>(spread.weight(residual, config_.student_freedom));
      const double z = static_cast<double>(reference_.depth.at<float>(y, x));
      const Eigen::Vector3d p = camera.back_project({x, y}, z);
      const double jx = static_cast<double>(slope_x_.at<float>(y, x)) * camera.fx / z,
                   jy = static_cast<double>(slope_y_.at<float>(y, x)) * camera.fy / z;
      const Eigen::Vector3d by_point(jx, jy, -(jx * p.x() + jy * p.y()) / z);
      Vector6d j;
      j << by_point, p.cross(by_point);
      const auto w = static_cast<double>(weight);
      sum.h.noalias() += w * j * j.transpose();
      sum.b.noalias() += w * residual * j;
    }
  }

  const DenseView& reference_;
  const DenseView& target_;
  const BamvoConfig& config_;
  int threads_;
  cv::Mat slope_x_, slope_y_, residual_, weight_;
};

}  // namespace

cv::Mat picked(const cv::Mat& image, int factor) {
  if (image.empty() || factor == 1) return image;
  cv::Mat small(image.rows / factor, image.cols / factor, CV_32FC1);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x)
      small.at<float>(y, x) = image.at<float>(y * factor + factor / 2, x * factor + factor / 2);
  return small;
}

cv::Mat averaged_depth(const cv::Mat& depth, int factor) {
  if (depth.empty() || factor == 1) return depth;
  cv::Mat small(depth.rows / factor, depth.cols / factor, CV_32FC1);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x) {
      const float middle = depth.at<float>(y * factor + factor / 2, x * factor + factor / 2);
      float sum = 0.0F;
      int count = 0;
      for (int v = y * factor; v < (y + 1) * factor; ++v)
        for (int u = x * factor; u < (x + 1) * factor; ++u)
          if (const float z = depth.at<float>(v, u); z > 0.0F && same_surface(z, middle)) sum += z, ++count;
      small.at<float>(y, x) = middle > 0.0F ? sum / static_cast<float>(count) : 0.0F;
    }
  return small;
}

DenseView make_dense_view(const cv::Mat& gray, const cv::Mat& depth, const Camera& camera, int factor) {
  DenseView view;
  const cv::Size size(gray.cols / factor, gray.rows / factor);
  cv::Mat whole;
  gray.convertTo(whole, CV_32F, 1.0 / 255.0);
  if (factor == 1)
    view.gray = whole;
  else
    cv::resize(whole, view.gray, size, 0, 0, cv::INTER_AREA);
  view.depth = averaged_depth(depth, factor);
  view.camera = camera.scaled_to(size.width, size.height);
  return view;
}

DenseView halved(const DenseView& view) {
  DenseView half;
  const cv::Size size(view.gray.cols / 2, view.gray.rows / 2);
  cv::resize(view.gray, half.gray, size, 0, 0, cv::INTER_AREA);
  half.depth = averaged_depth(view.depth, 2);
  half.weight = picked(view.weight, 2);
  half.camera = view.camera.scaled_to(size.width, size.height);
  return half;
}

DenseAlignment align_dense(const std::vector<DenseView>& reference, const std::vector<DenseView>& target,
                           const Pose& start, const BamvoConfig& config, int threads) {
  constexpr double kStill = 1e-6;  // m and rad: a shorter step ends a level
  DenseAlignment result;
  result.target_from_reference = start;
  Spread spread;
  for (std::size_t i = reference.size(); i-- > 0;) {
    Level level(reference[i], target[i], config, threads);
    Moments moments;
    const int wanted = std::max(6, config.min_pixels >> (2 * static_cast<int>(i)));
    for (int step = 0; step < config.iterations; ++step) {
      moments = level.compare(result.target_from_reference);
      if (moments.count < wanted) {
        result.failure = fmt::format("only {} pixels with depth count; {} must", moments.count, wanted);
        return result;
      }
      const NormalEquations equations = level.equations(spread);
      spread = level.spread(moments, spread);
      const std::optional<Vector6d> change = try_solve_ldlt<6>(equations.h, -equations.b);
      if (!change) {
        result.failure = "the pixels that count leave a motion undecided";
        return result;
      }
      // The reference's gradients: the step is of the reference, and is taken off.
      result.target_from_reference = normalised(result.target_from_reference * se3_exp(*change).inverse());
      ++result.iterations;
      if (change->norm() < kStill) break;
    }
    if (i > 0) continue;
    moments = level.compare(result.target_from_reference);
    (void)level.equations(spread);
    result.counted = moments.count;
    result.mean = spread.mean;
    result.sigma = spread.sigma;
    result.residual = level.residual();
    result.weight = level.weight();
  }
  return result;
}

}  // namespace stillpoint
