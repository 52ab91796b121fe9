#pragma once

#include <string>
#include <vector>

#include "core/sequence/image_survey.hpp"

namespace stillpoint {

// A look at a few pairs of a stereo sequence before the first frame: whether left and right are what they are
// said to be.

/// A pair by the names of its images.
struct PairPaths {
  std::string left, right;
};

/// Corners of some pairs, matched left to right wherever they lie.
struct PairSurvey {
  int pairs = 0;      ///< whose images could both be read
  int fit = 0;        ///< of these, pairs of one size
  std::string fault;  ///< of the first that does not fit, one sentence
  int matches = 0;
  double row_offset_px = 0.0;  ///< median row of a corner on the right less its row on the left
  double row_spread_px = 0.0;  ///< three of four matches lie within so many rows of that
  double to_the_left = 0.0;    ///< share of the matches that lie farther right in the right image
};
[[nodiscard]] PairSurvey survey_pairs(const std::vector<PairPaths>& pairs, const ImageReader& read_image);

/// Whether left and right are exchanged: nearly all that is seen would lie behind the cameras.
[[nodiscard]] bool is_exchanged(const PairSurvey& survey);

/// Whether rows do not correspond, so that matching along rows fails.
[[nodiscard]] bool is_unrectified(const PairSurvey& survey);

}  // namespace stillpoint
