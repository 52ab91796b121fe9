// What is wrong from the start ends the program with status 1 and one sentence: file, line, found and
// expected.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

/// Both commands that run a method over a sequence.
class Start : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] CliResult start(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {GetParam(), sequence.path()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  [[nodiscard]] CliResult start_with(const std::string& file, const std::string& text) const {
    const std::string before = sequence.folder.read(file);
    sequence.folder.write(file, text);
    CliResult result = start();
    sequence.folder.write(file, before);
    return result;
  }
  SmallSequence sequence{2};
};

TEST_P(Start, Folders) {
  expect_one_sentence(run_cli({GetParam(), sequence.path("none")}), "none: there is no such folder");
  expect_one_sentence(run_cli({GetParam(), ""}), "there is no such folder");
  expect_one_sentence(run_cli({GetParam(), sequence.path("rgb.txt")}),
                      "rgb.txt: is a file, expected a folder");
  expect_one_sentence(run_cli({GetParam(), sequence.path("rgb")}), "has colour frames only");
  std::filesystem::create_directory(sequence.path("empty"));
  expect_one_sentence(run_cli({GetParam(), sequence.path("empty")}),
                      "holds neither rgb.txt nor associations.txt nor images");
}

TEST_P(Start, Lists) {
  expect_one_sentence(start_with("rgb.txt", ""), "rgb.txt");
  expect_one_sentence(start_with("rgb.txt", "# timestamp filename\n"), "rgb.txt");
  expect_one_sentence(start_with("rgb.txt", "100.0 rgb/0.png\nsoon rgb/1.png\n"), "rgb.txt:2: ");
  expect_one_sentence(start_with("rgb.txt", "100.0\n100.1 rgb/0.png\n"), "rgb.txt:1: ");
  expect_one_sentence(start_with("rgb.txt", "nan rgb/0.png\n"), "rgb.txt:1: ");
  expect_one_sentence(start_with("depth.txt", "\n\nwhat is this\n"), "depth.txt:3: ");
  sequence.folder.write("associations.txt", "100.0 rgb/0.png 100.0\n");
  expect_one_sentence(start(), "associations.txt:1: ");
}

TEST_P(Start, ImagesOfWhichNoneCanBeRead) {
  for (int i = 0; i < 2; ++i) sequence.folder.write(sequence.colour(i), "");
  expect_one_sentence(start(), "rgb.txt: none of its 2 images can be read; line 1: ");
}

TEST_P(Start, ColourAlone) {
  std::filesystem::remove(sequence.path("depth.txt"));
  expect_one_sentence(start(), "has colour frames only, and odometry needs depth");
}

TEST_P(Start, GroundTruthOfNoUseCostsTheErrorsAlone) {
  const std::string good = "100.0 0 0 0 0 0 0 1\n";
  const auto goes_on = [&](const std::string& truth, const char* part) {
    const CliResult result = start_with("groundtruth.txt", truth);
    EXPECT_EQ(result.exit_code, 0) << truth;
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_EQ(result.out.find("lost"), std::string::npos) << result.out;
  };
  goes_on(good + "100.1 0 0 nan 0 0 0 1\n", "groundtruth.txt:2: a row of NaN or infinity");
  goes_on(good + "100.1 inf 0 0 0 0 0 1\n", "groundtruth.txt:2: a row of NaN or infinity");
  goes_on(good + "100.1 0 0 0 0 0 0 0\n",
          "groundtruth.txt:2: found a quaternion of length 0, expected length 1");
  goes_on(good + "100.1 0 0 0 0 0 0 2\n",
          "groundtruth.txt:2: found a quaternion of length 2, expected length 1");
  goes_on(good + "100.1 0 0 0\n", "groundtruth.txt:2: found 4 columns");
  goes_on("", "groundtruth.txt: holds no poses");
  goes_on("7.0 0 0 0 0 0 0 1\n", "groundtruth.txt: none of its 1 poses is within 0.02 s of a frame");
}

TEST_P(Start, UnsortedGroundTruthIsMendedWithAWarning) {
  const std::string before = sequence.folder.read("groundtruth.txt");
  const CliResult result = start_with("groundtruth.txt", before + "99.0 0 0 0 0 0 0 1\n99.0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("groundtruth.txt:3: "));
  EXPECT_THAT(result.err, HasSubstr("sorted"));
  EXPECT_THAT(result.err, HasSubstr("groundtruth.txt:4: "));
}

TEST_P(Start, Cameras) {
  expect_one_sentence(start({"--camera", "pinhole"}), "pinhole");
  expect_one_sentence(start({"--camera", sequence.path("none.toml")}), "none.toml");
  const std::string good = sequence.folder.read("camera.toml");
  expect_one_sentence(start_with("camera.toml", "width = 320\n"), "camera.toml");
  expect_one_sentence(start_with("camera.toml", good + "zoom = 3\n"), "camera.toml:14: ");
  expect_one_sentence(start_with("camera.toml", "name = \n" + good), "camera.toml:1: ");
}

TEST_P(Start, Parameters) {
  sequence.folder.write("wrong.toml", "[motion]\n\nerode_kernel_px = 0\n");
  expect_one_sentence(start({"--config", sequence.path("wrong.toml")}),
                      "wrong.toml:3: motion.erode_kernel_px = 0 is out of range");
  expect_one_sentence(start({"--config", "best"}), "there is no preset 'best'; the presets are: ");
  expect_one_sentence(start({"--config", "best"}), " default, ");
  expect_one_sentence(start({"--set", "motion.colour=3"}), "there is no parameter 'motion.colour'");
  expect_one_sentence(start({"--set", "features.count=3"}), "features.count = 3 is out of range");
  expect_one_sentence(start({"--set", "features.count=few"}), "'few' is no value for features.count");
  EXPECT_EQ(start({"--threads", "0"}).exit_code, 2);
  EXPECT_EQ(start({"--frames", "-3"}).exit_code, 2);
  EXPECT_EQ(start({"--seed", "-3"}).exit_code, 2);
  EXPECT_EQ(start({"--colour"}).exit_code, 2);
}

TEST_P(Start, GeneratedKinds) {
  expect_one_sentence(run_cli({GetParam(), "generated:moon"}), "moon");
  expect_one_sentence(run_cli({GetParam(), "generated:"}), "walking_xyz");
}

TEST_P(Start, OutFolders) {
  expect_one_sentence(start({"--out", sequence.path("rgb.txt")}), "rgb.txt: is a file, where a folder");
  expect_one_sentence(start({"--out", sequence.path("rgb.txt/out")}),
                      "rgb.txt/out: the folder cannot be made");
  expect_one_sentence(start({"--out", "/proc/stillpoint"}), "/proc/stillpoint: the folder cannot be made");
}

TEST_P(Start, OutFoldersWithoutRights) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  std::filesystem::create_directory(sequence.path("closed"));
  std::filesystem::permissions(sequence.path("closed"), std::filesystem::perms::owner_read);
  expect_one_sentence(start({"--out", sequence.path("closed")}), "closed: the folder cannot be written to");
}

INSTANTIATE_TEST_SUITE_P(Commands, Start, ::testing::Values("run", "benchmark"),
                         [](const auto& tested) { return std::string(tested.param); });

class BadStart : public ::testing::Test {
 protected:
  SmallSequence sequence{2};
};

TEST_F(BadStart, Methods) {
  expect_one_sentence(run_cli({"run", sequence.path(), "--method", "magic"}),
                      "run.method takes one of: stillpoint, paper, none");
  expect_one_sentence(run_cli({"benchmark", sequence.path(), "--methods", "none,magic"}),
                      "run.method takes one of: stillpoint, paper, none");
  expect_one_sentence(run_cli({"benchmark", sequence.path(), "--methods", "none,none"}),
                      "--methods names none twice");
  expect_one_sentence(run_cli({"run", sequence.path(), "--method", "oracle"}), "there is no mask.txt");
  expect_one_sentence(run_cli({"benchmark", sequence.path(), "--methods", "oracle"}), "there is no mask.txt");
}

TEST_F(BadStart, EarlierRunsAreKeptWithoutForce) {
  const std::vector<std::string> run = {"run", sequence.path(), "--out", sequence.path("out")};
  EXPECT_EQ(run_cli(run).exit_code, 0);
  sequence.folder.write("out/trajectory.txt", "mine");
  expect_one_sentence(run_cli(run), "out: holds earlier results (summary.json); --force overwrites them");
  EXPECT_EQ(sequence.folder.read("out/trajectory.txt"), "mine");
  std::vector<std::string> forced = run;
  forced.emplace_back("--force");
  EXPECT_EQ(run_cli(forced).exit_code, 0);
  EXPECT_NE(sequence.folder.read("out/trajectory.txt"), "mine");
  // Of a run that was killed there are the records alone, and they can be looked at.
  std::filesystem::create_directory(sequence.path("killed"));
  std::filesystem::copy(sequence.path("out/records.bin"), sequence.path("killed/records.bin"));
  expect_one_sentence(run_cli({"run", sequence.path(), "--out", sequence.path("killed")}),
                      "killed: holds earlier results (records.bin); --force overwrites them");
}

TEST_F(BadStart, SomebodysOwnConfigIsKeptWithoutForce) {
  const std::string mine = "# mine\n[run]\nmethod = \"none\"\n";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"run", sequence.path()},
                                                {"motion", sequence.path("rgb"), "--method", "yi2013"}}) {
    sequence.folder.write("out/config.toml", mine);
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--out", sequence.path("out")});
    expect_one_sentence(run_cli(all), "out: holds earlier results (config.toml); --force overwrites them");
    EXPECT_EQ(sequence.folder.read("out/config.toml"), mine);
  }
}

