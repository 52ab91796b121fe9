#include "ui/panels/timeline_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "ui/session/data_sources.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<int> frames_up_to(int count) {
  std::vector<int> frames(static_cast<std::size_t>(count));
  std::iota(frames.begin(), frames.end(), 0);
  return frames;
}

TEST(Aggregate, ManyFramesInAColumnKeepTheirExtremes) {
  // 1,000 frames on 10 columns: 100 each, and one spike that must not be lost.
  std::vector<double> values(1000, 1.0);
  values[437] = 9.0;
  values[438] = -2.0;
  const auto columns = aggregate(frames_up_to(1000), values, {-0.5, 999.5}, 10);
  ASSERT_EQ(columns.size(), 10U);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    EXPECT_EQ(columns[c].greatest, c == 4 ? 9.0 : 1.0) << c;
    EXPECT_EQ(columns[c].least, c == 4 ? -2.0 : 1.0) << c;
  }
}

TEST(Aggregate, AFrameWiderThanAColumnFillsItsOwn) {
  // 4 frames on 12 columns: 3 each.
  const auto columns = aggregate(frames_up_to(4), std::vector{5.0, 6.0, std::nan(""), 8.0}, {-0.5, 3.5}, 12);
  ASSERT_EQ(columns.size(), 12U);
  for (int c = 0; c < 12; ++c) {
    const double value = columns[static_cast<std::size_t>(c)].greatest;
    if (c / 3 == 2)
      EXPECT_TRUE(std::isnan(value)) << c;
    else
      EXPECT_EQ(value, 5.0 + c / 3) << c;
  }
}

TEST(Aggregate, WhatLiesOutsideTheRangeIsCutOff) {
  const auto columns = aggregate(frames_up_to(100), std::vector<double>(100, 1.0), {39.5, 49.5}, 5);
  for (const ColumnValues& column : columns) EXPECT_EQ(column.greatest, 1.0);
  const auto beyond = aggregate(frames_up_to(100), std::vector<double>(100, 1.0), {200.0, 210.0}, 5);
  for (const ColumnValues& column : beyond) EXPECT_TRUE(std::isnan(column.greatest));
  EXPECT_THAT(aggregate(frames_up_to(3), std::vector<double>(3, 1.0), {1.0, 1.0}, 5), IsEmpty());
  EXPECT_THAT(aggregate(frames_up_to(3), std::vector<double>(3, 1.0), {0.0, 1.0}, 0), IsEmpty());
}

TEST(Aggregate, EqualNeighboursAreDrawnAsOne) {
  const auto columns = aggregate(frames_up_to(4), std::vector{5.0, 5.0, std::nan(""), 8.0}, {-0.5, 3.5}, 12);
  const auto runs = runs_of(columns);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].first, 0);
  EXPECT_EQ(runs[0].last, 5);
  EXPECT_EQ(runs[1].first, 9);
  EXPECT_EQ(runs[1].last, 11);
}

TEST(Aggregate, SignsInOneColumnAreOne) {
  EXPECT_THAT(columns_of({0, 1, 2, 900}, {-0.5, 999.5}, 100), ElementsAre(0, 90));
  EXPECT_THAT(columns_of({5, 2000}, {-0.5, 9.5}, 100), ElementsAre(54));
}

TEST(Status, TheWorstOfAColumnIsShown) {
  for (const FrameStatus status : {FrameStatus::tracked, FrameStatus::initialised, FrameStatus::relocalised,
                                   FrameStatus::lost, FrameStatus::unreadable})
    EXPECT_EQ(status_of_badness(badness_of(status)), status);
  EXPECT_LT(badness_of(FrameStatus::tracked), badness_of(FrameStatus::relocalised));
  EXPECT_LT(badness_of(FrameStatus::relocalised), badness_of(FrameStatus::lost));
}

