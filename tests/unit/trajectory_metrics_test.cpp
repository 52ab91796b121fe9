#include "core/evaluation/trajectory_metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/evaluation/evaluation_json.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

StampedPose pose_at(double t, const Eigen::Vector3d& position, const Eigen::Vector3d& rotation = {0, 0, 0}) {
  StampedPose pose;
  pose.timestamp = t;
  pose.world_from_camera.linear() = so3_exp(rotation);
  pose.world_from_camera.translation() = position;
  return pose;
}

/// A curve in space with turning cameras, 0.1 s a pose.
Trajectory curve(int poses) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    const double t = 0.1 * i;
    trajectory.push_back(
        pose_at(t, {std::cos(t), std::sin(2 * t), 0.3 * t * t}, {0.2 * t, -0.1, 0.3 * std::sin(t)}));
  }
  return trajectory;
}

/// Straight along x at a speed in m/s and turning about z at a rate in deg/s, from 0 to 2 s by 0.1 s.
Trajectory straight(double speed, double turn_rate = 0.0) {
  Trajectory trajectory;
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.1 * i;
    trajectory.push_back(pose_at(t, {speed * t, 0, 0}, {0, 0, turn_rate * kDegree * t}));
  }
  return trajectory;
}

std::vector<Pose> poses_of(const Trajectory& trajectory) {
  std::vector<Pose> poses;
  for (const StampedPose& pose : trajectory) poses.push_back(pose.world_from_camera);
  return poses;
}

Trajectory moved(const Pose& by, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.world_from_camera = by * pose.world_from_camera;
  return trajectory;
}

Pose some_motion() {
  Vector6d xi;
  xi << 1.0, -2.0, 0.5, 0.4, 1.2, -0.7;
  return se3_exp(xi);
}