TEST_F(BadStart, ResultsAndSequencesAreKeptApart) {
  const std::string beside = sequence.path(), sentence = "is the sequence itself";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"run", beside},
                                                {"benchmark", beside, "--methods", "none"},
                                                {"sweep", "--parameter", "paper.border_px=1:2:2", beside},
                                                {"ablate", beside},
                                                {"snapshot", beside, "--frames", "0"}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--force", "--out", beside + "/."});
    expect_one_sentence(run_cli(all), sentence);
  }
  EXPECT_FALSE(std::filesystem::exists(sequence.path("summary.json")));
  ASSERT_EQ(run_cli({"run", beside, "--out", sequence.path("run")}).exit_code, 0);
  expect_one_sentence(
      run_cli({"import", beside, "own=" + sequence.path("run/trajectory.txt"), "--force", "--out", beside}),
      sentence);
  const std::string run = sequence.path("run");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"generate", "room", "--frames", "2", "--force", "--out", run},
        {"export", beside, "--force", "--out", run}})
    expect_one_sentence(run_cli(words), "run: holds a finished run; a sequence needs a folder of its own");
  EXPECT_FALSE(std::filesystem::exists(run + "/rgb"));
}

TEST_F(BadStart, EarlierTablesAreKeptWithoutForce) {
  const std::vector<std::string> run = {"benchmark", sequence.path(), "--methods",
                                        "none",      "--out",         sequence.path("out")};
  EXPECT_EQ(run_cli(run).exit_code, 0);
  expect_one_sentence(run_cli(run), "out: holds earlier results (table1.csv); --force overwrites them");
  std::vector<std::string> forced = run;
  forced.emplace_back("--force");
  EXPECT_EQ(run_cli(forced).exit_code, 0);
}

