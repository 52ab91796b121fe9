// A finished run in a session: what its records hold at once, and the rest bit for bit as the run had it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/run/open_run.hpp"
#include "core/run/outside_run.hpp"
#include "core/run/run_report.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/same_stages.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

constexpr int kFrames = 9;

class RecordedSession : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    config_.run.method = GetParam();
    config_.features.count = 400;
    source_ = open_sequence(sequence_.path());
  }

  /// Runs the first `frames` frames, keeps their records in a folder, and opens that.
  [[nodiscard]] OpenedRun recorded(int frames) const { return recorded(frames, config_, "run"); }
  [[nodiscard]] OpenedRun recorded(int frames, const Config& config, const std::string& name) const {
    const std::string folder = out_.path(name);
    std::filesystem::create_directories(folder);
    RecordsWriter writer(folder, origin_of(*source_, sequence_.path(), {}), config);
    RunOptions options;
    options.count = frames;
    options.on_frame = [&](const FrameResult& frame) { writer.add(frame); };
    const RunResult run = run_sequence(*source_, config, options);
    writer.finish(run, source_->ground_truth());
    return open_run(folder);
  }

  [[nodiscard]] static SessionOptions options_of(const OpenedRun& run) {
    SessionOptions options;
    options.recorded = run.recorded;
    options.no_images = run.no_images;
    return options;
  }

  SmallSequence sequence_{kFrames};
  TemporaryFolder out_{"out"};
  Config config_;
  std::shared_ptr<const FrameSource> source_;
};

TEST_P(RecordedSession, HasPicturesOfItsBaselineAsFarAsThatWent) {
  Config plain = config_;
  plain.run.method = "none";
  const OpenedRun run = recorded(kFrames), baseline = recorded(6, plain, "none");
  SessionOptions options = options_of(run);
  options.recorded_baseline = baseline.recorded;
  Session session(run.source, config_, options), live(source_, plain);
  session.request_baseline(true);
  for (const int index : {5, 2}) {
    session.go_to(index);
    live.go_to(index);
    const auto shown = session.view()->baseline_frame.current;
    ASSERT_NE(shown, nullptr);
    EXPECT_EQ(run_hash(std::vector{*shown->record}), run_hash(std::vector{*live.view()->current->record}));
    EXPECT_FALSE(shown->record->features.empty());
  }
  EXPECT_EQ(session.view()->baseline_config.run.method, "none");
  session.go_to(kFrames - 1);
  EXPECT_EQ(session.view()->baseline_frame.current, nullptr);
  EXPECT_EQ(session.view()->baseline->records.size(), 6U);
}

TEST_P(RecordedSession, ShowsEveryFrameAtOnceAsItWas) {
  const OpenedRun run = recorded(kFrames);
  Session live(source_, config_);
  live.go_to(kFrames - 1);
  Session session(run.source, config_, options_of(run));
  EXPECT_EQ(session.view()->processed, kFrames);
  for (const int index : {8, 3, 0, 5}) {
    session.go_to(index);
    live.go_to(index);
    const FrameView &opened = *session.view()->current, &ran = *live.view()->current;
    ASSERT_NE(opened.record, nullptr);
    EXPECT_EQ(run_hash(std::vector{*opened.record}), run_hash(std::vector{*ran.record}));
    EXPECT_EQ(opened.record->features.size(), ran.record->features.size());
    ASSERT_EQ(opened.mask.size(), ran.mask.size()) << index;
    if (!ran.mask.empty()) {
      EXPECT_EQ(cv::norm(opened.mask, ran.mask, cv::NORM_INF), 0.0) << index;
    }
  }
  const auto view = session.view(), expected = live.view();
  EXPECT_EQ(view->keyframes->size(), expected->keyframes->size());
  EXPECT_EQ(view->map_points->size(), expected->map_points->size());
  ASSERT_EQ(view->run->trajectory.size(), expected->run->trajectory.size());
  EXPECT_EQ(view->run->evaluation.ate.translation_m.rmse, expected->run->evaluation.ate.translation_m.rmse);
}

