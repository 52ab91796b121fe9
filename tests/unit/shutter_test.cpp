#include "core/motion/epipolar/shutter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/geometry/se3.hpp"
#include "core/motion/epipolar/relative_orientation.hpp"

namespace stillpoint {
namespace {

/// Turns about y whose rate grows evenly: angle(t) = t + t^2 rad, so rate(t) = 1 + 2 t rad / s.
double angle(double t) { return t + t * t; }

TEST(AngularVelocities, AreExactWhereTheRateChangesEvenly) {
  const double times[] = {0.0, 0.03, 0.07, 0.1, 0.15};
  AngularVelocities rates;
  for (int i = 1; i < 5; ++i)
    rates.add({0.0, -(angle(times[i]) - angle(times[i - 1])), 0.0}, times[i] - times[i - 1], 12);
  for (int back = 0; back <= 4; ++back)
    EXPECT_NEAR(rates.at(back).y(), 1.0 + 2.0 * times[4 - back], 1e-9) << back;
}

TEST(AngularVelocities, OfOneTurnAreThatTurnsAndOfNoneAreRest) {
  AngularVelocities rates;
  EXPECT_TRUE(rates.at(0).isZero());
  EXPECT_EQ(rates.sigma(), 0.0);
  rates.add({0.0, 0.0, 0.06}, 0.03, 12);
  EXPECT_NEAR(rates.at(0).z(), -2.0, 1e-12);
  EXPECT_NEAR(rates.at(1).z(), -2.0, 1e-12);
  EXPECT_NEAR(rates.sigma(), 2.0 / std::sqrt(3.0), 1e-12);
  rates.add({0.0, 0.0, 0.03}, 0.03, 12);
  EXPECT_NEAR(rates.sigma(), 1.0 / std::sqrt(3.0), 1e-12);
}

TEST(AngularVelocities, ReachBackAsFarAsAsked) {
  AngularVelocities rates;
  for (int i = 0; i < 30; ++i) rates.add({0.01 * i, 0.0, 0.0}, 1.0, 5);
  EXPECT_NEAR(rates.at(0).x(), -0.295, 1e-12);
  EXPECT_NEAR(rates.at(5).x(), -0.245, 1e-12);
}

TEST(UndoShutter, WarpsRowsToTheMiddleOne) {
  Camera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = 500.0, camera.cx = 320.0, camera.cy = 240.0;
  camera.readout_s = 0.03;
  // Turning about y by 1 rad / s carries points by about fx * 1 px / s along x.
  const std::vector<cv::Point2f> rows = {{320.0F, 239.5F}, {320.0F, 479.5F}, {320.0F, -0.5F}};
  std::vector<cv::Point2f> straight = rows;
  undo_shutter(camera, {0.0, 1.0, 0.0}, rows, straight);
  EXPECT_NEAR(straight[0].x, 320.0, 1e-3);
  EXPECT_NEAR(straight[1].x, 320.0 - 500.0 * 0.015, 0.01);
  EXPECT_NEAR(straight[2].x, 320.0 + 500.0 * 0.015, 0.01);
  camera.readout_s = 0.0;
  straight = rows;
  undo_shutter(camera, {0.0, 1.0, 0.0}, rows, straight);
  EXPECT_EQ(straight, rows);
}

constexpr double kReadout = 0.03;  // s

/// A room from two places; the rows of the later view are taken one after the other at a `rate` not undone.
/// @param moving so many go their own way along the epipolar lines, towards infinity and beyond
std::vector<BearingPair> room(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation,
                              const Eigen::Vector3d& rate, int moving) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> wide(-0.6, 0.6), high(-0.45, 0.45), far(1.0, 5.0);
  std::vector<BearingPair> pairs;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d now(wide(random), high(random), 1.0);
    const double depth = far(random), after_middle = now.y() / 0.9 * kReadout;
    Eigen::Vector3d then = rotation * (depth * now) + translation;
    if (i < moving) then -= translation * (1.0 + depth);
    const Eigen::Vector3d seen = now + after_middle * rate.cross(now);
    pairs.push_back({seen / seen.z(), then / then.z(), 1.0, after_middle});
  }
  return pairs;
}

const Eigen::Matrix3d kTurned = so3_exp({0.005, -0.04, 0.01});
const Eigen::Vector3d kWent(0.03, 0.002, 0.004), kRate(0.25, -0.2, 0.1);

TEST(RelativeOrientation, FindsTheRateThatARollingShutterShows) {
  const std::vector<BearingPair> pairs = room(kTurned, kWent, kRate, 60);
  RelativeOrientationOptions options;
  options.rate_sigma = 0.3;
  const RelativeOrientation motion = estimate_relative_orientation(pairs, options);
  ASSERT_FALSE(motion.rotation_only);
  EXPECT_GT(motion.direction.dot(kWent.normalized()), 0.99);
  EXPECT_LT(rotation_angle(motion.rotation.transpose() * kTurned), 2e-3);
  EXPECT_NEAR(motion.rate.x(), kRate.x(), 0.05);
  // Held to rest, it is taken for a motion that the camera has not made.
  const RelativeOrientation held = estimate_relative_orientation(pairs, {});
  EXPECT_TRUE(held.rate.isZero());
  EXPECT_LT(held.direction.dot(kWent.normalized()), 0.97);
}

TEST(RelativeOrientation, KnowsWhatLiesBehindInfinity) {
  const int moving = 60;
  const std::vector<BearingPair> pairs = room(kTurned, kWent, Eigen::Vector3d::Zero(), moving);
  const RelativeOrientation motion = estimate_relative_orientation(pairs, {});
  ASSERT_GT(pairs.size(), static_cast<std::size_t>(moving)) << "some move and some do not";
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    double sigma = 0.0;
    const double near = nearness(motion, pairs[i], sigma);
    EXPECT_GT(sigma, 0.0);
    if (i < moving)
      EXPECT_LT(near, -3.0 * sigma) << i;
    else
      EXPECT_GT(near, 0.0) << i;
  }
}

}  // namespace
}  // namespace stillpoint
