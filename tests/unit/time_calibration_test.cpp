#include "core/check/time_calibration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/check/check_sequence.hpp"
#include "core/error.hpp"
#include "core/sequence/with_camera.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

constexpr int kCalibrated = 75;  // frames

/// Frames that were filmed under `times`, by a camera of which no times are known.
WithCamera of_unknown_times(const FrameSource& filmed) {
  Camera unknown = filmed.camera();
  unknown.readout_s = unknown.depth_delay_s = 0.0;
  unknown.depth_readout_s.reset();
  return {filmed, unknown};
}

/// What such frames tell.
TimeCalibration calibrated(const std::string& times) {
  const auto filmed = rendered("room_shaken:exposure_s=0.004" + times, kCalibrated);
  return calibrate_time(of_unknown_times(*filmed), Config(), {.frames = kCalibrated, .tries = 1});
}

void expect_near(const TimeEstimate& estimate, double seconds, double tolerance = 1e-3) {
  ASSERT_TRUE(estimate.told);
  EXPECT_NEAR(estimate.seconds, seconds, tolerance);
  EXPECT_GT(estimate.sigma_s, 0.0);
  EXPECT_LT(estimate.sigma_s, 1.5e-3);
}

TEST(TimeCalibration, FindsReadoutsAndDelay) {
  const TimeCalibration times = calibrated(":readout_s=0.02:depth_delay_s=-0.02");
  expect_near(times.readout, 0.02);
  expect_near(times.depth_readout, 0.02);
  expect_near(times.depth_delay, -0.02);
  Camera unknown;
  EXPECT_THAT(check_times(times, unknown), ::testing::SizeIs(3)) << "and check says so";
  EXPECT_THAT(check_times(times, times.applied_to(unknown)), ::testing::IsEmpty());
  ASSERT_TRUE(times.after_truth) << "poses are of the middle row's time, which is the stamp";
  EXPECT_NEAR(times.after_truth->seconds, 0.0, 2e-3);
}

TEST(TimeCalibration, ACheckOfTheSequenceFindsTheSame) {
  const auto filmed =
      rendered("room_shaken:exposure_s=0.004:readout_s=0.02:depth_delay_s=-0.02", kCalibrated);
  const TimeCalibration times = check_sequence(of_unknown_times(*filmed)).times;
  expect_near(times.readout, 0.02);
  expect_near(times.depth_readout, 0.02);
  expect_near(times.depth_delay, -0.02);
  EXPECT_EQ(times.runs, 2) << "a single one is dragged towards the times that were known";
}

TEST(TimeCalibration, FindsDepthsOwnReadoutAndARowOrderUpsideDown) {
  const TimeCalibration times = calibrated(":readout_s=-0.03:depth_readout_s=0.01:depth_delay_s=0.02");
  expect_near(times.readout, -0.03);
  expect_near(times.depth_readout, 0.01, 2.5e-3);  // the hardest to tell
  expect_near(times.depth_delay, 0.02);
  Camera camera;
  camera = times.applied_to(camera);
  EXPECT_EQ(camera.readout_s, times.readout.seconds);
  EXPECT_EQ(camera.depth_readout_s, times.depth_readout.seconds);
  EXPECT_EQ(camera.depth_delay_s, times.depth_delay.seconds);
}

TEST(TimeCalibration, FindsNothingWhereThereIsNothing) {
  const TimeCalibration times = calibrated("");
  expect_near(times.readout, 0.0);
  expect_near(times.depth_delay, 0.0);
}

/// A camera on a tripod: one frame again and again.
class Still final : public WithCamera {
 public:
  using WithCamera::WithCamera;
  [[nodiscard]] Frame read(int index) const override {
    Frame frame = WithCamera::read(0);
    frame.index = index;
    frame.timestamp = frame.depth_timestamp = timestamp(index);
    return frame;
  }
};

TEST(TimeCalibration, WhatAStretchDoesNotTellStands) {
  const auto room = rendered("room", 40);
  Camera camera = room->camera();
  camera.readout_s = 0.012, camera.depth_delay_s = 0.003;
  const TimeCalibration times =
      calibrate_time(Still(*room, camera), Config(), {.frames = 40, .tries = 2, .runs = 1});
  EXPECT_FALSE(times.told());
  EXPECT_THAT(times.why_not, ::testing::HasSubstr("too little"));
  EXPECT_EQ(times.readout.seconds, 0.012);
  EXPECT_EQ(times.applied_to(camera).readout_s, 0.012);
  EXPECT_EQ(times.applied_to(camera).depth_delay_s, 0.003);
}

