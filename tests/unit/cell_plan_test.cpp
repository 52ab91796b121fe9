// Plans of cells, their records, and how they are merged.
#include "core/run/cell_plan.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/run/ablation.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Two methods on so many sequences, three repeats each.
CellPlan plan_of_sequences(int sequences) {
  CellPlan plan;
  plan.kind = "benchmark";
  plan.version = "0.1.0", plan.commit = "0123abcdef", plan.command = "stillpoint benchmark …";
  plan.config = "[run]\nseed = 1\n";
  plan.engines = {"features"}, plan.methods = {"none", "paper"};
  plan.repeated = true;
  for (int i = 0; i < sequences; ++i) {
    const std::string name = fmt::format("room {}", i);
    plan.sequences.push_back({name, "/data/" + name, name, {"depth_scale=1000"}});
    for (const std::string& method : plan.methods)
      for (int repeat = 0; repeat < 3; ++repeat)
        plan.cells.push_back({name, "features", method, repeat, "", 100 - repeat});
  }
  return plan;
}

CellRecord good_record(const CellPlan& plan, int cell) {
  CellRecord record{cell, plan.fingerprint(), plan.commit, "a machine"};
  record.json = fmt::format("{{\"rpe_m\":0.{}1}}", cell);
  return record;
}

TEST(CellPlans, AreReadAsTheyWereWritten) {
  CellPlan plan = plan_of_sequences(2);
  plan.replaces = true;
  plan.cells.push_back({"room 1", "features", "paper", 0, "huber", 100});
  plan.known.push_back({plan.cells[3], "{\"rpe_m\":0.10000000000000001}"});
  const std::string text = to_json_text(plan);
  const CellPlan read = plan_from_json(text, "plan.json");
  EXPECT_EQ(to_json_text(read), text);
  EXPECT_EQ(read.cells, plan.cells);
  EXPECT_EQ(read.sequences, plan.sequences);
  EXPECT_EQ(read.cells.back().without, "huber");
  EXPECT_EQ(nlohmann::json::parse(read.known.at(0).json).at("rpe_m"), 0.1);
  EXPECT_TRUE(read.replaces && read.repeated);
  // A row a cell: a person reads it, and a tool compares it.
  EXPECT_THAT(text, HasSubstr("\n    {\"sequence\":\"room 1\",\"odometry\":\"features\",\"method\":\"paper\","
                              "\"repeat\":2,\"frames\":98},\n"));
}

TEST(CellPlans, AreKnownByWhatDecidesTheirResults) {
  const CellPlan plan = plan_of_sequences(2);
  CellPlan other = plan;
  other.command = "stillpoint benchmark … --resume";
  other.known.push_back({plan.cells[0], "{}"});
  EXPECT_EQ(other.fingerprint(), plan.fingerprint());
  const auto changed = [&plan](auto change) {
    CellPlan one = plan;
    change(one);
    return one.fingerprint() != plan.fingerprint();
  };
  EXPECT_TRUE(changed([](CellPlan& one) { one.commit = "0123abcdee"; }));
  EXPECT_TRUE(changed([](CellPlan& one) { one.config += "# more\n"; }));
  EXPECT_TRUE(changed([](CellPlan& one) { one.kind = "ablate"; }));
  EXPECT_TRUE(changed([](CellPlan& one) { one.sequences[0].reading = {"depth_scale=5000"}; }));
  EXPECT_TRUE(changed([](CellPlan& one) { std::swap(one.cells[0], one.cells[1]); }));
}

TEST(CellPlans, SayWhatIsWrongWithThem) {
  const TemporaryFolder folder;
  EXPECT_THAT(input_error_of([&] { (void)read_plan(folder.path()); }), HasSubstr("holds no plan.json"));
  EXPECT_THAT(input_error_of([] { (void)plan_from_json("{}", "plan.json"); }),
              HasSubstr("plan.json: is no plan of cells"));
  CellPlan plan = plan_of_sequences(1);
  plan.cells[2].sequence = "another";
  EXPECT_THAT(input_error_of([&] { (void)plan_from_json(to_json_text(plan), "plan.json"); }),
              HasSubstr("a cell is of sequence 'another', which the plan does not have"));
  EXPECT_THAT(input_error_of([&] { throw_if_other_build(plan, "fedcba", "out"); }),
              HasSubstr("another build (commit 0123abcdef; this one is fedcba)"));
}

