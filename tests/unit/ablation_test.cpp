#include "core/run/ablation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

AblationCell cell(std::optional<double> rpe_m, std::optional<double> iou, double ms, std::string hash) {
  return {rpe_m, iou, 1.0, ms, std::move(hash)};
}

TEST(Ablation, EveryIngredientChangesTheConfigAndNothingElse) {
  const Config whole = ablated({}, nullptr);
  const MethodInfo& method = method_of(whole);
  std::set<std::string> names;
  const std::vector<Ingredient> all = ingredients(method);
  ASSERT_EQ(all.size(), 21U);
  for (const Ingredient& one : all) {
    const Config without = ablated({}, &one);
    EXPECT_FALSE(without == whole) << one.name;
    EXPECT_EQ(without.run, whole.run) << one.name;
    EXPECT_FALSE(one.help.empty());
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    // Its values are in range, and another config's constants stay.
    Config other;
    other.features.count = 321;
    EXPECT_EQ(ablated(other, &one).features.count, 321);
  }
  EXPECT_THROW((void)ingredient_by_name(method, "luck"), InputError);
  EXPECT_EQ(ingredient_by_name(method, "prior").name, "prior");
}

TEST(Ablation, ChangesAreAgainstTheWholeMethod) {
  const AblationRow whole{
      "", {}, {cell(0.010, 0.8, 10, "a"), cell(0.020, std::nullopt, 12, "b"), cell({}, 0.5, 14, "c")}};
  const AblationRow without{
      "prior", {}, {cell(0.020, 0.6, 8, "x"), cell(0.010, std::nullopt, 8, "b"), cell(0.5, 0.4, 8, "z")}};
  const AblationChange change = change_of(without, whole);
  // Twice and half: the geometric mean is no change at all.
  ASSERT_TRUE(change.mean && change.worst && change.mask_iou);
  EXPECT_NEAR(*change.mean, 0.0, 1e-12);
  EXPECT_NEAR(*change.worst, 1.0, 1e-12);
  EXPECT_EQ(change.worst_sequence, 0U);
  EXPECT_NEAR(*change.mask_iou, -0.15, 1e-12);
  EXPECT_NEAR(change.median_ms, 8.0, 1e-12);
  EXPECT_EQ(change.unchanged, 0) << "the same frames, but poses looked back at otherwise";
  EXPECT_EQ(change_of(whole, whole).unchanged, 3);
}

TEST(Ablation, NothingToCompareIsSaidSo) {
  const AblationRow whole{"", {}, {cell({}, {}, 1, "a")}}, without{"prior", {}, {cell({}, {}, 1, "b")}};
  const AblationChange change = change_of(without, whole);
  EXPECT_FALSE(change.mean || change.worst || change.mask_iou);
  const Table table = ablation_summary("stillpoint", {whole, without}, {"room"});
  EXPECT_THAT(table.rows.at(1),
              ::testing::ElementsAre("without prior", "–", "–", "–", "–", "–", "100.0 %", "1.0", "0 of 1"));
  EXPECT_TRUE(ablation_summary("stillpoint", {{"", {}, {}}, {"prior", {}, {}}}, {}).rows.size() == 2);
}

