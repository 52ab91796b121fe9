#include "core/motion/paper/gray_warp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

/// A turn about the first pixel and a change of scale, a shift, and perspective.
cv::Matx33d homography(double turn, double scale, const cv::Point2d& shift, const cv::Point2d& perspective) {
  return {scale * std::cos(turn), -scale * std::sin(turn), shift.x,
          scale * std::sin(turn), scale * std::cos(turn),  shift.y,
          perspective.x,          perspective.y,           1.0};
}

int pixels_unlike_opencv(const cv::Mat& image, const cv::Matx33d& matrix) {
  cv::Mat expected;
  cv::warpPerspective(image, expected, matrix, image.size(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return cv::countNonZero(warp_gray(image, matrix) != expected);
}

TEST(GrayWarp, IsOpenCvsByteForByte) {
  const cv::Mat image = motion_test::textured_image({320, 240}, 5);
  EXPECT_EQ(pixels_unlike_opencv(image, cv::Matx33d::eye()), 0);
  EXPECT_EQ(pixels_unlike_opencv(image, -cv::Matx33d::eye()), 0);
  EXPECT_EQ(pixels_unlike_opencv(image, motion_test::slight_motion()), 0);
  EXPECT_EQ(pixels_unlike_opencv(image, homography(-0.02, 1.03, {-7.3, 11.8}, {2e-5, -3e-5})), 0);
  EXPECT_EQ(pixels_unlike_opencv(image, homography(0.7, 0.4, {90.0, -60.0}, {1e-3, 5e-4})), 0);
  EXPECT_EQ(pixels_unlike_opencv(image, homography(3.0, 2.5, {400.0, 300.0}, {0.0, 0.0})), 0);
}

TEST(GrayWarp, IsOpenCvsForSizesThatFillNoGroup) {
  for (const cv::Size size : {cv::Size(333, 211), {70, 9}, {5, 40}, {7, 3}, {1, 1}}) {
    const cv::Mat image = motion_test::textured_image(size, 6);
    EXPECT_EQ(pixels_unlike_opencv(image, homography(0.01, 0.99, {1.3, -0.7}, {1e-5, 1e-5})), 0) << size;
  }
}

TEST(GrayWarp, IsOpenCvsOfAPartOfAnImage) {
  const cv::Mat image = motion_test::textured_image({320, 240}, 8);
  EXPECT_EQ(pixels_unlike_opencv(image(cv::Rect(31, 17, 200, 150)), motion_test::slight_motion()), 0);
}

TEST(GrayWarp, IsOpenCvsWhereTheImageHasAHorizon) {
  const cv::Mat image = motion_test::textured_image({320, 240}, 9);
  EXPECT_EQ(pixels_unlike_opencv(image, homography(0.0, 1.0, {0.0, 0.0}, {-0.005, 0.0})), 0);
}

TEST(GrayWarp, CarriesPixelsToWhereTheHomographySays) {
  cv::Mat image = cv::Mat::zeros(40, 60, CV_8UC1);
  image.at<unsigned char>(20, 30) = 200;
  const cv::Mat warped = warp_gray(image, {1, 0, 5.0, 0, 1, -2.5, 0, 0, 1});
  EXPECT_EQ(warped.at<unsigned char>(17, 35), 100);
  EXPECT_EQ(warped.at<unsigned char>(18, 35), 100);
  EXPECT_EQ(cv::countNonZero(warped), 2);
}

}  // namespace
}  // namespace stillpoint