TEST_F(BadStart, TheBenchmarkToldOfABadSequenceStartsNone) {
  expect_one_sentence(
      run_cli({"benchmark", sequence.path(), sequence.path("none"), "--out", sequence.path("out")}),
      "none: there is no such folder");
  EXPECT_FALSE(std::filesystem::exists(sequence.path("out")));
}

TEST_F(BadStart, Generate) {
  const std::string out = sequence.path("new");
  expect_one_sentence(run_cli({"generate", "moon", "--out", out}), "moon");
  expect_one_sentence(run_cli({"generate", "room", "--out", sequence.path("rgb.txt")}), "rgb.txt is a file");
  expect_one_sentence(run_cli({"generate", "room", "--frames", "2", "--out", sequence.path("rgb.txt/new")}),
                      "rgb.txt/new");
  expect_one_sentence(run_cli({"generate", "room", "--frames", "1", "--out", sequence.path()}), "--force");
  expect_one_sentence(run_cli({"generate", "room", "--frames", "-1", "--out", out}), "frames");
  expect_one_sentence(run_cli({"generate", "room", "--frames", "1000000", "--out", out}), "frames");
  EXPECT_EQ(run_cli({"generate", "room", "--seed", "-1", "--out", out}).exit_code, 2);
  EXPECT_EQ(run_cli({"generate", "room"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(BadStart, Motion) {
  const std::string out = sequence.path("out");
  expect_one_sentence(run_cli({"motion", sequence.path("none"), "--out", out}), "none");
  expect_one_sentence(run_cli({"motion", sequence.path(), "--out", sequence.path("rgb.txt/out")}),
                      "rgb.txt/out");
  expect_one_sentence(run_cli({"motion", sequence.path(), "--out", out, "--set", "motion.max_rounds=0"}),
                      "is out of range");
  expect_one_sentence(run_cli({"motion", sequence.path(), "--out", out, "--config", "best"}),
                      "there is no preset 'best'");
  expect_one_sentence(
      run_cli({"motion", sequence.path(sequence.colour(0)), sequence.path("none.png"), "--out", out}),
      "none.png is missing");
  sequence.folder.write(sequence.colour(1), "");
  expect_one_sentence(
      run_cli({"motion", sequence.path(sequence.colour(0)), sequence.path(sequence.colour(1)), "--out", out}),
      "rgb/1.png is empty (0 bytes)");
  const SmallSequence one(1);
  expect_one_sentence(run_cli({"motion", one.path(), "--out", one.path("out")}), "of its 1 frames none");
}

TEST_F(BadStart, UnknownCommandsGetTheUsage) {
  EXPECT_EQ(run_cli({"fly"}).exit_code, 2);
  const CliResult help = run_cli({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command :
       {"run", "generate", "evaluate", "benchmark", "motion", "snapshot", "view", "config"})
    EXPECT_THAT(help.out, HasSubstr(command));
}

}  // namespace
}  // namespace stillpoint
