#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "core/motion/wang2014/trajectories.hpp"

namespace stillpoint {

// From labelled trajectories to labelled pixels, for method `wang2014`. Images are small.

/// CV_8UC1: 1 + label of each pixel, 0 = none. Pixels go by superpixels, each with the majority of its three
/// nearest trajectories in place, brightness and depth; none where even the nearest is far. Pixels without
/// depth go by cells of the same side. @param label one each of `chosen`, from 0, below 255
[[nodiscard]] cv::Mat dense_labels(const TrajectoryFrame& here, const TrajectorySet& set,
                                   std::span<const int> chosen, std::span<const int> label,
                                   const Wang2014Config& config);

/// How many pixels have each label, from 0.
[[nodiscard]] std::vector<int> label_areas(const cv::Mat& labels, int count);

/// A mask with its holes filled: what it encloses, of less than a hundredth of the image. @param mask CV_8UC1
[[nodiscard]] cv::Mat holes_filled(const cv::Mat& mask);

/// An image of labels as flow carries it to the next frame: each pixel takes after the one it came from, 0
/// where that lies outside. @param image CV_8UC1; @param last_from_here CV_32FC2
[[nodiscard]] cv::Mat carried(const cv::Mat& image, const cv::Mat& last_from_here);

}  // namespace stillpoint
