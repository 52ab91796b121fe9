#include "ui/session/shown_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

GhostView ghost_run(const std::string& name, int frame, bool outside = false) {
  auto run = std::make_shared<RunView>();
  run->name = name;
  GhostView view;
  view.name = name;
  view.run = run;
  view.outside = outside;
  if (frame < 0) return view;
  auto current = std::make_shared<FrameView>();
  current->index = frame;
  view.current = current;
  return view;
}

/// A run at frame 3 with its baseline, a ghost that is there, one on its way, and another program's path.
SessionView session_of_runs() {
  SessionView view;
  auto run = std::make_shared<RunView>(), baseline = std::make_shared<RunView>();
  run->name = "paper";
  baseline->name = "none";
  auto current = std::make_shared<FrameView>();
  current->index = 3;
  view.run = run;
  view.baseline = baseline;
  view.baseline_config.run.method = "none";
  auto plain = std::make_shared<FrameView>();
  plain->index = 3;
  view.baseline_frame.current = plain;
  view.current = current;
  view.config.run.method = "paper";
  view.debug.ghosts = {ghost_run("method none", 3), ghost_run("paper", -1), ghost_run("orb3", 3, true)};
  view.debug.ghosts[0].config.run.method = "none";
  return view;
}

std::vector<std::string> names_of_runs(const std::vector<ListedRun>& runs) {
  std::vector<std::string> all;
  for (const ListedRun& run : runs) all.push_back(run.name);
  return all;
}

TEST(ShownRuns, AreOneListWithNamesOfTheirOwn) {
  const std::vector<ListedRun> runs = listed_runs(session_of_runs());
  EXPECT_THAT(names_of_runs(runs),
              ElementsAre("paper", "none (baseline)", "method none", "paper (2)", "orb3"));
  EXPECT_THAT(runs[0].no_pictures, IsEmpty());
  EXPECT_THAT(runs[1].no_pictures, IsEmpty());
  EXPECT_THAT(runs[2].no_pictures, IsEmpty());
  EXPECT_THAT(runs[3].no_pictures, HasSubstr("has not come to frame 3"));
  EXPECT_THAT(runs[4].no_pictures, HasSubstr("another program's trajectory"));
}

TEST(ShownRuns, OutsideRunsWithMasksHavePictures) {
  SessionView view = session_of_runs();
  auto current = std::make_shared<FrameView>(*view.debug.ghosts[2].current);
  current->mask = cv::Mat(4, 4, CV_8UC1, cv::Scalar(255));
  view.debug.ghosts[2].current = current;
  EXPECT_THAT(listed_runs(view)[4].no_pictures, IsEmpty());
}

TEST(ShownRuns, AnOutsideRunMayLackPicturesOfAFrameAlone) {
  SessionView view = session_of_runs();
  auto run = std::make_shared<RunView>();
  for (int i = 0; i < 4; ++i) {
    FrameRecord record;
    record.measured = poses_alone();
    record.measured.mask = i == 2;
    run->records.push_back(record);
  }
  view.debug.ghosts[2].run = run;
  const ListedRun listed = listed_runs(view)[4];
  EXPECT_EQ(listed.no_pictures, "orb3 left neither mask nor features of frame 3.");
  EXPECT_FALSE(listed.never_has_pictures);
  EXPECT_TRUE(listed_runs(session_of_runs())[4].never_has_pictures);
  // It is ticked in every frame, or in none.
  EXPECT_EQ(RunsShown{}.chosen_of(view).back().name, "orb3");
}

TEST(ShownRuns, AreThoseWithPicturesUntilSomebodyChooses) {
  const SessionView view = session_of_runs();
  RunsShown shown;
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)),
              ElementsAre("paper", "none (baseline)", "method none", "paper (2)"));
  shown.toggle(view, "paper (2)");
  shown.toggle(view, "none (baseline)");
  shown.toggle(view, "orb3");
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)), ElementsAre("paper", "method none", "orb3"));
  shown.toggle(view, "orb3");
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)), ElementsAre("paper", "method none"));
  // A run that is gone is passed over, and is there again when it is.
  SessionView without = view;
  without.debug.ghosts.clear();
  EXPECT_THAT(names_of_runs(shown.chosen_of(without)), ElementsAre("paper"));
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)), ElementsAre("paper", "method none"));
}

TEST(ShownRuns, ARunThatIsAddedLaterIsAmongThem) {
  SessionView view = session_of_runs();
  RunsShown shown;
  shown.toggle(view, "paper (2)");
  view.debug.ghosts.push_back(ghost_run("threshold 9", -1));
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)),
              ElementsAre("paper", "none (baseline)", "method none", "threshold 9"));
  // What was left out, removed and made again is a new run, too.
  shown.toggle(view, "threshold 9");
  shown.toggle_hidden("threshold 9");
  shown.forget("threshold 9");
  EXPECT_EQ(shown.chosen_of(view).back().name, "threshold 9");
  EXPECT_FALSE(shown.hides("threshold 9"));
}

TEST(ShownRuns, ThoseACommandNamesAreAlone) {
  const SessionView view = session_of_runs();
  RunsShown shown{.only = {"method none", "none (baseline)"}};
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)), ElementsAre("none (baseline)", "method none"));
  shown.toggle(view, "paper (2)");
  EXPECT_THAT(names_of_runs(shown.chosen_of(view)),
              ElementsAre("none (baseline)", "method none", "paper (2)"));
}

