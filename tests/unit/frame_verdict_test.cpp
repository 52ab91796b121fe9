#include "core/inspect/frame_verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Ten tracked frames, each step off by 2 mm but for that of frame 5, by 40 mm; 60 inliers a frame.
RunView run_with_a_bad_step() {
  RunView run;
  for (int i = 0; i < 10; ++i) {
    FrameRecord record;
    record.index = 100 + i;
    record.timestamp = i / 30.0;
    record.status = i == 0 ? FrameStatus::initialised : FrameStatus::tracked;
    record.estimated = true;
    record.inliers = 60;
    record.mask_share = 0.033;
    run.records.push_back(record);
    if (i > 0)
      run.evaluation.rpe_frame.errors.push_back({(i - 1) / 30.0, i / 30.0, i == 5 ? 0.040 : 0.002, 0.0});
  }
  return run;
}

std::vector<std::string> texts(const FrameVerdict& verdict) {
  std::vector<std::string> all;
  for (const FrameVerdict::Part& part : verdict.parts) all.push_back(part.text);
  return all;
}

TEST(FrameVerdict, NamesInliersOnDynamicObjects) {
  RunView run = run_with_a_bad_step();
  run.scores.resize(10);
  run.scores.edit(5).known = true;
  run.scores.edit(5).dynamic_inliers = 31;
  run.scores.edit(5).mask = {.found_rightly = 12, .found_wrongly = 12, .missed = 88, .left_rightly = 1000};
  const FrameVerdict verdict = frame_verdict(run, 5);
  EXPECT_TRUE(verdict.bad);
  EXPECT_EQ(verdict.sentence,
            "40.00 mm where 2.00 mm is usual: 31 of 60 inliers lie on dynamic objects; the mask holds 12 % "
            "of these.");
  EXPECT_THAT(texts(verdict), testing::ElementsAre("Step error 40.00 mm, worst of 9", "mask 3.3 %, IoU 11 %",
                                                   "31 of 60 inliers on dynamic objects"));
  ASSERT_EQ(verdict.parts.size(), 3U);
  for (const FrameVerdict::Part& part : verdict.parts) EXPECT_EQ(part.tone, Tone::bad) << part.text;
}

TEST(FrameVerdict, OfAMethodThatJudgesFeaturesTellsOfThese) {
  RunView run = run_with_a_bad_step();
  run.records.change(5, [](FrameRecord& record) {
    record.mask_share = 0.0, record.features_removed = 73, record.features_found = 1000;
  });
  EXPECT_THAT(texts(frame_verdict(run, 5)), testing::Contains("73 of 1000 features removed"));
  run.records.change(5, [](FrameRecord& record) { record.features_removed = 0; });
  EXPECT_THAT(texts(frame_verdict(run, 5)), testing::Contains("mask 0.0 %"));
}

TEST(FrameVerdict, WithoutMasksNamesWhatElseWasRecorded) {
  RunView run = run_with_a_bad_step();
  EXPECT_THAT(frame_verdict(run, 5).sentence, HasSubstr("nothing recorded explains it"));
  run.records.change(5, [](FrameRecord& record) { record.inliers = 22; });
  EXPECT_THAT(frame_verdict(run, 5).sentence, HasSubstr("the pose rests on 22 inliers, usually 60"));
  run.records.change(5, [](FrameRecord& record) { record.note = "little was left without what is dynamic"; });
  EXPECT_THAT(frame_verdict(run, 5).sentence, HasSubstr("little was left"));
  EXPECT_THAT(frame_verdict(run, 5, {105}).sentence, HasSubstr("solved without removal, the step is better"));
  EXPECT_THAT(texts(frame_verdict(run, 5, {105})), testing::Contains("removal hurt"));
  EXPECT_THAT(texts(frame_verdict(run, 5, {104})), Not(testing::Contains("removal hurt")));
}

TEST(FrameVerdict, ALargeStepMayBeTheWayBack) {
  RunView run = run_with_a_bad_step();
  const std::vector<double> off = {0.003, 0.002, 0.003, 0.020, 0.045, 0.004, 0.003, 0.003, 0.003, 0.003};
  for (int i = 0; i < 10; ++i) run.evaluation.ate.errors.push_back({i / 30.0, off[i]});
  EXPECT_EQ(
      frame_verdict(run, 5).sentence,
      "40.00 mm where 2.00 mm is usual: the estimate comes back, gone off since frame 101 by 45.00 mm.");
  // One that leaves the truth does not come back, nor does one that stays as far off on its other side.
  run.evaluation.ate.errors[4].translation_m = 0.003;
  run.evaluation.ate.errors[5].translation_m = 0.045;
  EXPECT_THAT(frame_verdict(run, 5).sentence, Not(HasSubstr("comes back")));
  run.evaluation.ate.errors[4].translation_m = 0.050;
  EXPECT_THAT(frame_verdict(run, 5).sentence, Not(HasSubstr("comes back")));
}

TEST(FrameVerdict, AUsualFrameIsNotBlamed) {
  const RunView run = run_with_a_bad_step();
  const FrameVerdict verdict = frame_verdict(run, 3);
  EXPECT_FALSE(verdict.bad);
  EXPECT_EQ(verdict.sentence, "As usual in this run (median 2.00 mm).");
  EXPECT_THAT(texts(verdict),
              testing::ElementsAre("Step error 2.00 mm, 2nd worst of 9", "mask 3.3 %", "60 inliers"));
  EXPECT_EQ(frame_verdict(run, 0).sentence, "The map begins here.");
}

TEST(FrameVerdict, AmongAFewFramesNothingIsUsual) {
  RunView run = run_with_a_bad_step();
  run.records.resize(3);
  run.evaluation.rpe_frame.errors.resize(2);
  const FrameVerdict verdict = frame_verdict(run, 2);
  EXPECT_THAT(texts(verdict), testing::Contains("Step error 2.00 mm"));
  EXPECT_EQ(verdict.sentence, "");
}

TEST(FrameVerdict, AFrameWithoutAPoseSaysWhy) {
  RunView run = run_with_a_bad_step();
  run.records.change(4, [](FrameRecord& record) {
    record.status = FrameStatus::lost;
    record.note = "too few inliers";
  });
  const FrameVerdict verdict = frame_verdict(run, 4);
  EXPECT_TRUE(verdict.bad);
  EXPECT_EQ(verdict.sentence, "No pose: too few inliers.");
  EXPECT_THAT(texts(verdict), testing::ElementsAre("lost"));
}

TEST(FrameVerdict, WithoutGroundTruthGoesByInliers) {
  RunView run = run_with_a_bad_step();
  run.evaluation = {};
  run.records.change(7, [](FrameRecord& record) { record.inliers = 12; });
  const FrameVerdict verdict = frame_verdict(run, 7);
  EXPECT_TRUE(verdict.bad);
  EXPECT_THAT(texts(verdict), testing::Contains("Inliers 12, worst of 10"));
  EXPECT_FALSE(frame_verdict(run, 6).bad);
}

TEST(FrameVerdict, TellsOfNoMaskWhereNobodyLeftOne) {
  RunView run = run_with_a_bad_step();
  for (std::size_t i = 0; i < run.records.size(); ++i)
    run.records.change(i, [](FrameRecord& record) {
      record.measured = poses_alone();
      record.inliers = 0;
      record.mask_share = 0.0;
    });
  EXPECT_THAT(texts(frame_verdict(run, 5)), testing::ElementsAre("Step error 40.00 mm, worst of 9"));
  EXPECT_EQ(frame_verdict(run, 0).sentence, "The run begins here.");
}

}  // namespace
}  // namespace stillpoint