TEST(CellMerge, ThousandsOfCellsComeInThePlansOrderWhoeverEndedFirst) {
  const TemporaryFolder folder;
  const CellPlan plan = plan_of_sequences(500);
  ASSERT_EQ(plan.cells.size(), 3000U);
  write_plan(folder.path(), plan);
  const std::string fingerprint = plan.fingerprint();
  // The last first; one crashed, one was killed on the way, one has not begun.
  for (int cell = 2999; cell >= 0; --cell) {
    if (cell == 1002) continue;
    folder.write(cell_log_name(cell), std::string("== began\n"));
    if (cell == 1001) continue;
    CellRecord record{cell, fingerprint, plan.commit, cell < 2000 ? "the first" : "the second"};
    record.json = fmt::format("{{\"number\":{}}}", cell);
    if (cell == 1000) record.status = 139, record.said = "frame 3", record.json.clear();
    write_record(folder.path(), record);
  }
  const CellPlan read = read_plan(folder.path());
  const CellRecords records = read_records(folder.path(), read);
  EXPECT_THAT(missing_cells(read, records), ElementsAre(1000, 1001, 1002));
  const MergedCells merged = merge_cells(read, records);
  EXPECT_FALSE(merged.whole);
  ASSERT_EQ(merged.results.size(), 2997U);
  for (std::size_t i = 0; i < merged.results.size(); ++i) {
    const std::size_t cell = i < 1000 ? i : i + 3;
    ASSERT_EQ(merged.results[i].cell, plan.cells[cell]);
    ASSERT_EQ(merged.results[i].json, fmt::format("{{\"number\":{}}}", cell));
  }
  EXPECT_THAT(merged.machines, ElementsAre("the first", "the second"));
  ASSERT_EQ(merged.missing.size(), 3U);
  EXPECT_EQ(merged.missing[0].log, "cells/001000.log");
  EXPECT_EQ(why_missing(merged.missing[0]), "exit status 139 (signal 11)");
  EXPECT_EQ(why_missing(merged.missing[1]), "has not ended");
  EXPECT_EQ(why_missing(merged.missing[2]), "has not begun");
  const std::string text = missing_text(merged.missing, plan.cells.size());
  EXPECT_THAT(text, HasSubstr("Of 3000 runs, 3 have no result:"));
  EXPECT_THAT(text, HasSubstr("frame 3"));
}

TEST(CellMerge, WhatIsKnownIsNotRunAgain) {
  const TemporaryFolder folder;
  CellPlan plan = plan_of_sequences(1);
  const PlanCell outside{"room 0", "its own", "droid", 0, "", 100};
  plan.known = {{plan.cells[4], "{\"number\":40}"}, {outside, "{\"number\":50}"}};
  write_plan(folder.path(), plan);
  for (const int cell : {0, 1, 2, 3}) write_record(folder.path(), good_record(plan, cell));
  CellRecords records = read_records(folder.path(), plan);
  EXPECT_THAT(missing_cells(plan, records), ElementsAre(5));
  CellRecord failed{5, plan.fingerprint(), plan.commit, "a machine", 1, "there is no such folder"};
  write_record(folder.path(), failed);
  records = read_records(folder.path(), plan);
  EXPECT_THAT(missing_cells(plan, records), ElementsAre(5)) << "a cell that failed is run again";
  MergedCells merged = merge_cells(plan, records);
  EXPECT_TRUE(merged.whole) << "it has ended all the same";
  ASSERT_EQ(merged.results.size(), 6U);
  EXPECT_EQ(merged.results[0].cell, outside) << "what is none of the plan's comes first";
  EXPECT_EQ(merged.results[5].json, "{\"number\":40}");
  EXPECT_EQ(merged.missing.at(0).said, "there is no such folder");
  write_record(folder.path(), good_record(plan, 5));
  records = read_records(folder.path(), plan);
  merged = merge_cells(plan, records);
  EXPECT_THAT(missing_cells(plan, records), IsEmpty());
  EXPECT_THAT(merged.missing, IsEmpty());
  EXPECT_EQ(missing_text(merged.missing, 6), "");
}

