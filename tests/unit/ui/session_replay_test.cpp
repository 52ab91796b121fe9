// Frames had again, and under other parameters: the same as a batch run has them.
#include <random>

#include "core/motion/stillpoint/stillpoint_config.hpp"
#include "core/run/sweep.hpp"
#include "tests/support/same_stages.hpp"
#include "tests/unit/ui/session_debug.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

TEST_F(SessionDebug, TheHashIsTheBatchRunsHoweverOneCameThere) {
  const RunResult batch = run_sequence(*source_, config_, {});
  const auto s = session(true);
  std::mt19937 random(3);
  for (int step = 0; step < 12; ++step) s->request(request::GoTo{static_cast<int>(random() % kDebugFrames)});
  s->request(request::GoTo{kDebugFrames - 1});
  s->request(request::GoTo{0});
  EXPECT_EQ(debug(*s).run_hash, run_hash(batch.records));
}

TEST_F(SessionDebug, AnyFrameShowsTheRecordAndTheMaskOfABatchRun) {
  write_masks(folder_);  // what oracle is told
  source_ = open_sequence(folder_.path());
  for (const char* method : {"none", "paper", "stillpoint", "oracle"}) {
    config_.run.method = method;
    std::vector<FrameResult> expected;
    RunOptions options;
    options.on_frame = [&](const FrameResult& frame) { expected.push_back(frame); };
    (void)run_sequence(*source_, config_, options);
    const auto s = session(true);
    std::mt19937 random(11);
    std::vector<int> way = {3, 2, 1, 0, kDebugFrames - 1, kDebugFrames - 2};
    for (int step = 0; step < 30; ++step) way.push_back(static_cast<int>(random() % kDebugFrames));
    int with_mask = 0;
    for (const int frame : way) {
      s->request(request::GoTo{frame});
      const auto view = s->view()->current;
      const FrameResult& batch_frame = expected[static_cast<std::size_t>(frame)];
      EXPECT_EQ(bytes_of(*view->record), bytes_of(batch_frame.record)) << method << " " << frame;
      ASSERT_EQ(view->mask.empty(), batch_frame.mask.empty()) << method << " " << frame;
      if (!view->mask.empty()) {
        EXPECT_EQ(cv::norm(view->mask, batch_frame.mask, cv::NORM_INF), 0.0) << method << " " << frame;
        ++with_mask;
      }
    }
    if (std::string_view(method) != "none") {
      EXPECT_GT(with_mask, 0) << method;
    }
  }
}

TEST_F(SessionDebug, APreviewsMotionStagesComeFirstAndAreThoseOfTheWhole) {
  config_.run.method = "stillpoint";
  ShownRunFixture at(*source_, config_);
  for (int i = 0; i < kDebugFrames; ++i) at.run.process(source_->read(i));
  for (const int index : {10, 4, 11}) {
    // Under the run's own config it is what the run had, and the whole what the motion stages were.
    const auto motion = at.run.motion_preview(index, config_);
    ASSERT_NE(motion, nullptr) << index;
    while (!at.run.prepare_preview(index)) {
    }
    const auto whole = at.run.preview(index, config_);
    EXPECT_EQ(cv::norm(motion->mask, whole->mask, cv::NORM_INF), 0.0) << index;
    ASSERT_FALSE(motion->motion->stages.empty());
    expect_same_stages(*motion->motion, *whole->motion);
    EXPECT_EQ(bytes_of(*motion->record), bytes_of(*whole->record)) << index;
    EXPECT_TRUE(computed_alike(*whole->record, at.run.track().record(index)));
  }
  // Another method's stages need nothing of the run's.
  Config paper = config_;
  paper.run.method = "paper";
  const auto other = at.run.motion_preview(5, paper);
  ASSERT_NE(other, nullptr);
  EXPECT_GT(other->motion->rounds(), 0);
  EXPECT_EQ(other->motion->method, "paper");
}

