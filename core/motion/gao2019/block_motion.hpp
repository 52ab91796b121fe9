#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/gao2019/gao2019_config.hpp"
#include "core/motion/residual_motion.hpp"
#include "core/motion/yi2013/block_model.hpp"

namespace stillpoint {

// The blocks of method `gao2019`: their depth, where they were, which move, and what is cleaned up.

/// The median of each block's measured depths. @param depth CV_32FC1, m; empty: none is measured
/// @return CV_32FC1, m; 0 where less than a quarter of a block's pixels have depth
[[nodiscard]] cv::Mat block_depths(const cv::Mat& depth, const cv::Size& blocks, int block_px);

/// Where the middle of each block was in the last frame: by pose and depth, and by the homography where there
/// is none.
/// @param rays of the blocks: PixelRays(camera, frame, block_px) @param depths as block_depths gives them
/// @param by_homography one place a block
[[nodiscard]] Yi2013Places places_by_depth(const cv::Mat& depths, const PixelRays& rays,
                                           const Pose& last_from_here, const Camera& camera, int block_px,
                                           const Yi2013Places& by_homography);

/// max_i (I_i - μ)² over each block's pixels, by σ̃²: CV_32FC1; NaN where the Gaussian is too young to judge.
/// @param chosen the model before this frame went into it @param updated and after
[[nodiscard]] cv::Mat block_deviations(const Yi2013Blocks& blocks, const Yi2013Model& chosen,
                                       const Yi2013Model& updated, double settled_age);

/// By how much the image became brighter as a whole: the median of block over model mean, of blocks that are
/// neither dark nor near white and whose Gaussian is old enough to judge; 1 where there are few of them.
[[nodiscard]] double exposure_gain(const Yi2013Blocks& blocks, const Yi2013Model& warped, double settled_age);

/// Brightens the model by a gain, as the image was. What the image clips to white stays as it is: nothing
/// tells how bright it is.
void brighten(Yi2013Model& model, double gain);

/// Takes out dynamic blocks without a dynamic neighbour, then fills those with many. @param moving CV_8UC1, 0
/// or 255
[[nodiscard]] cv::Mat clean_blocks(const cv::Mat& moving, bool drop_isolated, int fill_neighbours);

/// Blocks as a mask of the frame's size; strips narrower than a block are static.
[[nodiscard]] cv::Mat mask_of_blocks(const cv::Mat& blocks, int block_px, const cv::Size& frame);

}  // namespace stillpoint
