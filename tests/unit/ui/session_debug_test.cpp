#include "tests/unit/ui/session_debug.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(SessionDebug, RequestsAreCarriedOutAtOnceWithoutAWorker) {
  const auto s = session();
  s->request(request::GoTo{5});
  EXPECT_EQ(s->view()->current->index, 5);
  EXPECT_EQ(s->view()->processed, 6);
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, kDebugFrames - 1);
  EXPECT_FALSE(s->view()->playing);
  s->request(request::GoTo{-7});
  EXPECT_EQ(s->view()->current->index, 0);
}

TEST_F(SessionDebug, KeepsBookmarksByFrameAndPins) {
  const auto s = session();
  s->request(request::Bookmarks{{{9, "late"}, {2, "early"}, {400, "beyond"}}});
  EXPECT_THAT(debug(*s).bookmarks,
              ElementsAre(Bookmark{2, "early"}, Bookmark{9, "late"}, Bookmark{11, "beyond"}));
  s->request(request::Pins{{{1, 10.0, 20.0, "A"}}});
  EXPECT_THAT(debug(*s).pins, ElementsAre(Pin{1, 10.0, 20.0, "A"}));
}

TEST_F(SessionDebug, PlayStopsAtABreakpointAndGoesOnFromIt) {
  const auto s = session();
  s->request(request::Breakpoints{
      {{"frame == 3", true}, {"frame == 5", false}, {"frame >= 7 && frame <= 8", true}}});
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, 3);
  EXPECT_EQ(debug(*s).stopped_by, 0);
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, 7);  // the one switched off does not stop
  EXPECT_EQ(debug(*s).stopped_by, 2);
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, 8);
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, kDebugFrames - 1);
  EXPECT_FALSE(debug(*s).stopped_by.has_value());
  EXPECT_THAT(debug(*s).breakpoints[1].hits, ElementsAre(5));
  EXPECT_THAT(debug(*s).breakpoints[2].hits, ElementsAre(7, 8));
}

TEST_F(SessionDebug, ABreakpointThatCannotBeReadSaysWhereAndDisturbsNoOther) {
  const auto s = session();
  s->request(request::Breakpoints{{{"frame == 2 &", true}, {"keyframe", true}}});
  s->request(request::GoTo{4});
  EXPECT_THAT(debug(*s).breakpoints[0].error, HasSubstr("column 12"));
  EXPECT_EQ(debug(*s).breakpoints[0].error_column, 11);
  EXPECT_TRUE(debug(*s).breakpoints[0].hits.empty());
  EXPECT_TRUE(debug(*s).breakpoints[1].error.empty());
  EXPECT_FALSE(debug(*s).breakpoints[1].hits.empty());
  EXPECT_TRUE(s->view()->message.empty());
}

TEST_F(SessionDebug, TheSpanIsOrderedAndPlayGoesRoundInIt) {
  const auto s = session();
  s->request(request::Span{FrameSpan{6, 4}, true});
  EXPECT_EQ(debug(*s).span, (FrameSpan{4, 6}));
  // The breakpoint holds at its second visit only because play came round: it starts beyond it.
  s->request(request::GoTo{5});
  s->request(request::Breakpoints{{{"frame == 4", true}}});
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, 4);
  s->request(request::Span{std::nullopt, true});
  EXPECT_FALSE(debug(*s).loop);
}

