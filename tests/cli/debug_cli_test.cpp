// Debugging without a display: conditions on the command line, and frames that show a problem.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class DebugCli : public ::testing::Test {
 protected:
  [[nodiscard]] CliResult run(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"run", sequence_.path(), "--method", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  SmallSequence sequence_{8};
};

TEST_F(DebugCli, BreakTellsTheFramesAndTheRunIsComplete) {
  const CliResult result =
      run({"--break", "frame == 2 || frame >= 4 && frame < 7", "--out", sequence_.path("out")});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.out, HasSubstr("at 4 of 8 frames: 2, 4-6"));
  EXPECT_TRUE(fs::exists(sequence_.path("out/summary.json")));
  const CliResult without = run({"--break", "rpe > 1 m"});
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_THAT(without.out, HasSubstr("rpe > 1 m: at no frame; rpe from "));
}

TEST_F(DebugCli, BreakKnowsErrorsOfTheTruth) {
  EXPECT_EQ(run({"--break", "rpe >= 0 && frame == 3"}).exit_code, 3);
  sequence_.folder.write("groundtruth.txt", "0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(run({"--break", "rpe >= 0"}).exit_code, 0);
}

TEST_F(DebugCli, AWrongConditionIsAnsweredAtItsPlaceBeforeAnythingIsDone) {
  for (const char* option : {"--break", "--when"}) {
    std::vector<std::string> arguments = {std::string(option) == "--break" ? "run" : "snapshot",
                                          sequence_.path(),
                                          option,
                                          "lost || inlirs < 3",
                                          "--out",
                                          sequence_.path("out")};
    const CliResult result = run_cli(arguments);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("column 9: there is no name 'inlirs'; did you mean inliers?"));
    EXPECT_THAT(result.err, HasSubstr("\n          ^"));
    EXPECT_FALSE(fs::exists(sequence_.path("out")));
  }
}

TEST_F(DebugCli, BreakHelpNamesWhatThereIs) {
  const CliResult result = run({"--break", "help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("inliers"));
  EXPECT_THAT(result.out, HasSubstr("spike(x, 3)"));
}

TEST_F(DebugCli, SnapshotsOfTheFramesWhereAConditionHolds) {
  const CliResult result =
      run_cli({"snapshot", sequence_.path(), "--method", "none", "--when", "frame == 2 || frame == 5",
               "--panels", "input", "--out", sequence_.path("out")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("2 images of 2 frames"));
  EXPECT_TRUE(fs::exists(sequence_.path("out/000005_input.png")));
  const CliResult fewer =
      run_cli({"snapshot", sequence_.path(), "--method", "none", "--when", "frame == 2 || frame == 5",
               "--frames", "0:4", "--panels", "input", "--out", sequence_.path("fewer")});
  EXPECT_THAT(fewer.out, HasSubstr("1 image of 1 frame written"));
  const CliResult none = run_cli({"snapshot", sequence_.path(), "--method", "none", "--when", "lost",
                                  "--panels", "input", "--out", sequence_.path("none")});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err,
              HasSubstr("--when 'lost': holds at none of 8 frames, and nothing is drawn; lost at none"));
  EXPECT_FALSE(fs::exists(sequence_.path("none")));
  const CliResult film =
      run_cli({"snapshot", sequence_.path(), "--method", "none", "--when", "inliers > 5000", "--frames",
               "2:8", "--panels", "input", "--video", sequence_.path("n.mp4")});
  EXPECT_EQ(film.exit_code, 1);
  EXPECT_THAT(film.err, HasSubstr("holds at none of 6 frames, and nothing is drawn; inliers from "));
  EXPECT_FALSE(fs::exists(sequence_.path("n.mp4")));
}

TEST_F(DebugCli, ExportsFramesThatGiveTheSameRun) {
  const CliResult exported =
      run_cli({"export", sequence_.path(), "--frames", "0:5", "--out", sequence_.path("part")});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("5 frames written"));
  const auto hash_line = [](const CliResult& result) {
    return result.out.substr(result.out.find("run hash"));
  };
  const CliResult whole = run({"--frames", "5"});
  const CliResult part = run_cli({"run", sequence_.path("part"), "--method", "none"});
  ASSERT_THAT(whole.out, HasSubstr("run hash"));
  EXPECT_EQ(hash_line(part), hash_line(whole));
  const CliResult again = run_cli({"export", sequence_.path(), "--out", sequence_.path("part")});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("holds a sequence already"));
}

TEST_F(DebugCli, WhenKnowsTheTrueMasks) {
  // The oracle's mask is the true one.
  const auto generated = [&](const std::string& when, const std::string& out) {
    return run_cli({"snapshot", "generated:cup", "--length", "2", "--method", "oracle", "--when", when,
                    "--panels", "union_mask", "--out", sequence_.path(out), "--no-baseline"});
  };
  EXPECT_THAT(generated("frame == 1 && !(mask_iou < 99%)", "true").out, HasSubstr("of 1 frame "));
  EXPECT_THAT(generated("mask_iou < 99%", "wrong").err, HasSubstr("; mask_iou is 100.00 % throughout"));
  const CliResult unknown = run({"--break", "mask_iou < 50%"});
  EXPECT_EQ(unknown.exit_code, 0);
  EXPECT_THAT(unknown.out, HasSubstr("at no frame; none has mask_iou"));
}

TEST_F(DebugCli, ExportKeepsThePlaceOfWhatCannotBeRead) {
  sequence_.folder.write(SmallSequence::colour(2), std::string("no image"));
  const CliResult result =
      run_cli({"export", sequence_.path(), "--frames", "1:4", "--out", sequence_.path("part")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 frames written"));
  EXPECT_THAT(result.out, HasSubstr("cannot be read, and have places without images: 2"));
  const CliResult part =
      run_cli({"run", sequence_.path("part"), "--method", "none", "--break", "unreadable"});
  EXPECT_EQ(part.exit_code, 3) << part.err;
  EXPECT_THAT(part.out, HasSubstr("at 1 of 3 frames: 1"));
  EXPECT_EQ(run_cli({"export", sequence_.path(), "--frames", "2", "--out", sequence_.path("none")}).exit_code,
            1);
}

}  // namespace
}  // namespace stillpoint
