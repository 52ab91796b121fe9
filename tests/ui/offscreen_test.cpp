#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/gallery.hpp"
#include "ui/shell/offscreen.hpp"

namespace stillpoint::testing {
namespace {

cv::Mat render_gallery(const OffscreenOptions& options, bool with_scene) {
  Offscreen offscreen(options);
  Gallery gallery(with_scene);
  cv::Mat image = offscreen.render(std::ref(gallery));
  EXPECT_THAT(offscreen.take_gl_errors(), ::testing::IsEmpty());
  return image;
}

TEST(OffscreenTest, GalleryDark) {
  const cv::Mat image = render_gallery({.width = 1280, .height = 900}, true);
  EXPECT_FALSE(is_blank(image, 100));
  EXPECT_TRUE(matches_golden(image, "gallery_dark", kSceneTolerance));
}

}  // namespace
}  // namespace stillpoint::testing