TEST(Statistics, AgreeWithHandComputedValues) {
  const ErrorStatistics s = statistics_of({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(30.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.stddev, std::sqrt(1.25));
  EXPECT_EQ(s.min, 1.0);
  EXPECT_EQ(s.max, 4.0);
  EXPECT_EQ(statistics_of({5.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(statistics_of({}).count, 0);
}

TEST(Alignment, FindsTheMotionBetweenTwoWorlds) {
  const Trajectory truth = curve(30);
  const Alignment alignment = align(poses_of(moved(some_motion().inverse(), truth)), poses_of(truth));
  EXPECT_FALSE(alignment.degenerate);
  EXPECT_LT((alignment.truth_from_estimate.matrix() - some_motion().matrix()).norm(), 1e-9);
}

TEST(Alignment, NeverMirrors) {
  std::vector<Pose> truth = poses_of(curve(30)), estimate = truth;
  for (Pose& pose : estimate) pose.translation().z() *= -1;
  EXPECT_NEAR(align(estimate, truth).truth_from_estimate.linear().determinant(), 1.0, 1e-9);
}

TEST(Alignment, DegeneratePositionsAreSettledByOrientations) {
  for (const int count : {1, 2}) {
    const Trajectory truth = curve(count);
    const Alignment few = align(poses_of(moved(some_motion().inverse(), truth)), poses_of(truth));
    EXPECT_TRUE(few.degenerate);
    EXPECT_LT((few.truth_from_estimate.matrix() - some_motion().matrix()).norm(), 1e-9) << count;
  }
  const Trajectory line = straight(1.0, 30.0), point = straight(0.0, 30.0);
  for (const Trajectory& truth : {line, point}) {
    const Alignment alignment = align(poses_of(moved(some_motion().inverse(), truth)), poses_of(truth));
    EXPECT_TRUE(alignment.degenerate);
    EXPECT_LT((alignment.truth_from_estimate.matrix() - some_motion().matrix()).norm(), 1e-9);
  }
  EXPECT_TRUE(align({}, {}).degenerate);
}

TEST(Alignment, LaysALineOnALineWhateverTheOrientationsSay) {
  std::vector<Pose> truth = poses_of(straight(1.0)), estimate = truth;
  for (Pose& pose : estimate) pose.translation() = Eigen::Vector3d(0, pose.translation().x(), 0);
  const Pose a = align(estimate, truth).truth_from_estimate;
  ASSERT_GE(truth.size(), 2U);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_LT((a * estimate[i].translation() - truth[i].translation()).norm(), 1e-9);
}

TEST(TrajectoryMetrics, AMovedCopyHasNoError) {
  const Trajectory truth = curve(40);
  const auto e = evaluate_trajectory(truth, moved(some_motion(), truth));
  EXPECT_EQ(e.matched.size(), 40U);
  for (const ErrorStatistics& s :
       {e.ate.translation_m, e.ate.rotation_deg, e.rpe_time.translation_m, e.rpe_time.rotation_deg,
        e.rpe_frame.translation_m, e.rpe_frame.rotation_deg}) {
    EXPECT_LT(s.max, 1e-6);
    EXPECT_GT(s.count, 0);
  }
  EXPECT_FALSE(e.coverage);
}

TEST(TrajectoryMetrics, AConstantDriftIsWhatItIs) {
  // 10 % too fast: 0.1 m in every second, 0.01 m in every 0.1 s.
  const auto e = evaluate_trajectory(straight(1.0), straight(1.1));
  EXPECT_EQ(e.rpe_time.errors.size(), 11U);
  EXPECT_EQ(e.rpe_time.dropped, 10);
  EXPECT_NEAR(e.rpe_time.translation_m.rmse, 0.1, 1e-9);
  EXPECT_NEAR(e.rpe_time.translation_m.stddev, 0.0, 1e-9);
  EXPECT_NEAR(e.rpe_time.rotation_deg.max, 0.0, 1e-9);
  EXPECT_NEAR(e.rpe_time.errors[3].from_timestamp, 0.3, 1e-12);
  EXPECT_NEAR(e.rpe_time.errors[3].to_timestamp, 1.3, 1e-12);
  EXPECT_EQ(e.rpe_frame.errors.size(), 20U);
  EXPECT_NEAR(e.rpe_frame.translation_m.rmse, 0.01, 1e-9);
  // Aligned at the middle, each error is 0.1 |t - 1|; the mean square of 0.1 k, k = -10 … 10, is 7.7 / 21.
  EXPECT_NEAR(e.ate.translation_m.rmse, 0.1 * std::sqrt(7.7 / 21.0), 1e-9);
  EXPECT_NEAR(e.ate.translation_m.max, 0.1, 1e-9);
}

TEST(TrajectoryMetrics, AConstantTurnIsWhatItIs) {
  const auto e = evaluate_trajectory(straight(0.0), straight(0.0, 3.0));
  EXPECT_NEAR(e.rpe_time.rotation_deg.rmse, 3.0, 1e-9);
  EXPECT_NEAR(e.rpe_time.translation_m.max, 0.0, 1e-12);
  EXPECT_NEAR(e.rpe_frame.rotation_deg.median, 0.3, 1e-9);
}

TEST(TrajectoryMetrics, LostFramesAreNotBridged) {
  Trajectory estimate = straight(1.1);
  estimate.erase(estimate.begin() + 5, estimate.begin() + 8);  // 0.5, 0.6 and 0.7 s are lost
  EvaluationOptions options;
  options.expected_frames = 21;
  const auto e = evaluate_trajectory(straight(1.0), estimate, options);
  EXPECT_NEAR(*e.coverage, 18.0 / 21.0, 1e-12);
  EXPECT_EQ(e.rpe_frame.errors.size(), 16U);
  EXPECT_EQ(e.rpe_frame.dropped, 1);
  EXPECT_NEAR(e.rpe_frame.translation_m.max, 0.01, 1e-9);
  EXPECT_EQ(e.rpe_time.errors.size(), 8U);  // of the 11 starts 0 … 1.0 s, three are gone
}

TEST(TrajectoryMetrics, NothingInCommonGivesNoFigures) {
  Trajectory late = straight(1.0);
  for (StampedPose& pose : late) pose.timestamp += 100.0;
  const auto e = evaluate_trajectory(straight(1.0), late);
  EXPECT_TRUE(e.matched.empty());
  EXPECT_EQ(e.ate.translation_m.count, 0);
  const nlohmann::json json = e;
  EXPECT_TRUE(json["ate"]["translation_m"]["rmse"].is_null());
  EXPECT_EQ(evaluate_trajectory({}, {}).matched.size(), 0U);
  EXPECT_EQ(evaluate_trajectory(straight(1.0), {late[0]}).rpe_frame.translation_m.count, 0);
}

TEST(TrajectoryMetrics, TextTellsDeltasUnitsAndPairs) {
  const std::string text = to_text(evaluate_trajectory(straight(1.0), straight(1.1)));
  EXPECT_THAT(text, testing::ContainsRegex("RPE 1 s translation +m +11 +0.10000"));
  EXPECT_THAT(text, testing::ContainsRegex("RPE 1 frame rotation +deg +20 +0.00000"));
  EXPECT_THAT(text, testing::HasSubstr("Coverage  not known"));
}

TEST(TrajectoryMetrics, AgreesWithTheGoldenFigures) {
  const std::string data = places::source() + "/../shared/data/trajectories/fr3_walking_xyz_";
  if (!std::filesystem::exists(data + "groundtruth.txt"))
    GTEST_SKIP() << "the real trajectories are not here";
  const Trajectory truth = read_tum_trajectory(data + "groundtruth.txt");
  struct Golden {
    const char* name;
    double ate, second_m, second_deg, frame_m, frame_deg;
  };
  for (const Golden& g : {Golden{"a", 0.01588, 0.0201, 0.6202, 0.0119, 0.395},
                          Golden{"b", 0.03252, 0.03211, 0.6936, 0.01274, 0.3977}}) {
    const auto e = evaluate_trajectory(truth, read_tum_trajectory(data + "estimate_" + g.name + ".txt"));
    EXPECT_EQ(e.matched.size(), 826U);
    EXPECT_EQ(e.rpe_time.errors.size(), 799U);
    EXPECT_EQ(e.rpe_frame.errors.size(), 825U);
    EXPECT_NEAR(e.ate.translation_m.rmse, g.ate, 0.002 * g.ate);
    EXPECT_NEAR(e.rpe_time.translation_m.rmse, g.second_m, 0.002 * g.second_m);
    EXPECT_NEAR(e.rpe_time.rotation_deg.rmse, g.second_deg, 0.002 * g.second_deg);
    EXPECT_NEAR(e.rpe_frame.translation_m.rmse, g.frame_m, 0.002 * g.frame_m);
    EXPECT_NEAR(e.rpe_frame.rotation_deg.rmse, g.frame_deg, 0.002 * g.frame_deg);
  }
}

}  // namespace
}  // namespace stillpoint
