// Engine `bamvo`: its density against hand-computed values, its foreground rule, and poses from synthetic
// pairs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/odometry/bamvo/background_model.hpp"
#include "core/odometry/bamvo/dense_alignment.hpp"
#include "tests/support/bent_wall.hpp"

namespace stillpoint {
namespace {

TEST(BamvoDensity, IsThatOfAKernelWithTheMedianChangeForBandwidth) {
  // Changes 1, 2, 4 cm: sigma = 0.02 / (0.6744 * 1.41421356) = 0.0209700 m;
  // exponents 0.1137055, 0.4548154, 1.8192616 -> 0.8925207, 0.6345653, 0.1621454;
  // B = 1.6892314 / (3 * 2.5066283 * 0.0209700) = 10.71199.
  std::vector<float> changes{0.04F, 0.01F, 0.02F};
  double median = 0.0;
  EXPECT_NEAR(background_density(changes, 0.001, median), 10.7120, 2e-3);
  EXPECT_NEAR(median, 0.02, 1e-7);
}

TEST(BamvoDensity, HasALeastBandwidth) {
  std::vector<float> changes{0.0F, 0.0F, 0.0F};
  double median = 1.0;
  // 1 / (sqrt(2 pi) * 1 mm)
  EXPECT_NEAR(background_density(changes, 0.001, median), 398.942, 1e-2);
  EXPECT_EQ(median, 0.0);
}

TEST(BamvoDensity, OfEvenlyManyChangesTakesTheMeanOfTheMiddleTwo) {
  std::vector<float> changes{0.03F, 0.01F};
  double median = 0.0;
  (void)background_density(changes, 0.001, median);
  EXPECT_NEAR(median, 0.02, 1e-7);
}

TEST(BamvoDensity, TheForegroundsIsThePublishedOne) {
  EXPECT_NEAR(foreground_density(1.96 * 0.01623), 7.59, 5e-3);
}

/// A wall that three past images saw at one depth and that now stands nearer by a step.
BackgroundModel stepped(double depth_m, double step_m) {
  Camera camera = Camera().scaled_to(64, 48);
  const cv::Mat wall(48, 64, CV_32FC1, cv::Scalar(depth_m)),
      nearer(48, 64, CV_32FC1, cv::Scalar(depth_m - step_m));
  return model_background({{wall}, {wall}, {wall}, {nearer}}, camera, BamvoConfig());
}

TEST(BamvoForeground, APlaneThatStepsThreeCentimetresIsBackground) {
  const BackgroundModel model = stepped(2.0, 0.030);
  EXPECT_EQ(cv::countNonZero(model.foreground), 0);
  EXPECT_EQ(cv::countNonZero(model.compared == 3), 64 * 48);
  EXPECT_NEAR(model.median_m.at<float>(24, 32), 0.030F, 1e-5F);
}

TEST(BamvoForeground, OneThatStepsThreeAndAHalfIsForeground) {
  EXPECT_EQ(cv::countNonZero(stepped(2.0, 0.035).foreground), 64 * 48);
  // At any depth: the density is weighed by depth only afterwards.
  EXPECT_EQ(cv::countNonZero(stepped(4.5, 0.035).foreground), 64 * 48);
  EXPECT_EQ(cv::countNonZero(stepped(0.7, 0.030).foreground), 0);
}

TEST(BamvoForeground, OutsideTheRangeOfDepthNothingIsKnown) {
  const BackgroundModel model = stepped(5.5, 0.0);
  EXPECT_EQ(cv::countNonZero(model.weight), 0);
  EXPECT_EQ(cv::countNonZero(model.foreground), 0);
}

TEST(BamvoModel, TheFirstFramesWeighOne) {
  const cv::Mat wall(48, 64, CV_32FC1, cv::Scalar(2.0));
  const BackgroundModel model = model_background({{wall}}, Camera().scaled_to(64, 48), BamvoConfig());
  EXPECT_EQ(cv::countNonZero(model.weight == 1.0F), 64 * 48);
}

TEST(BamvoModel, WarpsPastDepthByThePosesBetween) {
  // The camera has come 0.5 m nearer to a wall that was 2.5 m away: nothing has changed.
  const Camera camera = Camera().scaled_to(64, 48);
  const cv::Mat far(48, 64, CV_32FC1, cv::Scalar(2.5)), near(48, 64, CV_32FC1, cv::Scalar(2.0));
  Pose now = Pose::Identity();
  now.translation().z() = -0.5;
  const BackgroundModel model =
      model_background({{far}, {far, Pose::Identity()}, {near, now}}, camera, BamvoConfig());
  EXPECT_EQ(cv::countNonZero(model.foreground), 0);
  double most = 0.0;
  cv::Mat median = model.median_m.clone();
  cv::patchNaNs(median, 0.0);
  cv::minMaxLoc(median, nullptr, &most);
  EXPECT_LT(most, 1e-5);
}

TEST(BamvoModel, OfTwoPointsThatFallOnOnePixelTheNearerIsKept) {
  const Camera camera = Camera().scaled_to(64, 48);
  cv::Mat depth(48, 64, CV_32FC1, cv::Scalar(0));
  depth.at<float>(24, 30) = 4.0F;
  depth.at<float>(24, 31) = 2.0F;
  // Half the focal length away everything is drawn towards the middle.
  Pose back = Pose::Identity();
  back.translation().z() = 20.0;
  const cv::Mat warped = warped_depth(depth, camera, back);
  double most = 0.0;
  cv::minMaxLoc(warped, nullptr, &most);
  EXPECT_EQ(cv::countNonZero(warped), 1);
  EXPECT_NEAR(most, 22.0, 1e-5);
}

/// Where the second camera of a pair stands.
Pose moved() {
  Vector6d xi;
  xi << 0.02, -0.01, 0.015, 0.004, -0.006, 0.008;
  return se3_exp(xi);
}

std::vector<DenseView> levels_of(const Frame& frame, const cv::Mat& weight = {}) {
  std::vector<DenseView> all{make_dense_view(frame.gray, frame.depth, camera_by_name("generated"), 2)};
  all.front().weight = picked(weight, 2);
  all.push_back(halved(all.front()));
  return all;
}

struct Pair {
  Frame first, second;
};

Pair pair_of(const BentWall& wall = {}) {
  const Camera camera = camera_by_name("generated");
  return {wall.render(camera, Pose::Identity()), wall.render(camera, moved())};
}

DenseAlignment aligned(const Pair& pair, int threads = 1, const cv::Mat& weight = {}) {
  return align_dense(levels_of(pair.first), levels_of(pair.second, weight), Pose::Identity(), BamvoConfig(),
                     threads);
}

double error_of(const DenseAlignment& found) { return se3_log(found.target_from_reference * moved()).norm(); }

TEST(BamvoAlignment, FindsHowTheCameraMoved) {
  const DenseAlignment found = aligned(pair_of());
  ASSERT_EQ(found.failure, "");
  EXPECT_LT(error_of(found), 3e-4);  // m and rad, of a motion of 0.03
  EXPECT_LT(255.0 * found.sigma, 2.0);
}

TEST(BamvoAlignment, GivesTheSameBytesByAnyNumberOfThreads) {
  const Pair pair = pair_of();
  const DenseAlignment one = aligned(pair, 1), three = aligned(pair, 3);
  EXPECT_EQ((one.target_from_reference.matrix() - three.target_from_reference.matrix()).norm(), 0.0);
  EXPECT_EQ(one.counted, three.counted);
}

TEST(BamvoAlignment, WithoutDepthSaysThatTooFewPixelsCount) {
  Pair pair = pair_of();
  pair.second.depth.setTo(0);
  EXPECT_THAT(aligned(pair).failure, testing::HasSubstr("pixels with depth count"));
}

TEST(BamvoAlignment, PixelsOfWeightNoughtHaveNoSay) {
  // What goes along with the camera draws the pose; without it the wall alone decides.
  const Pair pair = pair_of({.companion = true});
  cv::Mat kept(pair.first.gray.size(), CV_32FC1, cv::Scalar(1.0F));
  kept(BentWall::companion_at(camera_by_name("generated"))).setTo(0.0F);
  EXPECT_LT(error_of(aligned(pair, 1, kept)), 1e-3);
  EXPECT_GT(error_of(aligned(pair)), 5e-3);
}

}  // namespace
}  // namespace stillpoint
