// Frames had again, and under other parameters: the same as a batch run has them.
#include <random>

#include "tests/unit/ui/session_debug.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

TEST_F(SessionDebug, TheHashIsTheBatchRunsHoweverOneCameThere) {
  const RunResult batch = run_sequence(*source_, config_, {});
  const auto s = session(true);
  std::mt19937 random(3);
  for (int step = 0; step < 12; ++step) s->request(request::GoTo{static_cast<int>(random() % kFrames)});
  s->request(request::GoTo{kFrames - 1});
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
    std::vector<int> way = {3, 2, 1, 0, kFrames - 1, kFrames - 2};
    for (int step = 0; step < 30; ++step) way.push_back(static_cast<int>(random() % kFrames));
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
  config_.depth_motion.far_reference = 9;  // old enough for patches' shifts
  config_.depth_motion.slow_reference = 4;
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
    for (std::size_t i = 0; i < first.depth_motion.references.size(); ++i)
      EXPECT_EQ(again.depth_motion.references[i].reference.frames_back,
                first.depth_motion.references[i].reference.frames_back);
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

}  // namespace
}  // namespace stillpoint