TEST_F(SessionDebug, AnotherMethodsStagesAreLaidBesideTheRuns) {
  config_.run.method = "stillpoint";
  const auto s = session();
  s->request(request::GoTo{6});
  EXPECT_EQ(s->view()->current->motion_beside, nullptr);
  s->request(request::StagesBeside{"paper"});
  const auto view = s->view()->current;
  EXPECT_EQ(view->motion->method, "stillpoint");
  ASSERT_NE(view->motion_beside, nullptr);
  EXPECT_EQ(view->motion_beside->method, "paper");
  // They are what a run by that method has.
  config_.run.method = "paper";
  const auto paper = session();
  paper->request(request::GoTo{6});
  ASSERT_FALSE(paper->view()->current->motion->stages.empty());
  expect_same_stages(*view->motion_beside, *paper->view()->current->motion);
  // And the other way: a method with memory has the frames right before alone to go by.
  paper->request(request::StagesBeside{"stillpoint"});
  EXPECT_FALSE(paper->view()->current->motion_beside->stages.empty());
  s->request(request::StagesBeside{});
  EXPECT_EQ(s->view()->current->motion_beside, nullptr);
  s->request(request::StagesBeside{"magic"});
  EXPECT_THAT(s->view()->message, ::testing::HasSubstr("there is no method 'magic'"));
}

TEST_F(SessionDebug, ASweepRunsEachValueBesideTheSession) {
  StartedSession s(session());
  s->request(request::Sweep{config_, {"features.count", 200, 400, 3}, 6});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) {
    return view.debug.sweep && !view.debug.sweep->busy && view.debug.sweep->points.size() == 3;
  }));
  const SweepView sweep = *s->view()->debug.sweep;
  EXPECT_THAT(sweep.values, ::testing::ElementsAre(200, 300, 400));
  EXPECT_EQ(sweep.problem, "");
  EXPECT_EQ(sweep.points[2].value, 400);
  // What is reached at the session's own value is the session's own run.
  EXPECT_EQ(sweep.points[2].reached.hash, run_hash(batch(config_, 6).records));
  s->request(request::Sweep{config_, {"run.method", 0, 1, 3}, 6});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) {
    return view.message.find("run.method is no number") != std::string::npos;
  }));
  EXPECT_EQ(s->view()->debug.sweep->points.size(), 3U);
  // One that goes on ends with the session, or when it is asked to.
  s->request(request::Sweep{config_, {"features.count", 200, 1200, 50}, 0});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) { return view.debug.sweep && view.debug.sweep->busy; }));
  s->request(request::StopSweep{});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) { return !view.debug.sweep->busy; }));
  EXPECT_LT(s->view()->debug.sweep->points.size(), 50U);
}

TEST_F(SessionDebug, AnotherFrameStandsBesideTheOneShown) {
  const auto s = session();
  EXPECT_EQ(debug(*s).other, nullptr);  // nothing lies before the first
  s->request(request::GoTo{5});
  ASSERT_NE(debug(*s).other, nullptr);
  EXPECT_EQ(debug(*s).other->index, 4);
  ASSERT_NE(debug(*s).other->record, nullptr);
  EXPECT_EQ(run_hash(std::vector{*debug(*s).other->record}), run_hash(std::vector{s->record(4)}));
  EXPECT_TRUE(debug(*s).other->frame.readable());
  s->request(request::StandBeside{OtherFrame::kept, 2});
  ASSERT_NE(debug(*s).other, nullptr);
  EXPECT_EQ(debug(*s).other->index, 2);
  s->request(request::GoTo{9});
  EXPECT_EQ(debug(*s).other->index, 2);
  s->request(request::GoTo{2});
  EXPECT_EQ(debug(*s).other, nullptr);  // it is the one shown itself
  s->request(request::GoTo{9});
  s->request(request::StandBeside{OtherFrame::keyframe});
  const int reference = s->view()->current->record->reference_keyframe;
  ASSERT_NE(debug(*s).other, nullptr);
  const auto keyframes = s->view()->keyframes;
  const auto keyframe = std::find_if(keyframes->begin(), keyframes->end(),
                                     [reference](const SavedKeyframe& one) { return one.id == reference; });
  ASSERT_NE(keyframe, keyframes->end());
  EXPECT_EQ(debug(*s).other->index, keyframe->frame_index);
  s->request(request::StandBeside{OtherFrame::kept});  // what was kept is kept
  EXPECT_EQ(debug(*s).other->index, 2);
}

