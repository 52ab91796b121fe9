#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

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

TEST(SweepCommand, ShortInputSaysWhyThereAreDashesAndHasWhatThereIs) {
  const SmallSequence sequence(12);
  const std::string why = "- no RPE over 1 s: no two matched poses are 1 s apart (";
  const CliResult sweep = run_cli({"sweep", sequence.path(), "--method", "none", "--parameter",
                                   "features.count=500:501", "--out", sequence.path("out")});
  ASSERT_EQ(sweep.exit_code, 0) << sweep.err;
  EXPECT_THAT(sweep.out, HasSubstr(why + "features.count = 500; features.count = 501)"));
  EXPECT_THAT(sweep.err, HasSubstr("there are 2 values and no 7 to run"));
  const auto json = nlohmann::json::parse(sequence.folder.read("out/sweep.json"));
  EXPECT_THAT(json[0].at("command").get<std::string>(), HasSubstr("stillpoint sweep "));
  for (const auto& point : json[0].at("points")) {
    EXPECT_TRUE(point.at("rpe_m").is_null());
    EXPECT_GT(point.at("ate_m").get<double>(), 0.0);
    EXPECT_GT(point.at("rpe_frame_m").get<double>(), 0.0);
  }
  const CliResult ablate = run_cli({"ablate", sequence.path(), "--method", "none", "--without", "huber"});
  EXPECT_THAT(ablate.out, HasSubstr(why));
  EXPECT_THAT(ablate.out, HasSubstr("RPE 1 frame, RMSE [m]"));
  EXPECT_THAT(run_cli({"benchmark", sequence.path(), "--methods", "none"}).out, HasSubstr(why));
}

TEST(AblateCommand, StoppedInOneProcessGoesOnAndForceKeepsEarlierTables) {
  const SmallSequence sequence(34);
  const std::string out = sequence.path("out");
  const std::vector<std::string> words = {"ablate",         sequence.path(), "--without",
                                          "prior,smoother", "--out",         out};
  const auto with = [&words](const char* word) {
    std::vector<std::string> all = words;
    all.emplace_back(word);
    return all;
  };
  ASSERT_EQ(run_cli(words).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(out + "/plan.json"));
  EXPECT_FALSE(std::filesystem::exists(out + "/cells"));
  const std::string before = sequence.folder.read("out/ablation.csv");
  sequence.write_lists(300);
  CliProcess process(with("--force"));
  constexpr int kPolls = 6000;
  for (int i = 0; i < kPolls && !std::filesystem::exists(out + "/cells/000000.json"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  process.send(SIGINT);
  const CliResult stopped = process.wait();
  EXPECT_EQ(stopped.exit_code, 128 + SIGINT) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("the earlier tables stay until --resume has made these whole"));
  EXPECT_EQ(sequence.folder.read("out/ablation.csv"), before);
  const CliResult resumed = run_cli(with("--resume"));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("2 of the plan's 3 runs are to be made"));
  EXPECT_NE(sequence.folder.read("out/ablation.csv"), before);
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
    EXPECT_LT(variant["runs"][0]["rpe_m"].get<double>(), 0.02);
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
