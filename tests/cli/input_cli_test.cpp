// Inputs as people bring them, from the command line: figures that are right, or a sentence that says what is
// wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kInputFrames = 8;

class Input : public ::testing::Test {
 protected:
  [[nodiscard]] CliResult run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"run",   sequence.path(),      "--method", "none",
                                          "--out", sequence.path("out"), "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  void write_truth(const std::function<std::string(int)>& row) const {
    std::string text;
    for (int i = 0; i < kInputFrames; ++i) text += row(i) + "\n";
    sequence.folder.write("groundtruth.txt", text);
  }
  [[nodiscard]] nlohmann::json summary() const {
    return nlohmann::json::parse(sequence.folder.read("out/summary.json"));
  }
  SmallSequence sequence{kInputFrames};
};

TEST_F(Input, NumberedFoldersRunAndAreEvaluatedByEveryRoute) {
  std::string rgb, depth;
  for (int i = 0; i < kInputFrames; ++i) {
    rgb += fmt::format("{} {}\n", i, sequence.colour(i));
    depth += fmt::format("{} {}\n", i, sequence.depth(i));
  }
  sequence.folder.write("rgb.txt", rgb);
  sequence.folder.write("depth.txt", depth);
  write_truth([](int i) {
    return fmt::format("{} {:.6f} 0 0 0 0 0 1", i,
                       SmallSequence::kStep * i * SmallSequence::kDepth / SmallSequence::kFocal);
  });
  const CliResult result = run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(summary()["evaluation"]["matched"], kInputFrames);
  const double ate = summary()["evaluation"]["ate"]["translation_m"]["rmse"];
  EXPECT_LT(ate, 0.005);
  std::string numbered;
  for (int i = 0; i < kInputFrames; ++i) numbered += fmt::format("{} {:.6f} 0 0 0 0 0 1\n", i, 0.0115385 * i);
  sequence.folder.write("numbered.txt", numbered);
  for (const std::string truth : {"", "groundtruth.txt"})
    for (const std::string estimate : {"out/trajectory.txt", "numbered.txt"}) {
      const CliResult evaluated =
          run_cli({"evaluate", sequence.path(truth), sequence.path(estimate), "--json"});
      EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
      const auto json = nlohmann::json::parse(evaluated.out);
      EXPECT_EQ(json["matched"], kInputFrames) << truth << " " << estimate;
      if (estimate != "numbered.txt") {
        EXPECT_NEAR(json["ate"]["translation_m"]["rmse"].get<double>(), ate, 1e-6);
      }
    }
  EXPECT_EQ(run_cli({"export", sequence.path(), "--frames", "2:6", "--out", sequence.path("part")}).exit_code,
            0);
  EXPECT_THAT(sequence.folder.read("part/depth.txt"), HasSubstr("0.066667 depth/0.066667.png"));
}

TEST_F(Input, AnEstimateThatCountsFramesMeetsTheFolder) {
  std::string numbered;
  for (int i = 0; i < kInputFrames; ++i) numbered += fmt::format("{} {:.6f} 0 0 0 0 0 1\n", i, 0.0115385 * i);
  sequence.folder.write("numbered.txt", numbered);
  const CliResult result = run_cli({"evaluate", sequence.path(), sequence.path("numbered.txt")});
  EXPECT_THAT(result.out, HasSubstr("Matched   8 of 8"));
  EXPECT_THAT(result.err, HasSubstr("each was given its frame's time"));
  expect_one_sentence(run_cli({"evaluate", sequence.path("groundtruth.txt"), sequence.path("numbered.txt")}),
                      "give the sequence's folder in place of its ground truth");
}

TEST_F(Input, NothingToMeasureIsADashAndNull) {
  const CliResult result = run();
  EXPECT_THAT(result.out, AllOf(HasSubstr("RPE 1 s       – (no two matched poses are 1 s apart)"),
                                HasSubstr("RPE 1 frame   0.0"), Not(HasSubstr("over 0 pairs"))));
  EXPECT_TRUE(summary()["evaluation"]["rpe_time"]["translation_m"]["rmse"].is_null());
  sequence.folder.write("one.txt", fmt::format("{:.4f} 0 0 0 0 0 0 1\n", SmallSequence::stamp(0)));
  const CliResult one = run_cli({"evaluate", sequence.path("groundtruth.txt"), sequence.path("one.txt")});
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_THAT(one.out, Not(HasSubstr("0.00000")));
  EXPECT_THAT(one.err, HasSubstr("there is nothing to measure"));
}

