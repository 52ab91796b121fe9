// Engine `dso`: its parts against hand-computed values, and poses, brightness and depth recovered from a
// wall.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/odometry/dso/coarse_tracker.hpp"
#include "core/odometry/dso/dso_window.hpp"
#include "core/odometry/dso/point_selection.hpp"
#include "tests/support/bent_wall.hpp"

namespace stillpoint {
namespace {

TEST(DsoResidual, TakesGainAndOffsetOff) {
  // Twice as bright and 10 more: 2 * (100 - 5) + 15 in j, where j's offset is 15 and i's 5.
  const Affine of{0.0, 5.0}, in{std::log(2.0), 15.0};
  EXPECT_NEAR(photometric_residual(205.0, in, 100.0, of), 0.0, 1e-12);
  EXPECT_NEAR(photometric_residual(208.0, in, 100.0, of), 3.0, 1e-12);
}

TEST(DsoResidual, WeighsSteepPixelsAndLargeResidualsLess) {
  EXPECT_DOUBLE_EQ(gradient_weight(0.0, 0.0, 50.0), 1.0);
  EXPECT_DOUBLE_EQ(gradient_weight(30.0, 40.0, 50.0), 0.5);  // 2500 / (2500 + 2500)
  EXPECT_DOUBLE_EQ(huber_weight(-9.0, 9.0), 1.0);
  EXPECT_DOUBLE_EQ(huber_weight(-18.0, 9.0), 0.5);
}

TEST(DsoImage, HasCentralSlopesAndHalvesItsSize) {
  cv::Mat ramp(64, 96, CV_8UC1);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) ramp.at<uchar>(y, x) = static_cast<uchar>(2 * x + y);
  const auto image = make_dso_image(ramp, Camera().scaled_to(96, 64), 2);
  ASSERT_EQ(image->levels.size(), 2U);
  EXPECT_EQ(image->levels[0].at<cv::Vec3f>(10, 20), cv::Vec3f(50, 2, 1));
  EXPECT_EQ(image->levels[1].at<cv::Vec3f>(10, 20), cv::Vec3f(101.5F, 4, 2));  // mean of 80..83 and of 20, 21
  EXPECT_EQ(image->cameras[1].width, 48);
}

TEST(DsoSelection, AThresholdIsItsBlocksMedianAndTheMarginMeanedOverNeighbours) {
  // The left blocks rise by 4 grey levels a pixel, the right ones by 1; 32x32 px each, two by two.
  cv::Mat gray(64, 64, CV_8UC1);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) gray.at<uchar>(y, x) = static_cast<uchar>(x < 32 ? 4 * x : 128 + (x - 32));
  const auto image = make_dso_image(gray, Camera().scaled_to(64, 64), 1);
  const cv::Mat thresholds = gradient_thresholds(*image, 7.0);
  ASSERT_EQ(thresholds.size(), cv::Size(2, 2));
  // Every block has all four for neighbours: (2 * (4 + 7) + 2 * (1 + 7)) / 4 = 9.5.
  EXPECT_FLOAT_EQ(thresholds.at<float>(0, 0), 9.5F);
  EXPECT_FLOAT_EQ(thresholds.at<float>(1, 1), 9.5F);
}

TEST(DsoSelection, TakesTheSteepestPixelOfACellAndNoneThatIsNotUsable) {
  cv::Mat gray(64, 64, CV_8UC1, cv::Scalar(50));
  gray.at<uchar>(20, 20) = 150;  // slopes of 50 beside it
  gray.at<uchar>(24, 23) = 120;  // slopes of 35
  const auto image = make_dso_image(gray, Camera().scaled_to(64, 64), 3);
  const cv::Mat thresholds = gradient_thresholds(*image, 7.0);
  const auto all = select_in_cells(*image, thresholds, {}, 16);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(std::abs(all[0].x - 20) + std::abs(all[0].y - 20), 1);
  cv::Mat usable(64, 64, CV_8UC1, cv::Scalar(255));
  usable(cv::Rect(18, 18, 5, 5)) = 0;
  const auto rest = select_in_cells(*image, thresholds, usable, 16);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(std::abs(rest[0].x - 23) + std::abs(rest[0].y - 24), 1);
  usable = 0;
  EXPECT_TRUE(select_in_cells(*image, thresholds, usable, 16).empty());
}

TEST(DsoSelection, AdaptsItsCellsToTheNumberWanted) {
  const Camera camera = camera_by_name("generated");
  const auto image = make_dso_image(BentWall().render(camera, Pose::Identity()).gray, camera, 3);
  const cv::Mat thresholds = gradient_thresholds(*image, 1.0);
  int d = 20;
  std::vector<DsoCandidate> chosen;
  for (int i = 0; i < 3; ++i) chosen = select_candidates(*image, thresholds, {}, 1500, d);
  EXPECT_GE(chosen.size(), 1000U);
  EXPECT_LE(chosen.size(), 1875U);
}

