#include "core/export/dense_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

constexpr float kSteepest =
    0.1F;  // m between neighbours a pixel apart, at 1 m: more is an edge, with no normal
constexpr float kGrazing = 0.2F;  // cosine between surface and sight: flatter surfaces are measured badly
constexpr int kSplat = 1;         // px about the place a pixel is carried to: no gaps between neighbours
constexpr float kSameSurface = 0.03F;  // of depth: two measurements of one surface

cv::Mat grown(const cv::Mat& mask, int radius) {
  if (mask.empty() || radius == 0) return mask;
  cv::Mat result;
  cv::dilate(mask, result,
             cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1)));
  return result;
}

cv::Mat colour_of(const Frame& frame) {
  if (!frame.colour.empty()) return frame.colour;
  cv::Mat colour;
  cv::cvtColor(frame.gray, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

/// The rays of all pixels, at depth 1: undistorted once for a camera.
cv::Mat rays_of(const Camera& camera) {
  cv::Mat rays(camera.height, camera.width, CV_32FC2);
  for (int y = 0; y < rays.rows; ++y)
    for (int x = 0; x < rays.cols; ++x) {
      const Eigen::Vector3d ray = camera.back_project(
          camera.has_distortion() ? camera.undistorted({x, y}) : Eigen::Vector2d(x, y), 1.0);
      rays.at<cv::Vec2f>(y, x) = {static_cast<float>(ray.x()), static_cast<float>(ray.y())};
    }
  return rays;
}

Eigen::Vector3f point_at(const cv::Mat& rays, const cv::Mat& depth, int x, int y) {
  const float z = depth.at<float>(y, x);
  const auto& ray = rays.at<cv::Vec2f>(y, x);
  return {ray[0] * z, ray[1] * z, z};
}

/// The surface's normal towards the camera, from the neighbours to the right and below; zero at edges.
Eigen::Vector3f normal_at(const cv::Mat& rays, const cv::Mat& depth, int x, int y) {
  if (x + 1 >= depth.cols || y + 1 >= depth.rows) return Eigen::Vector3f::Zero();
  const float z = depth.at<float>(y, x), right = depth.at<float>(y, x + 1), below = depth.at<float>(y + 1, x);
  const float most = kSteepest * z;
  if (right <= 0 || below <= 0 || std::abs(right - z) > most || std::abs(below - z) > most)
    return Eigen::Vector3f::Zero();
  const Eigen::Vector3f here = point_at(rays, depth, x, y);
  const Eigen::Vector3f normal =
      (point_at(rays, depth, x, y + 1) - here).cross(point_at(rays, depth, x + 1, y) - here);
  const float length = normal.norm();
  return length > 0 ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::Zero();
}

std::uint64_t key_of(const Eigen::Vector3f& position, float voxel) {
  constexpr int kBits = 21;  // a coordinate: three fill a word
  // Cells: where 0 lies, so that there are as many to either side.
  constexpr std::int64_t kMiddle = 1 << (kBits - 1);
  std::uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    const auto cell = static_cast<std::int64_t>(std::floor(position[i] / voxel)) + kMiddle;
    key = (key << kBits) | (static_cast<std::uint64_t>(cell) & ((1U << kBits) - 1));
  }
  return key;
}

}  // namespace

DenseMap::DenseMap(const Camera& camera, const DenseMapOptions& options)
    : camera_(camera),
      options_(options),
      voxel_m_(camera.depth_limit(options.voxel_m)),
      farthest_m_(camera.depth_limit(options.farthest_m)),
      rays_(rays_of(camera)) {}

void DenseMap::add(const Frame& frame, const Pose& world_from_camera, const cv::Mat& dynamic) {
  if (!frame.has_depth()) return;
  const cv::Mat mask = grown(dynamic, options_.grow_px), colour = colour_of(frame);
  const Eigen::Matrix3f rotation = world_from_camera.linear().cast<float>();
  const Eigen::Vector3f origin = world_from_camera.translation().cast<float>();
  for (int y = 0; y < frame.depth.rows; ++y)
    for (int x = 0; x < frame.depth.cols; ++x) {
      const float z = frame.depth.at<float>(y, x);
      if (!(z > 0) || z > farthest_m_ || (!mask.empty() && mask.at<std::uint8_t>(y, x) != 0)) continue;
      const Eigen::Vector3f point = point_at(rays_, frame.depth, x, y),
                            normal = normal_at(rays_, frame.depth, x, y);
      // What the camera sees at a flat angle it measures badly; what has no normal lies at an edge.
      if (-normal.dot(point) < kGrazing * point.norm()) continue;
      const Eigen::Vector3f at = rotation * point + origin;
      Cell& cell = cells_[key_of(at, static_cast<float>(voxel_m_))];
      const float weight = 1.0F / (z * z * z * z);  // the variance of depth grows so
      const auto& bgr = colour.at<cv::Vec3b>(y, x);
      cell.position += weight * at;
      cell.normal += weight * (rotation * normal);
      cell.colour += weight * Eigen::Vector3f(bgr[0], bgr[1], bgr[2]);
      cell.weight += weight;
      if (cell.last != frames_) ++cell.seen;
      cell.last = frames_;
    }
  ++frames_;
}