TEST_F(SessionDebug, EveryRunHasItsOwnSecondFrame) {
  auto s = session(true);
  s->request(request::GoTo{9});
  Config none = config_;
  none.run.method = "none";
  s->request(request::AddGhost{none, "none", 0});
  s->request_baseline(true);
  const auto others = [&] {
    const auto view = s->view();
    return std::vector{view->debug.other, view->debug.ghosts[0].other, view->baseline_frame.other};
  };
  const auto expect_all_at = [&](int frame) {
    for (const auto& other : others()) {
      ASSERT_NE(other, nullptr);
      EXPECT_EQ(other->index, frame);
    }
    EXPECT_NE(run_hash(std::vector{*others()[0]->record}), run_hash(std::vector{*others()[1]->record}));
    EXPECT_EQ(run_hash(std::vector{*others()[1]->record}), run_hash(std::vector{*others()[2]->record}));
  };
  expect_all_at(8);
  s->request(request::StandBeside{OtherFrame::kept, 4});
  expect_all_at(4);
  s->request(request::GoTo{6});
  expect_all_at(4);
  s->request(request::GoTo{4});
  for (const auto& other : others()) EXPECT_EQ(other, nullptr);
}

TEST_F(SessionDebug, AGhostAddedDuringPlayComesOnWhileItPlays) {
  StartedSession s(session());
  s->request(request::GoTo{kDebugFrames - 1});
  ASSERT_TRUE(
      s.wait_for([](const SessionView& view) { return view.processed == kDebugFrames && !view.busy; }));
  // Round and round, faster than frames can be shown and never where the ghost is: nothing is left for what
  // waits for time, and no frame shown is the ghost's next.
  s->request_speed(1000.0);
  s->request(request::Span{FrameSpan{kDebugFrames / 2, kDebugFrames - 1}, true});
  s->request(request::Play{true});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) { return view.playing; }));
  Config other = config_;
  other.features.count = 300;
  s->request(request::AddGhost{other, "fewer", 0});
  EXPECT_TRUE(s.wait_for([](const SessionView& view) {
    return view.playing && view.debug.ghosts.size() == 1 && view.debug.ghosts[0].current != nullptr &&
           view.debug.ghosts[0].run->records.size() > kDebugFrames / 2;
  }));
  EXPECT_TRUE(s->view()->playing);
}

TEST_F(SessionDebug, AWindowReadsASecondFrameOnceSomebodyLooksAtTwo) {
  StartedSession s(session());
  s->request(request::GoTo{5});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) { return view.current->index == 5 && !view.busy; }));
  EXPECT_EQ(s->view()->debug.other, nullptr);
  s->request(request::StandBeside{});
  ASSERT_TRUE(s.wait_for([](const SessionView& view) { return view.debug.other != nullptr; }));
  EXPECT_EQ(s->view()->debug.other->index, 4);
  s->request(request::GoTo{7});
  EXPECT_TRUE(s.wait_for([](const SessionView& view) {
    return view.current->index == 7 && view.debug.other != nullptr && view.debug.other->index == 6;
  }));
}

