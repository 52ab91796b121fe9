// A benchmark's results: gone on with, and the tables of pages that are made of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(BenchmarkResume, MakesOnlyTheRunsThatAreNotThere) {
  const SmallSequence sequence(4);
  const std::vector<std::string> first = {"benchmark",  sequence.path(), "--methods",
                                          "none,paper", "--out",         sequence.path("out")};
  ASSERT_EQ(run_cli(first).exit_code, 0);
  const auto before = nlohmann::json::parse(sequence.folder.read("out/results.json"));
  ASSERT_EQ(before.at("runs").size(), 2U);
  EXPECT_EQ(before.at("runs")[0].at("frames"), 4);
  EXPECT_THAT(before.at("command").get<std::string>(), HasSubstr("stillpoint benchmark "));
  EXPECT_THAT(before.at("config").get<std::string>(), HasSubstr("[features]"));

  expect_one_sentence(run_cli(first), "--force");  // a folder with results is not overwritten unasked
  std::vector<std::string> more = first;
  more[3] = "none,paper,stillpoint";
  more.push_back("--resume");
  const CliResult result = run_cli(more);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("(stillpoint)"));
  EXPECT_THAT(result.err, Not(HasSubstr("(paper)")));
  const auto after = nlohmann::json::parse(sequence.folder.read("out/results.json"));
  ASSERT_EQ(after.at("runs").size(), 3U);
  EXPECT_EQ(after.at("runs")[0], before.at("runs")[0]);  // its times too: it was not run again
  EXPECT_EQ(after.at("runs")[1], before.at("runs")[1]);
  EXPECT_EQ(after.at("runs")[2].at("method"), "stillpoint");

  more.insert(more.end(), {"--set", "features.count=300"});
  expect_one_sentence(run_cli(more), "was made with other parameters");
}

TEST(BenchmarkRepeats, KeepEveryRunAndGoOn) {
  const SmallSequence sequence(40);
  std::vector<std::string> words = {"benchmark", sequence.path(), "--methods",         "none", "--repeat",
                                    "2",         "--out",         sequence.path("out")};
  CliResult result = run_cli(words);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("median of several runs"));
  auto runs = nlohmann::json::parse(sequence.folder.read("out/results.json")).at("runs");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[1].at("repeat"), 1);
  EXPECT_NE(runs[1].at("run_hash"), runs[0].at("run_hash"));
  for (const char* name : {"out/repeats.md", "out/repeats.csv", "out/repeats.tex", "out/repeats.json"})
    EXPECT_TRUE(std::filesystem::exists(sequence.path(name))) << name;
  words[5] = "3";
  words.push_back("--resume");
  result = run_cli(words);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("3 of 3"));
  EXPECT_THAT(result.err, Not(HasSubstr("2 of 3")));
  runs = nlohmann::json::parse(sequence.folder.read("out/results.json")).at("runs");
  EXPECT_EQ(runs.size(), 3U);
}

TEST(BenchmarkOutside, AnotherProgramsRunIsAColumn) {
  const SmallSequence sequence(40);
  ASSERT_EQ(run_cli({"run", sequence.path(), "--method", "none", "--out", sequence.path("run")}).exit_code,
            0);
  std::filesystem::create_directories(sequence.path("droid"));
  const std::string name = std::filesystem::path(sequence.path()).filename().string();
  std::filesystem::copy(sequence.path("run/trajectory.txt"), sequence.path("droid/" + name + ".txt"));
  const std::vector<std::string> words = {"benchmark", sequence.path(),
                                          "--methods", "none",
                                          "--run",     "droid=" + sequence.path("droid") + "/{}.txt",
                                          "--out",     sequence.path("out")};
  const CliResult result = run_cli(words);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("gain: droid"));
  const auto runs = nlohmann::json::parse(sequence.folder.read("out/results.json")).at("runs");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].at("odometry"), "its own");
  EXPECT_NEAR(runs[0].at("rpe_m").get<double>(), runs[1].at("rpe_m").get<double>(), 1e-6);

  expect_one_sentence(
      run_cli({"benchmark", sequence.path(), "--methods", "none", "--run", "droid=nowhere.txt"}),
      "nowhere.txt: there is no such file or folder");
  expect_one_sentence(run_cli({"benchmark", sequence.path(), "--methods", "none", "--run", "paper=a.txt"}),
                      "is called like one of the methods");
}

TEST(BenchmarkTwins, TwoSequencesOfOneNameAreBothRun) {
  const SmallSequence sequence(3);
  for (const char* twin : {"a/twin", "b/twin"}) {
    std::filesystem::create_directories(sequence.path(twin));
    for (const char* part : {"rgb", "depth", "rgb.txt", "depth.txt", "groundtruth.txt", "camera.toml"})
      std::filesystem::copy(sequence.path(part), sequence.path(std::string(twin) + "/" + part),
                            std::filesystem::copy_options::recursive);
  }
  const CliResult result = run_cli({"benchmark", sequence.path("a/twin"), sequence.path("b/twin"),
                                    "--methods", "none", "--out", sequence.path("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto runs = nlohmann::json::parse(sequence.folder.read("out/results.json")).at("runs");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].at("sequence"), "twin");
  EXPECT_EQ(runs[1].at("sequence"), "twin 2");
}

TEST(TablesCommand, MakesAPagesTablesOfItsResultsAndSaysWhereTheyDiffer) {
  const SmallSequence sequence(4);
  ASSERT_EQ(
      run_cli({"benchmark", sequence.path(), "--methods", "none", "--out", sequence.path("out")}).exit_code,
      0);
  sequence.folder.write("page.md",
                        "# Figures\n<!-- table: out/results.json lost -->\n<!-- end of table -->\n");
  const CliResult check = run_cli({"tables", "--check", sequence.path("page.md")});
  EXPECT_EQ(check.exit_code, 1);
  EXPECT_THAT(check.out, HasSubstr("its tables are not those of its results"));
  EXPECT_THAT(sequence.folder.read("page.md"), Not(HasSubstr("frames lost")));

  const CliResult made = run_cli({"tables", sequence.path("page.md")});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(sequence.folder.read("page.md"), HasSubstr("| 0 of 4 |"));
  EXPECT_EQ(run_cli({"tables", "--check", sequence.path("page.md")}).exit_code, 0);

  expect_one_sentence(run_cli({"tables", sequence.path("no_page.md")}), "no_page.md");
  sequence.folder.write("page.md", "<!-- table: camera.toml lost -->\n<!-- end of table -->\n");
  expect_one_sentence(run_cli({"tables", sequence.path("page.md")}), "holds no results of a benchmark");
}

/// Every page of the repository says what its results say.
TEST(TablesCommand, ThePagesTablesAreThoseOfTheirResults) {
  namespace fs = std::filesystem;
  std::vector<std::string> arguments = {"tables", "--check"};
  for (const char* room : {"app", "assets", "core", "tests", "ui"})
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(fs::path(places::source()) / room))
      if (entry.path().extension() == ".md") arguments.push_back(entry.path().string());
  ASSERT_GT(arguments.size(), 20U);
  const CliResult result = run_cli(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
}

TEST(Version, NamesTheProgramAndItsCommit) {
  const CliResult result = run_cli({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, ::testing::MatchesRegex("stillpoint [0-9.]+ \\(commit [-0-9a-z]+\\)\n"));
}

}  // namespace
}  // namespace stillpoint
