#include "ui/session/session.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "core/run/run_hash.hpp"
#include "core/run/run_report.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/same_stages.hpp"

namespace stillpoint {
namespace {

constexpr int kSessionFrames = 12;

Config config_of(const std::string& method) {
  Config config;
  config.run.method = method;
  config.features.count = 400;
  config.tracking.smoother_lag_frames = 4;  // within the few frames there are
  return config;
}

class SessionTest : public ::testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] RunResult batch() const {
    RunOptions options;
    options.keep_features = true;
    return run_sequence(*source_, config_, options);
  }

  std::vector<FrameRecord> records_of(const Session& session) const {
    std::vector<FrameRecord> records;
    for (int i = 0; i < session.view()->processed; ++i) records.push_back(session.record(i));
    return records;
  }

  SmallSequence folder_{kSessionFrames};
  std::shared_ptr<const FrameSource> source_ = open_sequence(folder_.path());
  Config config_ = config_of(GetParam());
};

TEST_P(SessionTest, EqualsABatchRunWhicheverWayOneGoes) {
  Session session(source_, config_);
  std::mt19937 random(5);
  for (int step = 0; step < 30; ++step) {
    const int wanted = static_cast<int>(random() % kSessionFrames);
    session.go_to(wanted);
    EXPECT_EQ(session.view()->current->index, wanted);
    ASSERT_NE(session.view()->current->record, nullptr);
    EXPECT_TRUE(computed_alike(*session.view()->current->record, session.record(wanted)));
  }
  session.go_to(kSessionFrames - 1);
  const RunResult expected = batch();
  EXPECT_EQ(run_hash(records_of(session)), run_hash(expected.records));
  const auto view = session.view();
  ASSERT_EQ(view->run->trajectory.size(), expected.trajectory.size());
  for (std::size_t i = 0; i < expected.trajectory.size(); ++i)
    EXPECT_TRUE(
        view->run->trajectory[i].world_from_camera.isApprox(expected.trajectory[i].world_from_camera, 0.0));
  EXPECT_EQ(&*view->ground_truth, &source_->ground_truth()) << "the sequence's own, not a copy";
  EXPECT_EQ(view->keyframes->size(), expected.keyframes.size());
  EXPECT_EQ(view->map_points->size(), expected.points.size());
}

TEST_P(SessionTest, ReplayingAFrameGivesItsImagesAgain) {
  ReplayableRun track(*source_, config_, {.checkpoint_every = 5, .max_checkpoints = 2});
  const ReplayableRun::ReadFrame read = [this](int index) { return source_->read(index); };
  std::vector<FrameResult> results;
  for (int i = 0; i < kSessionFrames; ++i) results.push_back(track.process_next(read));
  EXPECT_LE(track.checkpoints(), 2);
  for (const int index : {11, 0, 7, 4, 5}) {
    const FrameResult& first = results[static_cast<std::size_t>(index)];
    const FrameResult again = track.replay(index, read);
    EXPECT_EQ(run_hash(std::vector{again.record}), run_hash(std::vector{track.record(index)})) << index;
    ASSERT_EQ(again.mask.empty(), first.mask.empty()) << index;
    if (!first.mask.empty()) {
      EXPECT_EQ(cv::norm(again.mask, first.mask, cv::NORM_INF), 0.0) << index;
    }
    EXPECT_TRUE(same_bytes(again.motion.log_odds, first.motion.log_odds)) << index;
  }
}

TEST_P(SessionTest, ShowsTheMaskTheMethodUsedAfterManyOtherFrames) {
  Session session(source_, config_);
  session.go_to(3);
  const auto before = session.view()->current;
  session.go_to(kSessionFrames - 1);
  // Enough frames in between for what was kept of frame 3 to have gone.
  for (int i = 4; i < kSessionFrames; ++i) session.go_to(i);
  session.go_to(3);
  const auto after = session.view()->current;
  ASSERT_EQ(before->mask.empty(), after->mask.empty());
  if (!before->mask.empty()) {
    EXPECT_EQ(cv::norm(before->mask, after->mask, cv::NORM_INF), 0.0);
  }
  expect_same_stages(*before->motion, *after->motion);
}