TEST_F(Input, TruthOfNoUseIsNotNoTruth) {
  write_truth([](int i) { return fmt::format("{} 0 0 0 0 0 0 1", 86500.5 + i); });
  const CliResult result = run();
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("ground truth  is there and of no use"), Not(HasSubstr("no ground truth"))));
  EXPECT_THAT(summary()["ground_truth_unusable"].get<std::string>(), HasSubstr("begins 86"));
  expect_one_sentence(run_cli({"evaluate", sequence.path(), sequence.path("out/trajectory.txt")}),
                      "its ground truth is of no use");
  const CliResult table = run_cli({"benchmark", sequence.path(), "--methods", "none"});
  EXPECT_THAT(table.out, Not(HasSubstr("lost")));
}

TEST_F(Input, DepthOfAnotherKindIsRefusedBeforeTheRun) {
  for (int i = 0; i < kInputFrames; ++i)
    sequence.folder.write(sequence.depth(i),
                          cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(80)));
  expect_one_sentence(run(), "its depth is of no use: ");
  EXPECT_FALSE(std::filesystem::exists(sequence.path("out")));
}

TEST_F(Input, FramesThatLackedDepthAreToldAtTheEnd) {
  sequence.folder.write(sequence.depth(4),
                        cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(80)));
  sequence.folder.write(sequence.depth(5),
                        cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(80)));
  const CliResult result = run();
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("no depth      2 of 8 frames: 4-5 ("));
  EXPECT_THAT(result.out, HasSubstr("depth/4.png holds 1 channel of 8 bits"));
}

TEST_F(Input, MillimetresAreQuestionedBeforeAndTheScaleIsNamedAfter) {
  cv::Mat depth(SmallSequence::kHeight, SmallSequence::kWidth, CV_16UC1, cv::Scalar(1500));
  for (int i = 0; i < kInputFrames; ++i) sequence.folder.write(sequence.depth(i), depth);
  const CliResult result = run();
  EXPECT_THAT(result.err, HasSubstr("`--depth-scale 1000` reads it so"));
  const CliResult told = run({"--depth-scale", "1000"});
  EXPECT_THAT(told.err, Not(HasSubstr("depth reads")));
  EXPECT_LT(summary()["evaluation"]["ate"]["translation_m"]["rmse"].get<double>(), 0.005);
  EXPECT_EQ(summary()["depth_scale"], 1000.0);
}

TEST_F(Input, MasksOfNoUseStopTheOracleAlone) {
  std::string list;
  for (int i = 0; i < kInputFrames; ++i) {
    sequence.folder.write(
        fmt::format("mask/{}.png", i),
        cv::Mat(SmallSequence::kHeight / 2, SmallSequence::kWidth / 2, CV_8UC1, cv::Scalar(0)));
    list += fmt::format("{:.4f} mask/{}.png\n", SmallSequence::stamp(i), i);
  }
  sequence.folder.write("mask.txt", list);
  expect_one_sentence(run_cli({"run", sequence.path(), "--method", "oracle"}),
                      "the masks are 160x120 px, but the colour images are 320x240 px");
  const CliResult none = run();
  EXPECT_EQ(none.exit_code, 0);
  EXPECT_THAT(none.err, HasSubstr("the masks are 160x120 px"));
}

TEST_F(Input, ARunOfFramesReadAnotherWayIsOpenedTheSameWay) {
  EXPECT_EQ(run({"--truth", "inverse", "--depth-offset", "0.001"}).exit_code, 0);
  const CliResult again = run_cli({"snapshot", sequence.path("out"), "--frames", "2", "--panels", "input",
                                   "--out", sequence.path("pictures")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.err.find("no longer"), std::string::npos) << again.err;
}

TEST_F(Input, ConventionsAreNamed) {
  expect_one_sentence(run({"--truth", "upside-down"}),
                      "--truth upside-down: expected one of as-written, inverse, w-first");
}

}  // namespace
}  // namespace stillpoint
