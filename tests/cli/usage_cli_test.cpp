// What is said of a command line: status 2 where it is wrong by itself, 1 where what it names is, and one of
// a thing is one thing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using Line = std::vector<std::string>;

TEST(Usage, ColumnsOfATableDoNotRunTogether) {
  const SmallSequence sequence(4);
  // A trajectory in micrometres, and the widest name of an error.
  std::string far;
  for (int i = 0; i < 4; ++i)
    far += std::to_string(sequence.stamp(i)) + " " + std::to_string(1e5 * i * i) + " 0 " +
           std::to_string(2e5 * i) + " 0 0 0 1\n";
  sequence.folder.write("far.txt", far);
  const CliResult table =
      run_cli({"evaluate", sequence.path(), sequence.path("far.txt"), "--protocol", "tum"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("RPE random pairs translation m "));
  std::istringstream lines(table.out);
  int rows = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("ATE ") || line.starts_with("RPE random")) {
      ++rows;
      EXPECT_TRUE(std::regex_search(line, std::regex(R"( +\d+( +\d+\.\d{5}){6}$)"))) << line;
    }
  EXPECT_EQ(rows, 4);
}

class WrongByItself : public ::testing::TestWithParam<Line> {};

TEST_P(WrongByItself, EndsWithStatus2) { expect_usage_error(run_cli(GetParam()), ""); }

INSTANTIATE_TEST_SUITE_P(Missing, WrongByItself,
                         ::testing::Values(Line{"run"}, Line{"evaluate", "a"}, Line{"snapshot", "a"},
                                           Line{"manual"}, Line{"motion", "a"}, Line{"export", "a"},
                                           Line{"import", "a", "b"}, Line{"figures", "a"},
                                           Line{"report", "a"}, Line{"generate", "room"}, Line{"sweep", "a"},
                                           Line{"cells", "a"}, Line{"merge"},
                                           Line{"benchmark", "a", "--jobs", "2"}));
INSTANTIATE_TEST_SUITE_P(
    Contradicting, WrongByItself,
    ::testing::Values(Line{"snapshot", "a", "--out", "b", "--panels", "mask", "--fps", "5"},
                      Line{"export", "a", "--out", "b", "--voxel", "0.1"},
                      Line{"export", "a", "--to", "b.mcap", "--length", "3"},
                      Line{"export", "a", "--to", "b.ply", "--layers", "difference"},
                      Line{"motion", "a.png", "b.png", "--method", "paper", "--frames", "1:3", "--out", "c"},
                      Line{"run", "a", "--frames", "0"}, Line{"run", "a", "--no-such-option"}));
INSTANTIATE_TEST_SUITE_P(Empty, WrongByItself,
                         ::testing::Values(Line{"run", "a", "--out", ""}, Line{"run", "a", "--out="},
                                           Line{"benchmark", "a", "--methods", ""},
                                           Line{"snapshot", "--out", "", "a"}));

TEST(Usage, WhatIsNamedAndIsNotThereIsNoFaultOfTheLine) {
  const SmallSequence sequence(2);
  for (const Line& line :
       {Line{"run", sequence.path("nowhere")}, Line{"run", sequence.path(), "--method", "best"},
        Line{"run", sequence.path(), "--camera", "mine"},
        Line{"evaluate", sequence.path("a.txt"), sequence.path("b.txt")}})
    EXPECT_EQ(run_cli(line).exit_code, 1) << line.back();
  // A parameter may well be empty.
  EXPECT_EQ(run_cli({"run", sequence.path(), "--method", "none", "--set=masks.sources="}).exit_code, 0);
  const CliResult empty = run_cli({"run", sequence.path(), "--out", ""});
  expect_usage_error(empty, "--out: its value is empty");
}

/// The places where a text counts one thing as several: "1 frames", "1 map points".
std::vector<std::string> miscounted(const std::string& text) {
  static const std::regex one(R"((^|[^0-9.,:/a-zA-Z])1 ((map|estimated|matched) )?[a-z]+s\b)");
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), one), end; at != end; ++at) {
    const std::string word = at->str().substr(at->str().rfind(' ') + 1);
    if (word != "is" && word != "was" && word != "has" && word != "ms") found.push_back(at->str());
  }
  return found;
}

TEST(Counting, OneOfAThingIsOne) {
  EXPECT_THAT(miscounted("1 frames, 21 frames, 1.1 poses, RPE 1 s, over 1 map points; 1 is"),
              ::testing::ElementsAre("1 frames", " 1 map points"));
  const SmallSequence sequence(1);
  const std::string run = sequence.path("run"), theirs = sequence.path("theirs"),
                    truth = sequence.path("groundtruth.txt");
  const std::vector<Line> lines = {
      {"run", sequence.path(), "--method", "none", "--out", run, "--mcap", sequence.path("a.mcap")},
      {"run", sequence.path(), "--method", "none", "--break", "inliers < 1000"},
      {"check", sequence.path()},
      {"check", sequence.path(), truth},
      {"evaluate", sequence.path(), truth},
      {"import", sequence.path(), "theirs=" + truth, "--out", theirs},
      {"snapshot", sequence.path(), "--method", "none", "--frames", "0", "--panels", "input", "--out",
       sequence.path("p")},
      {"snapshot", run, "--when", "inliers > 1000", "--panels", "input", "--out", sequence.path("q")},
      {"export", sequence.path(), "--out", sequence.path("e")},
      {"export", run, "--to", sequence.path("b.mcap")},
      {"export", run, "--to", sequence.path("map.ply")},
      {"export", run, "--without-movers", sequence.path("w")},
      {"generate", "room", "--frames", "1", "--out", sequence.path("g")},
      {"report", run, "--out", sequence.path("r.html")},
      {"report", run, "--interactive", "--out", sequence.path("l.html")},
      {"motion", sequence.path(sequence.colour(0)), sequence.path(sequence.colour(0)), "--out",
       sequence.path("m")},
  };
  for (const Line& line : lines) {
    const CliResult said = run_cli(line);
    EXPECT_NE(said.exit_code, 2) << line[0] << ": " << said.err;
    EXPECT_THAT(miscounted(said.out + "\n" + said.err), ::testing::IsEmpty())
        << line[0] << ": " << said.out << said.err;
  }
  EXPECT_TRUE(std::filesystem::exists(sequence.path("r.html")));
}

}  // namespace
}  // namespace stillpoint
