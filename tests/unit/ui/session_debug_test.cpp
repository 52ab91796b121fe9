#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <random>

#include "core/run/open_run.hpp"
#include "core/run/record_codec.hpp"
#include "core/run/run_report.hpp"
#include "tests/cli/small_sequence.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kFrames = 12;

class SessionDebug : public ::testing::Test {
 protected:
  SessionDebug() {
    config_.run.method = "paper";
    config_.features.count = 400;
  }
  [[nodiscard]] std::unique_ptr<Session> session(bool baseline = false) const {
    return std::make_unique<Session>(source_, config_, SessionOptions{.baseline = baseline});
  }
  [[nodiscard]] RunResult batch(const Config& config, int frames) const {
    RunOptions options;
    options.count = frames;
    return run_sequence(*source_, config, options);
  }
  static const DebugView& debug(const Session& session) {
    static std::shared_ptr<const SessionView> view;
    view = session.view();
    return view->debug;
  }

  SmallSequence folder_{kFrames};
  std::shared_ptr<const FrameSource> source_ = open_sequence(folder_.path());
  Config config_;
};

TEST_F(SessionDebug, RequestsAreCarriedOutAtOnceWithoutAWorker) {
  const auto s = session();
  s->request(request::GoTo{5});
  EXPECT_EQ(s->view()->current->index, 5);
  EXPECT_EQ(s->view()->processed, 6);
  s->request(request::Play{true});
  EXPECT_EQ(s->view()->current->index, kFrames - 1);
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
  EXPECT_EQ(s->view()->current->index, kFrames - 1);
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

TEST_F(SessionDebug, TheHashIsTheBatchRunsHoweverOneCameThere) {
  const RunResult batch = run_sequence(*source_, config_, {});
  const auto s = session(true);
  std::mt19937 random(3);
  for (int step = 0; step < 12; ++step) s->request(request::GoTo{static_cast<int>(random() % kFrames)});
  s->request(request::GoTo{kFrames - 1});
  s->request(request::GoTo{0});
  EXPECT_EQ(debug(*s).run_hash, run_hash(batch.records));
}

/// All that a record holds, times left out, as bytes.
std::vector<std::uint8_t> bytes_of(FrameRecord record) {
  record.ms = {};
  ByteWriter bytes;
  write_record(bytes, record);
  return bytes.bytes();
}

/// A run that can be looked at, without a session about it.
struct ShownRunFixture {
  ShownRunFixture(const FrameSource& source, const Config& config)
      : frames(source), run(source, frames, RunTrack(source, config)) {}
  FrameCache frames;
  ShownRun run;
};

TEST_F(SessionDebug, AnyFrameShowsTheRecordAndTheMaskOfABatchRun) {
  for (const char* method : {"none", "paper", "stillpoint", "oracle"}) {
    config_.run.method = method;
    std::vector<FrameResult> expected;
    RunOptions options;
    options.on_frame = [&](const FrameResult& frame) { expected.push_back(frame); };
    (void)run_sequence(*source_, config_, options);
    const auto s = session(true);
    std::mt19937 random(11);
    std::vector<int> way = {3, 2, 1, 0, kFrames - 1, kFrames - 2};
    for (int step = 0; step < 30; ++step) way.push_back(static_cast<int>(random() % kFrames));
    for (const int frame : way) {
      s->request(request::GoTo{frame});
      const auto view = s->view()->current;
      const FrameResult& batch_frame = expected[static_cast<std::size_t>(frame)];
      EXPECT_EQ(bytes_of(*view->record), bytes_of(batch_frame.record)) << method << " " << frame;
      ASSERT_EQ(view->mask.empty(), batch_frame.mask.empty()) << method << " " << frame;
      if (!view->mask.empty()) {
        EXPECT_EQ(cv::norm(view->mask, batch_frame.mask, cv::NORM_INF), 0.0) << method << " " << frame;
      }
    }
  }
}

/// True masks, one a frame: a square that stands for what moves.
void write_masks(const SmallSequence& sequence) {
  std::string list;
  cv::Mat mask = cv::Mat::zeros(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1);
  mask(cv::Rect(40, 40, 60, 60)).setTo(255);
  for (int i = 0; i < kFrames; ++i) {
    const std::string file = fmt::format("mask/{}.png", i);
    sequence.folder.write(file, mask);
    list += fmt::format("{:.4f} {}\n", SmallSequence::stamp(i), file);
  }
  sequence.folder.write("mask.txt", list);
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

TEST_F(SessionDebug, AFinishedRunsMasksAreScoredAsTheyWere) {
  write_masks(folder_);
  config_.run.method = "oracle";
  const TemporaryFolder out;
  {
    Session first(std::shared_ptr<const FrameSource>(open_sequence(folder_.path())), config_,
                  {.baseline = false});
    first.request(request::GoTo{3});
    first.request(request::ExportSession{out.path("run")});
    ASSERT_EQ(first.view()->message, "");
  }
  const OpenedRun run = open_run(out.path("run"));
  SessionOptions options;
  options.recorded = run.recorded;
  Session other(run.source, run.recorded->run.config, options);
  other.request(request::Breakpoints{{{"mask_iou > 99%", true}}});
  EXPECT_THAT(debug(other).breakpoints[0].hits, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(debug(other).breakpoints[0].note, "");
}

TEST_F(SessionDebug, ABreakpointSaysWhatNoFrameHas) {
  const auto s = session();
  s->request(request::GoTo{4});
  s->request(request::Breakpoints{{{"mask_iou < 50% || step > 2", true}, {"inliers > 0", true}}});
  EXPECT_THAT(debug(*s).breakpoints[0].note, ::testing::AllOf(HasSubstr("step"), HasSubstr("mask_iou")));
  EXPECT_EQ(debug(*s).breakpoints[1].note, "");
}

TEST_F(SessionDebug, APreviewsMotionStagesComeFirstAndAreThoseOfTheWhole) {
  config_.run.method = "stillpoint";
  ShownRunFixture at(*source_, config_);
  for (int i = 0; i < kFrames; ++i) at.run.process(source_->read(i));
  for (const int index : {10, 4, 11}) {
    // Under the run's own config it is what the run had, and the whole what the motion stages were.
    const auto motion = at.run.motion_preview(index, config_);
    ASSERT_NE(motion, nullptr) << index;
    while (!at.run.prepare_preview(index)) {
    }
    const auto whole = at.run.preview(index, config_);
    EXPECT_EQ(cv::norm(motion->mask, whole->mask, cv::NORM_INF), 0.0) << index;
    EXPECT_EQ(cv::norm(motion->depth_motion.log_odds, whole->depth_motion.log_odds, cv::NORM_INF), 0.0);
    EXPECT_EQ(bytes_of(*motion->record), bytes_of(*whole->record)) << index;
    EXPECT_TRUE(computed_alike(*whole->record, at.run.track().record(index)));
  }
  // Another method's stages need nothing of the run's.
  Config paper = config_;
  paper.run.method = "paper";
  const auto other = at.run.motion_preview(5, paper);
  ASSERT_NE(other, nullptr);
  EXPECT_FALSE(other->motion.rounds.empty());
  paper.run.method = "oracle";
  EXPECT_EQ(at.run.motion_preview(5, paper), nullptr);
}

TEST_F(SessionDebug, WhatLeftTooLittleIsRepeatedAsTheRunHadIt) {
  config_.run.method = "stillpoint";
  config_.depth_motion.moving_log_odds = -3.9;  // all moves: what is left is too little
  RunTrack track(*source_, config_);
  const RunTrack::ReadFrame read = [this](int index) { return source_->read(index); };
  std::vector<FrameResult> results;
  for (int i = 0; i < kFrames; ++i) results.push_back(track.process_next(read));
  int harmed = 0;
  for (int index = 1; index < kFrames; ++index) {
    const FrameResult& first = results[static_cast<std::size_t>(index)];
    harmed += first.record.note.find("too little") != std::string::npos ? 1 : 0;
    if (!track.frames_to_repeat(index)) continue;
    const FrameResult again = track.repeat_motion(index, read);
    ASSERT_EQ(again.mask.empty(), first.mask.empty()) << index;
    if (!first.mask.empty()) {
      EXPECT_EQ(cv::norm(again.mask, first.mask, cv::NORM_INF), 0.0) << index;
    }
    EXPECT_EQ(cv::norm(again.depth_motion.log_odds, first.depth_motion.log_odds, cv::NORM_INF), 0.0) << index;
  }
  EXPECT_GT(harmed, 0);
}

TEST_F(SessionDebug, MotionHadAgainFromRecordsIsTheSameToTheBit) {
  config_.run.method = "stillpoint";
  config_.depth_motion.far_reference = 3;
  config_.depth_motion.slow_reference = 5;
  RunTrack track(*source_, config_);
  const RunTrack::ReadFrame read = [this](int index) { return source_->read(index); };
  std::vector<FrameResult> results;
  for (int i = 0; i < kFrames; ++i) results.push_back(track.process_next(read));
  EXPECT_FALSE(track.frames_to_repeat(0).has_value());
  for (const int index : {11, 1, 7, 4, 5, 10}) {
    const auto frames = track.frames_to_repeat(index);
    ASSERT_TRUE(frames.has_value()) << index;
    EXPECT_EQ(*frames->rbegin(), index);
    std::set<int> used;
    const FrameResult again = track.repeat_motion(index, [&](int i) {
      used.insert(i);
      return source_->read(i);
    });
    EXPECT_EQ(used, *frames);
    const FrameResult& first = results[static_cast<std::size_t>(index)];
    EXPECT_EQ(cv::norm(again.mask, first.mask, cv::NORM_INF), 0.0) << index;
    EXPECT_EQ(cv::norm(again.depth_motion.log_odds, first.depth_motion.log_odds, cv::NORM_INF), 0.0) << index;
    EXPECT_EQ(cv::norm(again.depth_motion.prior, first.depth_motion.prior, cv::NORM_INF), 0.0) << index;
    ASSERT_EQ(again.depth_motion.references.size(), first.depth_motion.references.size()) << index;
  }
}

TEST_F(SessionDebug, AGhostWithTheSameConfigIsTheSameRun) {
  for (const char* method : {"none", "paper", "stillpoint"}) {
    config_.run.method = method;
    const auto s = session();
    s->request(request::GoTo{kFrames - 1});
    s->request(request::AddGhost{config_, "same", 5});
    s->request(request::AddGhost{config_, "same from the first", 0});
    ASSERT_EQ(debug(*s).ghosts.size(), 2U);
    for (const GhostView& ghost : debug(*s).ghosts) {
      EXPECT_FALSE(ghost.busy);
      EXPECT_FALSE(ghost.diverged.has_value()) << method << " " << *ghost.diverged;
      EXPECT_EQ(ghost.run->records.size(), static_cast<std::size_t>(kFrames));
      EXPECT_EQ(run_hash(ghost.run->records), debug(*s).run_hash) << method;
      ASSERT_NE(ghost.current, nullptr);
      EXPECT_EQ(ghost.current->index, kFrames - 1);
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
  s->request(request::GoTo{kFrames - 1});
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
    s->request(request::GoTo{kFrames - 1});
    Config other = config_;
    other.run.method = to;
    s->request(request::AddGhost{other, to, 6});
    const GhostView ghost = debug(*s).ghosts[0];
    EXPECT_EQ(ghost.from, 6);
    EXPECT_EQ(ghost.run->name, to);
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
    EXPECT_EQ(debug(*s).preview->motion.rounds.size(), s->view()->current->motion.rounds.size());
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

TEST_F(SessionDebug, ExportedFramesShowTheSame) {
  const auto s = session();
  s->request(request::Span{FrameSpan{3, 6}, false});
  const TemporaryFolder out;
  s->request(request::ExportFrames{out.path("part")});
  ASSERT_EQ(s->view()->message, "");
  const auto part = open_sequence(out.path("part"));
  ASSERT_EQ(part->size(), 4);
  for (int i = 0; i < 4; ++i) {
    const Frame a = part->read(i), b = source_->read(i + 3);
    EXPECT_NEAR(a.timestamp, b.timestamp, 1e-6);
    EXPECT_NEAR(a.depth_timestamp, b.depth_timestamp, 1e-6);
    EXPECT_EQ(cv::norm(a.gray, b.gray, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(a.depth, b.depth, cv::NORM_INF), 0.0);
  }
  EXPECT_FALSE(part->ground_truth().empty());
  s->request(request::ExportFrames{out.path("part")});
  EXPECT_THAT(s->view()->message, HasSubstr("holds a sequence already"));
}

TEST_F(SessionDebug, ExportedFramesKeepTheirNumbers) {
  folder_.folder.write(SmallSequence::colour(4), std::string("no image"));
  folder_.folder.write(SmallSequence::depth(5), std::string("no image"));
  const auto s = session();
  s->request(request::Span{FrameSpan{3, 7}, false});
  const TemporaryFolder out;
  s->request(request::ExportFrames{out.path("part")});
  ASSERT_EQ(s->view()->message, "");
  EXPECT_THAT(debug(*s).notice, ::testing::AllOf(HasSubstr("5 frames"), HasSubstr("without images: 4")));
  const auto part = open_sequence(out.path("part"));
  ASSERT_EQ(part->size(), 5);
  for (int i = 0; i < 5; ++i) {
    const Frame frame = part->read(i);
    EXPECT_NEAR(frame.timestamp, source_->timestamp(i + 3), 1e-6);
    EXPECT_EQ(frame.readable(), i != 1) << i;
    EXPECT_EQ(frame.has_depth(), i != 1 && i != 2) << i;
    EXPECT_EQ(frame.problem.empty(), i != 1 && i != 2) << frame.problem;
  }
}

TEST_F(SessionDebug, ExportsGoOnBesideTheSessionAndCanBeStopped) {
  const auto s = session();
  std::mutex mutex;
  std::condition_variable changed;
  s->start([&] {
    const std::lock_guard lock(mutex);
    changed.notify_all();
  });
  const auto wait_for = [&](auto&& holds) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(120), [&] { return holds(*s->view()); });
  };
  s->request_frame(kFrames - 1);
  EXPECT_TRUE(wait_for([](const SessionView& v) { return v.processed == kFrames; }));
  const TemporaryFolder out;
  s->request(request::ExportSession{out.path("first")});
  s->request(request::ExportSession{out.path("second")});
  EXPECT_TRUE(wait_for([](const SessionView& v) { return !v.message.empty() || !v.debug.notice.empty(); }));
  s->request_frame(2);  // clears the message, and is done whatever is written meanwhile
  EXPECT_TRUE(wait_for([](const SessionView& v) { return v.current->index == 2; }));
  EXPECT_TRUE(wait_for([](const SessionView& v) { return !v.debug.exporting && !v.debug.notice.empty(); }));
  EXPECT_THAT(s->view()->debug.notice, HasSubstr("12 frames, their run"));
  EXPECT_EQ(open_run(out.path("first")).recorded->hash, s->view()->debug.run_hash);

  s->request(request::ExportSession{out.path("third")});
  s->request(request::StopExport{});
  EXPECT_TRUE(wait_for([](const SessionView& v) { return v.debug.notice.find("Stopped") == 0; }));
  EXPECT_FALSE(fs::exists(out.path("third")));
}

TEST_F(SessionDebug, ASessionIsHandedOnAsOneFolder) {
  const auto s = session();
  s->request(request::GoTo{7});
  const std::string hash = debug(*s).run_hash;
  s->request(request::Bookmarks{{{2, "look"}, {9, "beyond what is processed"}}});
  const TemporaryFolder out;
  s->request(request::ExportSession{out.path("session")});
  ASSERT_EQ(s->view()->message, "");
  EXPECT_THAT(debug(*s).notice,
              ::testing::AllOf(HasSubstr("8 frames"), ::testing::Not(HasSubstr("another one"))));

  // It opens where it was not written.
  fs::rename(out.path("session"), out.path("elsewhere"));
  const OpenedRun run = open_run(out.path("elsewhere"));
  EXPECT_EQ(run.no_images, "");
  EXPECT_EQ(run.recorded->hash, hash);
  SessionOptions options;
  options.recorded = run.recorded;
  options.sidecar = SidecarPlaces{out.path("elsewhere"), {}};
  Session other(run.source, run.recorded->run.config, options);
  other.request(request::GoTo{3});
  EXPECT_EQ(other.view()->message, "");
  EXPECT_EQ(other.view()->debug.run_hash, hash);
  EXPECT_THAT(other.view()->debug.bookmarks, ElementsAre(Bookmark{2, "look"}));
  other.request(request::Preview{config_});
  ASSERT_NE(other.view()->debug.preview, nullptr);
  EXPECT_TRUE(computed_alike(*other.view()->debug.preview->record, *other.view()->current->record));

  s->request(request::ExportSession{out.path("elsewhere")});
  EXPECT_THAT(s->view()->message, HasSubstr("elsewhere"));
}

TEST_F(SessionDebug, SavedPresetsAreRead) {
  const auto s = session();
  const TemporaryFolder out;
  config_.motion.max_rounds = 2;
  s->request(request::SavePreset{config_, out.path("mine.toml")});
  EXPECT_EQ(read_config(out.path("mine.toml")), config_);
  s->request(request::SavePreset{config_, out.path("no/such/folder/mine.toml")});
  EXPECT_FALSE(s->view()->message.empty());
}

TEST_F(SessionDebug, TheWorkerDoesTheSame) {
  const auto s = session();
  std::mutex mutex;
  std::condition_variable changed;
  s->start([&] {
    const std::lock_guard lock(mutex);
    changed.notify_all();
  });
  const auto wait_for = [&](auto&& holds) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(120), [&] { return holds(*s->view()); });
  };
  s->request_speed(1000);
  s->request(request::Breakpoints{{{"frame == 6", true}}});
  s->request(request::Play{true});
  EXPECT_TRUE(
      wait_for([](const SessionView& v) { return v.debug.stopped_by == 0 && v.current->index == 6; }));
  Config other = config_;
  other.features.count = 300;
  s->request(request::AddGhost{other, "ghost", 4});
  EXPECT_TRUE(wait_for([](const SessionView& v) {
    return v.debug.ghosts.size() == 1 && !v.debug.ghosts[0].busy &&
           v.debug.ghosts[0].run->records.size() == 7;
  }));
  for (int count = 390; count > 300; count -= 10) {
    other.features.count = count;
    s->request(request::Preview{other});
  }
  EXPECT_TRUE(wait_for(
      [](const SessionView& v) { return v.debug.preview && v.debug.preview_config->features.count == 310; }));
}

}  // namespace
}  // namespace stillpoint