TEST_F(SessionDebug, BreakpointsKnowTheTrueMasks) {
  write_masks(folder_);
  source_ = open_sequence(folder_.path());
  config_.run.method = "oracle";
  const auto told = session();
  told->request(request::GoTo{5});
  told->request(request::Breakpoints{{{"mask_iou > 99%", true}, {"mask_recall < 50%", true}}});
  EXPECT_THAT(debug(*told).breakpoints[0].hits, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(debug(*told).breakpoints[1].hits, ::testing::IsEmpty());
  // A ghost has its own masks; before it branches off they are the run's.
  Config none = config_;
  none.run.method = "none";
  told->request(request::AddGhost{none, "none", 3});
  const auto& scores = debug(*told).ghosts[0].run->scores;
  ASSERT_EQ(scores.size(), 6U);
  EXPECT_EQ(scores[2].mask.iou(), 1.0);
  EXPECT_EQ(scores[4].mask.iou(), 0.0);
}

TEST_F(SessionDebug, ABreakpointSaysWhatNoFrameHas) {
  const auto s = session();
  s->request(request::GoTo{4});
  s->request(request::Breakpoints{{{"mask_iou < 50% || step > 2", true}, {"inliers > 0", true}}});
  EXPECT_THAT(debug(*s).breakpoints[0].note, ::testing::AllOf(HasSubstr("step"), HasSubstr("mask_iou")));
  EXPECT_EQ(debug(*s).breakpoints[1].note, "");
}

TEST_F(SessionDebug, AGhostWithTheSameConfigIsTheSameRun) {
  for (const char* method : {"none", "paper", "stillpoint"}) {
    config_.run.method = method;
    const auto s = session();
    s->request(request::GoTo{kDebugFrames - 1});
    s->request(request::AddGhost{config_, "same", 5});
    s->request(request::AddGhost{config_, "same from the first", 0});
    ASSERT_EQ(debug(*s).ghosts.size(), 2U);
    for (const GhostView& ghost : debug(*s).ghosts) {
      EXPECT_FALSE(ghost.busy);
      EXPECT_FALSE(ghost.diverged.has_value()) << method << " " << *ghost.diverged;
      EXPECT_EQ(ghost.run->records.size(), static_cast<std::size_t>(kDebugFrames));
      EXPECT_EQ(run_hash(ghost.run->records), debug(*s).run_hash) << method;
      ASSERT_NE(ghost.current, nullptr);
      EXPECT_EQ(ghost.current->index, kDebugFrames - 1);
    }
    EXPECT_EQ(debug(*s).ghosts[0].from, 5);
    EXPECT_EQ(debug(*s).ghosts[1].from, 0);
  }
}

TEST_F(SessionDebug, AGhostDivergesWhereItsConfigBegins) {
  const auto s = session();
  s->request(request::GoTo{8});
  Config other = config_;
  other.features.count = 300;
  s->request(request::AddGhost{other, "fewer features", 5});
  const GhostView ghost = debug(*s).ghosts[0];
  EXPECT_EQ(ghost.from, 5);
  EXPECT_EQ(ghost.diverged, 5);
  EXPECT_LE(ghost.run->records[6].features_found, 310);
  EXPECT_EQ(ghost.config.features.count, 300);
  // It goes along with the run.
  s->request(request::GoTo{10});
  EXPECT_EQ(debug(*s).ghosts[0].run->records.size(), 11U);
  EXPECT_EQ(debug(*s).ghosts[0].current->index, 10);
  // From its first frame on it equals a run that had this config alone.
  s->request(request::AddGhost{other, "fewer features", 0});
  s->request(request::GoTo{kDebugFrames - 1});
  EXPECT_EQ(run_hash(debug(*s).ghosts[1].run->records), run_hash(run_sequence(*source_, other, {}).records));
  s->request(request::RemoveGhost{0});
  EXPECT_EQ(debug(*s).ghosts.size(), 1U);
  s->request(request::RemoveGhost{7});
  EXPECT_THAT(s->view()->message, HasSubstr("no ghost run 7"));
}

TEST_F(SessionDebug, AGhostMayBeAnotherMethodFromTheMiddleOn) {
  for (const auto& [from, to] :
       {std::pair{"none", "stillpoint"}, {"stillpoint", "paper"}, {"paper", "none"}}) {
    config_.run.method = from;
    const auto s = session();
    s->request(request::GoTo{kDebugFrames - 1});
    Config other = config_;
    other.run.method = to;
    s->request(request::AddGhost{other, to, 6});
    const GhostView ghost = debug(*s).ghosts[0];
    EXPECT_EQ(ghost.from, 6);
    EXPECT_EQ(ghost.run->name, to);
    ASSERT_EQ(ghost.run->records.size(), static_cast<std::size_t>(kDebugFrames));
    for (const FrameRecord& record : ghost.run->records) EXPECT_TRUE(record.estimated) << record.index;
  }
}

TEST_F(SessionDebug, AGhostWhoseFeaturesWouldNotFitBeginsAtTheFirstFrame) {
  const auto s = session();
  s->request(request::GoTo{8});
  Config other = config_;
  other.features.levels = 5;
  s->request(request::AddGhost{other, "levels 5", 5});
  EXPECT_EQ(debug(*s).ghosts[0].from, 0);
  EXPECT_EQ(run_hash(debug(*s).ghosts[0].run->records), run_hash(batch(other, 9).records));
}

TEST_F(SessionDebug, RunAllGoesAsFarAsTheRunHadGone) {
  const auto s = session();
  s->request(request::GoTo{9});
  s->request(request::GoTo{3});
  Config other = config_;
  other.run.method = "none";
  s->request(request::RunAll{other});
  EXPECT_EQ(s->view()->current->index, 3);
  EXPECT_EQ(s->view()->config.run.method, "none");
  EXPECT_EQ(s->view()->processed, 10);
  EXPECT_EQ(debug(*s).run_hash, run_hash(batch(other, 10).records));
}

TEST_F(SessionDebug, GhostsAreComparedWithARunThatBeginsAnew) {
  const auto s = session();
  s->request(request::GoTo{6});
  s->request(request::AddGhost{config_, "same", 0});
  EXPECT_FALSE(debug(*s).ghosts[0].diverged);
  Config other = config_;
  other.features.count = 300;
  s->request(request::RunAll{other});
  EXPECT_EQ(debug(*s).ghosts[0].diverged, 0);
  s->request(request::RunAll{config_});
  EXPECT_FALSE(debug(*s).ghosts[0].diverged);
}

TEST_F(SessionDebug, TheWorkerDoesTheSame) {
  StartedSession s(session());
  s->request_speed(1000);
  s->request(request::Breakpoints{{{"frame == 6", true}}});
  s->request(request::Play{true});
  EXPECT_TRUE(
      s.wait_for([](const SessionView& v) { return v.debug.stopped_by == 0 && v.current->index == 6; }));
  Config other = config_;
  other.features.count = 300;
  s->request(request::AddGhost{other, "ghost", 4});
  EXPECT_TRUE(s.wait_for([](const SessionView& v) {
    return v.debug.ghosts.size() == 1 && !v.debug.ghosts[0].busy &&
           v.debug.ghosts[0].run->records.size() == 7;
  }));
  for (int count = 390; count > 300; count -= 10) {
    other.features.count = count;
    s->request(request::Preview{other});
  }
  EXPECT_TRUE(s.wait_for(
      [](const SessionView& v) { return v.debug.preview && v.debug.preview_config->features.count == 310; }));
}

TEST_F(SessionDebug, NoneOfSeveralQuickStepsIsLost) {
  StartedSession s(session());
  for (int step = 0; step < 6; ++step) s->request_step(1);  // faster than frames are processed
  s->request_step(-1);
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return v.current->index == 5 && !v.busy; }));
  for (int step = 0; step < 40; ++step) s->request_step(-1);
  s->request_step(2);  // from the end that was come to, not from beyond it
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return v.current->index == 2 && !v.busy; }));
}

