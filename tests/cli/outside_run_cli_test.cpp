// `import` and `--run`: a trajectory of ours, given as another program's, is measured and shown as our own
// run is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/csv_rows.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kRunFrames = 40;  // over a second, so that there is an RPE over one

class OutsideRunCli : public ::testing::Test {
 protected:
  OutsideRunCli() {
    EXPECT_EQ(run_cli({"run", sequence.path(), "--method", "none", "--out", sequence.path("own")}).exit_code,
              0);
  }
  [[nodiscard]] nlohmann::json evaluation(const std::string& run) const {
    return nlohmann::json::parse(sequence.folder.read(run + "/summary.json"))["evaluation"];
  }
  SmallSequence sequence{kRunFrames};
};

TEST_F(OutsideRunCli, AsOurOwnRunIs) {
  const CliResult imported =
      run_cli({"import", sequence.path(), "theirs=" + sequence.path("own/trajectory.txt"), "--out",
               sequence.path("theirs")});
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_THAT(imported.out, HasSubstr("method theirs"));
  const auto own = evaluation("own"), theirs = evaluation("theirs");
  for (const char* error : {"ate", "rpe_time", "rpe_frame"}) {
    EXPECT_GT(own[error]["translation_m"]["count"], 0) << error;
    EXPECT_EQ(theirs[error]["translation_m"]["count"], own[error]["translation_m"]["count"]) << error;
    EXPECT_NEAR(theirs[error]["translation_m"]["rmse"], own[error]["translation_m"]["rmse"].get<double>(),
                1e-6)
        << error;
  }
  const auto a = csv_rows(sequence.folder.read("own/frames.csv")),
             b = csv_rows(sequence.folder.read("theirs/frames.csv"));
  ASSERT_EQ(a.size(), static_cast<std::size_t>(kRunFrames));
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t i = 1; i < a.size(); ++i)
    EXPECT_NEAR(std::stod(b[i].at("rpe_frame_m")), std::stod(a[i].at("rpe_frame_m")), 2e-6) << i;
  // What the trajectory does not tell is an empty cell, and of our own run all is there.
  for (const char* column : {"mask_share", "features_found", "inliers", "map_points", "keyframe", "total_ms",
                             "pose_start", "bundle_iterations"}) {
    EXPECT_NE(a[20].at(column), "") << column;
    EXPECT_EQ(b[20].at(column), "") << column;
  }
  EXPECT_EQ(b[20].at("tracked"), "1");
  EXPECT_THAT(imported.out, Not(HasSubstr("map points")));
  EXPECT_THAT(imported.out, Not(HasSubstr("time a frame")));
  // A report takes both, each by its name.
  const CliResult report = run_cli(
      {"report", sequence.path("own"), sequence.path("theirs"), "--out", sequence.path("report.html")});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(sequence.folder.read("report.html"), HasSubstr("theirs"));
  // Its colour is not that of the baseline, which is by a method of ours.
  ASSERT_EQ(run_cli({"run", sequence.path(), "--method", "none", "--out", sequence.path("plain")}).exit_code,
            0);
  ASSERT_EQ(run_cli({"report", sequence.path("plain"), sequence.path("theirs"), "--interactive", "--worst",
                     "0", "--picture-mb", "0", "--out", sequence.path("live.html")})
                .exit_code,
            0);
  const std::string page = sequence.folder.read("live.html"), start = "\"report-data\">";
  const std::size_t from = page.find(start) + start.size();
  const auto runs = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from))
                        .at("sequences")
                        .at(0)
                        .at("runs");
  EXPECT_EQ(runs.at(1).at("name"), "theirs");
  EXPECT_NE(runs.at(0).at("colours"), runs.at(1).at("colours"));
}

TEST_F(OutsideRunCli, AReportTellsItsDoubtAndNoConfiguration) {
  // Three poses are held while the truth goes on.
  std::string held, line;
  std::istringstream poses(sequence.folder.read("own/trajectory.txt"));
  for (int i = 0; std::getline(poses, line); ++i)
    held += line.substr(0, line.find(' ')) +
            (i < 20 || i > 25 ? line.substr(line.find(' ')) : " 0 0 0 0 0 0 1") + "\n";
  sequence.folder.write("held.txt", held);
  ASSERT_EQ(run_cli({"import", sequence.path(), "theirs=" + sequence.path("held.txt"), "--out",
                     sequence.path("theirs")})
                .exit_code,
            0);
  const auto page = [this](const std::vector<std::string>& runs) {
    std::vector<std::string> words = {"report", "--worst", "0", "--force", "--out", sequence.path("r.html")};
    for (const std::string& run : runs) words.push_back(sequence.path(run));
    const CliResult report = run_cli(words);
    EXPECT_EQ(report.exit_code, 0) << report.err;
    return sequence.folder.read("r.html");
  };
  const std::string both = page({"own", "theirs"});
  EXPECT_THAT(both, HasSubstr("theirs: 5 of its poses are the same number for number as the one before"));
  EXPECT_THAT(both, HasSubstr("All of none, as TOML"));
  EXPECT_THAT(both, HasSubstr("<td class=\"text\">its own</td>")) << "its odometry is none of ours";
  EXPECT_THAT(both, Not(HasSubstr("All of theirs, as TOML")));
  EXPECT_THAT(page({"theirs"}), HasSubstr("None: these runs are other programs'."));
}

TEST_F(OutsideRunCli, IsDrawnBesideOrByItself) {
  const std::string beside = "theirs=" + sequence.path("own/trajectory.txt");
  const CliResult snapshot =
      run_cli({"snapshot", sequence.path(), "--method", "none", "--run", beside, "--frames", "20", "--panels",
               "trajectory,errors", "--out", sequence.path("pictures")});
  EXPECT_EQ(snapshot.exit_code, 0) << snapshot.err;
  EXPECT_TRUE(std::filesystem::exists(sequence.path("pictures/000020_errors.png")));
  ASSERT_EQ(run_cli({"import", sequence.path(), beside, "--out", sequence.path("theirs")}).exit_code, 0);
  const CliResult alone = run_cli({"snapshot", sequence.path("theirs"), "--frames", "20", "--panels",
                                   "workbench", "--out", sequence.path("alone")});
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
  const CliResult when = run_cli({"snapshot", sequence.path("theirs"), "--when", "mask < 5 %", "--panels",
                                  "errors", "--out", sequence.path("when")});
  EXPECT_EQ(when.exit_code, 1) << when.err;
  EXPECT_THAT(
      when.err,
      HasSubstr("--when 'mask < 5 %': holds at none of 40 frames, and nothing is drawn; none has mask"));
  EXPECT_FALSE(std::filesystem::exists(sequence.path("when/000020_errors.png")));
}

TEST_F(OutsideRunCli, WhatCannotBeMeantIsRefused) {
  expect_one_sentence(run_cli({"snapshot", sequence.path(), "--run", "a=" + sequence.path("nowhere.txt"),
                               "--out", sequence.path("pictures")}),
                      "nowhere.txt: there is no such file or folder");
  expect_one_sentence(
      run_cli({"import", sequence.path(), sequence.path("rgb.txt"), "--out", sequence.path("x")}), "rgb.txt");
}

}  // namespace
}  // namespace stillpoint
