// What core/odometry/README.md promises of every engine: determinism, checkpoints, stages, masks in front of
// it, lost frames. Nothing here knows an engine by name.
#include "core/odometry/engines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/inspect/frame_stages.hpp"
#include "core/inspect/shown_run.hpp"
#include "core/odometry/odometry.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

constexpr int kFrames = 10;

std::shared_ptr<const FrameSource> people() { return rendered("walking_static", kFrames); }

class EveryEngine : public testing::TestWithParam<std::string> {
 protected:
  EveryEngine() { config_.run.odometry = GetParam(), config_.run.method = "none"; }
  Config config_;
};

TEST_P(EveryEngine, SaysWhatItIs) {
  const EngineInfo& info = engine_named(GetParam());
  EXPECT_NE(info.title, "");
  EXPECT_NE(info.summary, "");
  EXPECT_NE(info.citation, "");
  for (const FigureInfo& figure : info.figures)
    EXPECT_TRUE(figure.name.starts_with(info.name)) << figure.name;
}

TEST_P(EveryEngine, TracksAndGivesTheSameBytesByAnyNumberOfThreads) {
  const auto source = people();
  config_.run.threads = 1;
  const RunResult one = run_sequence(*source, config_);
  EXPECT_EQ(one.tracked(), kFrames);
  config_.run.threads = 3;
  EXPECT_EQ(run_hash(run_sequence(*source, config_).records), run_hash(one.records));
  EXPECT_THAT(to_text(report_on(one, *source)), testing::HasSubstr("method none, odometry " + GetParam()));
  EXPECT_EQ(to_summary(report_on(one, *source), one, *source)["odometry"], GetParam());
}

TEST_P(EveryEngine, WhatItDoesNotMeasureStaysUntouchedAndIsTold) {
  const auto source = people();
  config_.map.cull_dynamic = true;
  config_.run.method = "oracle";
  const RecordParts& measures = engine_named(GetParam()).measures;
  int features = 0, keyframes = 0;
  for (const FrameRecord& r : run_sequence(*source, config_).records) {
    EXPECT_EQ(r.measured.points, measures.points);
    EXPECT_EQ(r.measured.bundle, measures.bundle);
    // A figure that is left out was none: nothing that an engine counts is hidden.
    EXPECT_TRUE(measures.points || r.map_points + r.new_points + r.culled_points == 0) << r.index;
    EXPECT_TRUE(measures.fused_points || r.fused_points == 0) << r.index;
    EXPECT_TRUE(measures.culled_keyframes || r.culled_keyframes == 0) << r.index;
    EXPECT_TRUE(measures.bundle || r.bundle_iterations == 0) << r.index;
    EXPECT_TRUE(measures.direct || r.direct.patches == 0) << r.index;
    features += measures.features ? r.features_found : 1;
    keyframes += measures.keyframes ? r.map_keyframes : 1;
  }
  // … and what it says that it measures is there.
  EXPECT_GT(features, 0);
  EXPECT_GT(keyframes, 0);
}

TEST_P(EveryEngine, ACopyGoesOnAsTheOriginalWould) {
  const auto source = people();
  Odometry odometry(source->camera(), config_);
  for (int i = 0; i < 5; ++i) (void)odometry.process(source->read(i));
  Odometry copy = odometry;
  copy.drop_images();
  copy.restore_images(5, [&](int i) { return source->read(i); });
  for (int i = 5; i < kFrames; ++i) {
    const FrameResult mine = odometry.process(source->read(i)), its = copy.process(source->read(i));
    EXPECT_TRUE(computed_alike(mine.record, its.record)) << i;
  }
}

TEST_P(EveryEngine, AnEarlierFrameIsShownAgainWithItsStages) {
  const auto source = people();
  FrameCache cache(*source);
  ShownRun shown(*source, cache, ReplayableRun(*source, config_, {.checkpoint_every = 4}));
  for (int i = 0; i < kFrames; ++i) shown.process(source->read(i));
  ShownRun later(*source, cache, ReplayableRun(*source, config_, {.checkpoint_every = 4}));
  for (int i = 0; i < kFrames; ++i) later.process(source->read(i));
  const FrameResult again = later.track().replay(6, later.reader());
  EXPECT_TRUE(computed_alike(again.record, later.track().records()[6]));
  const std::vector<Stage> stages = stages_of(*later.frame_view(6));
  ASSERT_FALSE(stages.empty());
  EXPECT_TRUE(std::any_of(stages.begin(), stages.end(), of_odometry));
  for (const Stage& stage : stages) {
    EXPECT_NE(stage.what, "") << stage.id;
    for (const StageSide& side : stage.sides)
      EXPECT_TRUE(side.output.image.empty() || side.output.image.size() == source->read(6).gray.size())
          << stage.id;
  }
}

