#include "ui/session/stages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/ui/inspect_scene.hpp"
#include "ui/session/frame_neighbours.hpp"
#include "ui/session/stage_pictures.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<StageKind> kinds_of(const std::vector<StageInfo>& stages) {
  std::vector<StageKind> kinds;
  for (const StageInfo& stage : stages) kinds.push_back(stage.kind);
  return kinds;
}

const StageInfo& stage_of(const std::vector<StageInfo>& stages, StageKind kind, int round = -1) {
  for (const StageInfo& stage : stages)
    if (stage.kind == kind && stage.round == round) return stage;
  throw std::logic_error("no such stage");
}

const StageFigure& figure_of(const StageInfo& stage, const std::string& name) {
  for (const StageFigure& figure : stage.figures)
    if (figure.name == name) return figure;
  throw std::logic_error("no figure " + name);
}

TEST(Stages, OfThePaperFollowItsTextRoundByRound) {
  using enum StageKind;
  const InspectScene scene;
  const auto stages = stages_of(scene.view, scene.config);
  EXPECT_THAT(kinds_of(stages),
              ElementsAre(kTracks, kHomography, kCompensation, kDifference, kThreshold, kCleanUp, kUnion,
                          kTrackRemoval, kHomography, kCompensation, kDifference, kThreshold, kCleanUp,
                          kUnion, kTrackRemoval, kFeatures, kFeatureRemoval, kMatching, kInitialPose,
                          kRefinement, kMapping, kBundle));
  EXPECT_EQ(stages[1].group, "Round 1");
  EXPECT_EQ(stages[8].group, "Round 2");
}

TEST(Stages, OfTheOthersAreTheirOwn) {
  using enum StageKind;
  InspectScene scene;
  scene.config.run.method = "none";
  EXPECT_EQ(stages_of(scene.view, scene.config).front().kind, kFeatures);
  scene.config.run.method = "stillpoint";
  DepthMotionTrace& trace = scene.view.depth_motion;
  trace.log_odds = trace.prior = cv::Mat::zeros(30, 40, CV_32FC1);
  trace.references.resize(2);
  for (ReferenceEvidence& evidence : trace.references)
    evidence.depth_residual = evidence.intensity_residual = evidence.log_odds = trace.log_odds;
  trace.references[1].depth_residual = cv::Mat(30, 40, CV_32FC1, cv::Scalar(100.0));
  const auto stages = stages_of(scene.view, scene.config);
  const std::vector<StageKind> kinds = kinds_of(stages);
  EXPECT_THAT(
      std::vector<StageKind>(kinds.begin(), kinds.begin() + 13),
      ElementsAre(kSmallView, kFirstPose, kWarp, kDepthResidual, kBrightnessResidual, kEvidence, kWarp,
                  kDepthResidual, kBrightnessResidual, kEvidence, kMemory, kSegments, kMotionMask));
  EXPECT_EQ(figure_of(stages[3], "Farther than the limit").value, 0.0);
  EXPECT_EQ(figure_of(stages[7], "Farther than the limit").value, 100.0);
  scene.view.record = nullptr;
  scene.config.run.method = "none";
  EXPECT_TRUE(stages_of(scene.view, scene.config).empty());
}

TEST(Stages, PatchesShiftsStandWithTheReferenceTheyWereMeasuredAgainst) {
  InspectScene scene;
  scene.config.run.method = "stillpoint";
  DepthMotionTrace& trace = scene.view.depth_motion;
  trace.log_odds = trace.prior = trace.slow = cv::Mat::zeros(30, 40, CV_32FC1);
  trace.labels = cv::Mat::zeros(30, 40, CV_32SC1);
  trace.labels.colRange(20, 40).setTo(1);
  trace.segments.resize(2);
  trace.segments[1].centre = {30.0F, 15.0F};
  trace.references.resize(2);
  for (ReferenceEvidence& evidence : trace.references)
    evidence.depth_residual = evidence.intensity_residual = evidence.log_odds = trace.log_odds;
  trace.references[1].patches = {{{0.0F, 0.0F}, 0.0F, 0.0F}, {{3.0F, 4.0F}, 0.0F, 1.5F}};
  const auto stages = stages_of(scene.view, scene.config);
  const auto is_shifts = [](const StageInfo& stage) { return stage.kind == StageKind::kPatchShifts; };
  ASSERT_EQ(std::count_if(stages.begin(), stages.end(), is_shifts), 1);
  const StageInfo& stage = *std::find_if(stages.begin(), stages.end(), is_shifts);
  EXPECT_EQ(stage.reference, 1);
  EXPECT_EQ(figure_of(stage, "Patches measured").value, 1.0);
  EXPECT_EQ(figure_of(stage, "Of them speak for moving").value, 1.0);
  EXPECT_EQ(figure_of(stage, "Largest shift").value, 5.0);
  const StagePictures pictures = stage_pictures(scene.view, scene.camera, scene.config, stage, false);
  ASSERT_EQ(pictures.output.dots.size(), 1U);
  EXPECT_EQ(pictures.output.dots[0].at, cv::Point2f(30.0F, 15.0F));
  EXPECT_EQ(pictures.output.dots[0].from, cv::Point2f(42.0F, 31.0F));
  EXPECT_EQ(pictures.output.image.at<float>(5, 25), 1.5F);
  EXPECT_TRUE(std::isnan(pictures.output.image.at<float>(5, 5)));
}

