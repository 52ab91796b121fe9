#include "core/motion/paper/lucas_kanade.hpp"

#include <gtest/gtest.h>

#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/wide_lanes.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

constexpr int kWindow = 21, kLevels = 3;

std::vector<cv::Mat> pyramid_of(const cv::Mat& image) {
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(image, pyramid, {kWindow, kWindow}, kLevels, true);
  return pyramid;
}

FollowedPoints by_opencv(const std::vector<cv::Mat>& source, const std::vector<cv::Mat>& destination,
                         const std::vector<cv::Point2f>& points) {
  FollowedPoints followed;
  cv::calcOpticalFlowPyrLK(source, destination, points, followed.to, followed.found, followed.residuals,
                           {kWindow, kWindow}, kLevels,
                           {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.03});
  return followed;
}

/// Points between pixels over all of the image, and a few outside.
std::vector<cv::Point2f> points_over(const cv::Size& size) {
  std::vector<cv::Point2f> points;
  for (float y = -30.0F; y < static_cast<float>(size.height + 30); y += 7.3F)
    for (float x = -30.0F; x < static_cast<float>(size.width + 30); x += 9.7F) points.emplace_back(x, y);
  return points;
}

/// How many points are found, each where OpenCV finds it, to the last bit.
int expect_same_as_opencv(const cv::Mat& source, const cv::Mat& destination) {
  const auto from = pyramid_of(source), into = pyramid_of(destination);
  const std::vector<cv::Point2f> points = points_over(source.size());
  const FollowedPoints expected = by_opencv(from, into, points);
  const FollowedPoints followed = follow_points(from, into, points, {});
  EXPECT_EQ(followed.found, expected.found);
  int found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (expected.found[i] == 0) continue;
    ++found;
    EXPECT_EQ(followed.to[i], expected.to[i]) << points[i];
    EXPECT_EQ(followed.residuals[i], expected.residuals[i]) << points[i];
  }
  return found;
}

class LucasKanade : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::string_view(CV_VERSION) != "4.6.0") GTEST_SKIP() << "the last bit is known of OpenCV 4.6.0 only";
  }
};

TEST_F(LucasKanade, IsOpenCvsToTheLastBit) {
  const auto scene = motion_test::plane_and_patch({320, 240}, {130, 60, 65, 120}, {20, -1}, 16);
  EXPECT_GT(expect_same_as_opencv(scene.reference, scene.target), 800);
}

TEST_F(LucasKanade, IsOpenCvsWhereSumsAreTooLargeToBeExact) {
  cv::Mat black_and_white;
  cv::threshold(motion_test::textured_image({320, 240}, 3), black_and_white, 128, 255, cv::THRESH_BINARY);
  cv::Mat moved;
  cv::warpAffine(black_and_white, moved, cv::Matx23d(1, 0, 3.4, 0, 1, -2.7), black_and_white.size());
  EXPECT_GT(expect_same_as_opencv(black_and_white, moved), 500);
}

TEST_F(LucasKanade, IsOpenCvsWhereAnImageHasNothingToFollow) {
  const cv::Mat even(120, 160, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(expect_same_as_opencv(even, even), 0);
}

TEST(LucasKanadePoints, GoTheSameWayWhenTheirSumsAreKnown) {
  const auto scene = motion_test::plane_and_patch({320, 240}, {130, 60, 65, 120}, {20, -1}, 16);
  const auto from = pyramid_of(scene.reference), into = pyramid_of(scene.target);
  const std::vector<cv::Point2f> points = points_over(scene.reference.size());
  KnownSums sums;
  for (const auto* destination : {&into, &from, &into}) {  // the first fills the sums in
    const FollowedPoints anew = follow_points(from, *destination, points, {});
    const FollowedPoints known = follow_points(from, *destination, points, {}, &sums);
    EXPECT_EQ(known.found, anew.found);
    EXPECT_EQ(known.to, anew.to);
    EXPECT_EQ(known.residuals, anew.residuals);
    EXPECT_EQ(sums.all() != nullptr, has_wide_lanes());
  }
}

TEST(LucasKanadePoints, GoWhereThePlaneGoes) {
  const auto scene = motion_test::plane_and_patch({320, 240}, {130, 60, 65, 120}, {20, -1}, 16);
  const std::vector<cv::Point2f> points = {{40.0F, 40.0F}, {280.5F, 200.25F}, {60.0F, 180.0F}};
  const FollowedPoints followed =
      follow_points(pyramid_of(scene.reference), pyramid_of(scene.target), points, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Vec3d at = scene.target_from_reference * cv::Vec3d(points[i].x, points[i].y, 1.0);
    ASSERT_NE(followed.found[i], 0) << points[i];
    EXPECT_NEAR(followed.to[i].x, at[0] / at[2], 0.1) << points[i];
    EXPECT_NEAR(followed.to[i].y, at[1] / at[2], 0.1) << points[i];
    EXPECT_LT(followed.residuals[i], 4.0F) << points[i];
  }
}

}  // namespace
}  // namespace stillpoint