TEST(DsoTransfer, IsAPinholesWithoutRollingShutter) {
  const Camera camera = camera_by_name("generated");
  Pose target_from_host = Pose::Identity();
  target_from_host.translation().x() = 0.1;
  const auto place = DsoTransfer(camera, target_from_host, Vector6d::Zero(), Vector6d::Zero())(100, 200, 0.5);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->x, 100 + camera.fx * 0.1 / 2.0, 1e-9);
  EXPECT_NEAR(place->y, 200, 1e-9);
  target_from_host.translation().z() = -1.95;
  EXPECT_FALSE(DsoTransfer(camera, target_from_host, Vector6d::Zero(), Vector6d::Zero())(100, 200, 0.5));
}

TEST(DsoTransfer, UndoesARollingShutterInBothViews) {
  // Moving sideways at 1 m/s, a view is skewed by what its row's exposure comes later. Rows alike in both
  // views, the skews cancel; the host alone skewed, a point of the last row lies half a readout's way off.
  Camera camera = camera_by_name("generated");
  camera.readout_s = 0.03;
  Vector6d sideways = Vector6d::Zero();
  sideways[0] = 1.0;
  const double row = camera.height - 0.5;  // (row + 0.5) / height - 0.5 = 0.5
  const auto both = DsoTransfer(camera, Pose::Identity(), sideways, sideways)(100, row, 0.5);
  const auto host = DsoTransfer(camera, Pose::Identity(), sideways, Vector6d::Zero())(100, row, 0.5);
  ASSERT_TRUE(both && host);
  EXPECT_NEAR(both->x, 100.0, 1e-9);
  EXPECT_NEAR(host->x, 100.0 - camera.fx * 0.015 / 2.0, 1e-9);
}

DsoFrame keyframe_of(const Frame& frame, int id, const Pose& world_from_camera, const Camera& camera) {
  DsoFrame made;
  made.keyframe = id;
  made.frame_index = frame.index;
  made.camera_from_world = world_from_camera.inverse();
  made.image = make_dso_image(frame.gray, camera, 5);
  made.outlier_energy = 8 * 12.0 * 12.0;
  return made;
}

Pose at(double x, double y, double z, double turn) {
  Vector6d xi;
  xi << x, y, z, 0.3 * turn, turn, -0.5 * turn;
  return se3_exp(xi);
}

/// Keyframes before a bent wall, the points all in the first and second.
class DsoWindows : public testing::Test {
 protected:
  DsoWindows() {
    const std::vector<Pose> poses{Pose::Identity(), at(0.05, 0.01, 0.02, 0.01), at(0.1, -0.02, 0.01, -0.01)};
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Frame frame = BentWall{.brightness = i == 2 ? 12.0 : 0.0, .gain = i == 2 ? 0.9 : 1.0}.render(
          camera_, poses[i], static_cast<int>(i));
      window_.frames.push_back(keyframe_of(frame, static_cast<int>(i), poses[i], camera_));
      truth_.push_back(poses[i].inverse());
      if (i == 2) continue;
      for (int y = 20 + static_cast<int>(i) * 7; y < camera_.height - 20; y += 24)
        for (int x = 20; x < camera_.width - 20; x += 24)
          if (const auto point = make_dso_point(window_.frames[i], x, y,
                                                static_cast<double>(frame.depth.at<float>(y, x)), config_))
            window_.points.push_back(*point);
    }
    // Exposure is not known beforehand.
  }
  double pose_error(std::size_t frame) const {
    return se3_log(window_.frames[frame].camera_from_world * truth_[frame].inverse()).norm();
  }
  Camera camera_ = camera_by_name("generated");
  DsoConfig config_;
  DsoWindow window_;
  std::vector<Pose> truth_;
};

TEST_F(DsoWindows, FindPosesGainAndOffsetFromNearby) {
  window_.frames[1].camera_from_world = at(0.002, -0.002, 0.001, 0.001) * truth_[1];
  window_.frames[2].camera_from_world = at(-0.002, 0.001, -0.002, 0.001) * truth_[2];
  const double before = pose_error(1) + pose_error(2);
  config_.iterations = 15;
  const DsoOptimisation done = window_.optimise(camera_, config_, 1);
  EXPECT_GT(before, 6e-3);
  EXPECT_LT(pose_error(1), 4e-4);
  EXPECT_LT(pose_error(2), 6e-4);
  EXPECT_NEAR(std::exp(window_.frames[2].affine.a), 0.9, 0.01);
  EXPECT_NEAR(window_.frames[2].affine.b, 12.0, 1.0);
  EXPECT_LT(done.rmse_after, 1.5);
  EXPECT_LT(done.rmse_after, 0.5 * done.rmse_before);
  EXPECT_GT(done.residuals, 500);
}

