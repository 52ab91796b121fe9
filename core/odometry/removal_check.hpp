#pragma once

#include <opencv2/core.hpp>

#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/frame_solver.hpp"
#include "core/odometry/local_map.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// The pose of a frame as it would be had other features been taken out: beside the run, and of no effect on
/// it.
/// @param known_mask what truly moves, CV_8UC1; empty where it is not known
[[nodiscard]] RemovalCheck check_removal(const FrameSolver& solver, const LocalMap& map, const Frame& image,
                                         const PreparedFrame& prepared, const cv::Mat& known_mask,
                                         int threads);

}  // namespace stillpoint
