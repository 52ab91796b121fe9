// Another program's run laid onto a sequence's frames: the same poses give the same errors as our own run.
#include "core/run/outside_run.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/trajectory.hpp"
#include "core/inspect/replayable_run.hpp"
#include "core/run/condition.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_report.hpp"
#include "core/run/worst_frames.hpp"
#include "core/sequence/source.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;

constexpr int kFrames = 40;

class OutsideRun : public testing::Test {
 protected:
  OutsideRun() : source_(open_sequence(small_.path())) {}

  /// The truth's poses with an error that grows from frame 20 on, as a TUM file.
  [[nodiscard]] std::string drifting(double step_m, double origin_s = 0.0, int every = 1) const {
    std::string text;
    for (int i = 0; i < kFrames; i += every)
      text += fmt::format("{:.4f} {:.6f} {:.6f} 0 0 0 0 1\n", SmallSequence::stamp(i) + origin_s,
                          SmallSequence::kStep * i * SmallSequence::kDepth / SmallSequence::kFocal,
                          i < 20 ? 0.0 : step_m * (i - 19));
    return text;
  }
  [[nodiscard]] RecordedRun read(const std::string& argument) {
    warnings_.clear();
    return read_outside_run(*source_, {}, outside_run_argument(argument), warnings_);
  }
  [[nodiscard]] std::string write(const std::string& file, const std::string& text) const {
    folder_.write(file, text);
    return folder_.path(file);
  }
  SmallSequence small_{kFrames};
  std::unique_ptr<FrameSource> source_;
  TemporaryFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(OutsideRun, ArgumentsNameARunAndItsFile) {
  EXPECT_EQ(outside_run_argument("orb3=a/b.txt").name, "orb3");
  EXPECT_EQ(outside_run_argument("orb3=a/b.txt").where, "a/b.txt");
  EXPECT_EQ(outside_run_argument("runs/droid/").name, "droid");
  EXPECT_THAT(input_error_of([] { (void)outside_run_argument("orb3="); }), HasSubstr("write NAME=FILE"));
}

TEST_F(OutsideRun, PosesBeyondTheFramesAreLeftOutAndTold) {
  OpenOptions ten;
  ten.frames = 10;
  source_ = open_sequence(small_.path(), ten);
  const RecordedRun run = read("drift=" + write("drift.txt", drifting(0.03)));
  EXPECT_THAT(warnings_,
              ElementsAre(HasSubstr("30 of its poses lie before the first frame or after the last")));
  const RunReport report = report_on(run.run, *source_);
  EXPECT_EQ(report.tracked, 10);
  EXPECT_DOUBLE_EQ(report.coverage, 1.0);
  ASSERT_TRUE(report.evaluation);
  EXPECT_NEAR(report.evaluation->rpe_frame.translation_m.rmse, 0.0, 1e-6);  // the drift begins at frame 20
}

TEST_F(OutsideRun, IsMeasuredAsItsTrajectoryIs) {
  const RecordedRun run = read("drift=" + write("drift.txt", drifting(0.03)));
  EXPECT_EQ(run.outside, "drift");
  ASSERT_EQ(run.run.records.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(run.run.records[0].status, FrameStatus::initialised);
  EXPECT_EQ(run.run.records[5].status, FrameStatus::tracked);
  const RunReport report = report_on(run.run, *source_);
  ASSERT_TRUE(report.evaluation);
  // 20 of 39 steps are 3 cm off: the RMSE over neighbours is 0.03 sqrt(20 / 39).
  EXPECT_NEAR(report.evaluation->rpe_frame.translation_m.rmse, 0.03 * std::sqrt(20.0 / 39.0), 1e-6);
  EXPECT_EQ(report.tracked, kFrames);
  // Nothing is known of masks and features: no figure over nothing.
  EXPECT_FALSE(report.scores.known);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(OutsideRun, FramesItHasNoPoseForAreLost) {
  const RecordedRun run = read(write("half.txt", drifting(0.0, 0.0, 2)));
  EXPECT_EQ(run.run.records[1].status, FrameStatus::lost);
  EXPECT_EQ(run.run.records[1].note, "the trajectory has no pose for this frame");
  EXPECT_TRUE(run.run.records[2].estimated);
  EXPECT_EQ(run.run.tracked(), kFrames / 2);
}

TEST_F(OutsideRun, OfAnotherClockSaysSo) {
  EXPECT_THAT(input_error_of([&] { (void)read(write("apart.txt", drifting(0.0, 5000.0))); }),
              HasSubstr("none of its 40 poses is closer than 0.02 s to a frame"));
  OutsideRunFiles shifted = outside_run_argument(write("apart.txt", drifting(0.0, 5000.0)));
  shifted.time_offset_s = -5000.0;
  EXPECT_EQ(read_outside_run(*source_, {}, shifted, warnings_).run.tracked(), kFrames);
}

TEST_F(OutsideRun, RowsOfAMatrixCountFrames) {
  std::string kitti;
  for (int i = 0; i < kFrames; ++i) kitti += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", 0.01 * i);
  const RecordedRun run = read(write("kitti.txt", kitti));
  EXPECT_EQ(run.run.tracked(), kFrames);
  EXPECT_DOUBLE_EQ(run.run.records[7].world_from_camera.translation().x(), 0.07);
  EXPECT_THAT(warnings_, Not(IsEmpty()));  // that rows are taken for frames
}

TEST_F(OutsideRun, NumbersCountTheRecordingsFramesHoweverManyAreLookedAt) {
  std::string kitti, numbered;
  for (int i = 0; i < kFrames; ++i) {
    kitti += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", 0.01 * i);
    numbered += fmt::format("{} {} 0 0 0 0 0 1\n", i, 0.01 * i);
  }
  OpenOptions ten;
  ten.frames = 10;
  source_ = open_sequence(small_.path(), ten);
  for (const std::string& text : {kitti, numbered}) {
    const RecordedRun run = read(write("numbered.txt", text));
    EXPECT_EQ(run.run.tracked(), 10);
    EXPECT_EQ(run.run.trajectory.size(), 10U);
    EXPECT_DOUBLE_EQ(run.run.records[7].world_from_camera.translation().x(), 0.07);
    EXPECT_THAT(warnings_,
                testing::Contains(HasSubstr("30 of its poses lie before the first frame or after")));
  }
}

TEST_F(OutsideRun, PartsFromAnotherWhereItsMotionDoes) {
  const RecordedRun good = read(write("good.txt", drifting(0.0))),
                    bad = read(write("bad.txt", drifting(0.03)));
  EXPECT_FALSE(part_ways(good.run.records, bad.run.records, 19));
  EXPECT_TRUE(part_ways(good.run.records, bad.run.records, 20));
  const RecordedRun half = read(write("half.txt", drifting(0.0, 0.0, 2)));
  EXPECT_FALSE(part_ways(good.run.records, half.run.records, 0));
  EXPECT_TRUE(part_ways(good.run.records, half.run.records, 1));
}

TEST_F(OutsideRun, AFolderBringsFeaturesAndMasks) {
  folder_.write("run/CameraTrajectory.txt", drifting(0.0));
  folder_.write(
      "run/features.csv",
      fmt::format("stamp,x,y,state,id,point\n{0:.4f},10,20,inlier,4,77\n{0:.4f},11.5,21,removed,5,-1\n"
                  "{0:.4f},12,22,perhaps,6,-1\n{1:.4f},1,2,outlier,4,-1\n9.0,1,2,inlier,1,1\n",
                  SmallSequence::stamp(3), SmallSequence::stamp(4)));
  cv::Mat mask(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(0));
  mask.rowRange(0, 60).setTo(255);
  folder_.write("run/masks/3.png", mask);
  folder_.write("run/masks/0.png", mask);
  const RecordedRun run = read("theirs=" + folder_.path("run"));
  const FrameRecord record = run.record(3);
  ASSERT_EQ(record.features.size(), 2U);
  EXPECT_EQ(record.features[0].fate, FeatureFate::inlier);
  EXPECT_EQ(record.features[0].map_point, 77);
  EXPECT_EQ(record.features[1].pixel, cv::Point2f(11.5F, 21.0F));
  EXPECT_EQ(record.features_removed, 1);
  EXPECT_EQ(record.inliers, 1);
  EXPECT_EQ(run.run.records[4].matches, 1);
  EXPECT_DOUBLE_EQ(record.mask_share, 0.25);
  EXPECT_EQ(cv::countNonZero(run.mask(3) != mask), 0);
  EXPECT_THAT(run.run.records[5].mask_problem, HasSubstr("has no mask for this frame"));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("features.csv:4: is no feature"),
                                     HasSubstr("1 rows belong to no frame of the sequence")));
}

TEST_F(OutsideRun, FeaturesWithoutAPixelOrAnIdAreNone) {
  folder_.write("run/CameraTrajectory.txt", drifting(0.0));
  folder_.write("run/features.csv", fmt::format("stamp,x,y,state,id,point\n{0:.4f},10,20,inlier,4,1e300\n"
                                                "{0:.4f},10,20,inlier,nan,nan\n{0:.4f},1e300,20,inlier,4,1\n",
                                                SmallSequence::stamp(3)));
  const RecordedRun run = read("theirs=" + folder_.path("run"));
  const std::vector<FeatureRecord> features = run.record(3).features;
  ASSERT_EQ(features.size(), 2U);
  EXPECT_EQ(features[0].map_point, kNone);
  EXPECT_EQ(features[1].map_point, kNone);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("features.csv:4: is no feature")));
}

