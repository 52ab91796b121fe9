#pragma once

#include <Eigen/Core>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// The normals of a map's points, from the depth images of frames in which they are inliers.
class PointNormals {
 public:
  explicit PointNormals(const Camera& camera) : camera_(camera) {}

  /// @param frame read; one without depth tells nothing @param record of it, with its features
  void add(const Frame& frame, const FrameRecord& record, const Pose& world_from_camera);

  /// One a point: unit, towards the cameras; zero where no frame told, or frames disagree.
  [[nodiscard]] std::vector<Eigen::Vector3f> of(const std::vector<SavedPoint>& points) const;

 private:
  struct Sum {
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();  ///< of unit length each
    int count = 0;
  };
  Camera camera_;
  std::unordered_map<int, Sum> sums_;  // by the point's id
};

}  // namespace stillpoint