TEST_P(SessionTest, TheImageIsShownBeforeWhatLiesOverIt) {
  Session session(source_, config_);
  std::mutex mutex;
  std::vector<std::shared_ptr<const FrameView>> seen;
  session.start([&] {
    const auto view = session.view();
    const std::lock_guard lock(mutex);
    if (seen.empty() || seen.back() != view->current) seen.push_back(view->current);
    if (view->current->image_alone) {
      EXPECT_TRUE(view->busy);
    }
  });
  const auto until = [&](int index) {
    for (int tries = 0; tries < 12000; ++tries) {
      {
        const std::lock_guard lock(mutex);
        if (!seen.empty() && seen.back()->index == index && seen.back()->record != nullptr) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  session.request_frame(5);
  ASSERT_TRUE(until(5));
  {
    const std::lock_guard lock(mutex);
    ASSERT_GE(seen.size(), 2U);
    const FrameView &image = *seen[seen.size() - 2], &whole = *seen.back();
    EXPECT_TRUE(image.image_alone);
    EXPECT_EQ(image.index, 5);
    EXPECT_EQ(image.record, nullptr);
    EXPECT_FALSE(whole.image_alone);
    EXPECT_EQ(cv::norm(image.frame.gray, whole.frame.gray, cv::NORM_INF), 0.0);
  }
  // What is at hand has no image first, and a step forward still knows the frame before it.
  session.request_frame(4);
  ASSERT_TRUE(until(4));
  session.request_frame(5);
  ASSERT_TRUE(until(5));
  const std::lock_guard lock(mutex);
  EXPECT_EQ(seen[seen.size() - 2]->index, 4);
  ASSERT_NE(seen.back()->before, nullptr);
  EXPECT_EQ(seen.back()->before->index, 4);
}

TEST_P(SessionTest, TheWorkerComesToTheSame) {
  Session session(source_, config_);
  std::mutex mutex;
  std::condition_variable changed;
  session.start([&] {
    const std::lock_guard lock(mutex);
    changed.notify_all();
  });
  const auto wait_for = [&](auto&& holds) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(120), [&] { return holds(*session.view()); });
  };
  session.request_frame(5);
  EXPECT_TRUE(
      wait_for([](const SessionView& view) { return view.current->index == 5 && view.current->record; }));
  session.request_frame(2);
  EXPECT_TRUE(wait_for([](const SessionView& view) { return view.current->index == 2; }));
  session.request_speed(1000);
  session.request_play(true);
  EXPECT_TRUE(wait_for(
      [](const SessionView& view) { return view.current->index == kSessionFrames - 1 && !view.playing; }));
  const RunResult expected = batch();
  ASSERT_EQ(session.view()->run->records.size(), expected.records.size());
  for (std::size_t i = 0; i < expected.records.size(); ++i) {
    EXPECT_EQ(session.view()->run->records[i].inliers, expected.records[i].inliers) << i;
    EXPECT_TRUE(session.view()->run->records[i].world_from_camera.isApprox(
        expected.records[i].world_from_camera, 0.0))
        << i;
  }
}

TEST_P(SessionTest, RunsStayWhileFramesAreAddedAndAreLevelAtRest) {
  // So long that none would be made anew before the end, were it not for coming to rest.
  Session session(source_, config_, {.runs_wait = 1000000000});
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::pair<std::size_t, bool>> seen;  // records, and whether frames were being added
  session.start([&] {
    const auto view = session.view();
    const std::lock_guard lock(mutex);
    EXPECT_LE(view->run->records.size(), static_cast<std::size_t>(view->processed));
    for (const GhostView& ghost : view->debug.ghosts) EXPECT_NE(ghost.run, nullptr);
    seen.emplace_back(view->run->records.size(), view->playing);
    changed.notify_all();
  });
  const auto comes_to = [&](int frame) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(120), [&] {
      const auto view = session.view();
      return view->current->index == frame && view->current->record != nullptr && !view->playing;
    });
  };
  session.request_frame(2);
  ASSERT_TRUE(comes_to(2));
  EXPECT_EQ(session.view()->run->records.size(), 3U);
  session.request(request::AddGhost{config_, "another", 0});
  session.request_speed(1000);
  session.request_play(true);
  ASSERT_TRUE(comes_to(kSessionFrames - 1));
  const auto last = session.view();
  EXPECT_EQ(last->run->records.size(), static_cast<std::size_t>(kSessionFrames));
  EXPECT_EQ(last->run->trajectory.size(), batch().trajectory.size());
  EXPECT_EQ(last->baseline == nullptr, method_of(config_).baseline);
  if (last->baseline) {
    EXPECT_EQ(last->baseline->records.size(), static_cast<std::size_t>(kSessionFrames));
  }
  ASSERT_EQ(last->debug.ghosts.size(), 1U);
  const std::lock_guard lock(mutex);
  // The first of those shown while it played may have been made when the ghost came, the others wait.
  std::set<std::size_t> while_playing;
  for (const auto& [records, playing] : seen)
    if (playing) while_playing.insert(records);
  EXPECT_LE(while_playing.size(), 2U);
  EXPECT_FALSE(while_playing.empty());
}

INSTANTIATE_TEST_SUITE_P(Methods, SessionTest, ::testing::Values("none", "paper", "stillpoint"));