TEST_F(OutsideRun, WhatIsNoRunIsRefused) {
  EXPECT_THAT(input_error_of([&] { (void)read(folder_.path("none")); }), HasSubstr("there is no such file"));
  folder_.write("empty/readme.txt", std::string("nothing"));
  EXPECT_THAT(input_error_of([&] { (void)read(folder_.path("empty")); }), HasSubstr("holds no trajectory"));
  folder_.write("odd/trajectory.txt", drifting(0.0));
  folder_.write("odd/features.csv", std::string("u,v\n1,2\n"));
  EXPECT_THAT(input_error_of([&] { (void)read(folder_.path("odd")); }),
              HasSubstr("features.csv:1: names no column x"));
}

TEST_F(OutsideRun, WrittenAndReadAgainItIsTheSame) {
  const RecordedRun run = read("theirs=" + write("drift.txt", drifting(0.03)));
  const std::string out = folder_.path("out");
  prepare_run_folder(out, false);
  RecordedRun with_origin = run;
  with_origin.origin = origin_of(*source_, small_.path(), {});
  write_outside_run(out, with_origin, *source_);
  const RecordedRun again = read_records(out);
  EXPECT_EQ(again.outside, "theirs");
  EXPECT_EQ(run_name(again), "theirs");
  EXPECT_EQ(again.hash, run.hash);
  ASSERT_EQ(again.run.trajectory.size(), run.run.trajectory.size());
  EXPECT_EQ(again.run.trajectory[30].timestamp, run.run.trajectory[30].timestamp);
}

