#include "core/evaluation/benchmark_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/evaluation/page_tables.hpp"

namespace stillpoint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

BenchmarkResult result(const std::string& sequence, const std::string& engine, const std::string& method,
                       std::optional<double> rpe, double coverage = 1.0) {
  BenchmarkResult r;
  r.sequence = sequence;
  r.odometry = engine;
  r.method = method;
  r.frames = 120;
  r.coverage = coverage;
  r.rpe_m = rpe;
  r.pairs = rpe ? 90 : 0;
  r.median_ms = 4.25;
  r.hash = "0123456789abcdef";
  return r;
}

BenchmarkResults some_results() {
  BenchmarkResults results{"0.1.0",   "abc", "a machine, 2 cores", "2026-01-02", "stillpoint benchmark x",
                           "[run]\n", {}};
  results.runs = {result("generated:walking_xyz", "features", "none", 0.1),
                  result("generated:walking_xyz", "features", "paper", 0.025),
                  result("generated:walking_xyz", "dso", "none", 0.2),
                  result("clip", "features", "none", 0.0123, 0.996),
                  result("clip", "features", "paper", std::nullopt, 0.2)};
  results.runs[1].iou = 0.456;
  results.runs[1].right = 30;
  results.runs[1].wrong = 10;
  return results;
}

std::string page_with(const std::string& request) {
  return "before\n<!-- table: a.json " + request + " -->\nold\n<!-- end of table -->\nafter\n";
}

TableSources sources(const BenchmarkResults& results) {
  const auto named = [](const std::string& file) { EXPECT_EQ(file, "a.json"); };
  return {[=](const std::string& file) { return named(file), results; },
          [=](const std::string& file) {
            return named(file), Table{{"stillpoint", "IoU"}, {{"whole", "0.7"}}};
          },
          [=](const std::string& file) { return named(file), results; }};
}

std::string made(const std::string& request) {
  return with_tables(page_with(request), "page.md", "none", sources(some_results()));
}

TEST(BenchmarkResults, AnotherProgramsRunStandsBehindEveryEngineUnderItsOwnName) {
  BenchmarkResults results = some_results();
  results.runs.push_back(result("clip", kItsOwnOdometry, "droid", 0.00615));
  ASSERT_NE(results.find("clip", "dso", "droid"), nullptr);
  EXPECT_EQ(results.find("clip", "dso", "none"), nullptr);
  const Table table = table_one(results, "features", {"none", "droid"}, "none");
  EXPECT_THAT(table.header, ::testing::IsSupersetOf({"ours: none", "droid", "gain: droid"}));
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[1].back(), "50.0 %");
}

TEST(BenchmarkResults, RepeatsAreTablesOfTheirSpread) {
  BenchmarkResults results = some_results();
  for (int k = 1; k < 3; ++k) {
    results.runs.push_back(result("clip", "features", "none", 0.01));
    results.runs.back().repeat = k;
  }
  const std::string page =
      with_tables(page_with("spread sequences=clip methods=none"), "page.md", "none", sources(results));
  EXPECT_THAT(page, HasSubstr("| clip       | 0.0100 ± 0.0006 |"));
}

TEST(BenchmarkResults, ReadBackAsWritten) {
  const BenchmarkResults results = some_results();
  const BenchmarkResults again = results_from_json(to_json(results).dump(), "a.json");
  EXPECT_EQ(again.version, results.version);
  EXPECT_EQ(again.commit, results.commit);
  EXPECT_EQ(again.machine, results.machine);
  EXPECT_EQ(again.date, results.date);
  EXPECT_EQ(again.command, results.command);
  EXPECT_EQ(again.config, results.config);
  EXPECT_EQ(again.runs, results.runs);
}

TEST(BenchmarkResults, AnotherJsonIsToldInOneSentence) {
  for (const char* text : {"", "[]", "{}", "{\"program\": 3}", "{\"runs\": [{\"sequence\": \"a\"}]}"})
    EXPECT_THAT([text] { (void)results_from_json(text, "a.json"); },
                ThrowsMessage<InputError>(HasSubstr("a.json: holds no results of a benchmark")))
        << text;
}

