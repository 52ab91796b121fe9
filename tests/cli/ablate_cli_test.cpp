#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

TEST(SweepCommand, RunsEachValueAndWritesWhatItReached) {
  const SmallSequence sequence(34);
  const std::vector<std::string> command = {
      "sweep",    sequence.path(), "--parameter", "features.count=200:600:2",
      "--method", "none",          "--out",       sequence.path("out")};
  const CliResult result = run_cli(command);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("| features.count"));
  const auto json = nlohmann::json::parse(sequence.folder.read("out/sweep.json"));
  ASSERT_EQ(json.size(), 1U);
  ASSERT_EQ(json[0]["points"].size(), 2U);
  EXPECT_EQ(json[0]["points"][0]["value"], 200.0);
  EXPECT_NE(json[0]["points"][0]["run_hash"], json[0]["points"][1]["run_hash"]);
  for (const auto& point : json[0]["points"]) {
    EXPECT_EQ(point["coverage"], 1.0);
    EXPECT_TRUE(point["iou"].is_null());  // nothing is judged, so nothing is scored
    EXPECT_LT(point["rpe_m"].get<double>(), 0.02);
  }
  const std::string csv = sequence.folder.read("out/sweep.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  expect_one_sentence(run_cli(command), "--force");
  expect_one_sentence(run_cli({"sweep", sequence.path(), "--parameter", "run.method=1:2"}), "is no number");
  expect_one_sentence(run_cli({"sweep", sequence.path(), "--parameter", "nothing.at_all"}),
                      "there is no parameter nothing.at_all");
}

TEST(AblateCommand, RunsTheWholeMethodAndEachWithoutOne) {
  const SmallSequence sequence(34);
  const CliResult result = run_cli(
      {"ablate", sequence.path(), "--without", "prior,depth_residual", "--out", sequence.path("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("whole method"));
  EXPECT_THAT(result.out, HasSubstr("without depth_residual"));
  const auto json = nlohmann::json::parse(sequence.folder.read("out/ablation.json"));
  ASSERT_EQ(json["variants"].size(), 3U);
  EXPECT_TRUE(json["variants"][0]["without"].is_null());
  EXPECT_EQ(json["variants"][1]["without"], "prior");
  EXPECT_EQ(json["variants"][1]["set"][0], "stillpoint.prior_share=0");
  for (const auto& variant : json["variants"]) {
    ASSERT_EQ(variant["runs"].size(), 1U);
    EXPECT_EQ(variant["runs"][0]["coverage"], 1.0);
    EXPECT_LT(variant["runs"][0]["rpe_1s_m"].get<double>(), 0.02);
  }
  // Another pose solver, another run.
  EXPECT_NE(json["variants"][0]["runs"][0]["run_hash"], json["variants"][2]["runs"][0]["run_hash"]);
  const std::string csv = sequence.folder.read("out/ablation.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_THAT(sequence.folder.read("out/ablation.md"), HasSubstr("| without prior"));

  expect_one_sentence(
      run_cli({"ablate", sequence.path(), "--without", "prior", "--out", sequence.path("out")}), "--force");
}

TEST(AblateCommand, SaysWhatIsWrong) {
  const SmallSequence sequence(3);
  expect_one_sentence(run_cli({"ablate", sequence.path(), "--without", "luck"}), "depth_evidence");
  expect_one_sentence(run_cli({"ablate", sequence.path(), "--without", "prior,prior"}), "twice");
  expect_one_sentence(run_cli({"ablate", sequence.path("none")}), "none");
  std::filesystem::remove(sequence.path("depth.txt"));
  expect_one_sentence(run_cli({"ablate", sequence.path()}), "colour frames only");
}

}  // namespace
}  // namespace stillpoint
