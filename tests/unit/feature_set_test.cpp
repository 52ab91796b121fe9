// A frame's features as odometry has them: found again by place, with depth, freed of the shutter, matched.
#include "core/odometry/feature_set.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/odometry/matching.hpp"
#include "core/odometry/rolling_shutter.hpp"

namespace stillpoint {
namespace {

FeatureSet features_at(const std::vector<cv::Point2f>& pixels, const std::vector<int>& octaves = {}) {
  FeatureSet set;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    set.keypoints.emplace_back(pixels[i], 31.0F, 0.0F, 1.0F, octaves.empty() ? 0 : octaves[i]);
    set.undistorted.push_back(pixels[i]);
    Descriptor d{};
    d[0] = std::uint64_t{1} << i;
    set.descriptors.push_back(d);
    set.depth.push_back(1.0F);
    set.static_weight.push_back(1.0F);
  }
  set.build_index(640, 480);
  return set;
}

TEST(FeatureSet, FindsWhatASearchOfAllFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> x(-10, 650), y(-10, 490);
  std::vector<cv::Point2f> pixels;
  std::vector<int> octaves;
  for (int i = 0; i < 60; ++i) pixels.emplace_back(x(random), y(random)), octaves.push_back(i % 8);
  const FeatureSet set = features_at(pixels, octaves);
  std::vector<int> found;
  int with_some = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const cv::Point2f centre(x(random), y(random));
    const float radius = 5.0F + static_cast<float>(trial % 60);
    found.clear();
    set.find(centre, radius, 1, 5, found);
    std::sort(found.begin(), found.end());
    std::vector<int> expected;
    for (int i = 0; i < set.size(); ++i) {
      const auto f = static_cast<std::size_t>(i);
      if (octaves[f] >= 1 && octaves[f] <= 5 && std::abs(pixels[f].x - centre.x) <= radius &&
          std::abs(pixels[f].y - centre.y) <= radius)
        expected.push_back(i);
    }
    EXPECT_EQ(found, expected);
    with_some += expected.empty() ? 0 : 1;
  }
  EXPECT_GE(with_some, 50);
}

TEST(FeatureSet, DepthIsReadWhereItIsAndZeroElsewhere) {
  cv::Mat depth = cv::Mat::zeros(10, 10, CV_32FC1);
  depth.at<float>(3, 4) = 1.5F;
  depth.at<float>(5, 5) = std::numeric_limits<float>::quiet_NaN();
  const std::vector<cv::Point2f> pixels = {{4.2F, 2.9F}, {5, 5}, {9.9F, 3}, {0, 0}};
  EXPECT_EQ(depth_at(pixels, depth), (std::vector<float>{1.5F, 0, 0, 0}));
  EXPECT_EQ(depth_at(pixels, {}), (std::vector<float>{0, 0, 0, 0}));
}

TEST(FeatureSet, DepthTakenFromElsewhereIsWarpedToNow) {
  // The depth image was taken 2 cm to the left and 5 cm farther back, of a wall that slopes.
  const Camera camera = camera_by_name("generated");
  const Vector6d velocity{0.2, 0, 0.5, 0, 0, 0};
  constexpr double kLag = 0.1;
  const auto plane_depth = [](double x) { return 2.0 / (1.0 - 0.3 * x); };  // z = 2 + 0.3 X, by x = X / z
  cv::Mat depth(480, 640, CV_32FC1);
  // The wall in coordinates of then: z - 0.05 = 2 + 0.3 (X - 0.02).
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      const double x = (u - camera.cx) / camera.fx;
      depth.at<float>(v, u) = static_cast<float>((2.05 - 0.3 * 0.02) / (1.0 - 0.3 * x));
    }
  for (const cv::Point2f pixel : {cv::Point2f(100, 100), cv::Point2f(320, 240), cv::Point2f(500, 400)}) {
    const float z = depth_at({pixel}, {pixel}, depth, camera, velocity, kLag).front();
    EXPECT_NEAR(z, plane_depth((pixel.x - camera.cx) / camera.fx), 0.002);
    EXPECT_GT(std::abs(depth_at({pixel}, depth).front() - z), 0.03) << "without being carried it is off";
    EXPECT_EQ(depth_at({pixel}, {pixel}, depth, camera, velocity, std::nullopt), depth_at({pixel}, depth));
    // Depth's own delay and readout do what the stamps do.
    Camera late = camera;
    late.depth_delay_s = kLag;
    EXPECT_EQ(depth_at({pixel}, {pixel}, depth, late, velocity, 0.0).front(), z);
    late.depth_delay_s = 0.0;
    late.depth_readout_s = 2 * kLag;  // by which the row is late if it is the image's last
    const double at_row = kLag * 2 * ((static_cast<double>(pixel.y) + 0.5) / camera.height - 0.5);
    EXPECT_NEAR(depth_at({pixel}, {pixel}, depth, late, velocity, kLag - at_row).front(), z, 2e-3);
  }
}