TEST(ShownRuns, WhyThereAreNotTwoIsTold) {
  SessionView view = session_of_runs();
  RunsShown shown;
  EXPECT_EQ(shown.why_not_several(view), "");
  for (const char* name : {"none (baseline)", "method none", "paper (2)"}) shown.toggle(view, name);
  EXPECT_THAT(shown.why_not_several(view),
              HasSubstr("Only paper is ticked: tick another run in Compare runs."));
  shown.toggle(view, "paper");
  EXPECT_THAT(shown.why_not_several(view), HasSubstr("No run is ticked"));
  view.baseline = nullptr;
  view.debug.ghosts.erase(view.debug.ghosts.begin(), view.debug.ghosts.begin() + 2);
  EXPECT_THAT(RunsShown{}.why_not_several(view), HasSubstr("No second run has pictures: \"Compare with"));
  view.debug.ghosts.clear();
  EXPECT_THAT(RunsShown{}.why_not_several(view), HasSubstr("There is no second run: \"Compare with"));
}

TEST(ShownRuns, TheBaselineIsWantedWherePicturesHaveIt) {
  SessionView view = session_of_runs();
  RunsShown shown;
  EXPECT_FALSE(shown.wants_baseline(view));
  shown.pictures = RunPictures::wiped;
  EXPECT_TRUE(shown.wants_baseline(view));
  view.baseline_frame = {};
  EXPECT_TRUE(shown.wants_baseline(view));
  EXPECT_THAT(listed_runs(view)[1].no_pictures, HasSubstr("none (baseline) has not come to frame 3"));
  shown.toggle(view, "none (baseline)");
  EXPECT_FALSE(shown.wants_baseline(view));
}

TEST(ShownRuns, WhoseARunIsIsToldByItsName) {
  SessionView view = session_of_runs();
  EXPECT_EQ(run_words(view), "method paper");
  view.config.run.method = "none";
  view.outside = "orb3";
  EXPECT_EQ(run_words(view), "another program's run orb3");
  EXPECT_EQ(maker_of(view), "orb3");
  const SessionView there = as_run(session_of_runs(), listed_runs(session_of_runs())[4]);
  EXPECT_EQ(maker_of(there), "orb3");
}

TEST(ShownRuns, AFrameWithoutDepthIsJudgedByAnotherMethodAndSaysSo) {
  SessionView view = session_of_runs();
  view.config.run.method = "stillpoint";
  auto current = std::make_shared<FrameView>(*view.current);
  current->frame.gray = cv::Mat(4, 4, CV_8UC1, cv::Scalar(9));
  view.current = current;
  EXPECT_EQ(run_words(view), "method epipolar in stillpoint's place");
  current->frame.depth = cv::Mat(4, 4, CV_32FC1, cv::Scalar(1));
  EXPECT_EQ(run_words(view), "method stillpoint");
}

TEST(ShownRuns, FlipFromOneToTheNextAndRound) {
  const SessionView view = session_of_runs();
  RunsShown shown;
  EXPECT_FALSE(shown.flipped(view));
  std::vector<std::string> seen;
  for (int i = 0; i < 4; ++i) {
    shown.flip(view, 1);
    seen.push_back(shown.flipped(view)->name);
  }
  EXPECT_THAT(seen, ElementsAre("none (baseline)", "method none", "paper (2)", "paper"));
  shown.flip(view, -1);
  EXPECT_EQ(shown.flipped(view)->name, "paper (2)");
  shown.flipped_to = "gone";
  EXPECT_EQ(shown.flipped(view)->name, "paper");
}

TEST(ShownRuns, StandInTheSessionsPlace) {
  const SessionView view = session_of_runs();
  const std::vector<ListedRun> runs = listed_runs(view);
  const SessionView other = as_run(view, runs[2]);
  EXPECT_EQ(other.config.run.method, "none");
  EXPECT_EQ(other.run, view.debug.ghosts[0].run);
  EXPECT_EQ(other.current, view.debug.ghosts[0].current);
  EXPECT_EQ(as_run(view, runs[0]).config.run.method, "paper");
  const SessionView plain = as_run(view, runs[1]);
  EXPECT_EQ(plain.config.run.method, "none");
  EXPECT_EQ(plain.current, view.baseline_frame.current);
  EXPECT_EQ(plain.run, view.baseline);
}

TEST(ShownRuns, DividersFitTheStrips) {
  RunsShown shown;
  shown.fit_dividers(3);
  EXPECT_THAT(shown.dividers, ElementsAre(1.0F / 3.0F, 2.0F / 3.0F));
  shown.dividers = {0.2F, 0.9F};
  shown.fit_dividers(3);
  EXPECT_THAT(shown.dividers, ElementsAre(0.2F, 0.9F));
  shown.fit_dividers(1);
  EXPECT_THAT(shown.dividers, IsEmpty());
}

TEST(ShownRuns, HiddenOnesLeaveTheOthersTheirLooks) {
  const SessionView view = session_of_runs();
  RunsShown shown;
  shown.toggle_hidden("method none");
  shown.toggle_hidden("none (baseline)");
  shown.toggle_hidden("paper");  // the session's own stays
  const SessionView seen = without_hidden(view, shown);
  EXPECT_EQ(seen.baseline, nullptr);
  ASSERT_EQ(seen.debug.ghosts.size(), 2U);
  EXPECT_EQ(seen.debug.ghosts[0].run, view.debug.ghosts[1].run);
  EXPECT_EQ(seen.debug.ghosts[0].look, 1U);
  EXPECT_EQ(seen.debug.ghosts[1].look, 2U);
  EXPECT_EQ(seen.run, view.run);
  shown.toggle_hidden("method none");
  EXPECT_EQ(without_hidden(view, shown).debug.ghosts.size(), 3U);
}

}  // namespace
}  // namespace stillpoint
