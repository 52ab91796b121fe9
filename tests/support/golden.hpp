#pragma once

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

namespace stillpoint::testing {

/// How far two renderings of one thing may be apart.
struct ImageTolerance {
  int channel = 2;            ///< largest difference of a channel that passes unseen
  double pixels = 10.0;       ///< most pixels beyond it
  double pixels_share = 0.0;  ///< … or this share of all, whichever is more
};

inline constexpr ImageTolerance kInterfaceTolerance{2, 10.0, 0.0};
inline constexpr ImageTolerance kSceneTolerance{2, 0.0, 0.0005};

/// Whether two images agree: same size and type, and within tolerance. The message says by how much they do
/// not.
[[nodiscard]] ::testing::AssertionResult images_agree(const cv::Mat& actual, const cv::Mat& expected,
                                                      const ImageTolerance& tolerance);

/// The same of an image that shows three dimensions in one part: there kSceneTolerance holds, of that part's
/// own pixels, and kInterfaceTolerance everywhere else.
/// @param scene px, clipped to the image
[[nodiscard]] ::testing::AssertionResult images_agree_but_scene(const cv::Mat& actual,
                                                                const cv::Mat& expected,
                                                                const cv::Rect& scene);

/// Compares with tests/golden/NAME.png. On failure NAME.actual.png and NAME.diff.png (differences made
/// bright) are written beside the build. With STILLPOINT_UPDATE_GOLDEN=1 in the environment the golden image
/// is written anew.
[[nodiscard]] ::testing::AssertionResult matches_golden(
    const cv::Mat& actual, const std::string& name, const ImageTolerance& tolerance = kInterfaceTolerance);

/// The same by images_agree_but_scene.
[[nodiscard]] ::testing::AssertionResult matches_golden_but_scene(const cv::Mat& actual,
                                                                  const std::string& name,
                                                                  const cv::Rect& scene);

/// Whether an image shows nothing: fewer than `colours` different colours.
[[nodiscard]] bool is_blank(const cv::Mat& image, int colours = 4);

}  // namespace stillpoint::testing