TEST_P(RecordedSession, CaughtUpHasTheStagesToo) {
  const OpenedRun run = recorded(kFrames);
  SessionOptions options = options_of(run);
  options.catch_up = true;
  Session live(source_, config_), session(run.source, config_, options);
  live.go_to(6);
  session.go_to(6);
  expect_same_stages(*session.view()->current->motion, *live.view()->current->motion);
}

TEST_P(RecordedSession, ARunThatWasStoppedGoesOnAsIfItHadNotBeen) {
  const OpenedRun run = recorded(4);
  Session session(run.source, config_, options_of(run));
  EXPECT_EQ(session.view()->processed, 4);
  session.go_to(kFrames - 1);
  ASSERT_EQ(session.view()->processed, kFrames);
  std::vector<FrameRecord> records;
  for (int i = 0; i < kFrames; ++i) records.push_back(session.record(i));
  EXPECT_EQ(run_hash(records), run_hash(run_sequence(*source_, config_).records));
}

TEST_P(RecordedSession, ARunBesideThatWasStoppedGoesOnAsIfItHadNotBeen) {
  const OpenedRun run = recorded(4);
  SessionOptions options;
  options.beside = {run.recorded};
  Session session(source_, config_, options);
  session.go_to(kFrames - 1);
  const auto view = session.view();
  ASSERT_EQ(view->debug.ghosts.size(), 1U);
  const GhostView& ghost = view->debug.ghosts[0];
  ASSERT_EQ(ghost.run->records.size(), static_cast<std::size_t>(kFrames));
  EXPECT_FALSE(ghost.diverged.has_value());
  for (std::size_t i = 0; i < ghost.run->records.size(); ++i)
    EXPECT_EQ(ghost.run->records[i].world_from_camera.matrix(),
              view->run->records[i].world_from_camera.matrix())
        << i;
}

TEST_P(RecordedSession, WithoutImagesNothingIsLostOrTried) {
  OpenedRun run = recorded(kFrames);
  std::filesystem::remove_all(sequence_.path());
  run = open_run(out_.path("run"));
  ASSERT_NE(run.no_images, "");
  SessionOptions options = options_of(run);
  options.catch_up = true;
  Session session(run.source, config_, options);
  session.go_to(kFrames - 1);
  const auto view = session.view();
  EXPECT_EQ(view->message, run.no_images);
  EXPECT_EQ(view->processed, kFrames);
  EXPECT_FALSE(view->current->frame.readable());
  EXPECT_FALSE(view->current->record->features.empty());
  EXPECT_GT(view->run->evaluation.ate.translation_m.count, 0);
}

/// Another program's trajectory in the place of the session's run.
TEST(OutsideSession, IsNotThrownAwayByARunOfOurs) {
  const SmallSequence sequence{kFrames};
  const TemporaryFolder out{"out"};
  std::string poses;
  for (int i = 0; i < kFrames; ++i)
    poses += fmt::format("{:.4f} {:.3f} 0 0 0 0 0 1\n", SmallSequence::stamp(i), 0.01 * i);
  out.write("orb3.txt", poses);
  const std::shared_ptr<const FrameSource> source = open_sequence(sequence.path());
  std::vector<std::string> warnings;
  SessionOptions options;
  options.recorded = std::make_shared<const RecordedRun>(
      read_outside_run(*source, {}, outside_run_argument("orb3=" + out.path("orb3.txt")), warnings));
  Config config;
  config.run.method = "none";
  config.features.count = 400;
  Session session(source, config, options);
  ASSERT_EQ(session.view()->outside, "orb3");
  EXPECT_TRUE(session.view()->debug.ghosts.empty());
  config.run.method = "stillpoint";
  for (int times = 0; times < 2; ++times) {  // of which only the first finds it in its place
    session.request(request::RunAll{config});
    const auto view = session.view();
    EXPECT_EQ(view->outside, "");
    ASSERT_EQ(view->debug.ghosts.size(), 1U);
    const GhostView& ghost = view->debug.ghosts.front();
    EXPECT_EQ(ghost.name, "orb3");
    EXPECT_TRUE(ghost.outside);
    EXPECT_EQ(ghost.run->records.size(), static_cast<std::size_t>(kFrames));
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, RecordedSession, ::testing::Values("none", "paper", "stillpoint"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace stillpoint
