#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/pixel_conventions.hpp"
#include "core/motion/yi2013/yi2013_config.hpp"

namespace stillpoint {

// The background model of method `yi2013`, which `gao2019` warps its own way. Brightness is 0 to 255; a block
// is block_px pixels a side, and an image's right and bottom strips that are narrower than a block belong to
// none.

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

/// @param gray CV_8UC1
[[nodiscard]] Yi2013Blocks yi2013_blocks(const cv::Mat& gray, int block_px);

/// Where the middle of each block was in the last frame, in blocks: row by row. NaN where it was nowhere.
using Yi2013Places = std::vector<RasterPoint>;

/// The places that a homography gives. @param size in blocks
[[nodiscard]] Yi2013Places yi2013_places(const cv::Size& size, const cv::Matx33d& last_from_here,
                                         int block_px);

/// The last frame's model as it lies in this frame. A block that nothing is known of takes its own mean.
/// @param last empty matrices where there is no last frame @param places one a block; may be empty without a
/// last frame
[[nodiscard]] Yi2013Model yi2013_warped(const Yi2013Model& last, const Yi2013Places& places,
                                        const Yi2013Blocks& blocks, const Yi2013Config& config);
/// The same by a homography.
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