TEST(SpanDrag, SelectsBetweenPressAndRelease) {
  SpanDrag drag;
  drag.begin(30, std::nullopt, 2.0);
  EXPECT_TRUE(drag.active());
  EXPECT_FALSE(drag.span(100)) << "a press alone selects nothing";
  drag.move(12);
  EXPECT_EQ(drag.span(100), (FrameSpan{12, 30}));
  EXPECT_EQ(drag.end(100), (FrameSpan{12, 30}));
  EXPECT_FALSE(drag.active());
}

TEST(SpanDrag, AClickSelectsNothing) {
  SpanDrag drag;
  drag.begin(30, std::nullopt, 2.0);
  drag.move(30);
  EXPECT_FALSE(drag.end(100));
}

TEST(SpanDrag, TakesHoldOfAnEnd) {
  SpanDrag drag;
  drag.begin(51, FrameSpan{20, 50}, 2.0);
  drag.move(70);
  EXPECT_EQ(drag.end(100), (FrameSpan{20, 70}));
  drag.begin(19, FrameSpan{20, 50}, 2.0);
  drag.move(60);
  EXPECT_EQ(drag.end(100), (FrameSpan{50, 60})) << "an end dragged past the other";
  drag.begin(35, FrameSpan{20, 50}, 2.0);
  drag.move(40);
  EXPECT_EQ(drag.end(100), (FrameSpan{35, 40})) << "in the middle a new range begins";
}

TEST(SpanDrag, StaysInTheSequence) {
  SpanDrag drag;
  drag.begin(3, std::nullopt, 0.0);
  drag.move(400);
  EXPECT_EQ(drag.end(10), (FrameSpan{3, 9}));
}

/// Five frames with inliers, or with poses alone.
std::shared_ptr<const RunView> five_frames(const RecordParts& measured) {
  auto run = std::make_shared<RunView>();
  for (int i = 0; i < 5; ++i) {
    FrameRecord record;
    record.index = i;
    record.status = FrameStatus::tracked;
    record.measured = measured;
    record.inliers = measured.matches ? 100 + i : 0;
    run->records.push_back(record);
  }
  return run;
}

TEST(TimelineLanes, TellBetweenWhichTheirValuesLie) {
  SessionView session;
  session.run = five_frames({});
  TimelineModel model;
  model.update(session, {frame_figure("inliers"), frame_figure("mask")});
  ASSERT_EQ(model.lanes.size(), 2U);
  EXPECT_EQ(model.lanes[0].range_text(), "0–104");
  // The end of a lane of zeros is no value of it.
  EXPECT_EQ(model.lanes[1].range_text(), "0 %");
}

TEST(TimelineLanes, WhatARunDoesNotKnowIsAGap) {
  SessionView session;
  session.run = five_frames({});
  GhostView ghost;
  ghost.run = five_frames(poses_alone());
  session.debug.ghosts = {ghost};
  TimelineModel model;
  model.update(session, {frame_figure("inliers")});
  ASSERT_EQ(model.lanes.size(), 1U);
  EXPECT_THAT(model.lanes[0].values, ElementsAre(100, 101, 102, 103, 104));
  EXPECT_THAT(model.lanes[0].ghosts.at(0), ::testing::Each(::testing::IsNan()));
  // The other way round the lane is there for the run beside.
  std::swap(session.run, session.debug.ghosts[0].run);
  model.update(session, {frame_figure("inliers")});
  ASSERT_EQ(model.lanes.size(), 1U);
  EXPECT_THAT(model.lanes[0].values, ::testing::Each(::testing::IsNan()));
  EXPECT_THAT(model.lanes[0].ghosts.at(0), ElementsAre(100, 101, 102, 103, 104));
  EXPECT_GT(model.lanes[0].highest, 104.0);
  // Where nobody knows it, there is none.
  session.debug.ghosts.clear();
  model.update(session, {frame_figure("inliers")});
  EXPECT_THAT(model.lanes, IsEmpty());
}

}  // namespace
}  // namespace stillpoint
