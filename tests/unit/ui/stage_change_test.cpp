// What changed in a stage against another: what is compared, and that comparing changes nothing.
#include "core/inspect/stage_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/inspect/frame_stages.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/support/same_stages.hpp"
#include "tests/unit/ui/inspect_scene.hpp"
#include "ui/session/session.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 8;

/// Every image of a frame's stages, copied.
std::vector<cv::Mat> images_of(const std::vector<Stage>& stages) {
  std::vector<cv::Mat> images;
  for (const Stage& stage : stages)
    for (const StageSide& side : stage.sides) {
      for (const Layer& input : side.inputs) images.push_back(input.image.clone());
      images.push_back(side.output.image.clone());
    }
  return images;
}

/// All but that of masks made elsewhere, which has no stages without these.
std::vector<std::string> methods_looked_at() {
  std::vector<std::string> names = method_names();
  std::erase(names, "masks");
  return names;
}

class LookingAtStages : public ::testing::TestWithParam<std::string> {};

TEST_P(LookingAtStages, ChangesNeitherThemNorTheRun) {
  const auto source = rendered("walking_xyz", kFrames);
  Config config;
  config.run.method = GetParam();
  config.features.count = 400;
  Session session(source, config, {.baseline = false});
  session.request_comparison(true);
  int compared = 0;
  for (int i = 0; i < kFrames; ++i) {
    session.go_to(i);
    session.complete();
    const auto view = session.view();
    const FrameView& shown = *view->current;
    const std::vector<Stage> stages = stages_of(shown);
    const std::vector<cv::Mat> before = images_of(stages);
    for (std::size_t k = 0; k < stages.size(); ++k)
      for (std::size_t side = 0; side < stages[k].sides.size(); ++side)
        for (const auto against :
             {ChangeAgainst::kStageBefore, ChangeAgainst::kRoundBefore, ChangeAgainst::kFrameBefore})
          compared += stage_change(shown, view->camera, stages, k, side, against) ? 1 : 0;
    const std::vector<cv::Mat> after = images_of(stages);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_TRUE(same_bytes(before[k], after[k])) << "frame " << i << ", image " << k;
  }
  EXPECT_GT(compared, kFrames);
  std::vector<FrameRecord> records;
  for (int i = 0; i < kFrames; ++i) records.push_back(session.record(i));
  EXPECT_EQ(run_hash(records), run_hash(run_sequence(*source, config).records));
}

INSTANTIATE_TEST_SUITE_P(Methods, LookingAtStages, ::testing::ValuesIn(methods_looked_at()),
                         [](const auto& of) { return of.param; });

/// A stage that takes one layer and makes another.
std::vector<Stage> one_stage(const Layer& before, const Layer& now) {
  Stage stage;
  stage.id = "stage";
  stage.add_side({before}, now);
  return {stage};
}

Layer layer_of(LayerKind kind, const cv::Mat& image) {
  Layer layer;
  layer.name = "Before";
  layer.kind = kind;
  layer.image = image;
  layer.range = 6.0;
  return layer;
}

StageChange change_of(const Layer& before, const Layer& now) {
  const InspectScene scene;
  return stage_change(scene.view, scene.camera, one_stage(before, now), 0, 0, ChangeAgainst::kStageBefore)
      .value();
}

TEST(StageChanges, OfGreyLevelsIsTheirMeanDifference) {
  const cv::Mat before(4, 5, CV_32FC1, cv::Scalar(100.0)), now(4, 5, CV_32FC1, cv::Scalar(97.5));
  const StageChange change = change_of(layer_of(LayerKind::kPhoto, before), layer_of(LayerKind::kPhoto, now));
  EXPECT_EQ(change.text, "mean change 2.50 grey levels");
  EXPECT_EQ(change.layer.image.at<float>(2, 2), -2.5F);
  EXPECT_EQ(now.at<float>(2, 2), 97.5F);
  EXPECT_EQ(before.at<float>(2, 2), 100.0F);
}

TEST(StageChanges, OfClassesCountsPixelsAndKnowsNoGreyLevels) {
  const cv::Mat before(4, 5, CV_8UC1, cv::Scalar(6));
  cv::Mat now = before.clone();
  now.row(1).setTo(1);
  const StageChange change =
      change_of(layer_of(LayerKind::kClasses, before), layer_of(LayerKind::kClasses, now));
  EXPECT_EQ(change.text, "5 px of another class");
  EXPECT_EQ(change.layer.kind, LayerKind::kClasses);
  EXPECT_EQ(cv::countNonZero(change.layer.image), 5);
  EXPECT_EQ(change.layer.image.at<std::uint8_t>(1, 0), 1);
}

TEST(StageChanges, OfMasksAreGainedLostAndStay) {
  cv::Mat before = cv::Mat::zeros(4, 5, CV_8UC1), now = before.clone();
  before.row(0).setTo(255), now.col(0).setTo(255);
  const StageChange change = change_of(layer_of(LayerKind::kMask, before), layer_of(LayerKind::kMask, now));
  EXPECT_EQ(change.text, "3 px gained, 4 px lost, 1 px stay");
}

TEST(Layers, SayWhatTheirMarksStandFor) {
  Layer layer;
  EXPECT_EQ(layer.word_of(MarkKind::kOutlier), "outlier");
  EXPECT_EQ(layer.word_of(MarkKind::kRemoved), "removed");
  layer.words = {{MarkKind::kOutlier, "undecided"}};
  EXPECT_EQ(layer.word_of(MarkKind::kOutlier), "undecided");
  EXPECT_EQ(layer.word_of(MarkKind::kInlier), "inlier");
}

}  // namespace
}  // namespace stillpoint::testing
