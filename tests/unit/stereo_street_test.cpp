// A stereo pair on a car: metres a frame, and nothing nearer than some metres.
#include <gtest/gtest.h>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/street_scene.hpp"

namespace stillpoint {
namespace {

TEST(StereoStreet, ADriveIsTrackedWhole) {
  constexpr int kFrames = 12;
  const auto street = testing::make_street(kFrames, 0.5);
  for (const char* method : {"none", "stillpoint"}) {
    Config config;
    config.run.method = method;
    config.run.threads = 2;
    const RunResult run = run_sequence(*street, config);
    ASSERT_EQ(run.trajectory.size(), static_cast<std::size_t>(kFrames)) << method;
    const Trajectory& truth = street->ground_truth();
    const Pose true_way = truth.front().world_from_camera.inverse() * truth.back().world_from_camera,
               way = run.trajectory.front().world_from_camera.inverse() *
                     run.trajectory.back().world_from_camera;
    double length = 0.0;
    for (std::size_t i = 1; i < truth.size(); ++i)
      length +=
          (truth[i].world_from_camera.translation() - truth[i - 1].world_from_camera.translation()).norm();
    EXPECT_LT((true_way.translation() - way.translation()).norm(), 0.015 * length) << method;
  }
}

}  // namespace
}  // namespace stillpoint
