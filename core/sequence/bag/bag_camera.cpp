#include "core/sequence/bag/bag_camera.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>

#include "core/geometry/normal_equations.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr std::uint32_t kSmallestSide = 32;  // px: below it, features have no room
constexpr double kFitRemarkable = 0.05;      // px: what the model leaves beyond is told, as features see it

/// Camera's radial terms nearest to OpenCV's rational ones over the image, each place of the image weighing
/// the same. @return the largest difference, px
double fit_radial(Camera& camera, const std::vector<double>& d) {
  const auto rational = [&](double r2) {
    return (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / (1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  };
  // Places along either side at which both models are compared: six coefficients need few.
  constexpr int kSteps = 40;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  const auto each_place = [&](const auto& visit) {
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; j <= kSteps; ++j) {
        const double x = (camera.width * i / static_cast<double>(kSteps) - camera.cx) / camera.fx;
        const double y = (camera.height * j / static_cast<double>(kSteps) - camera.cy) / camera.fy;
        visit(x * x + y * y);
      }
  };
  each_place([&](double r2) {
    const double r = std::sqrt(r2);
    const Eigen::Vector3d row(r * r2, r * r2 * r2, r * r2 * r2 * r2);
    a += row * row.transpose(), b += row * (r * (rational(r2) - 1));
  });
  const Eigen::Vector3d k = solve_ldlt(a, b);
  camera.k1 = k[0], camera.k2 = k[1], camera.k3 = k[2];
  double worst = 0;
  each_place([&](double r2) {
    const double fitted = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
    worst = std::max(worst, std::sqrt(r2) * std::abs(fitted - rational(r2)) * camera.fx);
  });
  return worst;
}

/// The part of the whole image that is sent, and its pixels put together, as the message says. Images that
/// are of the whole size are, whatever it says: drivers fill this in at will.
Camera camera_of_region(Camera camera, const CameraInfoMessage& info, cv::Size images) {
  if (images == cv::Size(camera.width, camera.height)) return camera;
  const std::uint64_t right = std::uint64_t{info.roi_x} + info.roi_width;
  const std::uint64_t lower = std::uint64_t{info.roi_y} + info.roi_height;
  if (std::min(info.roi_width, info.roi_height) >= kSmallestSide && right <= info.width &&
      lower <= info.height) {
    camera.cx -= info.roi_x, camera.cy -= info.roi_y;
    camera.width = static_cast<int>(info.roi_width), camera.height = static_cast<int>(info.roi_height);
  }
  const std::uint32_t across = std::max(info.binning_x, 1U), down = std::max(info.binning_y, 1U);
  const std::uint32_t width = static_cast<std::uint32_t>(camera.width) / across;
  const std::uint32_t height = static_cast<std::uint32_t>(camera.height) / down;
  if (across * down == 1 || std::min(width, height) < kSmallestSide) return camera;
  return camera.scaled_to(static_cast<int>(width), static_cast<int>(height));
}

bool are_apart(const Camera& a, const Camera& b) {
  constexpr double kApart = 0.5;  // px: less is what calibrating online jitters by
  return std::abs(a.fx - b.fx) > kApart || std::abs(a.fy - b.fy) > kApart || std::abs(a.cx - b.cx) > kApart ||
         std::abs(a.cy - b.cy) > kApart;
}

/// Looks at a few messages spread over those after the first that described the camera.
void tell_change(const Camera& camera, std::size_t first, std::size_t count, const std::string& path,
                 const std::function<std::optional<Camera>(std::size_t)>& camera_in,
                 std::vector<std::string>& warnings) {
  constexpr std::size_t kSample = 8;  // messages
  for (std::size_t k = 1; k <= kSample; ++k) {
    const std::size_t at = first + k * (count - 1 - first) / kSample;
    const auto other = camera_in(at);
    if (!other || !are_apart(camera, *other)) continue;
    const auto numbers = [](const Camera& c) {
      return fmt::format("fx {:.1f}, fy {:.1f}, cx {:.1f}, cy {:.1f}", c.fx, c.fy, c.cx, c.cy);
    };
    warnings.push_back(fmt::format(
        "{}: the camera changes: {} in message {}, and {} in message {} of {}; the first was taken "
        "for all images",
        path, numbers(camera), first + 1, numbers(*other), at + 1, count));
    return;
  }
}

}  // namespace

