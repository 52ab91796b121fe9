#pragma once

#include <opencv2/core.hpp>

#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/frame_solver.hpp"
#include "core/odometry/mapper.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// What a run knows before a frame: where a check of the frame sets out from, as the run does.
struct BeforeFrame {
  FrameSolver solver;
  Mapper mapper;
  bool motion_settled = false;  ///< MotionStage::settled()
};

/// The pose of a frame as it would be had other features been taken out: beside the run, and of no effect on
/// it. It is solved by the run's own solver with all that belongs to it (first pose, consensus, weights,
/// direct alignment), from the same map; a mask in place of the judgement's is the only difference.
/// @param motion the run's judgement, for its weights; features that it removes by weight 0 count whole
/// @param judged_by_pose the frame was judged under its first pose: dynamic points leave the map then
/// @param known_mask what is truly dynamic, CV_8UC1; empty where it is not known
[[nodiscard]] RemovalCheck check_removal(const BeforeFrame& before, const Frame& image,
                                         const PreparedFrame& prepared, const MotionResult& motion,
                                         bool judged_by_pose, const cv::Mat& known_mask, int threads);

}  // namespace stillpoint
