#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "core/motion/paper/homography.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

using motion_test::slight_motion;

const cv::Size kPairSize(640, 480);

/// Tracks of a plane under `homography`: the first `outliers` of them go anywhere.
std::vector<Track> make_tracks(const cv::Matx33d& homography, int count, int outliers, double noise_px,
                               unsigned seed) {
  cv::RNG random(seed);
  std::vector<Track> tracks;
  for (int i = 0; i < count; ++i) {
    const cv::Point2d from(random.uniform(5.0, 635.0), random.uniform(5.0, 475.0));
    cv::Point2d to =
        carry(homography, from) + cv::Point2d(random.gaussian(noise_px), random.gaussian(noise_px));
    if (i < outliers) to += cv::Point2d(random.uniform(8.0, 40.0), random.uniform(-40.0, 40.0));
    tracks.push_back({.from = from, .to = to});
  }
  return tracks;
}

double corner_error_px(const cv::Matx33d& truth, const cv::Matx33d& estimate) {
  double worst = 0.0;
  for (const cv::Point2d corner : {cv::Point2d(0, 0), {639, 0}, {0, 479}, {639, 479}})
    worst = std::max(worst, cv::norm(carry(truth, corner) - carry(estimate, corner)));
  return worst;
}

/// The direct linear transform in raw pixels: what Levenberg-Marquardt has to better.
cv::Matx33d direct_linear_transform(const std::vector<Track>& tracks) {
  cv::Mat_<double> rows(0, 9);
  for (const Track& track : tracks) {
    const double x = track.from.x, y = track.from.y, u = track.to.x, v = track.to.y;
    rows.push_back(cv::Mat(cv::Matx<double, 1, 9>(x, y, 1, 0, 0, 0, -u * x, -u * y, -u)));
    rows.push_back(cv::Mat(cv::Matx<double, 1, 9>(0, 0, 0, x, y, 1, -v * x, -v * y, -v)));
  }
  cv::Mat_<double> h;
  cv::SVD::solveZ(rows, h);
  return cv::Matx33d(h.ptr<double>()) * (1.0 / h(8));
}

TEST(Homography, RecoversAKnownOneFromNoisyTracksWithOutliers) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::vector<Track> tracks = make_tracks(slight_motion(), 600, 240, 0.3, seed);
    const HomographyEstimate estimate =
        estimate_homography(tracks, kPairSize, PaperConfig{}, cv::Matx33d::eye());
    ASSERT_TRUE(estimate.valid);
    // 360 good tracks of 0.3 px noise: a corner is known to about 0.3 * sqrt(8 / 720) * 3 = 0.1 px.
    EXPECT_LT(corner_error_px(slight_motion(), estimate.matrix), 0.25);
    EXPECT_GE(estimate.ransac_inliers, 350);
    EXPECT_NEAR(estimate.refined_error_px, 0.3 * std::sqrt(2.0), 0.05);
    EXPECT_LE(estimate.refined_error_px, estimate.ransac_error_px);
    int false_inliers = 0;
    for (int i = 0; i < 240; ++i) false_inliers += tracks[static_cast<std::size_t>(i)].inlier ? 1 : 0;
    EXPECT_EQ(false_inliers, 0);
  }
}

TEST(Homography, ExactTracksGiveTheExactHomography) {
  std::vector<Track> tracks = make_tracks(slight_motion(), 100, 0, 0.0, 4);
  const HomographyEstimate estimate =
      estimate_homography(tracks, kPairSize, PaperConfig{}, cv::Matx33d::eye());
  ASSERT_TRUE(estimate.valid);
  EXPECT_LT(corner_error_px(slight_motion(), estimate.matrix), 1e-3);  // Track's floats round at 1e-5 px
}

TEST(Homography, LevenbergMarquardtLowersTheErrorOfADirectLinearTransform) {
  const cv::Matx33d tilted(0.9, 0.1, 20, -0.15, 1.05, 11, 2e-4, -3e-4, 1);
  const std::vector<Track> tracks = make_tracks(tilted, 80, 0, 1.0, 11);
  const cv::Matx33d start = direct_linear_transform(tracks);
  const RefinedHomography refined = refine_homography(start, tracks, 50);
  const double before = reprojection_error_px(start, tracks),
               after = reprojection_error_px(refined.matrix, tracks);
  EXPECT_LT(after, before - 1e-4);
  EXPECT_GT(refined.iterations, 0);
  // A minimum: no small step of any element gets below it.
  for (int element = 0; element < 8; ++element) {
    for (const double step : {-1e-4, 1e-4}) {
      cv::Matx33d nearby = refined.matrix;
      nearby.val[element] *= 1.0 + step;
      EXPECT_GE(reprojection_error_px(nearby, tracks), after - 1e-9) << "element " << element;
    }
  }
}