std::vector<DensePoint> DenseMap::points() const {
  std::vector<std::uint64_t> keys;
  for (const auto& [key, cell] : cells_)
    if (cell.seen >= std::min(options_.min_seen, frames_)) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  std::vector<DensePoint> points;
  points.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    const Cell& cell = cells_.at(key);
    DensePoint point;
    point.position = cell.position / cell.weight;
    const float length = cell.normal.norm();
    if (length > 0) point.normal = cell.normal / length;
    for (int i = 0; i < 3; ++i)
      point.colour[i] = cv::saturate_cast<std::uint8_t>(cell.colour[i] / cell.weight);
    points.push_back(point);
  }
  return points;
}

void write_dense_ply(const std::string& path, const std::vector<DensePoint>& points) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment world coordinates in metres: the first tracked frame's "
      "camera\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points.size());
  const auto number = [&bytes](float value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const DensePoint& point : points) {
    for (int i = 0; i < 3; ++i) number(point.position[i]);
    for (int i = 0; i < 3; ++i) number(point.normal[i]);
    for (int i = 2; i >= 0; --i) bytes += static_cast<char>(point.colour[i]);
  }
  write_text_file(path, bytes);
}

BackgroundFiller::BackgroundFiller(const Camera& camera, const DenseMapOptions& options)
    : camera_(camera), options_(options), rays_(rays_of(camera)) {}

void BackgroundFiller::add(const Frame& frame, const Pose& world_from_camera, const cv::Mat& dynamic) {
  if (!frame.has_depth()) return;
  cv::Mat depth = frame.depth.clone();
  if (!dynamic.empty()) depth.setTo(0, grown(dynamic, options_.grow_px));
  depth.setTo(0, depth > camera_.depth_limit(options_.farthest_m));
  views_.push_back({frame.index, colour_of(frame).clone(), depth, world_from_camera});
}

FilledFrame BackgroundFiller::fill(const Frame& frame, const Pose& world_from_camera,
                                   const cv::Mat& dynamic) const {
  FilledFrame result{colour_of(frame).clone(), cv::Mat::zeros(frame.gray.size(), CV_8UC1), 0.0};
  const cv::Mat mask = grown(dynamic, options_.grow_px);
  const int wanted = mask.empty() ? 0 : cv::countNonZero(mask);
  if (wanted == 0) return result;
  result.image.setTo(cv::Scalar::all(0), mask);
  // The nearest frames first: what they saw is the likest in light.
  std::vector<const View*> order;
  for (const View& view : views_) order.push_back(&view);
  std::stable_sort(order.begin(), order.end(), [&frame](const View* a, const View* b) {
    return std::abs(a->index - frame.index) < std::abs(b->index - frame.index);
  });
  const cv::Rect bounds(cv::Point(), frame.gray.size());
  for (const View* view : order) {
    const Pose here_from_view = world_from_camera.inverse() * view->world_from_camera;
    const Eigen::Matrix3f rotation = here_from_view.linear().cast<float>();
    const Eigen::Vector3f translation = here_from_view.translation().cast<float>();
    cv::Mat nearest(frame.gray.size(), CV_32FC1, cv::Scalar(0)), carried(frame.gray.size(), CV_8UC3);
    for (int y = 0; y < view->depth.rows; ++y)
      for (int x = 0; x < view->depth.cols; ++x) {
        if (view->depth.at<float>(y, x) <= 0) continue;
        const Eigen::Vector3f point = rotation * point_at(rays_, view->depth, x, y) + translation;
        if (point.z() <= 0) continue;
        Eigen::Vector2d pixel = camera_.project(point.cast<double>());
        if (camera_.has_distortion()) pixel = camera_.distort(pixel);
        const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
        for (int v = at.y - kSplat; v <= at.y + kSplat; ++v)
          for (int u = at.x - kSplat; u <= at.x + kSplat; ++u) {
            if (!bounds.contains({u, v}) || mask.at<std::uint8_t>(v, u) == 0) continue;
            float& depth = nearest.at<float>(v, u);
            const bool own = u == at.x && v == at.y;
            // The pixel's own place counts before its neighbours' splats of the same surface.
            if (depth > 0 && point.z() > depth * (own ? 1.0F + kSameSurface : 1.0F - kSameSurface)) continue;
            depth = point.z();
            carried.at<cv::Vec3b>(v, u) = view->colour.at<cv::Vec3b>(y, x);
          }
      }
    const cv::Mat fresh = (nearest > 0) & (result.filled == 0);
    carried.copyTo(result.image, fresh);
    result.filled.setTo(255, fresh);
    if (cv::countNonZero(result.filled) == wanted) break;
  }
  result.unknown = 1.0 - static_cast<double>(cv::countNonZero(result.filled)) / wanted;
  return result;
}

}  // namespace stillpoint