TEST_F(OutsideRun, IsShownWithoutAnyOdometry) {
  const auto run = std::make_shared<const RecordedRun>(read("theirs=" + write("drift.txt", drifting(0.03))));
  const ReplayableRun track(*source_, run);
  EXPECT_EQ(track.seen(), kFrames);
  EXPECT_FALSE(track.can_repeat_motion(10));
  const RunView view = track.view();
  EXPECT_EQ(view.name, "theirs");
  EXPECT_EQ(view.trajectory.size(), static_cast<std::size_t>(kFrames));
  EXPECT_GT(view.evaluation.rpe_frame.translation_m.rmse, 0.01);
}

/// A figure of each frame, by its name.
std::vector<double> figure_of_run(const RecordedRun& run, const char* name) {
  return frame_figure_values({run.run.records, nullptr, &run.run.scores}, frame_figure(name));
}

/// What a trajectory alone tells nothing of.
constexpr std::array kNotInATrajectory = {"mask",
                                          "rounds",
                                          "features",
                                          "removed",
                                          "kept",
                                          "matches",
                                          "inliers",
                                          "outliers",
                                          "residual",
                                          "position_sigma",
                                          "keyframe",
                                          "bundle",
                                          "wide_search",
                                          "epnp",
                                          "direct",
                                          "direct_share",
                                          "map_points",
                                          "map_keyframes",
                                          "new_points",
                                          "fused_points",
                                          "culled_points",
                                          "ms.total",
                                          "direct_patches",
                                          "culled_keyframes",
                                          "refine_iterations",
                                          "bundle_rms_px",
                                          "removed_rightly",
                                          "bundle_iterations",
                                          "dynamic_inliers"};

