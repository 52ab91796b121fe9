#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "core/motion/epipolar/colour_motion.hpp"

namespace stillpoint {

// Files of `stillpoint motion --method stillpoint`: what is judged from colour over several frames.

/// The heading of motion.csv, without a line end.
[[nodiscard]] std::string colour_motion_csv_heading();

/// A frame's row of motion.csv, without a line end. What does not exist stays empty.
[[nodiscard]] std::string colour_motion_csv_row(int index, const EpipolarTrace& trace,
                                                const EpipolarConfig& config);

/// A frame's figures, every reference's, with regions.
[[nodiscard]] nlohmann::json colour_motion_json(int index, const EpipolarTrace& trace,
                                                const EpipolarConfig& config);

/// Writes mask.png, evidence.png, points.png and overlay.png into `folder`, which exists.
/// @param frame CV_8UC3
/// @throws InputError when a file cannot be written
void write_colour_motion_pictures(const std::filesystem::path& folder, const EpipolarTrace& trace,
                                  const cv::Mat& frame, const EpipolarConfig& config);

/// Removes what write_colour_motion_pictures writes, and nothing else.
void remove_colour_motion_pictures(const std::filesystem::path& folder);

}  // namespace stillpoint