TEST_F(DsoWindows, HoldTheOldestKeyframe) {
  const Pose before = window_.frames[0].camera_from_world;
  (void)window_.optimise(camera_, config_, 1);
  EXPECT_EQ((window_.frames[0].camera_from_world.matrix() - before.matrix()).norm(), 0.0);
}

TEST_F(DsoWindows, GiveTheSameBytesByAnyNumberOfThreads) {
  DsoWindow other = window_;
  (void)window_.optimise(camera_, config_, 1);
  (void)other.optimise(camera_, config_, 3);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(
        (window_.frames[i].camera_from_world.matrix() - other.frames[i].camera_from_world.matrix()).norm(),
        0.0);
  for (std::size_t i = 0; i < window_.points.size(); ++i)
    EXPECT_EQ(window_.points[i].inverse_depth, other.points[i].inverse_depth);
}

TEST_F(DsoWindows, MendDepthByBrightnessAsFarAsTheSensorLetsThem) {
  window_.frames.pop_back();
  for (DsoPoint& point : window_.points) point.inverse_depth *= 1.01;
  const auto mean_off = [&] {
    double sum = 0.0;
    for (const DsoPoint& point : window_.points)
      sum += std::abs(point.inverse_depth / point.sensed_inverse_depth - 1.0);
    return sum / static_cast<double>(window_.points.size());
  };
  EXPECT_NEAR(mean_off(), 0.01, 1e-6);
  config_.iterations = 10;
  (void)window_.optimise(camera_, config_, 1);
  EXPECT_LT(mean_off(), 0.002);
}

TEST_F(DsoWindows, APointThatNothingShowsRightlyIsLost) {
  for (float& brightness : window_.points[3].brightness) brightness += 90.0F;
  const std::size_t before = window_.points.size();
  (void)window_.optimise(camera_, config_, 1);
  EXPECT_EQ(window_.points[3].seen, 0);
  EXPECT_GE(window_.drop_lost_points(), 1);
  EXPECT_LT(window_.points.size(), before);
}

TEST_F(DsoWindows, AMaskTakesPointsOutOfTheFrameItIsOf) {
  (void)window_.optimise(camera_, config_, 1);
  const auto in_frame = [&](int frame) {
    int count = 0;
    for (const DsoResidual& one : window_.residuals(camera_, config_)) count += one.frame == frame ? 1 : 0;
    return count;
  };
  ASSERT_GT(in_frame(2), 100);
  window_.frames[2].weight = cv::Mat(camera_.height, camera_.width, CV_32FC1, cv::Scalar(0.0F));
  EXPECT_EQ(in_frame(2), 0);
  EXPECT_GT(in_frame(1), 100);
}

DsoWindow standing_at(const std::vector<double>& x_m) {
  DsoWindow window;
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    DsoFrame frame;
    frame.keyframe = static_cast<int>(i);
    frame.camera_from_world.translation().x() = -x_m[i];
    frame.points_made = 10;
    window.frames.push_back(frame);
    for (int p = 0; p < 10; ++p) {
      DsoPoint point;
      point.host = static_cast<int>(i);
      point.seen = 1;
      window.points.push_back(point);
    }
  }
  return window;
}

TEST(DsoWindow, LetsGoOfWhoCrowdsTheOthersWhenItIsFull) {
  DsoConfig config;
  config.window = 3;
  // Of 1 and 2, both spared from being first and newest: sqrt(0.9) (1/0.1 + 1/0.05 + 1/0.9) against
  // sqrt(0.85) (1/0.15 + 1/0.05 + 1/0.85): the former is larger.
  EXPECT_THAT(standing_at({0.0, 0.1, 0.15, 1.0}).to_leave(config), testing::ElementsAre(1));
  EXPECT_TRUE(standing_at({0.0, 0.1, 1.0}).to_leave(config).empty());
}

TEST(DsoWindow, LetsGoOfKeyframesThatAreSpentOrInAnotherLightWhileEnoughAreLeft) {
  DsoConfig config;
  config.least_window = 2;
  DsoWindow window = standing_at({0.0, 0.1, 0.2, 0.3});
  for (DsoPoint& point : window.points)
    if (point.host == 1) point.seen = 0;
  window.frames[2].affine.a = 0.8;
  EXPECT_THAT(window.to_leave(config), testing::ElementsAre(1, 2));
  config.least_window = 3;
  EXPECT_THAT(window.to_leave(config), testing::ElementsAre(1));
  window.drop_frame(1);
  EXPECT_EQ(window.frames.size(), 3U);
  EXPECT_EQ(window.points.size(), 30U);
  EXPECT_EQ(window.index_of(1), -1);
}

