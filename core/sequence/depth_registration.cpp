#include "core/sequence/depth_registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

constexpr double kStep = 0.03;  // of depth; neighbours that differ by more are no one surface
constexpr double kLargestDrawn =
    64.0;  // px; what covers more has no sensible calibration, or grazes the lens

/// A point where the colour camera sees it.
struct Seen {
  double x = 0, y = 0;  ///< px of the colour image as stored
  double inverse = 0;   ///< 1/m; 0 = it is not seen
};

Seen look(const Camera& colour, const Pose& colour_from_depth, const Eigen::Vector3d& ray, double z) {
  const Eigen::Vector3d point = colour_from_depth * (ray * z);
  if (point.z() < kNearestProjected) return {};
  const Eigen::Vector2d pixel = colour.distort(colour.project(point));
  return {pixel.x(), pixel.y(), 1.0 / point.z()};
}

/// Inverse depths of an image, nearest first.
class ZBuffer {
 public:
  explicit ZBuffer(cv::Size size) : inverse_(size, CV_32FC1, cv::Scalar(0)) {}

  /// A triangle with its sides and corners. Either side may face the camera.
  void draw(const Seen& a, const Seen& b, const Seen& c) {
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const double left = std::min(a.x, std::min(b.x, c.x)), right = std::max(a.x, std::max(b.x, c.x));
    const double top = std::min(a.y, std::min(b.y, c.y)), bottom = std::max(a.y, std::max(b.y, c.y));
    if (!(std::abs(area) > kFlat) || !(right - left < kLargestDrawn) || !(bottom - top < kLargestDrawn))
      return;
    const double share = 1.0 / area;
    const int x0 = first(left, inverse_.cols), x1 = last(right, inverse_.cols);
    const int y0 = first(top, inverse_.rows), y1 = last(bottom, inverse_.rows);
    for (int y = y0; y <= y1; ++y) {
      float* const row = inverse_.ptr<float>(y);
      for (int x = x0; x <= x1; ++x) {
        const double of_b = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) * share;
        const double of_c = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) * share;
        // A little over the side, so that rounding opens no seam between two triangles.
        if (of_b < -kSeam || of_c < -kSeam || of_b + of_c > 1.0 + kSeam) continue;
        const double inverse = a.inverse + of_b * (b.inverse - a.inverse) + of_c * (c.inverse - a.inverse);
        row[x] = std::max(row[x], static_cast<float>(inverse));
      }
    }
  }

  /// What a pixel's square covers, all at one depth. @param corners in the square's order
  void draw_square(const std::array<Seen, 4>& corners, double inverse) {
    std::array<Seen, 4> flat = corners;
    for (Seen& corner : flat) corner.inverse = inverse;
    draw(flat[0], flat[1], flat[2]);
    draw(flat[0], flat[2], flat[3]);
  }

  [[nodiscard]] const cv::Mat& inverse() const { return inverse_; }

 private:
  // A triangle of less than half kFlat px² covers nothing. Shares of a side: more than rounding opens.
  static constexpr double kFlat = 1e-9, kSeam = 1e-7;
  // Pixel centres lie at whole numbers. (std::ceil and std::floor are calls of the C library.)
  static int first(double from, int count) {
    const double inside = std::clamp(from - kSeam, 0.0, static_cast<double>(count));
    const int whole = static_cast<int>(inside);
    return whole + (inside > whole ? 1 : 0);
  }
  static int last(double to, int count) {
    return static_cast<int>(std::clamp(to + kSeam, -1.0, count - 1.0) + 1.0) - 1;
  }

  cv::Mat inverse_;  // CV_32FC1, 1/m, 0 = nothing
};

bool is_one_surface(const std::array<float, 3>& z) {
  const float least = std::min(z[0], std::min(z[1], z[2])), most = std::max(z[0], std::max(z[1], z[2]));
  return most - least <= static_cast<float>(kStep) * least;
}

}  // namespace

DepthRegistration::DepthRegistration(const DepthCamera& depth, const Camera& colour)
    : depth_(depth), colour_(colour) {
  const Camera& camera = depth_.camera;
  const auto ray = [&camera](const Eigen::Vector2d& pixel) {
    return camera.back_project(camera.undistorted(pixel), 1.0);
  };
  for (int y = 0; y <= camera.height; ++y)
    for (int x = 0; x <= camera.width; ++x) corners_.push_back(ray(to_pixel(RasterPoint(x, y))));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) centres_.push_back(ray({x, y}));
}

cv::Mat DepthRegistration::registered(const cv::Mat& depth) const {
  const int width = depth.cols, height = depth.rows;
  const cv::Size size(colour_.width, colour_.height);
  const auto at = [](int x, int y, int columns) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
  };
  std::vector<Seen> seen(centres_.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (const double z = depth.at<float>(y, x); z > 0)
        seen[at(x, y, width)] = look(colour_, depth_.colour_from_depth, centres_[at(x, y, width)], z);
  ZBuffer surface(size), squares(size);
  std::vector<std::uint8_t> triangles(seen.size(), 0);  // that a pixel is a corner of
  using Place = std::array<int, 2>;
  const auto triangle = [&](const std::array<Place, 3>& corners) {
    std::array<std::size_t, 3> i{};
    std::array<float, 3> z{};
    for (std::size_t k = 0; k < 3; ++k) {
      i[k] = at(corners[k][0], corners[k][1], width);
      if (seen[i[k]].inverse <= 0) return;
      z[k] = depth.at<float>(corners[k][1], corners[k][0]);
    }
    if (!is_one_surface(z)) return;
    surface.draw(seen[i[0]], seen[i[1]], seen[i[2]]);
    for (const std::size_t corner : i) ++triangles[corner];
  };
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      triangle({{{x, y}, {x + 1, y}, {x + 1, y + 1}}});
      triangle({{{x, y}, {x + 1, y + 1}, {x, y + 1}}});
    }
  constexpr int kAllAround = 6;  // triangles of a pixel amid a surface, which needs no square
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = at(x, y, width);
      if (seen[i].inverse <= 0 || triangles[i] == kAllAround) continue;
      std::array<Seen, 4> corners;
      // A square's corners in their order round it, px.
      constexpr std::array<Place, 4> kAround = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      for (std::size_t k = 0; k < corners.size(); ++k)
        corners[k] =
            look(colour_, depth_.colour_from_depth,
                 corners_[at(x + kAround[k][0], y + kAround[k][1], width + 1)], depth.at<float>(y, x));
      if (std::all_of(corners.begin(), corners.end(), [](const Seen& c) { return c.inverse > 0; }))
        squares.draw_square(corners, seen[i].inverse);
    }
  cv::Mat result(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    const float *smooth = surface.inverse().ptr<float>(y), *square = squares.inverse().ptr<float>(y);
    float* const row = result.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      // A square is flat where its surface may slope: it counts where there is no surface, or one behind it.
      const float inverse = square[x] > smooth[x] * static_cast<float>(1.0 + kStep) ? square[x] : smooth[x];
      row[x] = inverse > 0 ? 1.0F / inverse : 0.0F;
    }
  }
  return result;
}

}  // namespace stillpoint
