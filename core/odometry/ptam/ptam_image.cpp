#include "core/odometry/ptam/ptam_image.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/geometry/normal_equations.hpp"

namespace stillpoint {
namespace {

constexpr int kSmallFactor = 16;  // full-size px a side of one: 40 x 30 of 640 x 480, as PTAM has it

float between(const cv::Mat& image, double x, double y) {
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  const auto a = static_cast<float>(x - u), b = static_cast<float>(y - v);
  const auto* top = image.ptr<std::uint8_t>(v) + u;
  const auto* bottom = image.ptr<std::uint8_t>(v + 1) + u;
  return (1 - b) * ((1 - a) * static_cast<float>(top[0]) + a * static_cast<float>(top[1])) +
         b * ((1 - a) * static_cast<float>(bottom[0]) + a * static_cast<float>(bottom[1]));
}

float between_small(const cv::Mat& image, double x, double y) {
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  const auto a = static_cast<float>(x - u), b = static_cast<float>(y - v);
  const auto* top = image.ptr<float>(v) + u;
  const auto* bottom = image.ptr<float>(v + 1) + u;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

/// Moves a found patch between pixels: inverse compositional, over place and mean. False where it strays.
bool refine(const PtamPatch& patch, const cv::Mat& image, int steps, Eigen::Vector2d& at) {
  constexpr double kStill = 0.03, kFar = 2.0;  // px of the level
  constexpr int kHalf = kPatch / 2;            // px from a patch's corner to its middle
  const Eigen::Vector2d begun = at;
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  std::array<Eigen::Vector3d, kPatch * kPatch> by;
  const auto value = [&](int x, int y) {
    return static_cast<double>(patch.values[static_cast<std::size_t>(y * kPatch + x)]);
  };
  for (int y = 1; y + 1 < kPatch; ++y)
    for (int x = 1; x + 1 < kPatch; ++x) {
      auto& j = by[static_cast<std::size_t>(y * kPatch + x)];
      j = {0.5 * (value(x + 1, y) - value(x - 1, y)), 0.5 * (value(x, y + 1) - value(x, y - 1)), 1.0};
      h += j * j.transpose();
    }
  const Eigen::LDLT<Eigen::Matrix3d> solver(h);
  if (solver.info() != Eigen::Success || std::abs(h.determinant()) < 1e-6) return false;
  double offset = 0.0;
  for (int i = 0; i < steps; ++i) {
    if (at.x() < kHalf + 1 || at.y() < kHalf + 1 || at.x() > image.cols - kHalf - 2 ||
        at.y() > image.rows - kHalf - 2)
      return false;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (int y = 1; y + 1 < kPatch; ++y)
      for (int x = 1; x + 1 < kPatch; ++x) {
        const double shown = static_cast<double>(between(image, at.x() + x - kHalf, at.y() + y - kHalf));
        b += (shown - value(x, y) + offset) * by[static_cast<std::size_t>(y * kPatch + x)];
      }
    const Eigen::Vector3d change = solver.solve(b);
    at -= change.head<2>();
    offset -= change[2];
    if (!at.allFinite() || (at - begun).norm() > kFar) return false;
    if (change.head<2>().norm() < kStill) return true;
  }
  return steps == 0;
}

}  // namespace

std::shared_ptr<const PtamImage> make_ptam_image(const cv::Mat& gray, const PtamConfig& config) {
  auto image = std::make_shared<PtamImage>();
  for (std::size_t i = 0; i < image->levels.size(); ++i) {
    if (i == 0)
      image->levels[0] = gray;
    else
      cv::resize(image->levels[i - 1], image->levels[i],
                 {image->levels[i - 1].cols / 2, image->levels[i - 1].rows / 2}, 0, 0, cv::INTER_AREA);
    std::vector<cv::KeyPoint> found;
    cv::FAST(image->levels[i], found, config.fast()[i], false);
    std::vector<cv::Point>& corners = image->corners[i];
    for (const cv::KeyPoint& one : found) corners.emplace_back(cvRound(one.pt.x), cvRound(one.pt.y));
    std::sort(corners.begin(), corners.end(),
              [](const cv::Point& a, const cv::Point& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    std::vector<int>& rows = image->row_begin[i];
    rows.assign(static_cast<std::size_t>(image->levels[i].rows) + 1, 0);
    for (const cv::Point& one : corners) ++rows[static_cast<std::size_t>(one.y) + 1];
    for (std::size_t row = 1; row < rows.size(); ++row) rows[row] += rows[row - 1];
  }
  cv::Mat numbers;
  cv::resize(gray, numbers, {gray.cols / kSmallFactor, gray.rows / kSmallFactor}, 0, 0, cv::INTER_AREA);
  numbers.convertTo(numbers, CV_32F);
  cv::GaussianBlur(numbers, image->small, {0, 0}, config.small_blur);
  image->small -= cv::mean(image->small)[0];
  return image;
}

double shi_tomasi(const cv::Mat& level, const cv::Point& at) {
  constexpr int kHalf = 3;  // px to each side: 7x7
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (int y = at.y - kHalf; y <= at.y + kHalf; ++y)
    for (int x = at.x - kHalf; x <= at.x + kHalf; ++x) {
      const double gx = level.at<std::uint8_t>(y, x + 1) - level.at<std::uint8_t>(y, x - 1),
                   gy = level.at<std::uint8_t>(y + 1, x) - level.at<std::uint8_t>(y - 1, x);
      xx += gx * gx, xy += gx * gy, yy += gy * gy;
    }
  constexpr double kPixels = (2 * kHalf + 1) * (2 * kHalf + 1);  // of the 7x7
  // Half a mean scatter, as PTAM has it.
  xx /= 2.0 * kPixels, xy /= 2.0 * kPixels, yy /= 2.0 * kPixels;
  return 0.5 * (xx + yy - std::sqrt((xx + yy) * (xx + yy) - 4.0 * (xx * yy - xy * xy)));
}

SmallTurn turn_between(const cv::Mat& then, const cv::Mat& now, const Camera& full) {
  constexpr int kSteps = 10;       // at most, as PTAM has it
  constexpr double kStill = 1e-5;  // rad: less than a thousandth of a small pixel
  SmallTurn turn;
  const Camera camera = full.scaled_to(now.cols, now.rows);
  for (int step = 0; step <= kSteps; ++step) {
    Eigen::Matrix4d h = Eigen::Matrix4d::Identity() * 1e-9;
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    double squares = 0.0;
    int count = 0;
    for (int y = 1; y + 1 < then.rows; ++y)
      for (int x = 1; x + 1 < then.cols; ++x) {
        const Eigen::Vector3d ray = turn.now_from_then * camera.back_project({x, y}, 1.0);
        if (ray.z() < 0.1) continue;
        const Eigen::Vector2d at = camera.project(ray);
        if (!(at.x() >= 1 && at.y() >= 1 && at.x() < now.cols - 2 && at.y() < now.rows - 2)) continue;
        const double r = static_cast<double>(between_small(now, at.x(), at.y()) - then.at<float>(y, x));
        const double gx = 0.5 * static_cast<double>(between_small(now, at.x() + 1, at.y()) -
                                                    between_small(now, at.x() - 1, at.y())),
                     gy = 0.5 * static_cast<double>(between_small(now, at.x(), at.y() + 1) -
                                                    between_small(now, at.x(), at.y() - 1));
        const double iz = 1.0 / ray.z();
        const double jx = gx * camera.fx * iz, jy = gy * camera.fy * iz;
        const Eigen::Vector3d by_ray(jx, jy, -(jx * ray.x() + jy * ray.y()) * iz);
        Eigen::Vector4d j;
        j << ray.cross(by_ray), 1.0;  // and a difference of the means
        h += j * j.transpose();
        b += r * j;
        squares += r * r;
        ++count;
      }
    if (count < 100) return {};
    turn.difference = squares / count;
    if (step == kSteps) break;
    const Eigen::Vector4d change = -solve_ldlt(h, b);
    if (!change.allFinite()) return {};
    turn.now_from_then = so3_exp(change.head<3>()) * turn.now_from_then;
    if (change.head<3>().norm() < kStill) break;
  }
  return turn;
}

double PtamPatch::difference(const cv::Mat& image, const cv::Point& at) const {
  constexpr int kHalf = kPatch / 2;  // px from a patch's corner to its middle
  if (at.x < kHalf || at.y < kHalf || at.x + kHalf > image.cols || at.y + kHalf > image.rows)
    return std::numeric_limits<double>::infinity();
  float squares = 0.0F, across = 0.0F;
  for (int y = 0; y < kPatch; ++y) {
    const auto* row = image.ptr<std::uint8_t>(at.y - kHalf + y) + at.x - kHalf;
    for (int x = 0; x < kPatch; ++x) {
      const float d = static_cast<float>(row[x]) - values[static_cast<std::size_t>(y * kPatch + x)];
      squares += d * d, across += d;
    }
  }
  constexpr float kPixels = kPatch * kPatch;
  // The mean of squares, less the square of the mean.
  return static_cast<double>((squares - across * across / kPixels) / kPixels);
}

std::optional<PtamPatch> warped_patch(const cv::Mat& source, const cv::Point& at,
                                      const Eigen::Matrix2d& warp) {
  // How many px² of the level one of the patch may cover, as PTAM has it.
  constexpr double kLargest = 3.0, kSmallest = 0.25;
  constexpr int kHalf = kPatch / 2;  // px from a patch's corner to its middle
  PtamPatch patch;
  double area = warp.determinant();
  while (area > kLargest && patch.level < PtamConfig::kLevels - 1) area *= 0.25, ++patch.level;
  if (!(area > kSmallest) || area > kLargest) return std::nullopt;
  const Eigen::Matrix2d source_from_view = warp.inverse() * (1 << patch.level);
  for (int y = 0; y < kPatch; ++y)
    for (int x = 0; x < kPatch; ++x) {
      const Eigen::Vector2d from =
          Eigen::Vector2d(at.x, at.y) + source_from_view * Eigen::Vector2d(x - kHalf, y - kHalf);
      if (!(from.x() >= 0 && from.y() >= 0 && from.x() < source.cols - 1 && from.y() < source.rows - 1))
        return std::nullopt;
      const float value = between(source, from.x(), from.y());
      patch.values[static_cast<std::size_t>(y * kPatch + x)] = value;
      patch.mean += static_cast<double>(value) / (kPatch * kPatch);
    }
  return patch;
}

std::optional<PtamFound> search_patch(const PtamPatch& patch, const PtamImage& image,
                                      const Eigen::Vector2d& about, double radius_px, double limit,
                                      int subpixel_steps) {
  const auto level = static_cast<std::size_t>(patch.level);
  const cv::Mat& shown = image.levels[level];
  const Eigen::Vector2d middle = to_level(about, patch.level);
  const double radius = std::max(1.0, radius_px / (1 << patch.level));
  const int top = std::max(0, static_cast<int>(std::floor(middle.y() - radius))),
            bottom = std::min(shown.rows - 1, static_cast<int>(std::ceil(middle.y() + radius)));
  cv::Point best;
  double least = limit;
  bool found = false;
  for (int row = top; row <= bottom; ++row) {
    const auto first = image.corners[level].begin() + image.row_begin[level][static_cast<std::size_t>(row)],
               end = image.corners[level].begin() + image.row_begin[level][static_cast<std::size_t>(row) + 1];
    const auto left = std::lower_bound(first, end, middle.x() - radius,
                                       [](const cv::Point& one, double x) { return one.x < x; });
    for (auto corner = left; corner != end && corner->x <= middle.x() + radius; ++corner) {
      if ((Eigen::Vector2d(corner->x, corner->y) - middle).squaredNorm() > radius * radius) continue;
      const double difference = patch.difference(shown, *corner);
      if (difference < least) least = difference, best = *corner, found = true;
    }
  }
  if (!found) return std::nullopt;
  PtamFound result;
  result.difference = least;
  Eigen::Vector2d at(best.x, best.y);
  if (subpixel_steps > 0) {
    if (!refine(patch, shown, subpixel_steps, at)) return std::nullopt;
    result.subpixel = true;
  }
  result.pixel = from_level(at, patch.level);
  return result;
}

}  // namespace stillpoint
