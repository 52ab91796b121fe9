// Looking back at poses.
#include "core/odometry/smoother.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

#include "core/odometry/odometry.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

const Camera kSmootherCamera = camera_by_name("freiburg3");
constexpr int kFrame = 5, kRoom = 60, kMover = 40;  // points of each, the room's first

double moved_between(const Pose& a, const Pose& b) { return (a.inverse() * b).translation().norm(); }

/// A map of a room and of something in it, as one keyframe saw them; a later frame sees them from elsewhere,
/// and by then what is in the room has gone on by four millimetres.
class LookingBack : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_from_world_.translation() = Eigen::Vector3d(0.05, 0.01, -0.02);
    Keyframe keyframe;
    keyframe.features = std::make_shared<const FeatureSet>();
    keyframe.points.assign(kRoom + kMover, kNone);
    const int id = map_.add_keyframe(keyframe);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(40, 600), y(40, 440), z(1.5, 4);
    std::vector<PoseObservation> observations;
    for (int i = 0; i < kRoom + kMover; ++i) {
      const bool mover = i >= kRoom;
      const Eigen::Vector3d point =
          kSmootherCamera.back_project({x(random), y(random)}, mover ? 1.5 : z(random));
      points_.push_back(map_.add_point(point, id, i));
      const Eigen::Vector3d seen = camera_from_world_ * (point + Eigen::Vector3d(mover ? 0.004 : 0.0, 0, 0));
      const Eigen::Vector2d pixel = kSmootherCamera.project(seen);
      matches_.push_back({points_.back(), static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                          static_cast<float>(seen.z()), 1.0F, 1.0F});
      observations.push_back({point, pixel, seen.z()});
    }
    first_ = {id, refine_pose(kSmootherCamera, observations, Pose::Identity(), {}).camera_from_world};
    smoother_.remember(kFrame, first_, matches_);
  }

  /// The frame's pose as it is after looking back, against the truth; m.
  [[nodiscard]] double error() const {
    return moved_between(smoother_.revised().of(kFrame).value().camera_from_reference, camera_from_world_);
  }

  LocalMap map_;
  Pose camera_from_world_ = Pose::Identity();
  std::vector<int> points_;
  std::vector<FixedLagSmoother::InlierMatch> matches_;
  KeyframeRelativePose first_;
  FixedLagSmoother smoother_;
};

TEST_F(LookingBack, WhatWasFoundToMoveHasNoPartInThePose) {
  ASSERT_GT(moved_between(first_.camera_from_reference, camera_from_world_), 0.0015)
      << "the dynamic object drew it along";
  for (int i = kRoom; i < kRoom + kMover; ++i) map_.remove_moving_point(points_[static_cast<std::size_t>(i)]);
  smoother_.advance(kFrame, map_, kSmootherCamera, {});
  EXPECT_LT(error(), 1e-5);
  EXPECT_EQ(smoother_.revised().of(kFrame).value().reference_keyframe, first_.reference_keyframe);
}

TEST_F(LookingBack, PosesFollowThePointsTheyWereSolvedBy) {
  for (int i = kRoom; i < kRoom + kMover; ++i) map_.remove_moving_point(points_[static_cast<std::size_t>(i)]);
  for (int i = 0; i < kRoom; ++i) map_.point(points_[static_cast<std::size_t>(i)]).position.y() += 0.01;
  smoother_.advance(kFrame, map_, kSmootherCamera, {});
  EXPECT_NEAR(error(), 0.01, 1e-4);
}

TEST_F(LookingBack, IsDoneOnceAndNotBeforeItsTime) {
  smoother_.advance(kFrame - 1, map_, kSmootherCamera, {});
  EXPECT_TRUE(smoother_.revised().empty());
  EXPECT_EQ(smoother_.pending(), 1U);
  smoother_.advance(kFrame, map_, kSmootherCamera, {});
  const Pose once = smoother_.revised().of(kFrame).value().camera_from_reference;
  EXPECT_EQ(smoother_.pending(), 0U);
  for (int i = kRoom; i < kRoom + kMover; ++i) map_.remove_moving_point(points_[static_cast<std::size_t>(i)]);
  smoother_.advance(kFrame + 100, map_, kSmootherCamera, {});
  EXPECT_EQ(smoother_.revised().of(kFrame).value().camera_from_reference.matrix(), once.matrix());
}

