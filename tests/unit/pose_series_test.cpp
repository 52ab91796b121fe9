// Poses number by number over time.
#include "core/evaluation/pose_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillpoint {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;  // of a degree

Pose turned(double roll, double pitch, double yaw, const Eigen::Vector3d& at = Eigen::Vector3d::Zero()) {
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(yaw * kRadian, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(pitch * kRadian, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(roll * kRadian, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = at;
  return pose;
}

TEST(PoseSeries, AnglesAreRollPitchAndYawAndGoOnPastHalfATurn) {
  Trajectory trajectory;
  for (int i = 0; i <= 40; ++i) trajectory.push_back({5.0 + 0.1 * i, turned(10, -20, 10.0 * i)});
  const PoseSeries series = pose_series(trajectory, 5.0);
  ASSERT_EQ(series.time.size(), 41U);
  EXPECT_NEAR(series.time.back(), 4.0, 1e-9);
  for (std::size_t i = 0; i <= 40; ++i) {
    EXPECT_NEAR(series.angle[0][i], 10.0, 1e-6);
    EXPECT_NEAR(series.angle[1][i], -20.0, 1e-6);
    EXPECT_NEAR(series.angle[2][i], 10.0 * static_cast<double>(i), 1e-6);
  }
}

TEST(PoseSeries, SpeedIsTheWayFromThePoseBefore) {
  const PoseSeries series = pose_series({{0.0, turned(0, 0, 0, {0, 0, 0})},
                                         {0.5, turned(0, 0, 0, {0.3, 0.4, 0})},
                                         {1.0, turned(0, 0, 0, {0.3, 0.4, 0.1})}});
  EXPECT_TRUE(std::isnan(series.speed[0]));
  EXPECT_NEAR(series.speed[1], 1.0, 1e-12);
  EXPECT_NEAR(series.speed[2], 0.2, 1e-12);
  EXPECT_NEAR(series.position[2][2], 0.1, 1e-12);
}

TEST(PoseSeries, NoLineIsDrawnWherePosesAreMissing) {
  Trajectory trajectory;
  for (const double t : {0.0, 0.1, 0.2, 0.9, 1.0}) trajectory.push_back({t, turned(0, 0, 0, {t, 0, 0})});
  const PoseSeries series = pose_series(trajectory);
  ASSERT_EQ(series.time.size(), 6U);
  EXPECT_NEAR(series.time[3], 0.55, 1e-12);
  EXPECT_TRUE(std::isnan(series.position[0][3]));
  EXPECT_TRUE(std::isnan(series.speed[4]));
  EXPECT_NEAR(series.position[0][4], 0.9, 1e-12);
  EXPECT_TRUE(pose_series({}).time.empty());
}

TEST(PoseSeries, DifferencesOfAnglesAreTheShortWayRound) {
  const Trajectory one = {{0.0, turned(0, 0, 179, {1, 2, 3})}, {0.1, turned(0, 0, 179, {1, 2, 3})}},
                   other = {{0.0, turned(0, 0, -179, {1, 2, 2})}, {0.1, turned(0, 0, -179, {1, 2, 2})}};
  const PoseSeries error = difference(pose_series(one), pose_series(other));
  EXPECT_NEAR(error.angle[2][1], -2.0, 1e-6);
  EXPECT_NEAR(error.position[2][0], 1.0, 1e-12);
  EXPECT_NEAR(error.speed[1], 0.0, 1e-12);
}

}  // namespace
}  // namespace stillpoint
