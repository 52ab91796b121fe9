// What a run leaves, that it is the same every time, and how it ends when it is stopped or the disk is full.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "tests/cli/csv_rows.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

nlohmann::json summary_of(const TemporaryFolder& folder, const std::string& run) {
  return nlohmann::json::parse(folder.read(run + "/summary.json"));
}

TEST(Run, LeavesWhatItSays) {
  const SmallSequence sequence(10);
  const CliResult result =
      run_cli({"run", sequence.path(), "--method", "paper", "--out", sequence.path("out")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("sequence, method paper, odometry features: 10 of 10 frames tracked (100.0 %)"));

  EXPECT_EQ(line_count(sequence.folder.read("out/trajectory.txt")), 10U);
  EXPECT_EQ(line_count(sequence.folder.read("out/trajectory_live.txt")), 10U);
  EXPECT_GE(line_count(sequence.folder.read("out/keyframes.txt")), 1U);
  EXPECT_THAT(sequence.folder.read("out/map.ply"), ::testing::StartsWith("ply\nformat ascii 1.0\n"));
  // Points have the colours of the images: greys of the wall, and many of them.
  std::istringstream map(sequence.folder.read("out/map.ply"));
  std::set<std::string> colours;
  for (std::string line; std::getline(map, line);) {
    std::istringstream words(line);
    double x = 0, y = 0, z = 0;
    std::string red, green, blue, rest;
    if (words >> x >> y >> z >> red >> green >> blue && !(words >> rest) && red == green)
      colours.insert(blue);
  }
  EXPECT_GT(colours.size(), 20U);
  EXPECT_THAT(sequence.folder.read("out/config.toml"), HasSubstr("method = \"paper\""));
  const auto rows = csv_rows(sequence.folder.read("out/frames.csv"));
  ASSERT_EQ(rows.size(), 10U);
  EXPECT_THAT(rows[3], ::testing::Contains(::testing::Pair("status", "tracked")));
  EXPECT_GT(std::stoi(rows[3].at("inliers")), 50);
  EXPECT_LT(std::stod(rows[3].at("rpe_frame_m")), 0.01);

  const auto summary = summary_of(sequence.folder, "out");
  EXPECT_EQ(summary["frames"], 10);
  EXPECT_EQ(summary["tracked"], 10);
  EXPECT_EQ(summary["interrupted"], false);
  EXPECT_EQ(summary["camera"], "small");
  EXPECT_LT(summary["evaluation"]["ate"]["translation_m"]["rmse"].get<double>(), 0.01);
}

TEST(Run, ItsConfigRepeatsIt) {
  const SmallSequence sequence(6);
  EXPECT_EQ(run_cli({"run", sequence.path(), "--method", "none", "--set", "features.count=400", "--out",
                     sequence.path("a")})
                .exit_code,
            0);
  EXPECT_EQ(run_cli({"run", sequence.path(), "--config", sequence.path("a/config.toml"), "--out",
                     sequence.path("b")})
                .exit_code,
            0);
  EXPECT_EQ(sequence.folder.read("a/config.toml"), sequence.folder.read("b/config.toml"));
  EXPECT_EQ(sequence.folder.read("a/trajectory.txt"), sequence.folder.read("b/trajectory.txt"));
}

TEST(Run, ConfigCommandPrintsWhatIsRun) {
  const CliResult result = run_cli({"config", "--config", "fast", "--set", "map.far_depth_m=2.5"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("far_depth_m = 2.5"));
  const TemporaryFolder folder;
  folder.write("mine.toml", result.out);
  EXPECT_EQ(run_cli({"config", "--config", folder.path("mine.toml")}).out, result.out);
}

/// The same frames from memory and from a folder; with one thread, with two, and again.
class Determinism : public ::testing::TestWithParam<const char*> {};

TEST_P(Determinism, SameBytesWhateverTheThreadsAndTheSource) {
  const std::string method = GetParam(), frames = "16", kind = "walking_xyz";
  const TemporaryFolder folder;
  ASSERT_EQ(
      run_cli({"generate", kind, "--frames", frames, "--seed", "3", "--out", folder.path("film")}).exit_code,
      0);
  const auto run = [&](const std::string& source, const char* threads, const std::string& out) {
    const CliResult result =
        run_cli({"run", source, "--method", method, "--frames", frames, "--seed", "3", "--threads", threads,
                 "--set", "tracking.smoother_lag_frames=6", "--out", folder.path(out)});
    EXPECT_EQ(result.exit_code, 0) << result.err;
  };
  run(folder.path("film"), "1", "one");
  run(folder.path("film"), "2", "two");
  run(folder.path("film"), "2", "again");
  run("generated:" + kind, "2", "memory");
  const std::string hash = summary_of(folder, "one")["run_hash"];
  for (const char* other : {"two", "again", "memory"}) {
    EXPECT_EQ(summary_of(folder, other)["run_hash"], hash) << other;
    for (const char* file : {"trajectory.txt", "trajectory_live.txt", "keyframes.txt", "map.ply"})
      EXPECT_EQ(folder.read(std::string(other) + "/" + file), folder.read(std::string("one/") + file))
          << other;
  }
  EXPECT_GT(line_count(folder.read("one/trajectory.txt")), 1U);
}

INSTANTIATE_TEST_SUITE_P(Methods, Determinism, ::testing::Values("none", "paper", "stillpoint"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(Determinism, AnotherSeedIsAnotherSequence) {
  const TemporaryFolder folder;
  for (const char* seed : {"1", "2"})
    ASSERT_EQ(
        run_cli({"generate", "room", "--frames", "1", "--seed", seed, "--out", folder.path(seed)}).exit_code,
        0);
  const std::string first =
      std::filesystem::directory_iterator(folder.path("1/rgb"))->path().filename().string();
  EXPECT_GT(folder.read("1/rgb/" + first).size(), 1000U);
  EXPECT_NE(folder.read("1/rgb/" + first), folder.read("2/rgb/" + first));
}

class Interrupt : public ::testing::TestWithParam<int> {};

TEST_P(Interrupt, KeepsWhatWasDone) {
  constexpr int kMany = 30'000;
  const SmallSequence sequence(4);
  sequence.write_lists(kMany);
  CliProcess process({"run", sequence.path(), "--method", "none", "--out", sequence.path("out")});
  // The program listens to signals before it makes the folder.
  for (int i = 0; i < 600 && !std::filesystem::exists(sequence.path("out")); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  process.send(GetParam());
  const CliResult result = process.wait();
  EXPECT_FALSE(result.by_signal) << "it should end by itself";
  EXPECT_EQ(result.exit_code, 128 + GetParam());
  EXPECT_THAT(result.err, HasSubstr("what was done is kept"));

  const auto summary = summary_of(sequence.folder, "out");
  EXPECT_EQ(summary["interrupted"], true);
  EXPECT_EQ(summary["frames_in_sequence"], kMany);
  EXPECT_LT(summary["frames"], kMany);
  EXPECT_EQ(csv_rows(sequence.folder.read("out/frames.csv")).size(), summary["frames"].get<std::size_t>());
  EXPECT_EQ(line_count(sequence.folder.read("out/trajectory.txt")), summary["tracked"].get<std::size_t>());
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupt, ::testing::Values(SIGINT, SIGTERM));

TEST(FullDisk, StandardOutput) {
  const SmallSequence sequence(2);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"evaluate", sequence.path("groundtruth.txt"),
                                 sequence.path("groundtruth.txt")},
        {"config"},
        {"--help"},
        {"run", sequence.path()},
        {"benchmark", sequence.path()}}) {
    const CliResult result = CliProcess(arguments, places::program(), "/dev/full").wait();
    EXPECT_EQ(result.exit_code, 1) << arguments[0];
    EXPECT_THAT(result.err, HasSubstr("No space left on device")) << arguments[0];
  }
}

TEST(FullDisk, RunFolders) {
  const SmallSequence sequence(2);
  for (const char* file : {"trajectory.txt", "trajectory_live.txt", "keyframes.txt", "frames.csv",
                           "config.toml", "map.ply", "keyframes.ply", "summary.json", "records.bin"}) {
    const std::string out = sequence.path(std::string("out_") + file);
    std::filesystem::create_directory(out);
    std::filesystem::create_symlink("/dev/full", std::filesystem::path(out) / file);
    const CliResult result = run_cli({"run", sequence.path(), "--out", out, "--force"});
    EXPECT_EQ(result.exit_code, 1) << file;
    EXPECT_THAT(result.err, HasSubstr(std::string(file) + ": ")) << file;
    EXPECT_THAT(result.err, HasSubstr("No space left on device")) << file;
    EXPECT_THAT(result.out, HasSubstr("2 of 2 frames tracked")) << "the figures are told all the same";
  }
}

TEST(FullDisk, Tables) {
  const SmallSequence sequence(2);
  std::filesystem::create_directory(sequence.path("out"));
  std::filesystem::create_symlink("/dev/full", sequence.path("out/table1.md"));
  const CliResult result =
      run_cli({"benchmark", sequence.path(), "--methods", "none", "--out", sequence.path("out"), "--force"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("table1.md: cannot be written (No space left on device)"));
}

/// `cmake --install`, and the installed program far from its sources' assets.
TEST(Install, TheInstalledProgramFindsItsOwnAssets) {
  const TemporaryFolder folder;
  const std::string command = fmt::format("'{}' --install '{}' --prefix '{}' > '{}' 2>&1", places::cmake(),
                                          places::build(), folder.path("usr"), folder.path("log"));
  ASSERT_EQ(std::system(command.c_str()), 0) << folder.read("log");
  const std::string program = folder.path("usr/bin/stillpoint");
  EXPECT_TRUE(std::filesystem::exists(folder.path("usr/share/stillpoint/cameras/freiburg1.toml")));

  folder.write("usr/share/stillpoint/presets/own.toml", "[features]\ncount = 777\n");
  const CliResult own = CliProcess({"config", "--config", "own"}, program).wait();
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_THAT(own.out, HasSubstr("count = 777"));

  const SmallSequence sequence(2);
  const CliResult run = CliProcess({"run", sequence.path(), "--config", "paper"}, program).wait();
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace stillpoint