TEST_F(SessionDebug, WhatLeftTooLittleIsRepeatedAsTheRunHadIt) {
  config_.run.method = "stillpoint";
  config_.of<StillpointConfig>().moving_log_odds = -3.9;  // all moves: what is left is too little
  ReplayableRun track(*source_, config_);
  const ReplayableRun::ReadFrame read = [this](int index) { return source_->read(index); };
  std::vector<FrameResult> results;
  for (int i = 0; i < kDebugFrames; ++i) results.push_back(track.process_next(read));
  int harmed = 0;
  for (int index = 1; index < kDebugFrames; ++index) {
    const FrameResult& first = results[static_cast<std::size_t>(index)];
    harmed += first.record.note.find("too little") != std::string::npos ? 1 : 0;
    ASSERT_TRUE(track.can_repeat_motion(index)) << index;
    const MotionAgain again = track.motion_before(index, read).repeat(read(index), &first.record);
    ASSERT_EQ(again.mask.empty(), first.mask.empty()) << index;
    if (!first.mask.empty()) {
      EXPECT_EQ(cv::norm(again.mask, first.mask, cv::NORM_INF), 0.0) << index;
    }
    EXPECT_TRUE(same_bytes(again.motion.log_odds, first.motion.log_odds)) << index;
  }
  EXPECT_GT(harmed, 0);
}

TEST_F(SessionDebug, MotionHadAgainFromRecordsIsTheSameToTheBit) {
  config_.run.method = "stillpoint";
  config_.of<StillpointConfig>().far_reference = 9;  // old enough for patches' shifts
  config_.of<StillpointConfig>().slow_reference = 4;
  ReplayableRun track(*source_, config_);
  const ReplayableRun::ReadFrame read = [this](int index) { return source_->read(index); };
  std::vector<FrameResult> results;
  for (int i = 0; i < kDebugFrames; ++i) results.push_back(track.process_next(read));
  const MotionStage describer(source_->camera(), config_);
  for (const int index : {11, 1, 7, 4, 5, 10}) {
    ASSERT_TRUE(track.can_repeat_motion(index)) << index;
    const std::set<int> frames = track.frames_to_repeat(index);
    const FrameResult& first = results[static_cast<std::size_t>(index)];
    std::set<int> used;
    MotionReplay replay = track.motion_before(index, [&](int i) {
      used.insert(i);
      return source_->read(i);
    });
    EXPECT_EQ(used, frames) << index;
    const Frame frame = source_->read(index);
    const MotionAgain again = replay.repeat(frame, &first.record);
    EXPECT_TRUE(same_bytes(again.mask, first.mask)) << index;
    EXPECT_TRUE(same_bytes(again.motion.log_odds, first.motion.log_odds)) << index;
    const StageLog now = describer.describe(frame, again.motion),
                   then = describer.describe(frame, first.motion);
    ASSERT_FALSE(then.stages.empty()) << index;
    for (std::size_t i = 0; i < then.stages.size(); ++i)
      EXPECT_EQ(now.stages[i].frames_back, then.stages[i].frames_back);
    expect_same_stages(now, then);
  }
}

TEST_F(SessionDebug, PreviewsTheFrameShownAndLeavesTheRunAlone) {
  for (const char* method : {"paper", "stillpoint"}) {
    config_.run.method = method;
    const auto s = session();
    s->request(request::GoTo{8});
    s->request(request::GoTo{4});
    const std::string hash = debug(*s).run_hash;
    Config other = config_;
    s->request(request::Preview{other});
    ASSERT_NE(debug(*s).preview, nullptr);
    ASSERT_NE(debug(*s).preview->record, nullptr);
    EXPECT_TRUE(computed_alike(*debug(*s).preview->record, *s->view()->current->record));
    expect_same_stages(*debug(*s).preview->motion, *s->view()->current->motion);
    other.features.count = 200;
    s->request(request::Preview{other});
    EXPECT_LT(debug(*s).preview->record->features_found, s->view()->current->record->features_found);
    s->request(request::GoTo{6});
    EXPECT_EQ(debug(*s).preview->index, 6);
    EXPECT_EQ(debug(*s).run_hash, hash);
    other.features.count = -4;
    s->request(request::Preview{other});
    EXPECT_THAT(s->view()->message, HasSubstr("features.count is -4, expected"));
    s->request(request::Preview{std::nullopt});
    EXPECT_EQ(debug(*s).preview, nullptr);
  }
}

}  // namespace
}  // namespace stillpoint
