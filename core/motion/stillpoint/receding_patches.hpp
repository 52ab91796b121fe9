#pragma once

#include <vector>

#include "core/motion/stillpoint/depth_motion.hpp"

namespace stillpoint {

/// Finds patches that went back, away from the camera, farther than a patch can be followed by its own depth:
/// at their place the reference shows a surface some decimetres nearer. That surface may as well have been
/// another one, which has left since; so it must have the patch's shape, all of it nearer by the same step,
/// and, about where the patch was before that step along its ray or along the optical axis, the patch's
/// texture. What is plain says nothing.
/// @param slack m, what registration leaves of the steps of what stands still, standard deviation
/// @param patches one a segment; those with nothing to say yet (log_odds 0) are looked at
void measure_receding(const RgbdView& current, const RgbdView& reference, const Pose& reference_from_current,
                      const cv::Mat& labels, const std::vector<Segment>& segments, double slack,
                      std::vector<PatchMotion>& patches);

}  // namespace stillpoint