TEST(Ablation, TablesHoldEveryRun) {
  std::vector<AblationRow> rows = {{"", {}, {cell(0.01, 0.8, 10, "a"), cell(0.02, {}, 12, "b")}},
                                   {"prior", {}, {cell(0.03, 0.6, 8, "x"), cell(0.04, {}, 8, "y")}}};
  const std::vector<std::string> sequences = {"one", "two"};
  rows[0].cells[0].pairs = rows[1].cells[0].pairs = 7;
  rows[0].cells[1].pairs = 11, rows[1].cells[1].pairs = 4;
  const Table errors = ablation_errors(rows, sequences);
  EXPECT_THAT(errors.header,
              ::testing::ElementsAre("RPE 1 s, RMSE [m]", "pairs", "whole method", "without prior"));
  EXPECT_THAT(errors.rows.at(0), ::testing::ElementsAre("one", "7", "0.0100", "0.0300"));
  EXPECT_THAT(errors.rows.at(1), ::testing::ElementsAre("two", "4-11", "0.0200", "0.0400"));
  EXPECT_EQ(ablation_cell_from_json(to_json(rows[1].cells[1]).dump(), "it").pairs, 4U);
  const Table list = ablation_list(rows, sequences);
  ASSERT_EQ(list.rows.size(), 4U);
  for (const auto& row : list.rows) EXPECT_EQ(row.size(), list.header.size());
  EXPECT_THAT(list.rows.at(2),
              ::testing::ElementsAre("one", "prior", "0.030000", "0.6000", "1.0000", "8.00", "x", "7"));
  const Provenance made{"1.2", "abc", "two cores", "2026-01-02", "stillpoint ablate one two"};
  const auto json = ablation_json("stillpoint", rows, sequences, made);
  EXPECT_TRUE(json["variants"][0]["without"].is_null());
  EXPECT_EQ(json["variants"][1]["runs"][1]["rpe_m"], 0.04);
  EXPECT_TRUE(json["variants"][1]["runs"][1]["iou"].is_null());
  // (3 * 2)^(1/2) - 1
  EXPECT_NEAR(json["variants"][1]["rpe_mean_change"].get<double>(), std::sqrt(6.0) - 1.0, 1e-12);
}

TEST(Ablation, WhatHasNoRpeOverASecondHasItOverAFrameAndSaysWhy) {
  std::vector<AblationRow> rows = {{"", {}, {cell({}, {}, 1, "a")}}, {"prior", {}, {cell({}, {}, 1, "b")}}};
  for (AblationRow& row : rows) row.cells[0].why_no_rpe = "it is short";
  rows[0].cells[0].rpe_frame_m = 0.00125;
  rows[1].cells[0].doubt = "it drifts";
  const Table errors = ablation_errors(rows, {"one"});
  EXPECT_EQ(errors.header[0], "RPE 1 frame, RMSE [m]");
  EXPECT_THAT(errors.rows.at(0), ::testing::ElementsAre("one", "0.00125", "–"));
  EXPECT_EQ(notes_text(notes_on(rows, {"one"})),
            "- no RPE over 1 s: it is short (one, whole method; one, without prior)\n"
            "- one, without prior: it drifts\n");
  const AblationCell read = ablation_cell_from_json(to_json(rows[1].cells[0]).dump(), "it");
  EXPECT_EQ(read.doubt, "it drifts");
  EXPECT_EQ(read.why_no_rpe, "it is short");
}

TEST(Notes, AreAsManyAsFitAScreen) {
  EXPECT_EQ(notes_text({{"one", "", ""}, {"two", "", ""}}), "");
  const std::string text = notes_text(std::vector<RunNote>(30, {"run", "short", "off"}));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 22);
  EXPECT_THAT(text, ::testing::HasSubstr("- no RPE over 1 s: short (30 runs)\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("- 10 more runs are to be doubted\n"));
}

TEST(Ablation, IsReadBackAndSaysWhatItWasMadeBy) {
  std::vector<AblationRow> rows = {{"", {}, {cell(0.01, 0.8, 10, "a"), cell(0.02, {}, 12, "b")}},
                                   {"prior", {}, {cell(0.03, 0.6, 8, "x"), cell(0.04, {}, 8, "y")}}};
  const std::vector<std::string> sequences = {"one", "two"};
  const Provenance made{"1.2", "abc", "two cores", "2026-01-02", "stillpoint ablate one two"};
  const TemporaryFolder folder;
  folder.write("ablation.json", ablation_json("stillpoint", rows, sequences, made).dump());
  const Ablation read = read_ablation(folder.path("ablation.json"));
  EXPECT_EQ(read.sequences, sequences);
  EXPECT_EQ(to_csv(read.summary()), to_csv(ablation_summary("stillpoint", rows, sequences)));
  EXPECT_EQ(provenance_from_json(folder.read("ablation.json"), "it").command, made.command);

  folder.write("none.json", R"({"method": "stillpoint", "variants": []})");
  EXPECT_THROW((void)read_ablation(folder.path("none.json")), InputError);
  EXPECT_THROW((void)provenance_from_json(folder.read("none.json"), "it"), InputError);
}

}  // namespace
}  // namespace stillpoint
