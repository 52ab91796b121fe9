#include "core/evaluation/tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillpoint {
namespace {

using testing::ElementsAre;

TEST(Tables, MarkdownIsPaddedAndEscaped) {
  const Table table = {{"name", "x"}, {{"a|b", "1"}, {"–", "12345"}}};
  EXPECT_EQ(to_markdown(table),
            "| name |     x |\n"
            "|:-----|------:|\n"
            "| a\\|b |     1 |\n"
            "| –    | 12345 |\n");
}

TEST(Tables, CsvQuotesWhatNeedsIt) {
  EXPECT_EQ(to_csv({{"a", "b"}, {{"1,5", "say \"x\""}, {"", "2"}}}), "a,b\n\"1,5\",\"say \"\"x\"\"\"\n,2\n");
}

TEST(PublishedTable, IsFoundByName) {
  for (const char* name :
       {"fr3_walking_xyz", "rgbd_dataset_freiburg3_walking_xyz", "generated:walking_xyz", "walking_xyz"}) {
    ASSERT_TRUE(published_row(name)) << name;
    EXPECT_EQ(published_row(name)->paper, 0.105852);
  }
  EXPECT_EQ(published_row("generated:desk_with_person")->sequence, "fr2_desk_with_person");
  EXPECT_FALSE(published_row("walking_rpy")->ref7);
  for (const char* name :
       {"room", "generated:cup", "rgbd_dataset_freiburg3_walking_xyz_validation", "xyz", ""})
    EXPECT_FALSE(published_row(name)) << name;
  EXPECT_EQ(published_table().size(), 9U);
}

TEST(TableOne, SetsOursBesideThePublished) {
  const Table table =
      table_one({{"generated:walking_static", {{"none", 0.4, 1.0, 50}, {"paper", 0.1, 0.9996, 50}}},
                 {"room", {{"none", 0.02, 1.0, 50}, {"paper", 0.025, 1.0, 50}}},
                 {"generated:walking_rpy", {{"none", std::nullopt, 0.01, 0}}}},
                {"none", "paper"}, "none");
  EXPECT_THAT(table.header,
              ElementsAre("RPE 1 s, RMSE [m]", "ORB-SLAM2 VO", "paper, published", "Gao 2019, quoted",
                          "BaMVO, quoted", "published gain", "ours: none", "ours: paper", "gain: paper"));
  ASSERT_EQ(table.rows.size(), 4U);
  EXPECT_THAT(table.rows[0],
              ElementsAre("generated:walking_static", "0.463615", "0.056029", "0.010200", "0.133900",
                          "87.9 %", "0.400000", "0.100000 (99.9 % of frames)", "75.0 %"));
  EXPECT_THAT(table.rows[1], ElementsAre("room", "–", "–", "–", "–", "–", "0.020000", "0.025000", "-25.0 %"));
  EXPECT_THAT(table.rows[2], ElementsAre("generated:walking_rpy", "0.912968", "0.612395", "lost", "0.358400",
                                         "32.9 %", "lost", "–", "–"));
  EXPECT_THAT(table.rows[3], ElementsAre("mean gain", "", "", "", "", "60.4 %", "", "", "25.0 %"));
}

TEST(TableOne, WhatPublishedFiguresAreOfIsTold) {
  EXPECT_EQ(published_notes({"room", "rgbd_dataset_freiburg3_walking_xyz", "fr3_sitting_xyz"}), "");
  EXPECT_EQ(
      published_notes({"walking_xyz", "room", "generated:walking_rpy"}),
      "- published figures beside walking_xyz, generated:walking_rpy are of TUM's sequences of these names, "
      "not of these frames\n");
  EXPECT_EQ(published_notes({"fr3_sitting_static"}),
            "- BaMVO's 0.015700 on sitting_static is as Niu & Li quote it; Xu et al. (2022) give 0.0248, and "
            "0.0157 "
            "is DVO's\n");
}

TEST(TableOne, PublishedGainsAverageToThePapersFigure) {
  std::vector<BenchmarkRow> rows;
  for (const PublishedRow& row : published_table()) rows.push_back({row.sequence, {}});
  EXPECT_EQ(table_one(rows, {"none"}, "none").rows.back()[5], "38.0 %");  // "38 % on average"
}

}  // namespace
}  // namespace stillpoint
