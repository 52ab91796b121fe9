#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/image_file.hpp"

namespace stillpoint {

// A look at a few of a sequence's images before the first frame: what can be known to be wrong is told then.

/// Paths of images, spread over the sequence.
using ImagePaths = std::vector<std::string>;

/// How an image is read by its path.
using ImageReader = std::function<ImageRead(const std::string& path)>;

/// Image units a metre in which a survey has depth that is in metres.
inline constexpr double kMetresSurveyScale = 1000.0;

/// Depth images by sample.
struct DepthSurvey {
  int read = 0;             ///< images that could be read
  int fit = 0;              ///< of these, those that hold depth of the colour images' size
  std::string fault;        ///< of the first that does not fit, one sentence
  bool other_size = false;  ///< that is its fault
  double nearest = 0, median = 0,
         farthest = 0;     ///< 2, 50 and 98 % of all values of those that fit, in image units
  double zeros = 0;        ///< share of pixels without a measurement
  bool in_metres = false;  ///< the images were; the values are in kMetresSurveyScale units a metre
};

/// The size that depth images must have, px, and whose it is in messages.
struct DepthSize {
  cv::Size size;
  const char* whose = "its colour image is";
};

/// Depth images as sequences have them: 16 bits, one channel, the size of the colour image or of a depth
/// camera; 65535 and 0 are no measurement. Or depth in metres, where the reader says so.
/// @return why the image is no such depth, empty when it is
[[nodiscard]] std::string fault_of_depth(const std::string& path, const ImageRead& read,
                                         const DepthSize& expected);

[[nodiscard]] DepthSurvey survey_depth(const ImagePaths& paths, const DepthSize& expected,
                                       const ImageReader& read_image = stillpoint::read_image);

/// What cameras measure indoors: 2 % nearest and 98 % farthest, m.
inline constexpr double kNearestPlausible = 0.33, kFarthestPlausible = 25.0;

/// A doubt about a depth scale: the range it gives, and the usual scale that gives a plausible one. Nothing
/// where the range is plausible.
struct ScaleDoubt {
  double nearest_m = 0, median_m = 0, farthest_m = 0;
  std::optional<double> likely_scale;  ///< units a metre
};
[[nodiscard]] std::optional<ScaleDoubt> doubt_scale(const DepthSurvey& survey, double scale);

/// How a sequence's masks say what is dynamic.
enum class MaskCoding {
  bright,   ///< above half of the type's range, of a coloured image in any colour: 0 and 255
  nonzero,  ///< anything but 0: 0 and 1, or labels
};

/// Masks by sample.
struct MaskSurvey {
  int read = 0;
  MaskCoding coding = MaskCoding::bright;
  double largest = 0;         ///< value
  int labels = 0;             ///< different values but 0, at most
  double moving_share = 0.0;  ///< of all pixels
  double gray_share = 0.0;    ///< neither nearly black nor nearly white, of those that are not nearly black
  bool coloured = false;      ///< some have colours
  cv::Size size;              ///< of the first that could be read
};
[[nodiscard]] MaskSurvey survey_masks(const ImagePaths& paths,
                                      const ImageReader& read_image = stillpoint::read_image);

/// How masks are read, where that could be doubted; empty for those that are black and white.
/// @param become what happens to the pixels that are set: "taken out"
[[nodiscard]] std::string how_read(const MaskSurvey& survey, const std::string& become);

/// A mask image as 255 = moving, 0 = not, of its own size. Of an image whose alpha varies alpha is the mask.
[[nodiscard]] cv::Mat moving_pixels(const cv::Mat& image, MaskCoding coding);

}  // namespace stillpoint