TEST_P(SessionTest, AFrameIsShownWithThoseBeforeIt) {
  Session session(source_, config_, {.keep_times = false});
  session.go_to(4);
  session.go_to(5);
  const auto forward = session.view()->current;
  ASSERT_NE(forward->before, nullptr);
  EXPECT_EQ(forward->before->index, 4);
  EXPECT_EQ(forward->before->before, nullptr);
  ASSERT_EQ(forward->history.size(), 5U);
  EXPECT_EQ(forward->history[0]->index, 4);
  EXPECT_EQ(run_hash(std::vector{*forward->history[2]}), run_hash(std::vector{session.record(2)}));
  for (const Stage& stage : forward->motion->stages) EXPECT_EQ(stage.ms, 0.0) << stage.id;
  session.go_to(3);
  EXPECT_EQ(session.view()->current->before, nullptr);
  session.complete();
  const auto completed = session.view()->current;
  EXPECT_EQ(completed->index, 3);
  ASSERT_NE(completed->before, nullptr);
  EXPECT_EQ(completed->before->index, 2);
  EXPECT_EQ(run_hash(std::vector{*completed->before->record}), run_hash(std::vector{session.record(2)}));
  session.go_to(0);
  session.complete();
  EXPECT_EQ(session.view()->current->before, nullptr);
}

TEST_P(SessionTest, TheWorkerComparesFramesWhereThatIsWanted) {
  Session session(source_, config_);
  std::mutex mutex;
  std::condition_variable changed;
  session.start([&] {
    const std::lock_guard lock(mutex);
    changed.notify_all();
  });
  const auto wait_for = [&](auto&& holds) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(120), [&] { return holds(*session.view()->current); });
  };
  session.request_frame(5);
  EXPECT_TRUE(wait_for([](const FrameView& view) { return view.index == 5 && view.record != nullptr; }));
  session.request_frame(3);
  EXPECT_TRUE(wait_for([](const FrameView& view) { return view.index == 3; }));
  EXPECT_EQ(session.view()->current->before, nullptr);
  session.request_comparison(true);
  EXPECT_TRUE(
      wait_for([](const FrameView& view) { return view.before != nullptr && view.before->index == 2; }));
}

TEST(Session, RunsABaselineBesideOtherMethodsAlone) {
  const SmallSequence folder(4);
  const std::shared_ptr<const FrameSource> source = open_sequence(folder.path());
  Session paper(source, config_of("paper"));
  paper.go_to(3);
  ASSERT_NE(paper.view()->baseline, nullptr);
  EXPECT_EQ(paper.view()->baseline->name, "none");
  EXPECT_EQ(paper.view()->baseline->records.size(), 4U);
  Session none(source, config_of("none"));
  none.go_to(3);
  EXPECT_EQ(none.view()->baseline, nullptr);
}

TEST(Session, TheBaselineHasPicturesOnceTheyAreWanted) {
  const SmallSequence folder(6);
  const std::shared_ptr<const FrameSource> source = open_sequence(folder.path());
  Session session(source, config_of("paper"));
  session.go_to(5);
  EXPECT_EQ(session.view()->baseline_frame.current, nullptr);
  EXPECT_EQ(session.view()->baseline_config.run.method, "none");
  session.request_baseline(true);
  Session alone(source, config_of("none"));
  for (const int index : {5, 2, 0, 4}) {
    session.go_to(index);
    alone.go_to(index);
    const BesideFrame shown = session.view()->baseline_frame;
    ASSERT_NE(shown.current, nullptr) << index;
    EXPECT_EQ(shown.current->index, index);
    ASSERT_NE(shown.current->record, nullptr);
    EXPECT_FALSE(shown.current->record->features.empty());
    EXPECT_EQ(run_hash(std::vector{*shown.current->record}),
              run_hash(std::vector{*alone.view()->current->record}));
    expect_same_stages(*shown.current->motion, *alone.view()->current->motion);
    ASSERT_EQ(shown.other == nullptr, index == 0);
    if (index > 0) {
      EXPECT_EQ(run_hash(std::vector{*shown.other->record}), run_hash(std::vector{alone.record(index - 1)}));
    }
  }
  session.request_baseline(false);
  session.go_to(1);
  EXPECT_EQ(session.view()->baseline_frame.current, nullptr);
}

TEST(Session, FramesBeyondTheEndsAreTheNearestThereAre) {
  const SmallSequence folder(3);
  Session session(open_sequence(folder.path()), config_of("none"));
  session.go_to(1000);
  EXPECT_EQ(session.view()->current->index, 2);
  session.go_to(-5);
  EXPECT_EQ(session.view()->current->index, 0);
}

}  // namespace
}  // namespace stillpoint
