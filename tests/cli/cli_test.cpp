#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_cli.hpp"

namespace stillpoint {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

/// Ground truth at 1 m/s along x and an estimate at 1.1 m/s, 3 s at 10 Hz.
class Evaluate : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string truth, estimate;
    for (int i = 0; i <= 30; ++i) {
      truth += fmt::format("{:.1f} {:.2f} 0 0 0 0 0 1\n", 0.1 * i, 0.1 * i);
      estimate += fmt::format("{:.1f} {:.3f} 0 0 0 0 0 1\n", 0.1 * i, 0.11 * i);
    }
    folder.write("truth.txt", truth);
    folder.write("estimate.txt", estimate);
  }
  [[nodiscard]] CliResult evaluate(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"evaluate", folder.path("truth.txt"), folder.path("estimate.txt")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  TemporaryFolder folder;
};

TEST_F(Evaluate, PrintsATable) {
  const CliResult result = evaluate({"--frames", "62"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("Matched   31 of 31 estimated poses"));
  EXPECT_THAT(result.out, HasSubstr("Coverage  50.0 %: 31 poses for 62 frames"));
  EXPECT_THAT(result.out, ContainsRegex("RPE 1 s translation +m +21 +0.10000"));
}

TEST_F(Evaluate, PrintsJson) {
  const CliResult result = evaluate({"--json"});
  EXPECT_EQ(result.exit_code, 0);
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["matched"], 31);
  EXPECT_EQ(json["rpe_time"]["pairs"], 21);
  EXPECT_NEAR(json["rpe_time"]["translation_m"]["rmse"].get<double>(), 0.1, 1e-6);
  EXPECT_TRUE(json["coverage"].is_null());
}

TEST_F(Evaluate, TakesASequenceForTruthAndCoverage) {
  folder.write("groundtruth.txt", folder.read("truth.txt"));
  folder.write("rgb/a.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  std::string list;
  for (int i = 0; i < 40; ++i) list += fmt::format("{:.1f} rgb/a.png\n", 0.1 * i);
  folder.write("rgb.txt", list);
  CliResult result = run_cli({"evaluate", folder.path(), folder.path("estimate.txt")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("31 poses for 40 frames"));
  result = evaluate({"--sequence", folder.path()});
  EXPECT_THAT(result.out, HasSubstr("31 poses for 40 frames"));
  std::filesystem::remove(folder.path("groundtruth.txt"));
  expect_one_sentence(run_cli({"evaluate", folder.path(), folder.path("estimate.txt")}),
                      "has no ground truth");
}

TEST_F(Evaluate, TellsWarningsApartFromResults) {
  folder.write("estimate.txt", "0.1 0 0 0 0 0 0 1\n0.0 0 0 0 0 0 0 1\n");
  const CliResult result = evaluate({"--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("warning: "));
  EXPECT_TRUE(nlohmann::json::accept(result.out));
}

TEST_F(Evaluate, BadInputGetsOneSentence) {
  const std::string truth = folder.path("truth.txt"), estimate = folder.path("estimate.txt");
  expect_one_sentence(run_cli({"evaluate", truth, folder.path("none.txt")}), "none.txt: cannot be read");
  expect_one_sentence(run_cli({"evaluate", folder.path("none"), estimate}), "none: cannot be read");
  expect_one_sentence(run_cli({"evaluate", folder.path(), estimate}), "neither rgb.txt nor associations.txt");
  folder.write("estimate.txt", "1 0 0 nan 0 0 0 1\n");
  expect_one_sentence(evaluate(), "estimate.txt:1: found 'nan'");
  folder.write("estimate.txt", "0 0 0 0 0 0 0 0\n");
  expect_one_sentence(evaluate(), "estimate.txt:1: found a quaternion of length 0");
  folder.write("estimate.txt", "");
  expect_one_sentence(evaluate(), "estimate.txt: holds no poses");
  folder.write("estimate.txt", "500 0 0 0 0 0 0 1\n");
  expect_one_sentence(evaluate(), "none of its poses (500.000 s to 500.000 s) is closer than 0.02 s");
}

TEST_F(Evaluate, BadArgumentsEndWithStatusTwo) {
  EXPECT_EQ(evaluate({"--frames", "0"}).exit_code, 2);
  EXPECT_EQ(evaluate({"--max-difference", "-1"}).exit_code, 2);
  EXPECT_EQ(evaluate({"--align", "sideways"}).exit_code, 2);
  EXPECT_EQ(evaluate({"--align", "first:2"}).exit_code, 2);
  EXPECT_EQ(evaluate({"--time-offset", "soon"}).exit_code, 2);
  EXPECT_EQ(run_cli({"evaluate", folder.path("truth.txt")}).exit_code, 2);
  EXPECT_EQ(run_cli({"evaluate", "--help"}).exit_code, 0);
}

}  // namespace
}  // namespace stillpoint