TEST(Homography, LevenbergMarquardtFindsBackFromFarOff) {
  const std::vector<Track> tracks = make_tracks(slight_motion(), 200, 0, 0.0, 21);
  const cv::Matx33d off(1.1, 0.05, -20, -0.04, 0.93, 15, 1e-5, -2e-5, 1);
  const RefinedHomography refined = refine_homography(off, tracks, 50);
  EXPECT_GT(reprojection_error_px(off, tracks), 20.0);
  EXPECT_LT(corner_error_px(slight_motion(), refined.matrix), 1e-3);
}

TEST(Homography, NoStepsLeaveTheStart) {
  const std::vector<Track> tracks = make_tracks(slight_motion(), 50, 0, 0.5, 2);
  EXPECT_EQ(refine_homography(cv::Matx33d::eye(), tracks, 0).matrix, cv::Matx33d::eye());
}

TEST(Homography, RemovedTracksHaveNoSay) {
  std::vector<Track> tracks = make_tracks(slight_motion(), 300, 0, 0.1, 8);
  // Twice as many tracks agree on another motion, and all are marked as removed.
  for (Track& other : make_tracks({1, 0, 30, 0, 1, 30, 0, 0, 1}, 600, 0, 0.1, 9)) {
    other.removed = true;
    tracks.push_back(other);
  }
  const HomographyEstimate estimate =
      estimate_homography(tracks, kPairSize, PaperConfig{}, cv::Matx33d::eye());
  ASSERT_TRUE(estimate.valid);
  EXPECT_LT(corner_error_px(slight_motion(), estimate.matrix), 0.2);
  for (const Track& track : tracks) EXPECT_FALSE(track.removed && track.inlier);
}

TEST(Homography, TooFewOrSenselessTracksFallBack) {
  const cv::Matx33d fall_back(1, 0, 3, 0, 1, 2, 0, 0, 1);
  std::vector<Track> few = make_tracks(slight_motion(), 11, 0, 0.0, 1);
  std::vector<Track> on_a_point(40, Track{.from = {100, 100}, .to = {120, 90}});
  std::vector<Track> none;
  std::vector<Track> anywhere;
  cv::RNG random(5);
  for (int i = 0; i < 60; ++i)
    anywhere.push_back({.from = cv::Point2d(random.uniform(0.0, 640.0), random.uniform(0.0, 480.0)),
                        .to = cv::Point2d(random.uniform(0.0, 640.0), random.uniform(0.0, 480.0))});
  for (std::vector<Track>* tracks : {&few, &on_a_point, &none, &anywhere}) {
    const HomographyEstimate estimate = estimate_homography(*tracks, kPairSize, PaperConfig{}, fall_back);
    EXPECT_FALSE(estimate.valid);
    EXPECT_EQ(estimate.matrix, fall_back);
    for (const Track& track : *tracks) EXPECT_FALSE(track.inlier);
  }
}

TEST(Homography, DegenerateOnesAreNotPlausible) {
  EXPECT_TRUE(is_plausible(cv::Matx33d::eye(), kPairSize));
  EXPECT_TRUE(is_plausible(slight_motion() * -3.0, kPairSize)) << "its scale and sign mean nothing";
  EXPECT_FALSE(is_plausible({1, 0, 0, 0, 1, 0, 0, 0, 0}, kPairSize)) << "not invertible";
  EXPECT_FALSE(is_plausible({1, 2, 3, 2, 4, 6, 0, 0, 1}, kPairSize)) << "onto a line";
  EXPECT_FALSE(is_plausible({-1, 0, 640, 0, 1, 0, 0, 0, 1}, kPairSize)) << "a mirror image";
  EXPECT_FALSE(is_plausible({1, 0, 0, 0, 1, 0, -1.0 / 400, 0, 1}, kPairSize)) << "horizon inside the image";
  EXPECT_FALSE(is_plausible({8, 0, 0, 0, 8, 0, 0, 0, 1}, kPairSize)) << "64 times as large";
  EXPECT_FALSE(is_plausible({0.1, 0, 0, 0, 0.1, 0, 0, 0, 1}, kPairSize)) << "a hundredth of it";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_plausible({nan, 0, 0, 0, 1, 0, 0, 0, 1}, kPairSize));
}

}  // namespace
}  // namespace stillpoint
