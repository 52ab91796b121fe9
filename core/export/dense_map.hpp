#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

// The room as depth images have it, without what was found to move. Lengths chosen for a Kinect grow with a
// stereo pair's baseline (Camera::depth_limit).

struct DenseMapOptions {
  double voxel_m = 0.01;    ///< m, side of the cubes that measurements are averaged in
  double farthest_m = 4.0;  ///< m: depth beyond is too coarse to be averaged
  int grow_px = 5;          ///< px, by which masks are grown: their rims are the movers' own
  int min_seen = 2;         ///< frames a cube must be measured in
};

struct DensePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, world
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the cameras; zero where none is known
  cv::Vec3b colour{};                                ///< BGR
};

/// Averages frames into cubes of space.
class DenseMap {
 public:
  DenseMap(const Camera& camera, const DenseMapOptions& options);

  /// @param dynamic CV_8UC1, non-zero = left out; empty = nothing is
  void add(const Frame& frame, const Pose& world_from_camera, const cv::Mat& dynamic);

  /// One point a cube, in an order that depends on nothing but the cubes.
  [[nodiscard]] std::vector<DensePoint> points() const;

 private:
  struct Cell {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero(),
                    colour = Eigen::Vector3f::Zero();  // sums
    float weight = 0.0F;
    int seen = 0, last = -1;  // frames
  };

  Camera camera_;
  DenseMapOptions options_;
  double voxel_m_, farthest_m_;
  cv::Mat rays_;  // CV_32FC2, of all pixels at depth 1
  int frames_ = 0;
  std::unordered_map<std::uint64_t, Cell> cells_;
};

/// Binary PLY with positions, normals and colours.
/// @throws InputError when it cannot be written
void write_dense_ply(const std::string& path, const std::vector<DensePoint>& points);

/// A frame with its background where somebody stood, as other frames saw it.
struct FilledFrame {
  cv::Mat image;         ///< CV_8UC3 BGR
  cv::Mat filled;        ///< CV_8UC1: 255 where it was filled in
  double unknown = 0.0;  ///< share of the dynamic pixels whose background no frame saw: these are black
};

/// Fills in what is dynamic from frames that saw the place behind it.
class BackgroundFiller {
 public:
  BackgroundFiller(const Camera& camera, const DenseMapOptions& options);

  /// A frame to take the background from.
  void add(const Frame& frame, const Pose& world_from_camera, const cv::Mat& dynamic);

  [[nodiscard]] FilledFrame fill(const Frame& frame, const Pose& world_from_camera,
                                 const cv::Mat& dynamic) const;

 private:
  struct View {
    int index = 0;
    cv::Mat colour, depth;  // depth 0 where it is dynamic or not measured
    Pose world_from_camera = Pose::Identity();
  };

  Camera camera_;
  DenseMapOptions options_;
  cv::Mat rays_;  // CV_32FC2, of all pixels at depth 1
  std::vector<View> views_;
};

}  // namespace stillpoint
