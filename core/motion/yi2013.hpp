#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/methods.hpp"
#include "core/motion/motion_method.hpp"

namespace stillpoint {

// Method `yi2013`: a background model of two Gaussians a block, warped along with the camera by a homography.
// Yi, Yun, Kim, Chang, Choi: "Detection of moving objects with non-stationary cameras in 5.8 ms", CVPRW 2013.
// yi2013.md beside this file has the equations. Brightness is 0 to 255; a block is block_px pixels a side,
// and an image's right and bottom strips that are narrower than a block belong to none.

/// Meanings, units and ranges: Yi2013Config::list.
struct Yi2013Config {
  static constexpr const char* kSection = "yi2013";
  Yi2013Config() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const Yi2013Config&) const = default;

  int median_radius_px;
  int cell_width_px;
  int cell_height_px;
  int window_px;
  int levels;
  int iterations;
  double epsilon_px;
  int min_tracks;
  double ransac_px;
  int block_px;
  double initial_sigma;
  double least_sigma;
  double max_age;
  double decay;
  double decay_above_sigma;
  double match_limit;
  double moving_limit;
  double settled_age;
};

/// One Gaussian a block: CV_32FC1 each, a value a block.
struct Yi2013Gaussians {
  cv::Mat mean;      ///< grey levels
  cv::Mat variance;  ///< grey levels, squared
  cv::Mat age;       ///< frames it stands for; 0 = it begins here
};

/// The background model. [0] is the apparent background, [1] the candidate that may take its place.
using Yi2013Model = std::array<Yi2013Gaussians, 2>;

/// What a frame's blocks hold, a value a block.
struct Yi2013Blocks {
  cv::Mat mean;         ///< CV_32FC1
  cv::Mat least, most;  ///< CV_8UC1
};

/// Which Gaussian a block belongs to.
enum Yi2013Match : std::uint8_t { kMatchApparent = 0, kMatchCandidate = 1, kMatchNeither = 2 };

/// A grid point followed from this frame to the last.
struct Yi2013Track {
  cv::Point2f here, there;  ///< px, in this frame and in the last
  bool inlier = false;      ///< it agrees with the homography
};

/// The camera's motion as an image motion.
struct Yi2013Motion {
  int points = 0;                   ///< of the grid
  std::vector<Yi2013Track> tracks;  ///< those that could be followed
  int inliers = 0;
  cv::Matx33d last_from_here = cv::Matx33d::eye();
  std::string note;  ///< why the homography is the identity; empty when it was measured
};

/// Pyramids as cv::buildOpticalFlowPyramid makes them of the filtered frames, with config's window and
/// levels.
[[nodiscard]] Yi2013Motion yi2013_motion(const std::vector<cv::Mat>& here, const std::vector<cv::Mat>& last,
                                         const Yi2013Config& config);

/// @param gray CV_8UC1
[[nodiscard]] Yi2013Blocks yi2013_blocks(const cv::Mat& gray, int block_px);

/// The last frame's model as it lies in this frame. A block that nothing is known of takes its own mean.
/// @param last empty matrices where there is no last frame
[[nodiscard]] Yi2013Model yi2013_warped(const Yi2013Model& last, const cv::Matx33d& last_from_here,
                                        const Yi2013Blocks& blocks, const Yi2013Config& config);

/// Lets older candidates take the apparent background's place, and finds the Gaussian each block belongs to.
/// Where it belongs to neither, the candidate's age becomes 0.
/// @return CV_8UC1 of Yi2013Match
[[nodiscard]] cv::Mat yi2013_choose(Yi2013Model& warped, const Yi2013Blocks& blocks,
                                    const Yi2013Config& config);

/// The model with this frame in it; only the Gaussian that a block belongs to changes.
[[nodiscard]] Yi2013Model yi2013_updated(const Yi2013Model& chosen, const cv::Mat& matches,
                                         const Yi2013Blocks& blocks, const Yi2013Config& config);

/// Pixels too far from the apparent background. @param chosen the model before this frame went into it
/// @return CV_8UC1, 255 = dynamic
[[nodiscard]] cv::Mat yi2013_moving(const cv::Mat& gray, const Yi2013Model& chosen,
                                    const Yi2013Model& updated, const Yi2013Config& config);

}  // namespace stillpoint