/// A keyframe before the wall, and what tracking against it finds of a second frame.
struct TrackedWall {
  Camera camera = camera_by_name("generated");
  DsoConfig config;
  CoarseReference reference;

  explicit TrackedWall(const BentWall& wall = {}, const cv::Mat& weight = {}) {
    const Frame frame = wall.render(camera, Pose::Identity());
    DsoWindow window;
    window.frames.push_back(keyframe_of(frame, 0, Pose::Identity(), camera));
    window.frames[0].weight = weight;
    for (int y = 10; y < camera.height - 10; y += 10)
      for (int x = 10; x < camera.width - 10; x += 10)
        if (auto point = make_dso_point(window.frames[0], x, y,
                                        static_cast<double>(frame.depth.at<float>(y, x)), config)) {
          point->id = static_cast<int>(window.points.size());
          window.points.push_back(*point);
        }
    reference = make_coarse_reference(window, camera);
  }
  [[nodiscard]] CoarseAlignment track(const Frame& frame, const cv::Mat& weight = {}) const {
    TrackerFrame looked{frame, frame.gray, frame.depth, weight};
    return track_coarse(reference, *make_dso_image(frame.gray, camera, 5), looked,
                        dso_starts(Pose::Identity(), Pose::Identity(), Pose::Identity(), config.turn), {},
                        1e9, config);
  }
};

TEST(DsoTracking, FindsPoseGainAndOffset) {
  const TrackedWall wall;
  const Pose moved = at(0.03, -0.02, 0.02, 0.01);
  const CoarseAlignment found =
      wall.track(BentWall{.brightness = 15.0, .gain = 0.8}.render(wall.camera, moved));
  ASSERT_EQ(found.failure, "");
  EXPECT_LT(se3_log(found.frame_from_reference * moved).norm(), 5e-4);
  EXPECT_NEAR(std::exp(found.affine.a), 0.8, 0.01);
  EXPECT_NEAR(found.affine.b, 15.0, 1.0);
  EXPECT_GT(found.inliers, 2000);
  EXPECT_EQ(found.tries, 1);
}

TEST(DsoTracking, MeasuresFlowACoordinateAsAtVga) {
  const TrackedWall wall;
  // 2 cm sideways: fx * 0.02 / z px in one of two coordinates; the wall's 1/z is 0.5 to 0.55 on average here.
  const CoarseAlignment found = wall.track(BentWall().render(wall.camera, at(0.02, 0, 0, 0)));
  ASSERT_EQ(found.failure, "");
  const double expected = wall.camera.fx * 0.02 * 0.49 / std::sqrt(2.0);
  EXPECT_NEAR(found.shift_px, expected, 0.1 * expected);
  EXPECT_NEAR(found.flow_px, found.shift_px, 0.1 * expected);
}

TEST(DsoTracking, PixelsOfWeightNoughtHaveNoSay) {
  const Camera camera = camera_by_name("generated");
  cv::Mat kept(camera.height, camera.width, CV_32FC1, cv::Scalar(1.0F));
  kept(BentWall::companion_at(camera)).setTo(0.0F);
  const Pose moved = at(0.02, -0.01, 0.01, 0.005);
  const Frame frame = BentWall{.companion = true}.render(camera, moved);
  const auto error = [&](const cv::Mat& weight) {
    const CoarseAlignment found = TrackedWall({.companion = true}, weight).track(frame, weight);
    EXPECT_EQ(found.failure, "");
    return se3_log(found.frame_from_reference * moved).norm();
  };
  EXPECT_LT(error(kept), 1e-3);
  EXPECT_GT(error({}), 3e-3);
}

TEST(DsoTracking, ADarkFrameIsNotBelieved) {
  const TrackedWall wall;
  Frame dark = BentWall().render(wall.camera, Pose::Identity());
  dark.gray.setTo(0);
  EXPECT_NE(wall.track(dark).failure, "");
}

TEST(DsoTracking, BeginsFromTheMotionBeforeAndThenFromOthers) {
  Pose last = Pose::Identity(), predicted = Pose::Identity();
  last.translation().x() = 0.1;
  predicted.translation().x() = 0.2;
  const std::vector<Pose> starts = dso_starts(predicted, last, Pose::Identity(), 0.02);
  ASSERT_EQ(starts.size(), 31U);
  for (const auto& [start, x] : {std::pair{0, 0.2}, {1, 0.3}, {2, 0.15}, {3, 0.1}, {4, 0.0}, {5, 0.2}})
    EXPECT_NEAR(starts[static_cast<std::size_t>(start)].translation().x(), x, 0.02) << start;
  EXPECT_NEAR(rotation_angle(starts[5].linear()), 0.02 * std::sqrt(3.0), 1e-9);
}

}  // namespace
}  // namespace stillpoint