TEST(RollingShutter, FeaturesComeToWhereTheMiddleRowSeesThem) {
  // A camera that moves and turns; each point is projected at the very moment its row is read.
  Camera camera = camera_by_name("generated");
  camera.readout_s = 0.03;
  Vector6d velocity;
  velocity << 0.4, -0.2, 0.3, 0.1, -0.5, 0.2;
  const std::vector<Eigen::Vector3d> points = {
      {-0.5, -0.6, 1.5}, {0.4, 0.1, 1.0}, {0.3, 0.7, 2.0}, {-0.2, 0.45, 1.2}};
  std::vector<cv::Point2f> pixels, undistorted;
  std::vector<float> depth;
  for (const Eigen::Vector3d& p : points) {
    Eigen::Vector3d seen = p;
    for (int i = 0; i < 10; ++i) {  // the row decides the moment, the moment the row
      const double moment = ((camera.project(seen).y() + 0.5) / camera.height - 0.5) * camera.readout_s;
      seen = se3_exp(velocity * moment) * p;
    }
    const Eigen::Vector2d pixel = camera.project(seen);
    pixels.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    depth.push_back(static_cast<float>(seen.z()));
  }
  undistorted = pixels;
  correct_rolling_shutter(camera, velocity, pixels, undistorted, depth);
  double largest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d at_once = camera.project(points[i]);
    EXPECT_NEAR(undistorted[i].x, at_once.x(), 0.05) << i;
    EXPECT_NEAR(undistorted[i].y, at_once.y(), 0.05) << i;
    EXPECT_NEAR(depth[i], points[i].z(), 1e-4) << i;
    largest = std::max(largest, std::abs(pixels[i].x - at_once.x()));
  }
  EXPECT_GT(largest, 1.0) << "uncorrected they are off";
}

TEST(RollingShutter, AGlobalShutterIsLeftAlone) {
  Vector6d velocity = Vector6d::Constant(1.0);
  std::vector<cv::Point2f> pixels = {{10, 20}}, undistorted = pixels;
  std::vector<float> depth = {1.5F};
  correct_rolling_shutter(camera_by_name("generated"), velocity, pixels, undistorted, depth);
  EXPECT_EQ(undistorted[0], pixels[0]);
  EXPECT_EQ(depth[0], 1.5F);
}

TEST(Matching, TheNearestDescriptorInTheWindowWins) {
  const FeatureSet set = features_at({{100, 100}, {104, 100}, {300, 300}});
  Descriptor wanted{};
  wanted[0] = 0b010 | (std::uint64_t{1} << 40);  // one bit from feature 1 more than exact
  const auto candidate = [&](float x, float radius) {
    return Candidate{7, {x, 100}, radius, 0, 0, &wanted, -1.0F};
  };
  auto matches = match_in_windows(set, {candidate(102, 5)}, 50, 0.9);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].feature, 1);
  EXPECT_EQ(matches[0].point, 7);
  EXPECT_EQ(matches[0].distance, 1);
  EXPECT_TRUE(match_in_windows(set, {candidate(102, 5)}, 0, 0.9).empty()) << "beyond the largest distance";
  EXPECT_TRUE(match_in_windows(set, {candidate(102, 5)}, 50, 0.3).empty()) << "1 of 3 bits: too alike";
  EXPECT_TRUE(match_in_windows(set, {candidate(200, 5)}, 50, 0.9).empty()) << "nothing in the window";
}

TEST(Matching, AFeatureGoesToTheNearestCandidate) {
  const FeatureSet set = features_at({{100, 100}});
  Descriptor exact{}, off{};
  exact[0] = 1, off[0] = 0b111;
  const std::vector<Candidate> candidates = {{1, {100, 100}, 5, 0, 0, &off, -1.0F},
                                             {2, {100, 100}, 5, 0, 0, &exact, -1.0F}};
  const auto matches = match_in_windows(set, candidates, 50, 1.0);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].point, 2);
  EXPECT_EQ(match_everywhere(set, candidates, 50, 1.0).front().point, 2);
}

TEST(Matching, FeaturesThatTurnedOtherwiseAreDropped) {
  std::vector<Match> matches;
  for (int i = 0; i < 40; ++i) matches.push_back({i, i, 0, 30.0F});
  matches.push_back({40, 40, 0, 200.0F});
  const auto kept = consistently_turned(matches);
  EXPECT_EQ(kept.size(), 40u);
}

}  // namespace
}  // namespace stillpoint
