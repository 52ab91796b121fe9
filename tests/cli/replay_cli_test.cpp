// Recordings as a user makes and plays them: in a window and without a display.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/xvfb.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ReplayCli : public ::testing::Test {
 protected:
  /// A recording of the small sequence. @returns its path
  [[nodiscard]] std::string recording(const std::string& events, int frames = 6) const {
    const std::string name = "sequence";
    sequence_.folder.write("recording.txt",
                           fmt::format("stillpoint recording 1\nsequence {} {}\nopened {}\nsize 800 600\n"
                                       "look light 1\nlayout {{\"columns\": [{{\"panel\": \"input\"}}, "
                                       "{{\"panel\": \"union_mask\"}}]}}\n"
                                       "set run.method=paper\nidle\n{}",
                                       frames, name, sequence_.path(), events));
    return sequence_.path("recording.txt");
  }
  [[nodiscard]] std::string out(const std::string& name) const { return sequence_.path(name); }

  SmallSequence sequence_{6};
};

TEST_F(ReplayCli, PlaysWithoutADisplay) {
  const std::string file =
      recording("key Right\nidle\nexpect frame 2\nexpect method paper\nscreenshot two.png\n");
  const CliResult result = run_cli({"replay", file, "--out", out("shots")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("replayed, 1 screenshot\n"));
  EXPECT_EQ(cv::imread(out("shots") + "/two.png").size(), cv::Size(800, 600));
  expect_one_sentence(run_cli({"replay", file, "--out", out("shots")}), "--force");
  EXPECT_EQ(run_cli({"replay", file, "--out", out("shots"), "--force"}).exit_code, 0);
}

TEST_F(ReplayCli, SaysWhatIsWrongInOneSentence) {
  expect_one_sentence(run_cli({"replay", out("none.txt")}), "cannot be read");
  expect_one_sentence(run_cli({"replay", recording("expect frame 5\n"), "--out", out("a")}),
                      "recording.txt:9: expected frame '5', found '1'");
  expect_one_sentence(run_cli({"replay", recording("jump\n"), "--out", out("a")}),
                      "recording.txt:9: 'jump' is nothing");
  expect_one_sentence(run_cli({"replay", recording("idle\n", 7), "--out", out("a")}), "was recorded of");
  sequence_.folder.write("old.txt", std::string("stillpoint recording 0\n"));
  expect_one_sentence(run_cli({"replay", out("old.txt")}), "another version");
}

TEST_F(ReplayCli, TheWindowShowsTheSame) {
  const stillpoint::testing::Xvfb xvfb;
  if (!xvfb.running()) GTEST_SKIP() << "Xvfb is not installed";
  const std::string file = recording(
      "frame 4\npoint input 0.5 0.5\nwheel 0 2\nwait 0.2\nmove -9999 -9999\nscreenshot four.png\nquit\n");
  const CliResult window = run_cli({"view", "--replay", file, "--out", out("window")});
  EXPECT_EQ(window.exit_code, 0) << window.err;
  const CliResult offscreen = run_cli({"replay", file, "--out", out("offscreen")});
  EXPECT_EQ(offscreen.exit_code, 0) << offscreen.err;
  const cv::Mat shown = cv::imread(out("window") + "/four.png"),
                drawn = cv::imread(out("offscreen") + "/four.png");
  ASSERT_EQ(shown.size(), drawn.size());
  cv::Mat difference;
  cv::absdiff(shown, drawn, difference);
  EXPECT_LE(cv::countNonZero(difference.reshape(1) > 2), 10);
}

TEST_F(ReplayCli, WhatAWindowRecordedIsReplayed) {
  const stillpoint::testing::Xvfb xvfb;
  if (!xvfb.running()) GTEST_SKIP() << "Xvfb is not installed";
  ::setenv("XDG_CONFIG_HOME", sequence_.path("config").c_str(), 1);
  const std::string file = sequence_.path("mine.txt");
  CliProcess window({"view", sequence_.path(), "--record", file});
  for (int i = 0; i < 200 && !fs::exists(file); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::seconds(2));
  window.send(SIGTERM);
  EXPECT_EQ(window.wait().exit_code, 128 + SIGTERM);
  ::unsetenv("XDG_CONFIG_HOME");
  EXPECT_THAT(sequence_.folder.read("mine.txt"), HasSubstr("stillpoint recording 1\nsequence 6 "));
  const CliResult replayed = run_cli({"replay", file, "--out", out("again")});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
}

TEST_F(ReplayCli, ARecordingThatCannotBeWrittenIsSaidBeforeThereIsAWindow) {
  const stillpoint::testing::Xvfb xvfb;
  if (!xvfb.running()) GTEST_SKIP() << "Xvfb is not installed";
  expect_one_sentence(run_cli({"view", sequence_.path(), "--record", "/nowhere/at/all"}),
                      "cannot be written");
}

}  // namespace
}  // namespace stillpoint