TEST_P(EveryEngine, AMaskInFrontOfItIsFollowed) {
  const auto source = people();
  config_.run.method = "oracle";
  const RunResult masked = run_sequence(*source, config_, {.keep_features = true});
  EXPECT_EQ(masked.tracked(), kFrames);
  int removed = 0;
  for (int i = 1; i < kFrames; ++i) {
    const cv::Mat moving = source->truth(i).moving;
    for (const FeatureRecord& feature : masked.records[static_cast<std::size_t>(i)].features) {
      const bool is_moving = moving.at<uchar>(cvRound(feature.pixel.y), cvRound(feature.pixel.x)) != 0;
      removed += feature.fate == FeatureFate::removed ? 1 : 0;
      EXPECT_FALSE(feature.fate == FeatureFate::inlier && is_moving) << i;
    }
  }
  EXPECT_GT(removed, 0);
}

TEST_P(EveryEngine, TellsWhatRemovalDid) {
  const auto source = people();
  config_.run.method = "oracle";
  const std::string plain = run_hash(run_sequence(*source, config_).records);
  config_.run.check_removal = true;
  const RunResult checked = run_sequence(*source, config_);
  EXPECT_EQ(run_hash(checked.records), plain);
  const RemovalCheck& check = checked.records.back().removal_check;
  ASSERT_TRUE(check.nothing_removed && check.truth_removed);
  // The oracle removes the truth.
  EXPECT_LT((check.truth_removed->matrix() - checked.records.back().world_from_camera.matrix()).norm(), 1e-9);
  EXPECT_GT((check.nothing_removed->matrix() - check.truth_removed->matrix()).norm(), 0.0);
}

TEST_P(EveryEngine, ADarkFrameIsLostAndTheRunGoesOn) {
  const auto source = people();
  Odometry odometry(source->camera(), config_);
  for (int i = 0; i < 4; ++i) (void)odometry.process(source->read(i));
  Frame dark = source->read(4);
  dark.gray.setTo(0);
  dark.depth.setTo(0);
  const FrameResult lost = odometry.process(dark);
  EXPECT_EQ(lost.record.status, FrameStatus::lost);
  EXPECT_NE(lost.record.note, "");
  Frame missing = source->read(5);
  missing.gray.release(), missing.depth.release(), missing.colour.release();
  EXPECT_EQ(odometry.process(missing).record.status, FrameStatus::unreadable);
  EXPECT_EQ(odometry.process(source->read(6)).record.status, FrameStatus::relocalised);
  EXPECT_EQ(odometry.process(source->read(7)).record.status, FrameStatus::tracked);
}

TEST_P(EveryEngine, GoesOnUnderAnotherMethodAndNotAsAnotherEngine) {
  const auto source = people();
  Odometry odometry(source->camera(), config_);
  for (int i = 0; i < 4; ++i) (void)odometry.process(source->read(i));
  EXPECT_EQ(odometry.frames_wanted(config_), 0);
  std::optional<Odometry> same = odometry.continued_with(config_, {});
  ASSERT_TRUE(same);
  const FrameResult mine = odometry.process(source->read(4)), its = same->process(source->read(4));
  EXPECT_TRUE(computed_alike(mine.record, its.record));
  Config other = config_;
  for (const EngineInfo& engine : engines())
    if (engine.name != GetParam()) other.run.odometry = engine.name;
  EXPECT_FALSE(odometry.continued_with(other, {}));
}

INSTANTIATE_TEST_SUITE_P(All, EveryEngine, testing::ValuesIn(engine_names()),
                         [](const auto& one) { return one.param; });

TEST(Engines, OneThatIsNotThereIsRefusedByName) {
  Config config;
  EXPECT_THROW(set_parameter(config, "run.odometry=nosuch"), InputError);
  EXPECT_THROW((void)engine_named("nosuch"), InputError);
}

TEST(Engines, TheDefaultIsTheFirst) {
  EXPECT_EQ(engines().front().name, kDefaultEngine);
  EXPECT_EQ(Config().run.odometry, kDefaultEngine);
}

TEST(Engines, ARunIsCalledByItsEngineWhereThatIsNotTheDefault) {
  Config config;
  config.run.method = "paper";
  EXPECT_EQ(run_label(config), "paper");
  EXPECT_EQ(run_words(config), "method paper");
  config.run.odometry = "bamvo";
  EXPECT_EQ(run_label(config), "bamvo/paper");
  EXPECT_EQ(run_words(config), "odometry bamvo, method paper");
}

TEST(Engines, AMethodThatJudgesMatchesStandsOnlyBeforeOneThatHasThem) {
  static const bool registered = [] {
    MethodInfo info;
    info.name = "test_judges_matches";
    info.title = "Judges matches";
    info.needs.first_pose = info.needs.matches = true;
    info.make = method_named("none").make;
    register_method(std::move(info));
    return true;
  }();
  ASSERT_TRUE(registered);
  Config config;
  config.run.method = "test_judges_matches";
  for (const EngineInfo& engine : engines()) {
    config.run.odometry = engine.name;
    EXPECT_EQ(why_no_pair(config).empty(), engine.offers_matches) << engine.name;
    if (engine.offers_matches) continue;
    EXPECT_THROW(Odometry(Camera(), config), InputError) << engine.name;
  }
}

}  // namespace
}  // namespace stillpoint
