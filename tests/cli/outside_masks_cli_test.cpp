// `--masks`: masks made elsewhere are removed by as `oracle` removes by the true ones, and what is wrong with
// one is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/cli/csv_rows.hpp"
#include "tests/cli/run_cli.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kMaskedFrames = 8;

/// A generated sequence with people, written once.
class OutsideMasksCli : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder();
    const CliResult made = run_cli({"generate", "walking_xyz", "--out", folder_->path("film"), "--frames",
                                    std::to_string(kMaskedFrames)});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  /// Runs into a folder of that name. @returns what was printed
  static CliResult run(const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"run", folder_->path("film"), "--out", folder_->path(out),
                                          "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CliResult result = run_cli(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  }
  static std::string hash(const std::string& out) {
    return nlohmann::json::parse(folder_->read(out + "/summary.json"))["run_hash"].get<std::string>();
  }
  static TemporaryFolder* folder_;
};
TemporaryFolder* OutsideMasksCli::folder_ = nullptr;

TEST_F(OutsideMasksCli, TheTrueMasksGiveTheRunOfOracleBitForBit) {
  run("oracle", {"--method", "oracle"});
  run("by_folder", {"--method", "masks", "--masks", folder_->path("film/mask")});
  run("by_list", {"--masks", folder_->path("film/mask.txt")});
  EXPECT_EQ(hash("by_folder"), hash("oracle"));
  EXPECT_EQ(hash("by_list"), hash("oracle"));
  EXPECT_EQ(folder_->read("by_folder/trajectory.txt"), folder_->read("oracle/trajectory.txt"));
  run("nothing", {"--method", "none"});
  EXPECT_NE(hash("nothing"), hash("oracle"));
}

TEST_F(OutsideMasksCli, ScoresAreThoseOfAnyMask) {
  run("scored", {"--masks", folder_->path("film/mask")});
  const auto summary = nlohmann::json::parse(folder_->read("scored/summary.json"));
  EXPECT_EQ(summary["masks"]["mask"]["iou"].get<double>(), 1.0);
}

TEST_F(OutsideMasksCli, WhatIsWrongWithSomeIsToldOnceAndMarked) {
  fs::copy(folder_->path("film/mask"), folder_->path("some"), fs::copy_options::recursive);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_->path("some"))) names.push_back(entry.path());
  std::sort(names.begin(), names.end());
  ASSERT_EQ(names.size(), static_cast<std::size_t>(kMaskedFrames));
  fs::remove(names[2]);
  cv::imwrite(names[4], cv::Mat(10, 10, CV_8UC1, cv::Scalar(0)));
  cv::imwrite(names[5], cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)));
  const CliResult result = run("gaps", {"--masks", folder_->path("some")});
  EXPECT_THAT(result.out, HasSubstr("no mask       3 of 8 frames: 2 ("));
  EXPECT_THAT(result.out, HasSubstr("; 4 ("));
  EXPECT_THAT(result.out, HasSubstr("is 10x10 px, but the frame is 640x480 px); 5 ("));
  EXPECT_THAT(result.out, HasSubstr("takes out the whole frame and is not used)"));
  EXPECT_THAT(result.out, HasSubstr("has no mask for this frame"));
  const auto rows = csv_rows(folder_->read("gaps/frames.csv"));
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(kMaskedFrames));
  EXPECT_THAT(rows[2].at("note"), HasSubstr("has no mask for this frame"));
  EXPECT_THAT(rows[4].at("note"), HasSubstr("is 10x10 px, but the frame is 640x480 px"));
  EXPECT_THAT(rows[5].at("note"), HasSubstr("takes out the whole frame and is not used"));
  EXPECT_EQ(rows[3].at("note"), "");
}

TEST_F(OutsideMasksCli, WithAMethodOfOurOwn) {
  run("both", {"--method", "paper", "--masks", folder_->path("film/mask")});
  const auto summary = nlohmann::json::parse(folder_->read("both/summary.json"));
  EXPECT_EQ(summary["masks"]["mask"]["recall"].get<double>(), 1.0);
  run("common", {"--method", "paper", "--masks", folder_->path("film/mask"), "--set",
                 "masks.with_method=intersection"});
  const auto common = nlohmann::json::parse(folder_->read("common/summary.json"));
  EXPECT_EQ(common["masks"]["mask"]["precision"].get<double>(), 1.0);
  EXPECT_LT(common["masks"]["mask"]["recall"].get<double>(), 1.0);
}

TEST_F(OutsideMasksCli, InvertedOnesAreToldByTheTruth) {
  fs::create_directories(folder_->path("inverted"));
  for (const auto& entry : fs::directory_iterator(folder_->path("film/mask"))) {
    const cv::Mat mask = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    cv::imwrite(folder_->path("inverted/" + entry.path().filename().string()), cv::Mat(255 - mask));
  }
  const CliResult result = run("turned", {"--masks", folder_->path("inverted")});
  EXPECT_THAT(result.out,
              HasSubstr("the masks hold what stands still: the other way round their IoU is 1.00 instead "
                        "of 0.00 (`--set masks.inverted=true` reads them so)"));
}

TEST_F(OutsideMasksCli, OfAnotherProgramsRunTheyAreToldAsWell) {
  run("sound", {"--method", "oracle"});
  fs::create_directories(folder_->path("another/masks"));
  fs::copy(folder_->path("sound/trajectory.txt"), folder_->path("another/trajectory.txt"));
  for (const auto& entry : fs::directory_iterator(folder_->path("film/mask"))) {
    const cv::Mat mask = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    cv::imwrite(folder_->path("another/masks/" + entry.path().filename().string()), cv::Mat(255 - mask));
  }
  const CliResult result = run_cli({"import", folder_->path("film"), "another=" + folder_->path("another"),
                                    "--out", folder_->path("imported")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(
      result.out,
      HasSubstr("the masks hold what stands still: the other way round their IoU is 1.00 instead of 0.00\n"));
}

TEST_F(OutsideMasksCli, WhatCannotBeMeantIsRefused) {
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(0));
  mask.colRange(100, 200).setTo(255);
  fs::create_directories(folder_->path("other"));
  cv::imwrite(folder_->path("other/hall.png"), mask);
  expect_one_sentence(run_cli({"run", folder_->path("film"), "--masks", folder_->path("other")}),
                      "none of 8 frames has a mask that can be used");
  expect_one_sentence(run_cli({"run", folder_->path("film"), "--method", "masks"}),
                      "method masks removes by masks made elsewhere: name them by --masks DIR|LIST");
  expect_one_sentence(run_cli({"run", folder_->path("film"), "--masks", folder_->path("nowhere")}),
                      "nowhere: there is no such folder or list of masks");
}

}  // namespace
}  // namespace stillpoint
