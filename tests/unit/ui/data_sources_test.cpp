#include "ui/session/data_sources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"
#include "core/run/worst_frames.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A run whose steps are off by so many millimetres; below 0 the frame is lost.
RunView run_of(const std::vector<double>& errors_mm) {
  RunView run;
  for (std::size_t i = 0; i < errors_mm.size(); ++i) {
    FrameRecord record;
    record.index = static_cast<int>(i);
    record.timestamp = static_cast<double>(i) / 30.0;
    record.status = errors_mm[i] < 0.0 ? FrameStatus::lost : FrameStatus::tracked;
    record.estimated = errors_mm[i] >= 0.0;
    record.inliers = 100 - static_cast<int>(i);
    run.records.push_back(record);
    if (i > 0 && errors_mm[i] >= 0.0)
      run.evaluation.rpe_frame.errors.push_back(
          {record.timestamp - 1.0 / 30.0, record.timestamp, 0.001 * errors_mm[i], 0.0});
  }
  return run;
}

std::vector<int> worst(const RunView& run, const char* figure, int apart, std::size_t most = 50) {
  std::vector<int> frames;
  for (const WorstFrame& frame : worst_frames(run.measured(), frame_figure(figure), apart, most))
    frames.push_back(frame.index);
  return frames;
}

TEST(LaneFigures, ErrorsStandAtTheEndOfTheirMotion) {
  const RunView run = run_of({0, 3, 5, -1, 2});
  const std::vector<double> values = frame_figure_values(run.measured(), frame_figure("rpe"));
  ASSERT_EQ(values.size(), 5U);
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_NEAR(values[1], 0.003, 1e-12);
  EXPECT_NEAR(values[2], 0.005, 1e-12);
  EXPECT_TRUE(std::isnan(values[3]));
  EXPECT_NEAR(values[4], 0.002, 1e-12);
  const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(frame_figure("rpe"))];
  EXPECT_EQ(shown_value(info, values[1]), "3.00 mm");
  EXPECT_EQ(shown_value(info, values[0]), "–");
}

TEST(WorstFrames, WithoutTruthInliersTell) {
  RunView run = run_of({0, 1, 2});
  EXPECT_EQ(usual_figure(run.measured()), frame_figure("rpe"));
  run.evaluation = {};
  EXPECT_EQ(usual_figure(run.measured()), frame_figure("inliers"));
  // Fewer are worse: the last frame has the fewest.
  // … and the better half is none of the worst.
  EXPECT_THAT(worst(run, "inliers", 1), ElementsAre(2, 1));
}

TEST(WorstFrames, EachFailureIsNamedOnce) {
  // Two spikes with slopes, one at 3 and a greater one at 9.
  const RunView run = run_of({0, 1, 4, 6, 5, 1, 1, 2, 8, 9, 7, 1, 1});
  EXPECT_THAT(worst(run, "rpe", 4), ElementsAre(9, 3));
  EXPECT_THAT(worst(run, "rpe", 4, 1), ElementsAre(9));
}

TEST(WorstFrames, LostStretchesComeFirst) {
  const RunView run = run_of({0, 1, -1, -1, 1, 1, 1, 50, 1, 1, -1, 1});
  EXPECT_THAT(worst(run, "rpe", 3, 3), ElementsAre(2, 10, 7));
}

TEST(WorstFrames, OneGoesDownAndUpTheList) {
  const std::vector<int> list{9, 3, 40};
  EXPECT_EQ(next_worst(list, 17, {}), 9) << "from anywhere to the worst";
  EXPECT_EQ(next_worst(list, 3, {}), 9) << "also from a frame that happens to be in the list";
  EXPECT_EQ(next_worst(list, 9, {}), 3) << "the worst is shown already";
  EXPECT_EQ(next_worst(list, 9, 9), 3);
  EXPECT_EQ(next_worst(list, 3, 3), 40);
  EXPECT_EQ(next_worst(list, 17, 3), 9) << "one went elsewhere meanwhile";
  EXPECT_EQ(next_worst(list, 40, 40), std::nullopt);
  EXPECT_EQ(previous_worst(list, 40, 40), 3);
  EXPECT_EQ(previous_worst(list, 9, 9), std::nullopt);
  EXPECT_EQ(previous_worst(list, 17, {}), std::nullopt);
  EXPECT_EQ(next_worst({}, 0, {}), std::nullopt);
}

TEST(Places, HitsOfEnabledBreakpointsAreOneList) {
  DebugView debug;
  debug.breakpoints = {
      {{"a", true}, "", 0, {3, 8}}, {{"b", false}, "", 0, {5}}, {{"c", true}, "", 0, {1, 8}}};
  EXPECT_THAT(hit_frames(debug), ElementsAre(1, 3, 8));
  EXPECT_EQ(next_in(hit_frames(debug), 3), 8);
  EXPECT_EQ(previous_in(hit_frames(debug), 3), 1);
  EXPECT_EQ(next_in(hit_frames(debug), 8), std::nullopt);
  EXPECT_EQ(previous_in(hit_frames(debug), 1), std::nullopt);
}

TEST(Places, TheFirstGhostToPartIsGoneTo) {
  DebugView debug;
  EXPECT_EQ(first_divergence(debug), std::nullopt);
  debug.ghosts.resize(3);
  debug.ghosts[0].diverged = 40;
  debug.ghosts[2].diverged = 12;
  EXPECT_EQ(first_divergence(debug), 12);
}

TEST(Bookmarks, StayInOrderAndKeepTheirNotes) {
  std::vector<Bookmark> all = with_bookmark({{3, "a"}, {9, "b"}}, 5);
  EXPECT_THAT(all, ElementsAre(Bookmark{3, "a"}, Bookmark{5, ""}, Bookmark{9, "b"}));
  EXPECT_EQ(with_bookmark(all, 9), all);
  EXPECT_THAT(without_bookmark(all, 3), ElementsAre(Bookmark{5, ""}, Bookmark{9, "b"}));
  EXPECT_EQ(without_bookmark(all, 4), all);
}

TEST(Span, IsCutToTheSequence) {
  EXPECT_EQ(span_between(7, 3, 100), (FrameSpan{3, 7}));
  EXPECT_EQ(span_between(-4, 300, 100), (FrameSpan{0, 99}));
  EXPECT_EQ(span_between(0, 0, 0), (FrameSpan{0, 0}));
}

}  // namespace
}  // namespace stillpoint
