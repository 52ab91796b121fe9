#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "core/motion/paper/paper_trace.hpp"

namespace stillpoint {

/// The mask laid over the target: where both directions, only forward and only backward see motion, each in a
/// colour of its own; a box around each region; a legend below.
/// @param colour CV_8UC3, the target as the camera gave it
[[nodiscard]] cv::Mat draw_mask_overlay(const cv::Mat& colour, const MotionRound& round);

/// The tracks of one direction over its destination: inliers, outliers and removed ones told apart by colour
/// and shape, each with the way it came; a legend below.
/// @param destination CV_8UC3 or CV_8UC1
[[nodiscard]] cv::Mat draw_tracks(const cv::Mat& destination, const DirectionTrace& direction);

/// The forward features over the target: those the round's mask leaves, and those it takes out; a legend
/// below.
[[nodiscard]] cv::Mat draw_features(const cv::Mat& colour, const MotionRound& round);

/// Writes all pictures of one round into `folder`, which exists. What a round did not get to has no picture.
/// @param reference,target CV_8UC3
/// @throws InputError when a file cannot be written
void write_round_pictures(const std::filesystem::path& folder, const MotionRound& round,
                          const cv::Mat& reference, const cv::Mat& target);

/// Removes what write_round_pictures writes, and nothing else.
void remove_round_pictures(const std::filesystem::path& folder);

}  // namespace stillpoint