TEST(TimeCalibration, TooFewFramesAreSaidToBe) {
  OpenOptions options;
  options.frames = 5;
  const TimeCalibration times = calibrate_time(*open_sequence("generated:room", options), Config());
  EXPECT_FALSE(times.told());
  EXPECT_THAT(times.why_not, ::testing::HasSubstr("5 frames are too few"));
}

TEST(TimeCalibration, TheDelayBesideTruthIsFoundAndAnEvenPathTellsNone) {
  const auto pose_at = [](double t) {
    Pose pose = Pose::Identity();
    pose.linear() =
        so3_exp({0.3 * std::sin(3.3 * t), 0.4 * std::sin(2.9 * t + 1), 0.3 * std::sin(4.1 * t + 2)});
    pose.translation() = Eigen::Vector3d(0.3 * std::cos(2.7 * t), 0.3 * std::sin(2.7 * t), 0.3 * std::sin(t));
    return pose;
  };
  Trajectory truth, late, even;
  for (int i = 0; i < 500; ++i) truth.push_back({i / 100.0, pose_at(i / 100.0)});
  for (int i = 3; i < 120; ++i) {
    late.push_back({i / 30.0, pose_at(i / 30.0 - 0.008)});
    even.push_back({i / 30.0, Pose::Identity()});
  }
  const auto delay = delay_beside_truth(truth, late);
  ASSERT_TRUE(delay);
  EXPECT_NEAR(delay->seconds, -0.008, 3e-4);
  Trajectory still;
  for (int i = 0; i < 500; ++i) still.push_back({i / 100.0, Pose::Identity()});
  EXPECT_FALSE(delay_beside_truth(still, even));
}

TEST(GeneratedTiming, TimesAreToldAndWhatIsNoneIsRefused) {
  OpenOptions options;
  options.frames = 2;
  const auto timed =
      open_sequence("generated:room:readout_s=0.02:depth_readout_s=0.01:depth_delay_s=-0.005", options);
  EXPECT_EQ(timed->camera().readout_s, 0.02);
  EXPECT_EQ(timed->camera().depth_readout_s, 0.01);
  EXPECT_EQ(timed->camera().depth_delay_s, -0.005);
  options.camera = Camera();
  EXPECT_EQ(open_sequence("generated:room:readout_s=0.02", options)->camera().readout_s, 0.0)
      << "a camera that is given says what is held to be so";
  for (const char* bad : {":readout_s", ":readout_s=", ":readout_s=fast", ":readout_s=0.5", ":exposure_s=0",
                          ":rolling=0.02", ":readout_s=nan", ":", ":stereo:readout_s=0.02"})
    EXPECT_THROW((void)open_sequence(std::string("generated:room") + bad), InputError) << bad;
}

TEST(GeneratedTiming, RowsAreFilmedAtTheirOwnTimes) {
  // The row in the middle is the same as a global shutter's; the first one is what a frame of half a readout
  // earlier shows there.
  const auto global = rendered("room_shaken:exposure_s=0.001", 40),
             rolling = rendered("room_shaken:exposure_s=0.001:readout_s=0.066667", 40);
  constexpr int kShot = 30;  // a frame amid a turn
  const cv::Mat seen = rolling->truth(kShot).depth, now = global->truth(kShot).depth,
                before = global->truth(kShot - 1).depth, after = global->truth(kShot + 1).depth;
  const auto differs = [](const cv::Mat& a, const cv::Mat& b, int row) {
    return cv::norm(a.rowRange(row, row + 4), b.rowRange(row, row + 4), cv::NORM_L1) / (4.0 * a.cols);
  };
  EXPECT_LT(differs(seen, now, 238), 0.02);
  EXPECT_GT(differs(seen, now, 2), 4 * differs(seen, before, 2));
  EXPECT_GT(differs(seen, now, 474), 4 * differs(seen, after, 474));
}

}  // namespace
}  // namespace stillpoint
