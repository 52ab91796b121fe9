// Ctrl-C in commands that take long: each says that it was stopped and what is left, and has the status of a
// signal.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// Whether a process has a handler of its own for a signal.
bool catches(pid_t process, int signal) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1)) & 1U;
  return false;
}

/// The program, stopped as soon as it can say so. @param sign wait for this file as well
CliResult stopped_when_ready(const Words& words, const std::string& sign = "") {
  CliProcess process(words);
  constexpr int kPolls = 6000;
  for (int i = 0; i < kPolls && !(catches(process.id(), SIGINT) && (sign.empty() || fs::exists(sign))); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  process.send(SIGINT);
  return process.wait();
}

void expect_stopped(const CliResult& result, const std::string& told) {
  EXPECT_EQ(result.exit_code, 128 + SIGINT) << result.err;
  EXPECT_FALSE(result.by_signal);
  EXPECT_THAT(result.err, HasSubstr("stillpoint: stopped"));
  EXPECT_THAT(result.err, HasSubstr(told));
  EXPECT_EQ(result.err.find("stillpoint: stopped"), result.err.rfind("stillpoint: stopped"));
}

TEST(Stopped, PicturesAndFigures) {
  const TemporaryFolder folder("stopped");
  const std::string out = folder.path("out");
  expect_stopped(stopped_when_ready({"snapshot", "generated:walking_xyz", "--frames", "0:300", "--panels",
                                     "mask,errors", "--out", out},
                                    out + "/000001_mask.png"),
                 " of 300 frames; what was drawn is kept");
  EXPECT_TRUE(fs::exists(out + "/snapshots.txt"));
  expect_stopped(stopped_when_ready({"snapshot", "generated:walking_xyz", "--when", "rpe > 1 m", "--out",
                                     folder.path("when")}),
                 "stopped after 0 frames; what was drawn is kept");
  expect_stopped(
      stopped_when_ready({"figures", "generated:walking_xyz", "--frame", "-1", "--out", folder.path("f")}),
      "no figure was drawn");
  EXPECT_FALSE(fs::exists(folder.path("f")));
}

TEST(Stopped, ARunThatIsTakenOver) {
  const SmallSequence sequence(30);
  sequence.write_lists(3000);
  std::string poses;
  for (int i = 0; i < 30; ++i) {
    poses += std::to_string(SmallSequence::stamp(i)) + " 0 0 0 0 0 0 1\n";
    sequence.folder.write("theirs/masks/" + std::to_string(i) + ".png",
                          cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(0)));
  }
  sequence.folder.write("theirs/trajectory.txt", poses);
  const std::string out = sequence.path("taken/over");
  expect_stopped(stopped_when_ready({"import", sequence.path(), sequence.path("theirs"), "--out", out}),
                 "nothing was written");
  EXPECT_FALSE(fs::exists(sequence.path("taken")));
}

TEST(Stopped, RunsAndTheirTables) {
  const TemporaryFolder folder("stopped");
  const std::string sequence = "generated:walking_xyz";
  expect_stopped(stopped_when_ready({"run", sequence, "--out", folder.path("run")}),
                 " of 300 frames; what was done is kept");
  expect_stopped(stopped_when_ready({"benchmark", sequence, "--methods", "none", "--out", folder.path("b")}),
                 "the tables hold what was finished");
  expect_stopped(stopped_when_ready({"ablate", sequence, "--out", folder.path("a")}), "--resume goes on");
  expect_stopped(
      stopped_when_ready({"sweep", sequence, "--parameter", "features.count", "--out", folder.path("s")}),
      "the tables hold the values that were finished");
}

TEST(Stopped, WhatIsWritten) {
  const TemporaryFolder folder("stopped");
  const std::string sequence = "generated:walking_xyz", out = folder.path("out");
  expect_stopped(stopped_when_ready({"generate", "walking_xyz", "--out", out}, out + ".part/rgb"),
                 "stopped early; ");
  expect_stopped(stopped_when_ready({"export", sequence, "--out", folder.path("excerpt")}),
                 "nothing was written");
  EXPECT_FALSE(fs::exists(folder.path("excerpt")));
  expect_stopped(stopped_when_ready({"motion", sequence, "--out", folder.path("motion")},
                                    folder.path("motion/000002/mask.png")),
                 " frames; what was done is kept");
}

TEST(Stopped, ExportsAndReportsOfARun) {
  const SmallSequence sequence(12);
  sequence.write_lists(600);
  const std::string run = sequence.path("run");
  ASSERT_EQ(run_cli({"run", sequence.path(), "--method", "paper", "--out", run}).exit_code, 0);
  for (const Words& words :
       {Words{"export", run, "--to", sequence.path("run.mcap"), "--layers", "difference"},
        Words{"export", run, "--dense", sequence.path("room.ply")}}) {
    expect_stopped(stopped_when_ready(words), "nothing was written");
    EXPECT_FALSE(fs::exists(words[3]));
  }
  expect_stopped(stopped_when_ready({"report", run, "--interactive", "--out", sequence.path("r.html")}),
                 "no report was written");
  EXPECT_FALSE(fs::exists(sequence.path("r.html")));
}

TEST(Stopped, Checks) {
  const auto begun = std::chrono::steady_clock::now();
  expect_stopped(stopped_when_ready({"check", "generated:walking_xyz"}), "stopped before all was asked");
  expect_stopped(stopped_when_ready({"run", "generated:walking_xyz", "--calibrate-time"}),
                 "stopped before it was done");
  expect_stopped(stopped_when_ready({"run", "generated:walking_xyz", "--fix"}), "stopped before it was done");
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(60)) << "it does not end the work";
}

}  // namespace
}  // namespace stillpoint
