// A figure measured several times: median, quartiles, and what may be called the best.
#include "core/evaluation/spread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/run/repeats.hpp"

namespace stillpoint {
namespace {

using testing::HasSubstr;

Spread spread(std::initializer_list<double> values) { return spread_of({values.begin(), values.end()}); }

TEST(Spreads, MedianAndQuartilesOfTheRunsThatGaveAFigure) {
  const Spread s = spread_of({4.0, std::nullopt, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.failed, 1);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.lower, 1.75);
  EXPECT_DOUBLE_EQ(s.upper, 3.25);
  EXPECT_EQ(spread_of({std::nullopt}).values.size(), 0U);
}

TEST(Spreads, OnlyWhatSurvivesIsRanked) {
  const Spread good = spread({1.0, 1.1, 1.2}), close = spread({1.05, 1.15, 1.3}),
               bad = spread({3.0, 3.1, 3.2});
  EXPECT_EQ(rank({bad, good}).best, 1U);
  EXPECT_FALSE(rank({bad, good}).second);       // the last of two has nobody to be ahead of
  EXPECT_FALSE(rank({good, close, bad}).best);  // two that overlap: neither
  const Ranking clear = rank({spread({9.0, 9.1}), bad, good});
  EXPECT_EQ(clear.best, 2U);
  EXPECT_EQ(clear.second, 1U);
  EXPECT_FALSE(rank({spread_of({1.0, std::nullopt}), bad}).best);  // it fails at times
  EXPECT_FALSE(rank({}).best);
}

TEST(Spreads, AsTables) {
  const std::vector<SpreadRow> rows = {
      {"walking_xyz", {spread({0.02, 0.02}), spread({0.010, 0.012}), spread({0.5})}},
      {"room", {spread({0.01}), spread_of({std::nullopt}), spread({0.01})}}};
  const std::vector<std::string> methods = {"none", "ours", "other"};
  const std::string markdown = spread_text(rows, methods, "RPE [m]", TableMarkup::markdown);
  EXPECT_THAT(markdown, HasSubstr("**0.0110 ± 0.0005**"));
  EXPECT_THAT(markdown, HasSubstr("_0.0200 ± 0.0000_"));
  EXPECT_THAT(markdown, HasSubstr("–"));
  const std::string latex = spread_text(rows, methods, "RPE [m]", TableMarkup::latex);
  EXPECT_THAT(latex, HasSubstr("\\begin{tabular}{lrrr}\n\\toprule"));
  EXPECT_THAT(
      latex, HasSubstr("walking\\_xyz & \\underline{0.0200 $\\pm$ 0.0000} & \\textbf{0.0110 $\\pm$ 0.0005}"));
  EXPECT_THAT(spread_text(rows, methods, "RPE [m]", TableMarkup::csv),
              HasSubstr("walking_xyz,ours,0.011000,0.010500,0.011500,2,0,0.010000 0.012000\n"));
  const auto json = spread_json(rows, methods);
  ASSERT_EQ(json.size(), 6U);
  EXPECT_TRUE(json[4]["median"].is_null());
  EXPECT_EQ(json[4]["failed"], 1);
  EXPECT_EQ(json[4]["figure"], "RPE 1 s, RMSE");
  EXPECT_EQ(json[4]["unit"], "m");
}

TEST(Spreads, OneRunHasNone) {
  EXPECT_FALSE(rank({spread({1.0}), spread({2.0, 2.1})}).best);
  EXPECT_EQ(rank({spread({3.0}), spread({2.0, 2.1})}).best, 1U);
}

TEST(Spreads, OfABenchmarksRunsByEngineAndMethod) {
  BenchmarkResults results;
  const auto add = [&results](const char* engine, const char* method, int repeat, std::optional<double> rpe,
                              double coverage = 1.0) {
    BenchmarkResult r;
    r.sequence = "s", r.odometry = engine, r.method = method;
    r.repeat = repeat, r.rpe_m = rpe, r.coverage = coverage;
    results.runs.push_back(r);
  };
  add(kItsOwnOdometry, "droid", 0, 0.5);
  for (int k = 0; k < 3; ++k) add("features", "none", k, 0.1 * (k + 1));
  add("dso", "none", 0, 0.4);
  add("dso", "none", 1, 0.2, 0.3);  // half of its frames are lost
  const SpreadTable table = spread_of_runs(results, {"features", "dso"}, {"none", "droid"});
  EXPECT_THAT(table.methods, ::testing::ElementsAre("features, none", "droid", "dso, none"));
  ASSERT_EQ(table.rows.size(), 1U);
  const std::vector<Spread>& cells = table.rows[0].cells;
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_DOUBLE_EQ(cells[0].median, 0.2);
  EXPECT_DOUBLE_EQ(cells[1].median, 0.5);
  EXPECT_EQ(cells[2].values.size(), 1U);
  EXPECT_EQ(cells[2].failed, 1);
}

TEST(Repeats, TheFirstIsTheRunItselfAndNoTwoAreAlike) {
  Config config;
  EXPECT_EQ(perturbed(config, perturbation(0)), config);
  EXPECT_EQ(to_text(perturbation(0)), "as it is");
  std::set<std::pair<int, int>> seen;
  for (int i = 0; i < 9; ++i) {
    const Perturbation by = perturbation(i);
    EXPECT_TRUE(seen.emplace(by.features, by.first_frame).second) << i;
    EXPECT_LE(std::abs(by.features), 10);
    EXPECT_LE(by.first_frame, 2);
  }
  EXPECT_EQ(to_text(perturbation(5)), "features -10, first frame 2, seed +5");
  config.features.count = 1000;
  EXPECT_EQ(perturbed(config, perturbation(5)).features.count, 990);
}

}  // namespace
}  // namespace stillpoint
