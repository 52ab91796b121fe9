#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/regions.hpp"
#include "core/motion/stage_log.hpp"

namespace stillpoint {

// Layers of a StageLog as image files, whatever method made them.

/// A layer as an 8-bit picture: marks over the dimmed image with a legend below; 8-bit images and masks as
/// they are; grey levels in CV_32FC1 rounded; signed values linearly, -range black, 0 at 128, range white;
/// lengths linearly, 0 black, range white. NaN is drawn as 0. Empty when the layer has no image.
[[nodiscard]] cv::Mat draw_layer(const Layer& layer);

/// A mask laid over its frame, with a box around each region and a legend below.
/// @param colour CV_8UC3, the frame as the camera gave it
/// @param mask CV_8UC1 of the same size, non-zero = dynamic
/// @param partial CV_8UC1: a mask that tells apart what of `mask` it holds; empty = none
/// @param partial_name what the legend calls it
[[nodiscard]] cv::Mat draw_mask_overlay(const cv::Mat& colour, const cv::Mat& mask,
                                        const std::vector<MotionRegion>& regions, const cv::Mat& partial,
                                        const std::string& partial_name);

/// @throws InputError when the file cannot be written
void write_picture(const std::filesystem::path& path, const cv::Mat& picture);

}  // namespace stillpoint