std::optional<Camera> camera_of_topic(const MessageLog& log, std::size_t topic, bool is_rectified,
                                      cv::Size images, std::string& why_not,
                                      std::vector<std::string>& warnings) {
  const LoggedTopic& logged = log.topics()[topic];
  const std::string path = fmt::format("{}:{}", log.path(), logged.name);
  const std::size_t count = logged.times.size();
  std::vector<std::string> told;
  const auto camera_in = [&](std::size_t message) -> std::optional<Camera> {
    std::string fault;
    told.clear();
    try {
      const auto camera = camera_of_info(camera_info_message(log.read(topic, message), logged.format),
                                         is_rectified, images, path, fault, told);
      if (camera) return camera;
    } catch (const MalformedBytes& error) {
      fault = fmt::format("{} {}", path, error.what());
    }
    if (message == 0) why_not = fault;
    return std::nullopt;
  };
  for (std::size_t i = 0; i < std::min(count, kFirstMessages); ++i) {
    const auto camera = camera_in(i);
    if (!camera) continue;
    warnings.insert(warnings.end(), told.begin(), told.end());
    tell_change(*camera, i, count, path, camera_in, warnings);
    return camera;
  }
  return std::nullopt;
}

std::optional<Camera> camera_of_info(const CameraInfoMessage& info, bool is_rectified, cv::Size images,
                                     const std::string& path, std::string& why_not,
                                     std::vector<std::string>& warnings) {
  Camera camera;
  camera.name = "camera_info";
  for (const std::uint32_t side : {info.width, info.height})
    if (side < kSmallestSide || side > kLargestImageSide) {
      why_not = fmt::format("{}: the camera's images are said to be {}x{} px", path, info.width, info.height);
      return std::nullopt;
    }
  camera.width = static_cast<int>(info.width), camera.height = static_cast<int>(info.height);
  if (is_rectified)
    camera.fx = info.p[0], camera.fy = info.p[5], camera.cx = info.p[2], camera.cy = info.p[6];
  else
    camera.fx = info.k[0], camera.fy = info.k[4], camera.cx = info.k[2], camera.cy = info.k[5];
  const bool is_finite = std::isfinite(camera.cx) && std::isfinite(camera.cy) && std::isfinite(camera.fx) &&
                         std::isfinite(camera.fy);
  if (!is_finite || camera.fx <= 0 || camera.fy <= 0) {
    why_not = fmt::format("{}: the camera is not calibrated (its focal length is {:g})", path, camera.fx);
    return std::nullopt;
  }
  camera = camera_of_region(camera, info, images);
  std::vector<double> d = info.distortion;
  if (is_rectified || std::all_of(d.begin(), d.end(), [](double v) { return v == 0; })) return camera;
  const std::string model = lower_case(info.model);
  const bool is_finite_too = std::all_of(d.begin(), d.end(), [](double v) { return std::isfinite(v); });
  const bool is_rational = model == "rational_polynomial";
  if (!is_finite_too ||
      (!is_rational && model != "plumb_bob" && model != "brown conrady" && !model.empty()) || d.size() < 4 ||
      d.size() > (is_rational ? 14 : 5)) {
    why_not = fmt::format(
        "{}: its distortion, {} with {} coefficients, is not supported; plumb_bob and rational_polynomial "
        "are",
        path, model.empty() ? "without a name" : in_quotes(info.model), d.size());
    return std::nullopt;
  }
  d.resize(14, 0.0);
  camera.k1 = d[0], camera.k2 = d[1], camera.p1 = d[2], camera.p2 = d[3], camera.k3 = d[4];
  if (std::any_of(d.begin() + 8, d.end(), [](double v) { return v != 0; })) {
    why_not = fmt::format("{}: its distortion has thin prism terms, which are not supported", path);
    return std::nullopt;
  }
  if (d[5] != 0 || d[6] != 0 || d[7] != 0)
    if (const double worst = fit_radial(camera, d); worst > kFitRemarkable)
      warnings.push_back(
          fmt::format("{}: its rational distortion is read as k1 {:.4f}, k2 {:.4f}, k3 {:.4f}, "
                      "which is up to {:.2f} px off",
                      path, camera.k1, camera.k2, camera.k3, worst));
  return camera;
}

bool is_factory_default(const Camera& camera) {
  return camera.fx == 525.0 && camera.fy == 525.0 && !camera.has_distortion();
}

}  // namespace stillpoint
