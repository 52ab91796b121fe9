#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

TEST(CheckCommand, HasStatusZeroAndNothingToSayOfASoundFolder) {
  const SmallSequence sequence(8);
  const CliResult result = run_cli({"check", sequence.path()});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_THAT(result.out, HasSubstr("8 frames"));
  EXPECT_THAT(result.out, HasSubstr("no findings"));
}

TEST(CheckCommand, HasStatusThreeAndTheSwitchThatMends) {
  const SmallSequence sequence(8);
  for (int i = 0; i < 8; ++i)
    sequence.folder.write(sequence.depth(i),
                          cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_16UC1, cv::Scalar(1500)));
  const CliResult result = run_cli({"check", sequence.path(), "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["findings"][0]["about"], "depth");
  EXPECT_THAT(json["findings"][0]["sentence"].get<std::string>(), HasSubstr("`--depth-scale 1000`"));
  EXPECT_EQ(run_cli({"check", sequence.path(), "--depth-scale", "1000"}).exit_code, 0);
}

TEST(CheckCommand, WhatIsCertainIsMendedWhenAskedFor) {
  const SmallSequence sequence(8);
  for (int i = 0; i < 8; ++i)
    sequence.folder.write(sequence.depth(i),
                          cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_16UC1, cv::Scalar(1500)));
  const std::vector<std::string> run = {"run", sequence.path(), "--method", "none", "--out"};
  const auto with = [&run](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words = run;
    words.push_back(out);
    words.insert(words.end(), more.begin(), more.end());
    return run_cli(words);
  };
  const CliResult told = with(sequence.path("told"), {});
  EXPECT_THAT(told.err, HasSubstr("`--depth-scale 1000` reads it so"));  // told, and not done
  const CliResult fixed = with(sequence.path("fixed"), {"--fix"});
  ASSERT_EQ(fixed.exit_code, 0) << fixed.err;
  EXPECT_THAT(fixed.err, HasSubstr("fixed by --depth-scale 1000: "));
  const CliResult given = with(sequence.path("given"), {"--depth-scale", "1000"});
  EXPECT_EQ(sequence.folder.read("fixed/trajectory.txt"), sequence.folder.read("given/trajectory.txt"));
  EXPECT_NE(sequence.folder.read("fixed/trajectory.txt"), sequence.folder.read("told/trajectory.txt"));
  // The run's folder opens by what was mended.
  EXPECT_EQ(run_cli({"snapshot", sequence.path("fixed"), "--frames", "3", "--panels", "input", "--out",
                     sequence.path("pictures")})
                .exit_code,
            0);
  // What was given stands.
  const CliResult kept = run_cli({"check", sequence.path(), "--fix", "--depth-scale", "5000", "--json"});
  EXPECT_EQ(kept.exit_code, 3);
  EXPECT_EQ(nlohmann::json::parse(kept.out)["depth_scale"], 5000.0);
}

TEST(CheckCommand, ARunIsToldWhatAQuickLookFinds) {
  const SmallSequence sequence(8);
  sequence.folder.write(sequence.colour(1),
                        cv::imread(sequence.path(sequence.colour(0)), cv::IMREAD_UNCHANGED));
  const CliResult run = run_cli({"run", sequence.path(), "--method", "none"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: " + sequence.path() +
                                 ": 1 of 7 sampled colour images are the same, pixel for pixel"));
}

TEST(CheckCommand, NamesFilesWithoutBytes) {
  const SmallSequence sequence(8);
  std::ofstream(sequence.path(sequence.colour(2))).close();
  std::ofstream(sequence.path(sequence.colour(5))).close();
  std::filesystem::remove(sequence.path(sequence.depth(3)));
  const std::string colours = "2 of 8 colour images are missing or empty, and their frames cannot be read: " +
                              sequence.colour(2) + " is empty (0 bytes), " + sequence.colour(5) +
                              " is empty (0 bytes)",
                    depths = "1 of 8 depth images are missing or empty, and their frames have no depth: " +
                             sequence.depth(3) + " is missing";
  const CliResult check = run_cli({"check", sequence.path()});
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_THAT(check.out, HasSubstr("  images    " + sequence.path("rgb.txt") + ": " + colours));
  EXPECT_THAT(check.out, HasSubstr("  depth     " + sequence.path("depth.txt") + ": " + depths));
  // Whatever opens a sequence says so, and an archive is no other than its folder.
  const std::string archive = sequence.path("all.tar");
  ASSERT_EQ(CliProcess({"-c", "cd " + sequence.path() + " && tar -cf all.tar *.txt rgb depth"}, "/bin/bash")
                .wait()
                .exit_code,
            0);
  for (const std::string& place : {sequence.path(), archive}) {
    const CliResult run = run_cli({"run", place, "--method", "none"});
    EXPECT_THAT(run.err, HasSubstr(colours));
    EXPECT_THAT(run.err, HasSubstr(depths));
  }
}

TEST(CheckCommand, SaysWhetherFramesTellTimes) {
  const SmallSequence few(8);
  const auto json = nlohmann::json::parse(run_cli({"check", few.path(), "--json"}).out);
  EXPECT_TRUE(json["time"]["readout"].is_null());
  EXPECT_THAT(json["time"]["why_not"].get<std::string>(), HasSubstr("8 frames are too few: 30 are needed"));
  const CliResult run = run_cli({"run", few.path(), "--method", "none", "--calibrate-time"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("time: 8 frames are too few"));
  EXPECT_EQ(run_cli({"run", few.path(), "--method", "none"}).out.find("time: "), std::string::npos);
}

TEST(CheckCommand, TellsThatItMeasuresTimesInAnyCase) {
  const SmallSequence sequence(6);
  EXPECT_THAT(run_cli({"check", sequence.path(), "--calibrate-time"}).err,
              HasSubstr("warning: --calibrate-time is of no use here"));
  EXPECT_EQ(run_cli({"check", sequence.path()}).err, "");
}

TEST(CheckCommand, QuestionsAnEstimate) {
  const SmallSequence sequence(8);
  sequence.folder.write("estimate.txt", "5.0 0 0 0 0 0 0 1\n5.1 0 0 0 0 0 0 1\n");
  const CliResult result = run_cli({"check", sequence.path(), sequence.path("estimate.txt")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.out, HasSubstr("none of its 2 poses meets the ground truth in time"));
  std::string still;
  for (int i = 0; i < 8; ++i) still += fmt::format("{:.4f} 1 2 3 0 0 0 1\n", SmallSequence::stamp(i));
  sequence.folder.write("still.txt", still);
  const CliResult held = run_cli({"check", sequence.path(), sequence.path("still.txt"), "--json"});
  EXPECT_EQ(held.exit_code, 3);
  const auto json = nlohmann::json::parse(held.out);
  EXPECT_EQ(json["evaluation"]["matched"], 8);
  EXPECT_EQ(json["findings"][0]["about"], "estimate");
  EXPECT_THAT(json["findings"][0]["sentence"].get<std::string>(),
              HasSubstr("7 of its poses are the same number for number"));
  expect_one_sentence(run_cli({"check", sequence.path("none")}), "there is no such folder");
}

}  // namespace
}  // namespace stillpoint