TEST_F(OutsideRun, WhatNobodyMeasuredHasNoValue) {
  const RecordedRun run = read("theirs=" + write("drift.txt", drifting(0.03)));
  RecordedRun with_origin = run;
  with_origin.origin = origin_of(*source_, small_.path(), {});
  const std::string out = folder_.path("out");
  prepare_run_folder(out, false);
  write_outside_run(out, with_origin, *source_);
  // As it was laid onto the frames, and as its folder is opened again.
  for (const RecordedRun& one : {run, read_records(out)})
    for (const char* name : kNotInATrajectory) {
      ASSERT_GE(frame_figure(name), 0) << name;
      EXPECT_THAT(figure_of_run(one, name), Each(IsNan())) << name;
    }
  EXPECT_EQ(figure_of_run(run, "tracked")[5], 1.0);
  EXPECT_EQ(figure_of_run(run, "lost")[5], 0.0);
}

TEST_F(OutsideRun, AConditionOverWhatNobodyMeasuredHoldsNowhere) {
  const RecordedRun run = read("theirs=" + write("drift.txt", drifting(0.03)));
  const FrameFigures figures({run.run.records});
  for (const char* text : {"mask < 5 %", "!(mask > 5 %)", "inliers < 30", "!keyframe", "map_points == 0",
                           "ms.total < 1 ms", "!spike(inliers, 3)", "tracked && inliers < 30"})
    EXPECT_THAT(Condition(text).frames(figures), IsEmpty()) << text;
  EXPECT_THAT(Condition("mask < 5 % || mask > 50 %").unknown_figures(figures), ElementsAre("mask"));
  EXPECT_THAT(Condition("frame == 7 || mask < 5 %").frames(figures), ElementsAre(7));
}

TEST_F(OutsideRun, ItsReportTellsNoKeyframesMapPointsOrTimes) {
  const RecordedRun run = read("theirs=" + write("drift.txt", drifting(0.03)));
  const RunReport report = report_on(run.run, *source_);
  const std::string text = to_text(report);
  for (const char* word : {"keyframes", "map points", "time a frame", "mask"})
    EXPECT_THAT(text, Not(HasSubstr(word))) << word;
  EXPECT_THAT(text, HasSubstr("run hash"));
  const auto summary = to_summary(report, run.run, *source_);
  for (const char* key : {"keyframes", "map_points", "speed", "masks"})
    EXPECT_TRUE(summary[key].is_null()) << key;
}

TEST_F(OutsideRun, WhatItLeftOfSingleFramesHasAValueThere) {
  folder_.write("run/CameraTrajectory.txt", drifting(0.0));
  folder_.write("run/features.csv", fmt::format("stamp,x,y,state,id,point\n{0:.4f},10,20,inlier,4,77\n"
                                                "{0:.4f},11.5,21,removed,5,-1\n",
                                                SmallSequence::stamp(3)));
  // A mask that takes nothing out is told too, and is not the same as none.
  const cv::Mat empty(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(0));
  folder_.write("run/masks/0.png", empty);
  folder_.write("run/masks/3.png", empty);
  RecordedRun run = read("theirs=" + folder_.path("run"));
  run.origin = origin_of(*source_, small_.path(), {});
  const std::string out = folder_.path("out");
  prepare_run_folder(out, false);
  write_outside_run(out, run, *source_);
  for (const RecordedRun& one : {run, read_records(out)}) {
    std::vector<double> inliers(kFrames, std::nan("")), mask = inliers;
    inliers[3] = 1.0, mask[0] = mask[3] = 0.0;
    EXPECT_THAT(figure_of_run(one, "inliers"), testing::Pointwise(testing::NanSensitiveDoubleEq(), inliers));
    EXPECT_THAT(figure_of_run(one, "mask"), testing::Pointwise(testing::NanSensitiveDoubleEq(), mask));
    // The program told which feature it used, not how far that was off.
    EXPECT_THAT(figure_of_run(one, "residual"), Each(IsNan()));
    EXPECT_TRUE(std::isnan(one.record(3).features.at(0).residual_px));
  }
}

}  // namespace
}  // namespace stillpoint
