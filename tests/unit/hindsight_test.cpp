// Looking back at poses.
#include "core/odometry/hindsight.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

const Camera kCamera = camera_by_name("freiburg3");
constexpr int kFrame = 5, kRoom = 60, kMover = 40;  // points of each, the room's first

double distance(const Pose& a, const Pose& b) { return (a.inverse() * b).translation().norm(); }

/// A map of a room and of something in it, as one keyframe saw them; a later frame sees them from elsewhere,
/// and by then what is in the room has gone on by two centimetres.
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
      const Eigen::Vector3d point = kCamera.back_project({x(random), y(random)}, mover ? 1.5 : z(random));
      points_.push_back(map_.add_point(point, id, i));
      const Eigen::Vector3d seen = camera_from_world_ * (point + Eigen::Vector3d(mover ? 0.004 : 0.0, 0, 0));
      const Eigen::Vector2d pixel = kCamera.project(seen);
      sights_.push_back({points_.back(), static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                         static_cast<float>(seen.z()), 1.0F, 1.0F});
      observations.push_back({point, pixel, seen.z()});
    }
    first_ = {id, refine_pose(kCamera, observations, Pose::Identity(), {}).camera_from_world};
    hindsight_.remember(kFrame, first_, sights_);
  }

  /// The frame's pose as it is after looking back, against the truth; m.
  [[nodiscard]] double error() const {
    return distance(hindsight_.revised().at(kFrame).camera_from_reference, camera_from_world_);
  }

  LocalMap map_;
  Pose camera_from_world_ = Pose::Identity();
  std::vector<int> points_;
  std::vector<Hindsight::Sight> sights_;
  HangingPose first_;
  Hindsight hindsight_;
};

TEST_F(LookingBack, WhatWasFoundToMoveHasNoPartInThePose) {
  ASSERT_GT(distance(first_.camera_from_reference, camera_from_world_), 0.0015) << "the mover drew it along";
  for (int i = kRoom; i < kRoom + kMover; ++i) map_.remove_moving_point(points_[static_cast<std::size_t>(i)]);
  hindsight_.look_back(kFrame, map_, kCamera, {});
  EXPECT_LT(error(), 1e-5);
  EXPECT_EQ(hindsight_.revised().at(kFrame).reference_keyframe, first_.reference_keyframe);
}

TEST_F(LookingBack, PosesFollowThePointsTheyWereSolvedBy) {
  for (int i = kRoom; i < kRoom + kMover; ++i) map_.remove_moving_point(points_[static_cast<std::size_t>(i)]);
  for (int i = 0; i < kRoom; ++i) map_.point(points_[static_cast<std::size_t>(i)]).position.y() += 0.01;
  hindsight_.look_back(kFrame, map_, kCamera, {});
  EXPECT_NEAR(error(), 0.01, 1e-4);
}

TEST_F(LookingBack, IsDoneOnceAndNotBeforeItsTime) {
  hindsight_.look_back(kFrame - 1, map_, kCamera, {});
  EXPECT_TRUE(hindsight_.revised().empty());
  EXPECT_EQ(hindsight_.points().size(), 1U);
  hindsight_.look_back(kFrame, map_, kCamera, {});
  const Pose once = hindsight_.revised().at(kFrame).camera_from_reference;
  EXPECT_TRUE(hindsight_.points().empty());
  for (int i = kRoom; i < kRoom + kMover; ++i) map_.remove_moving_point(points_[static_cast<std::size_t>(i)]);
  hindsight_.look_back(kFrame + 100, map_, kCamera, {});
  EXPECT_EQ(hindsight_.revised().at(kFrame).camera_from_reference.matrix(), once.matrix());
}

TEST_F(LookingBack, WithTooFewPointsLeftThePoseStaysAsItWas) {
  for (int i = TrackingConfig{}.min_inliers - 1; i < kRoom + kMover; ++i)
    map_.remove_point(points_[static_cast<std::size_t>(i)]);
  hindsight_.look_back(kFrame, map_, kCamera, {});
  EXPECT_TRUE(hindsight_.revised().empty());
}

TEST_F(LookingBack, ACopyLooksBackByItself) {
  Hindsight copy = hindsight_;
  copy.look_back(kFrame, map_, kCamera, {});
  EXPECT_EQ(copy.revised().size(), 1U);
  EXPECT_TRUE(hindsight_.revised().empty());
  EXPECT_EQ(hindsight_.points().size(), 1U);
}

std::string hash_of(const RunResult& run) {
  RunHash hash;
  for (const FrameRecord& record : run.records) hash.add(record);
  return hash.hex();
}

TEST(LookingBackInARun, ChangesNoFrameOnlyTheTrajectory) {
  const auto source = open_sequence("generated:room");
  RunOptions options;
  options.count = 14;
  const auto run = [&](const char* method, int frames) {
    Config config;
    config.run.method = method;
    config.tracking.look_back_frames = frames;
    return run_sequence(*source, config, options);
  };
  for (const char* method : {"stillpoint", "oracle", "none"}) {
    const RunResult never = run(method, 0), soon = run(method, 4), late = run(method, 100);
    ASSERT_EQ(never.trajectory.size(), 14U) << method;
    EXPECT_EQ(hash_of(never), hash_of(soon)) << method;
    int revised = 0;
    for (std::size_t i = 0; i < never.trajectory.size(); ++i) {
      const Pose &before = never.trajectory[i].world_from_camera,
                 &after = soon.trajectory[i].world_from_camera;
      const bool moved = before.matrix() != after.matrix();
      revised += moved;
      EXPECT_LT(distance(before, after), 0.02) << method << ' ' << i;
      if (never.records[i].keyframe) {
        EXPECT_FALSE(moved) << "bundle adjustment has a keyframe's pose";
      }
    }
    const bool keeps_to_the_paper = std::string_view(method) == "none";
    EXPECT_EQ(revised > 5, !keeps_to_the_paper) << method << ' ' << revised;
    EXPECT_EQ(late.trajectory.size(), 14U) << "what is left is looked back at when the run ends";
    EXPECT_EQ(
        late.trajectory[5].world_from_camera.matrix() != never.trajectory[5].world_from_camera.matrix() ||
            never.records[5].keyframe,
        !keeps_to_the_paper || never.records[5].keyframe)
        << method;
  }
}

}  // namespace
}  // namespace stillpoint