TEST(BenchmarkResults, TableOneIsOfOneEngine) {
  const Table table = table_one(some_results(), "dso", {"none", "paper"}, "none");
  ASSERT_EQ(table.rows.size(), 2U);  // the one sequence it was run on, and the mean gain
  EXPECT_THAT(table.rows[0], ElementsAre("generated:walking_xyz", "0.819595", "0.105852", "0.032000",
                                         "0.232600", "87.1 %", "0.200000", "–", "–"));
}

TEST(PageTables, HoldARowASequenceAndAColumnAMethod) {
  EXPECT_EQ(made("rpe odometry=features"),
            "before\n<!-- table: a.json rpe odometry=features -->\n\n"
            "| RPE 1 s, m  |          none |  paper |\n"
            "|:------------|--------------:|-------:|\n"
            "| walking_xyz |        0.1000 | 0.0250 |\n"
            "| clip        | 0.0123 (99 %) |   lost |\n"
            "\n<!-- end of table -->\nafter\n");
}

TEST(PageTables, ColumnsOfSeveralEnginesNameThem) {
  EXPECT_THAT(made("rpe methods=none sequences=generated:*"),
              HasSubstr("| RPE 1 s, m  | features, none | dso, none |\n"
                        "|:------------|---------------:|----------:|\n"
                        "| walking_xyz |         0.1000 |    0.2000 |\n\n"));
}

TEST(PageTables, TellGainsMasksAndWhatTheyWereMadeBy) {
  EXPECT_THAT(made("gain methods=paper odometry=features names=long"),
              HasSubstr("| generated:walking_xyz  |  75 % |"));
  EXPECT_THAT(made("iou methods=paper odometry=features"), HasSubstr("| walking_xyz |  0.46 |"));
  EXPECT_THAT(made("right methods=paper odometry=features"), HasSubstr("| walking_xyz     |  75 % |"));
  EXPECT_THAT(made("lost methods=paper odometry=features"), HasSubstr("| clip        | 96 of 120 |"));
  EXPECT_THAT(made("published odometry=features"), HasSubstr("ORB-SLAM2 VO"));
  EXPECT_THAT(made("ablation"), HasSubstr("| whole      | 0.7 |"));
  EXPECT_THAT(made("made"),
              HasSubstr("\n*Made by stillpoint 0.1.0 at commit abc, on 2026-01-02, a machine, 2 cores, by "
                        "`stillpoint benchmark x`.*\n"));
}

TEST(PageTables, MadeAgainTheyAreTheSame) {
  const std::string once = made("rpe");
  EXPECT_NE(once, page_with("rpe"));
  EXPECT_EQ(with_tables(once, "page.md", "none", sources(some_results())), once);
  EXPECT_EQ(with_tables("no table\n", "page.md", "none", sources(some_results())), "no table\n");
}

TEST(PageTables, WhatIsNotThereIsNamed) {
  const auto fails = [](const std::string& request, const std::string& why) {
    EXPECT_THAT([&] { (void)made(request); }, ThrowsMessage<InputError>(HasSubstr(why))) << request;
  };
  fails("speed", "page.md: a table asks for 'speed'; there are ate, gain, iou");
  fails("", "a table names its results and what of them");
  fails("rpe methods=papre", "asks for method 'papre'; its results have none, paper");
  fails("rpe odometry=bamvo", "asks for odometry 'bamvo'; its results have features, dso");
  fails("rpe sequences=cup", "asks for sequences that it has none of");
  fails("rpe colour=red", "asks for 'colour=red'; it may choose methods=");
  EXPECT_THAT(
      [] { (void)with_tables("<!-- table: a.json rpe -->\n", "page.md", "none", sources(some_results())); },
      ThrowsMessage<InputError>(HasSubstr("a table begins and has no '<!-- end of table -->'")));
}

}  // namespace
}  // namespace stillpoint
