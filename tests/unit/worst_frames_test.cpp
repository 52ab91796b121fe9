#include "core/run/worst_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

FrameRecord measured_record(int index, bool estimated, int inliers) {
  FrameRecord record;
  record.index = index;
  record.timestamp = index;
  record.estimated = estimated;
  record.status = estimated ? FrameStatus::tracked : FrameStatus::lost;
  record.note = estimated ? "" : "too few inliers";
  record.inliers = inliers;
  return record;
}

TEST(WorstFrames, LostStretchesComeFirstThenLargestErrorsApart) {
  std::vector<FrameRecord> records;
  for (int i = 0; i < 40; ++i) records.push_back(measured_record(i, i != 20 && i != 21, 100 + i));
  TrajectoryEvaluation evaluation;
  for (int i = 1; i < 40; ++i) {
    const double error = i == 5 ? 0.03 : i == 6 ? 0.04 : i == 30 ? 0.01 : i == 35 ? 0.02 : 0.001;
    if (i != 20 && i != 21)
      evaluation.rpe_frame.errors.push_back({i - 1.0, static_cast<double>(i), error, 0.0});
  }
  const MeasuredFrames frames{records, &evaluation};
  const auto worst = worst_frames(frames, usual_figure(frames), 5, 3);
  ASSERT_EQ(worst.size(), 3U);
  EXPECT_EQ(worst[0].index, 20);
  EXPECT_THAT(worst[0].why, HasSubstr("too few inliers"));
  EXPECT_EQ(worst[1].index, 6);  // 5 is too near to it
  EXPECT_EQ(worst[1].why, "step error 40.00 mm");
  EXPECT_EQ(worst[2].index, 35);
  EXPECT_TRUE(worst_frames(frames, usual_figure(frames), 5, 0).empty());
}

TEST(WorstFrames, WithoutTruthGoByInliers) {
  std::vector<FrameRecord> records;
  for (int i = 0; i < 10; ++i) records.push_back(measured_record(i, true, i == 7 ? 21 : 100));
  const MeasuredFrames frames{records};
  const auto worst = worst_frames(frames, usual_figure(frames), 1, 1);
  ASSERT_EQ(worst.size(), 1U);
  EXPECT_EQ(worst[0].index, 7);
  EXPECT_EQ(worst[0].why, "inliers 21");
}

}  // namespace
}  // namespace stillpoint
