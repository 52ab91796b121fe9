#pragma once

#include <opencv2/core.hpp>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/odometry/local_map.hpp"

namespace stillpoint {

// What happens to the map at a keyframe, step by step; each returns how much it did.

/// Points for the keyframe's features that have depth and none yet: all up to map.far_depth_m, and beyond it
/// the nearest until map.min_new_points are there.
int create_points(LocalMap& map, int keyframe, const Camera& camera, const Config& config);

/// Joins points that are the same: the keyframe's points looked for in its neighbours, and theirs in it.
int fuse_neighbours(LocalMap& map, int keyframe, const Camera& camera, const Config& config);

/// Removes young points that were seldom found where they should have been, or that no second keyframe sees.
int cull_points(LocalMap& map, int newest_keyframe, const Config& config);

/// Retires keyframes most of whose points three others see at least as finely; and the oldest beyond
/// map.max_keyframes.
int cull_keyframes(LocalMap& map, int newest_keyframe, const Camera& camera, const Config& config);

/// At any frame: takes out the points about a keyframe that lie on what is dynamic, or before it where
/// nothing is now. Each is remembered among LocalMap::moved_points().
/// @param depth of the frame, CV_32FC1, m; @param mask CV_8UC1 of the same size, 255 = dynamic; empty: none
int remove_dynamic_points(LocalMap& map, const cv::Mat& depth, const cv::Mat& mask,
                          const Pose& camera_from_world, int about, const Camera& camera,
                          const Config& config);

}  // namespace stillpoint