TEST_F(LookingBack, WithTooFewPointsLeftThePoseStaysAsItWas) {
  const int third = (kRoom + kMover) / 3;
  for (int i = third - 1; i < kRoom + kMover; ++i) map_.remove_point(points_[static_cast<std::size_t>(i)]);
  smoother_.advance(kFrame, map_, kSmootherCamera, {});
  EXPECT_TRUE(smoother_.revised().empty()) << "a few are no match for what it was solved by";
}

TEST_F(LookingBack, ACopyLooksBackByItself) {
  FixedLagSmoother copy = smoother_;
  copy.advance(kFrame, map_, kSmootherCamera, {});
  EXPECT_EQ(copy.revised().size(), 1U);
  EXPECT_TRUE(smoother_.revised().empty());
  EXPECT_EQ(smoother_.pending(), 1U);
}

std::string hash_of(const RunResult& run) {
  RunHash hash;
  for (const FrameRecord& record : run.records) hash.add(record);
  return hash.hex();
}

class LookingBackInARun : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr int kFrames = 16;
  [[nodiscard]] RunResult run(int smoother_lag_frames) const {
    Config config;
    config.run.method = GetParam();
    config.tracking.smoother_lag_frames = smoother_lag_frames;
    RunOptions options;
    options.count = kFrames;
    return run_sequence(*source_, config, options);
  }
  std::shared_ptr<const FrameSource> source_ = rendered("walking_static", 0);
};

TEST_P(LookingBackInARun, ChangesNoFrameOnlyTheTrajectory) {
  const RunResult never = run(0), soon = run(4), late = run(100);
  ASSERT_EQ(never.trajectory.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(hash_of(never), hash_of(soon));
  EXPECT_EQ(hash_of(never), hash_of(late));
  int revised = 0, revised_at_the_end = 0;
  for (std::size_t i = 0; i < never.trajectory.size(); ++i) {
    const Pose& before = never.trajectory[i].world_from_camera;
    const Pose &after = soon.trajectory[i].world_from_camera, &at_end = late.trajectory[i].world_from_camera;
    revised += before.matrix() != after.matrix();
    revised_at_the_end += before.matrix() != at_end.matrix();
    EXPECT_LT(moved_between(before, after), 0.05) << i;
    if (never.records[i].keyframe) {
      EXPECT_EQ(before.matrix(), after.matrix()) << "a keyframe's pose is bundle adjustment's";
    }
  }
  const bool keeps_to_the_paper = std::string_view(GetParam()) == "none";
  EXPECT_EQ(revised > 5, !keeps_to_the_paper) << revised;
  EXPECT_EQ(revised_at_the_end > 5, !keeps_to_the_paper) << revised_at_the_end;
}

INSTANTIATE_TEST_SUITE_P(Methods, LookingBackInARun, ::testing::Values("stillpoint", "oracle", "none"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(LookingBackContinued, WithAnotherConfigThatDoesNotItLeavesPosesAsTheyAre) {
  const auto source = rendered("room", 0);
  Config config;
  config.run.method = "oracle";
  Odometry odometry(source->camera(), config);
  for (int i = 0; i < 6; ++i) (void)odometry.process(source->read(i));
  Config never = config;
  never.tracking.smoother_lag_frames = 0;
  auto other = odometry.continued_with(never, {});
  ASSERT_TRUE(other.has_value());
  other->finish();
  odometry.finish();
  EXPECT_TRUE(other->revised_poses().empty());
  EXPECT_FALSE(odometry.revised_poses().empty());
}

}  // namespace
}  // namespace stillpoint