TEST_F(SessionDebug, ChangesOfMarksAreTakenBackAndMadeAgain) {
  const auto s = session();
  s->request(request::Bookmarks{{{3, "here"}}});
  s->request(request::Pins{{{3, 10.0, 20.0, "A"}}});
  s->request(request::Breakpoints{{{"lost", true}}});
  s->request(request::Span{FrameSpan{2, 5}, true});
  s->request(request::Drawn{{{4, {}}}});
  EXPECT_EQ(debug(*s).undo_steps, 5);
  s->request(request::GoTo{6});  // going about changes no marks
  EXPECT_EQ(debug(*s).undo_steps, 5);
  s->request(request::Undo{});
  EXPECT_TRUE(debug(*s).drawn.empty());
  s->request(request::Undo{});
  EXPECT_FALSE(debug(*s).span);
  EXPECT_FALSE(debug(*s).loop);
  s->request(request::Undo{});
  EXPECT_TRUE(debug(*s).breakpoints.empty());
  EXPECT_EQ(debug(*s).pins.size(), 1U);
  EXPECT_EQ(debug(*s).redo_steps, 3);
  s->request(request::Redo{});
  ASSERT_EQ(debug(*s).breakpoints.size(), 1U);
  EXPECT_EQ(debug(*s).breakpoints[0].breakpoint.expression, "lost");
  // Another change ends what could be made again.
  s->request(request::Bookmarks{});
  EXPECT_EQ(debug(*s).redo_steps, 0);
  s->request(request::Redo{});
  EXPECT_TRUE(debug(*s).bookmarks.empty());
  s->request(request::Undo{});
  EXPECT_EQ(debug(*s).bookmarks, (std::vector<Bookmark>{{3, "here"}}));
  for (int i = 0; i < 9; ++i) s->request(request::Undo{});
  EXPECT_EQ(debug(*s).undo_steps, 0);
  EXPECT_TRUE(debug(*s).bookmarks.empty());
  EXPECT_TRUE(debug(*s).pins.empty());
}

TEST_F(SessionDebug, WhatIsTypedIsOneChange) {
  StartedSession s(session());
  for (const char* note : {"h", "he", "her", "here"}) s->request(request::Bookmarks{{{3, note}}});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) {
    return view.debug.bookmarks == std::vector<Bookmark>{{3, "here"}};
  }));
  EXPECT_EQ(s->view()->debug.undo_steps, 1);
  s->request(request::Undo{});
  EXPECT_TRUE(s.wait_for([](const SessionView& view) { return view.debug.bookmarks.empty(); }));
}

}  // namespace
}  // namespace stillpoint