TEST(CellMerge, RefusesWhatIsOfAnotherPlanOrBuild) {
  const TemporaryFolder folder;
  const CellPlan plan = plan_of_sequences(1);
  write_plan(folder.path(), plan);
  const auto refusal = [&] { return input_error_of([&] { (void)read_records(folder.path(), plan); }); };
  CellRecord record = good_record(plan, 2);
  record.commit = "fedcba";
  write_record(folder.path(), record);
  EXPECT_THAT(refusal(),
              HasSubstr("000002.json: was made by another build (commit fedcba) than the plan (0123abcdef)"));
  record = good_record(plan, 2);
  record.plan = "0000000000000000";
  write_record(folder.path(), record);
  EXPECT_THAT(refusal(), HasSubstr("000002.json: is of another plan"));
  folder.write(cell_record_name(2), std::string("{\"cell\""));
  EXPECT_THAT(refusal(), HasSubstr("000002.json: is no record of a cell"));
  write_record(folder.path(), good_record(plan, 2));
  CellRecord odd{1, plan.fingerprint(), plan.commit, "a machine", 1, "no \xff.png"};
  EXPECT_EQ(record_from_json(to_json_text(odd), "a record").said, "no \xEF\xBF\xBD.png")
      << "logs may hold any bytes";
  folder.write("cells/000004.json.part_node_17", std::string("half"));  // is being written by another
  EXPECT_THAT(missing_cells(plan, read_records(folder.path(), plan)), ElementsAre(0, 1, 3, 4, 5));
}

TEST(CellMerge, APlanMadeAnewKeepsItsRecordsAndTakesAwayAnothers) {
  const TemporaryFolder folder;
  CellPlan plan = plan_of_sequences(1);
  write_plan(folder.path(), plan);
  write_record(folder.path(), good_record(plan, 2));
  plan.command = "typed again";
  write_plan(folder.path(), plan);
  EXPECT_TRUE(read_record(folder.path(), plan, plan.fingerprint(), 2));
  plan.config += "# changed\n";
  write_plan(folder.path(), plan);
  EXPECT_FALSE(std::filesystem::exists(folder.path(cell_record_name(2))));
  write_record(folder.path(), good_record(plan, 2));
  remove_plan(folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder.path(cell_record_name(2))));
  EXPECT_FALSE(std::filesystem::exists(folder.path(kPlanName)));
}

TEST(CellMerge, MissingRunsAreAmongTheResults) {
  BenchmarkResults results;
  EXPECT_THAT(to_json(results).dump(), Not(HasSubstr("missing")));
  results.missing.push_back({"room", "features", "paper", 2, "", 139, "cells/000007.log", "frame 3"});
  results.missing.push_back({"room", "features", "none", 0});
  EXPECT_EQ(results_from_json(to_json(results).dump(), "results.json").missing, results.missing);
}

TEST(CellMerge, CellsOfAnAblationAreReadAsTheyWereWritten) {
  const AblationCell cell{0.0123456789012345, std::nullopt, 0.5, 12.25, "0123"};
  const AblationCell read = ablation_cell_from_json(to_json(cell).dump(), "a cell");
  EXPECT_EQ(read.rpe_m, cell.rpe_m);
  EXPECT_EQ(read.mask_iou, cell.mask_iou);
  EXPECT_EQ(to_json(read), to_json(cell));
  EXPECT_THAT(input_error_of([] { (void)ablation_cell_from_json("{}", "a cell"); }),
              HasSubstr("a cell: is no result of an ablation"));
}

}  // namespace
}  // namespace stillpoint