TEST(Stages, OfAFrameWithoutDepthFollowPoints) {
  using enum StageKind;
  InspectScene scene;
  without_depth(scene);
  const auto stages = stages_of(scene.view, scene.config);
  const std::vector<StageKind> kinds = kinds_of(stages);
  ASSERT_GE(kinds.size(), 7U);
  EXPECT_THAT(std::vector<StageKind>(kinds.begin(), kinds.begin() + 7),
              ElementsAre(kFollowedPoints, kCameraTurn, kUnexplained, kPointEvidence, kSpread, kColourMask,
                          kFeatures));
  EXPECT_EQ(figure_of(stages[0], "Points").value, 3.0);
  EXPECT_EQ(figure_of(stages[0], "Followed long enough").value, 2.0);
  EXPECT_EQ(figure_of(stages[2], "Noise").value, 0.5);
  EXPECT_EQ(figure_of(stages[2], "Above the limit").value, 1.0);
  EXPECT_EQ(figure_of(stages[3], "Points that move by themselves").value, 0.0);
  EXPECT_EQ(figure_of(stages[3], "… with their neighbours").value, 1.0);
  EXPECT_NEAR(figure_of(stages[4], "Above the limit").value, 100.0 * 100 / 1200, 1e-9);
  const auto pictures = [&](std::size_t i) {
    return stage_pictures(scene.view, scene.camera, scene.config, stages[i], false);
  };
  // Where it came from beside the rotation: 2 small px are 4, drawn at twice their length.
  EXPECT_EQ(pictures(1).output.dots[0].from, cv::Point2f(46.0F, 40.0F));
  EXPECT_EQ(pictures(2).output.dots[0].kind, DotKind::kOutlier);
  EXPECT_EQ(pictures(2).output.dots[1].kind, DotKind::kInlier);
  EXPECT_EQ(pictures(3).output.dots.size(), 2U);
  EXPECT_EQ(pictures(3).output.dots[0].kind, DotKind::kRemoved);
  EXPECT_EQ(pictures(4).output.image.size(), scene.view.frame.gray.size());
  EXPECT_EQ(cv::countNonZero(pictures(5).output.image), 1600);
}

TEST(Stages, AreHeldAgainstTheRoundBefore) {
  const InspectScene scene;
  const auto stages = stages_of(scene.view, scene.config);
  const StageFigure& first = figure_of(stage_of(stages, StageKind::kUnion, 0), "Regions");
  const StageFigure& second = figure_of(stage_of(stages, StageKind::kUnion, 1), "Regions");
  EXPECT_EQ(first.value, 1.0);
  EXPECT_FALSE(first.round_before);
  EXPECT_EQ(second.value, 2.0);
  EXPECT_EQ(second.round_before, 1.0);
  EXPECT_EQ(change_text(second, *second.round_before), "+1");
  const StageFigure& corner =
      figure_of(stage_of(stages, StageKind::kHomography, 1), "Forward: furthest corner moves");
  EXPECT_NEAR(corner.value, InspectScene::kShift, 1e-9);
  EXPECT_EQ(figure_text(corner), "5.00 px");
  EXPECT_EQ(
      figure_of(stage_of(stages, StageKind::kHomography, 1), "Forward: corners differ from the round before")
          .value,
      0.0);
}

TEST(Stages, AreHeldAgainstTheFrameBefore) {
  InspectScene scene, earlier;
  scene.record().inliers = 90;
  scene.add_feature({10, 10}, FeatureFate::inlier, 1);
  scene.add_feature({20, 10}, FeatureFate::inlier, 2);
  earlier.record().inliers = 100;
  earlier.add_feature({11, 10}, FeatureFate::inlier, 1);
  earlier.add_feature({30, 10}, FeatureFate::inlier, 3);
  earlier.add_feature({40, 10}, FeatureFate::inlier, 4);
  scene.view.before = alone(earlier.view);
  const auto stages = stages_of(scene.view, scene.config);
  const StageInfo& refined = stage_of(stages, StageKind::kRefinement);
  const StageFigure& inliers = figure_of(refined, "Inliers");
  EXPECT_EQ(change_text(inliers, inliers.frame_before.value()), "-10");
  EXPECT_EQ(figure_of(refined, "Points gained").value, 1.0);
  EXPECT_EQ(figure_of(refined, "Points lost").value, 2.0);
  const auto change =
      stage_change(scene.view, scene.camera, scene.config, refined, false, ChangeAgainst::kFrameBefore);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->text, "1 map points gained, 2 lost, 1 seen in both frames");
  EXPECT_EQ(change->picture.dots.size(), 3U);
}

TEST(Stages, SmallChangesAreNone) {
  const StageFigure figure{"RMS", 1.2345, "px", 2, {}, {}};
  EXPECT_EQ(change_text(figure, 1.2344), "±0");
  EXPECT_EQ(change_text(figure, 1.0), "+0.23 px");
}

TEST(Stages, AChoiceStaysWhereItWasFromFrameToFrame) {
  InspectScene scene;
  auto stages = stages_of(scene.view, scene.config);
  const StageInfo wanted = stage_of(stages, StageKind::kThreshold, 1);
  EXPECT_EQ(find_stage(stages, wanted), 11U);
  scene.view.motion.rounds.pop_back();
  stages = stages_of(scene.view, scene.config);
  EXPECT_EQ(find_stage(stages, wanted), 4U);  // round 1's, as there is no second
}

TEST(StagePictures, TellGainedFromLost) {
  cv::Mat before = cv::Mat::zeros(1, 4, CV_8UC1), after = before.clone();
  before.at<std::uint8_t>(0, 0) = before.at<std::uint8_t>(0, 1) = 255;
  after.at<std::uint8_t>(0, 1) = after.at<std::uint8_t>(0, 2) = 255;
  const cv::Mat change = mask_change(before, after);
  EXPECT_EQ(change.at<std::uint8_t>(0, 0), kLost);
  EXPECT_EQ(change.at<std::uint8_t>(0, 1), kStays);
  EXPECT_EQ(change.at<std::uint8_t>(0, 2), kGained);
  EXPECT_EQ(change.at<std::uint8_t>(0, 3), kClear);
}

TEST(StagePictures, ShowWhatChangedAgainstStageRoundAndFrame) {
  InspectScene scene;
  const auto stages = stages_of(scene.view, scene.config);
  const auto against = [&](const StageInfo& stage, ChangeAgainst what) {
    const auto change = stage_change(scene.view, scene.camera, scene.config, stage, false, what);
    return change ? change->text : std::string("nothing");
  };
  const StageInfo& cleaned = stage_of(stages, StageKind::kCleanUp, 1);
  // Squares of 20 and 10 px become 26 and 16.
  EXPECT_EQ(against(cleaned, ChangeAgainst::kStageBefore), "432 px gained, 0 px lost, 500 px stay");
  EXPECT_EQ(against(cleaned, ChangeAgainst::kRoundBefore), "256 px gained, 0 px lost, 676 px stay");
  EXPECT_EQ(against(stage_of(stages, StageKind::kCleanUp, 0), ChangeAgainst::kRoundBefore), "nothing");
  EXPECT_EQ(against(stage_of(stages, StageKind::kHomography, 1), ChangeAgainst::kRoundBefore),
            "0 inliers gained, 1 lost");
  EXPECT_EQ(against(cleaned, ChangeAgainst::kFrameBefore), "nothing");
  // The frame before is carried by the homography: 5 px to the left.
  const InspectScene earlier;
  scene.view.before = alone(earlier.view);
  EXPECT_EQ(against(stage_of(stages, StageKind::kCleanUp, 0), ChangeAgainst::kFrameBefore),
            "130 px gained, 130 px lost, 546 px stay");
}

TEST(StagePictures, HaveInputsAndAnOutputForEveryStage) {
  InspectScene scene;
  scene.add_feature({10, 10}, FeatureFate::inlier, 1);
  const auto stages = stages_of(scene.view, scene.config);
  ASSERT_GE(stages.size(), 5U);
  for (const StageInfo& stage : stages)
    for (const bool backward : {false, true}) {
      const StagePictures pictures = stage_pictures(scene.view, scene.camera, scene.config, stage, backward);
      EXPECT_FALSE(pictures.inputs.empty()) << stage.name;
      EXPECT_FALSE(pictures.output.image.empty()) << stage.name;
      EXPECT_FALSE(pictures.output.heading.empty()) << stage.name;
    }
}

TEST(FrameNeighbours, HistoryIsNewestFirstAndEndsAtTheFirstFrame) {
  const auto record = [](int index) {
    FrameRecord made;
    made.index = index;
    return made;
  };
  const auto history = history_of(3, record);
  ASSERT_EQ(history.size(), 3U);
  EXPECT_EQ(history.front()->index, 2);
  EXPECT_EQ(history.back()->index, 0);
  EXPECT_EQ(history_of(100, record).size(), static_cast<std::size_t>(kHistoryFrames));
  EXPECT_TRUE(history_of(0, record).empty());
}

TEST(FrameNeighbours, AViewAloneKeepsItsRecordAndLetsGoOfTheRest) {
  std::shared_ptr<const FrameView> kept;
  {
    InspectScene scene;
    scene.record().inliers = 77;
    scene.view.before = std::make_shared<FrameView>();
    kept = alone(scene.view);
  }
  ASSERT_NE(kept->record, nullptr);
  EXPECT_EQ(kept->record->inliers, 77);
  EXPECT_EQ(kept->before, nullptr);
}

}  // namespace
}  // namespace stillpoint::testing
