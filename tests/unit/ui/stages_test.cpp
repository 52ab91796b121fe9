#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/check/findings.hpp"
#include "core/inspect/frame_neighbours.hpp"
#include "core/inspect/frame_stages.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/inspect/stage_change.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/unit/ui/inspect_scene.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> ids_of(const std::vector<Stage>& stages) {
  std::vector<std::string> ids;
  for (const Stage& stage : stages) ids.push_back(stage.id);
  return ids;
}

std::vector<std::string> first_ids(const std::vector<Stage>& stages, std::size_t count) {
  std::vector<std::string> ids = ids_of(stages);
  ids.resize(std::min(count, ids.size()));
  return ids;
}

std::size_t index_of(const std::vector<Stage>& stages, const std::string& id, int round = -1) {
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (stages[i].id == id && stages[i].round == round) return i;
  throw std::logic_error("no such stage");
}

const Stage& stage_of(const std::vector<Stage>& stages, const std::string& id, int round = -1) {
  return stages[index_of(stages, id, round)];
}

const StageFigure& figure_of(const Stage& stage, const std::string& name) {
  for (const StageFigure& figure : stage.figures)
    if (figure.name == name) return figure;
  throw std::logic_error("no figure " + name);
}

TEST(Stages, OfThePaperFollowItsTextRoundByRound) {
  const InspectScene scene;
  const auto stages = stages_of(scene.view);
  EXPECT_THAT(ids_of(stages),
              ElementsAre("tracks", "homography", "compensation", "difference", "threshold", "clean_up",
                          "union", "track_removal", "homography", "compensation", "difference", "threshold",
                          "clean_up", "union", "track_removal", "features", "feature_removal", "matching",
                          "initial_pose", "refinement", "mapping", "bundle"));
  EXPECT_EQ(telling_stage(stages), 13U);  // the last round's union
  EXPECT_EQ(stages[1].group, "Round 1");
  EXPECT_EQ(stages[8].group, "Round 2");
}

/// What method `stillpoint` saw against two earlier frames, nothing of it moving.
void with_two_references(InspectScene& scene) {
  scene.config.run.method = "stillpoint";
  StillpointTrace& trace = scene.own.judged;
  trace.log_odds = trace.prior = trace.slow = cv::Mat::zeros(30, 40, CV_32FC1);
  trace.labels = cv::Mat::zeros(30, 40, CV_32SC1);
  trace.labels.colRange(20, 40).setTo(1);
  trace.small_mask = cv::Mat::zeros(30, 40, CV_8UC1);
  trace.mask = cv::Mat::zeros(120, 160, CV_8UC1);
  trace.superpixels.resize(2);
  trace.superpixels[1].centre = {30.0F, 15.0F};
  trace.references.resize(2);
  for (ReferenceEvidence& evidence : trace.references)
    evidence.depth_residual = evidence.intensity_residual = evidence.log_odds = trace.log_odds;
}

TEST(Stages, OfTheOthersAreTheirOwn) {
  InspectScene scene;
  scene.config.run.method = "none";
  scene.describe();
  EXPECT_EQ(stages_of(scene.view).front().id, "features");
  with_two_references(scene);
  scene.own.judged.references[1].depth_residual = cv::Mat(30, 40, CV_32FC1, cv::Scalar(100.0));
  scene.describe();
  const auto stages = stages_of(scene.view);
  EXPECT_THAT(first_ids(stages, 11), ElementsAre("downsampled", "depth_residual", "brightness_residual",
                                                 "evidence", "depth_residual", "brightness_residual",
                                                 "evidence", "prior", "all_evidence", "superpixels", "mask"));
  EXPECT_EQ(figure_of(stages[1], "Farther than the limit").value, 0.0);
  EXPECT_EQ(figure_of(stages[4], "Farther than the limit").value, 100.0);
  EXPECT_EQ(telling_stage(stages), 10U);
  scene.view.record = nullptr;
  scene.config.run.method = "none";
  scene.describe();
  EXPECT_TRUE(stages_of(scene.view).empty());
}

TEST(Stages, SuperpixelShiftsStandWithTheReferenceTheyWereMeasuredAgainst) {
  InspectScene scene;
  with_two_references(scene);
  scene.own.judged.references[1].motions = {{{0.0F, 0.0F}, 0.0F, 0.0F}, {{3.0F, 4.0F}, 0.0F, 1.5F}};
  scene.describe();
  const auto stages = stages_of(scene.view);
  const auto is_shifts = [](const Stage& stage) { return stage.id == "superpixel_shifts"; };
  ASSERT_EQ(std::count_if(stages.begin(), stages.end(), is_shifts), 1);
  const Stage& stage = *std::find_if(stages.begin(), stages.end(), is_shifts);
  EXPECT_EQ(stage.reference, 1);
  EXPECT_EQ(figure_of(stage, "Superpixels measured").value, 1.0);
  EXPECT_EQ(figure_of(stage, "Of them speak for motion").value, 1.0);
  EXPECT_EQ(figure_of(stage, "Largest shift").value, 5.0);
  const Layer& layer = stage.sides.at(0).output;
  ASSERT_EQ(layer.marks.size(), 1U);
  EXPECT_EQ(layer.marks[0].at, cv::Point2f(30.0F, 15.0F));
  EXPECT_EQ(layer.marks[0].from, cv::Point2f(42.0F, 31.0F));
  EXPECT_EQ(layer.image.at<float>(5, 25), 1.5F);
  EXPECT_TRUE(std::isnan(layer.image.at<float>(5, 5)));
}

TEST(Stages, OfAFrameWithoutDepthFollowPoints) {
  InspectScene scene;
  without_depth(scene);
  const auto stages = stages_of(scene.view);
  ASSERT_GE(stages.size(), 7U);
  EXPECT_THAT(first_ids(stages, 7), ElementsAre("points", "camera_motion", "epipolar_residual",
                                                "point_evidence", "propagation", "mask", "features"));
  EXPECT_EQ(figure_of(stages[0], "Points").value, 3.0);
  EXPECT_EQ(figure_of(stages[0], "Followed long enough").value, 2.0);
  EXPECT_EQ(figure_of(stages[2], "Noise").value, 0.5);
  EXPECT_EQ(figure_of(stages[2], "Above the limit").value, 1.0);
  EXPECT_EQ(figure_of(stages[3], "Points dynamic by themselves").value, 0.0);
  EXPECT_EQ(figure_of(stages[3], "… with their neighbours").value, 1.0);
  EXPECT_NEAR(figure_of(stages[4], "Above the limit").value, 100.0 * 100 / 1200, 1e-9);
  const auto output = [&](std::size_t i) -> const Layer& { return stages[i].sides.at(0).output; };
  // Where it came from beside the rotation: 2 downsampled px are 4, drawn at twice their length.
  EXPECT_EQ(output(1).marks[0].from, cv::Point2f(46.0F, 40.0F));
  EXPECT_EQ(output(2).marks[0].kind, MarkKind::kOutlier);
  EXPECT_EQ(output(2).marks[1].kind, MarkKind::kInlier);
  EXPECT_EQ(output(3).marks.size(), 2U);
  EXPECT_EQ(output(3).marks[0].kind, MarkKind::kRemoved);
  EXPECT_EQ(output(4).image.size(), scene.view.frame.gray.size());
  EXPECT_EQ(cv::countNonZero(output(5).image), 1600);
}

TEST(Stages, AreHeldAgainstTheRoundBefore) {
  const InspectScene scene;
  const auto stages = stages_of(scene.view);
  const StageFigure& first = figure_of(stage_of(stages, "union", 0), "Regions");
  const StageFigure& second = figure_of(stage_of(stages, "union", 1), "Regions");
  EXPECT_EQ(first.value, 1.0);
  EXPECT_FALSE(first.round_before);
  EXPECT_EQ(second.value, 2.0);
  EXPECT_EQ(second.round_before, 1.0);
  EXPECT_EQ(change_text(second, *second.round_before), "+1");
  const StageFigure& corner = figure_of(stage_of(stages, "homography", 1), "Forward: furthest corner moves");
  EXPECT_NEAR(corner.value, InspectScene::kShift, 1e-9);
  EXPECT_EQ(figure_text(corner), "5.00 px");
  EXPECT_EQ(
      figure_of(stage_of(stages, "homography", 1), "Forward: corners differ from the round before").value,
      0.0);
}

TEST(Stages, AreHeldAgainstTheFrameBefore) {
  InspectScene scene, earlier;
  scene.change([](FrameRecord& record) { record.inliers = 90; });
  scene.add_feature({10, 10}, FeatureFate::inlier, 1);
  scene.add_feature({20, 10}, FeatureFate::inlier, 2);
  earlier.change([](FrameRecord& record) { record.inliers = 100; });
  earlier.add_feature({11, 10}, FeatureFate::inlier, 1);
  earlier.add_feature({30, 10}, FeatureFate::inlier, 3);
  earlier.add_feature({40, 10}, FeatureFate::inlier, 4);
  scene.view.before = alone(earlier.view);
  const auto stages = stages_of(scene.view);
  const Stage& refined = stage_of(stages, "refinement");
  const StageFigure& inliers = figure_of(refined, "Inliers");
  EXPECT_EQ(change_text(inliers, inliers.frame_before.value()), "-10");
  EXPECT_EQ(figure_of(refined, "Points gained").value, 1.0);
  EXPECT_EQ(figure_of(refined, "Points lost").value, 2.0);
  const auto change = stage_change(scene.view, scene.camera, stages, index_of(stages, "refinement"), 0,
                                   ChangeAgainst::kFrameBefore);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->text, "1 map points gained, 2 lost, 1 seen in both frames");
  EXPECT_EQ(change->layer.marks.size(), 3U);
}

TEST(Stages, SmallChangesAreNone) {
  const StageFigure figure{"RMS", 1.2345, "px", 2, {}, {}};
  EXPECT_EQ(change_text(figure, 1.2344), "±0");
  EXPECT_EQ(change_text(figure, 1.0), "+0.23 px");
}

TEST(Stages, AChoiceStaysWhereItWasFromFrameToFrame) {
  InspectScene scene;
  auto stages = stages_of(scene.view);
  const Stage wanted = stage_of(stages, "threshold", 1);
  EXPECT_EQ(find_stage(stages, wanted), 11U);
  scene.paper.pair.rounds.pop_back();
  scene.describe();
  stages = stages_of(scene.view);
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
  const auto stages = stages_of(scene.view);
  const auto against = [&](const Stage& stage, ChangeAgainst what) {
    const auto change =
        stage_change(scene.view, scene.camera, stages, index_of(stages, stage.id, stage.round), 0, what);
    return change ? change->text : std::string("nothing");
  };
  const Stage& cleaned = stage_of(stages, "clean_up", 1);
  // Squares of 20 and 10 px become 26 and 16.
  EXPECT_EQ(against(cleaned, ChangeAgainst::kStageBefore), "432 px gained, 0 px lost, 500 px stay");
  EXPECT_EQ(against(cleaned, ChangeAgainst::kRoundBefore), "256 px gained, 0 px lost, 676 px stay");
  EXPECT_EQ(against(stage_of(stages, "clean_up", 0), ChangeAgainst::kRoundBefore), "nothing");
  EXPECT_EQ(against(stage_of(stages, "homography", 1), ChangeAgainst::kRoundBefore),
            "0 inliers gained, 1 lost");
  EXPECT_EQ(against(cleaned, ChangeAgainst::kFrameBefore), "nothing");
  // The frame before is warped here by depth and the camera's motion: 5 px to the left.
  InspectScene earlier;
  earlier.view.index = 4;
  earlier.change([](FrameRecord& record) { record.world_from_camera.translation().x() = 0.4; });
  scene.view.before = alone(earlier.view);
  EXPECT_EQ(against(stage_of(stages, "clean_up", 0), ChangeAgainst::kFrameBefore),
            "130 px gained, 130 px lost, 546 px stay");
}

TEST(StagePictures, HaveInputsAndAnOutputForEveryStage) {
  InspectScene scene;
  scene.add_feature({10, 10}, FeatureFate::inlier, 1);
  const auto stages = stages_of(scene.view);
  ASSERT_EQ(stages.size(), 22U);
  for (const Stage& stage : stages) {
    ASSERT_FALSE(stage.sides.empty()) << stage.name;
    for (const StageSide& side : stage.sides) {
      EXPECT_FALSE(side.inputs.empty()) << stage.name;
      EXPECT_FALSE(side.output.image.empty()) << stage.name;
      EXPECT_FALSE(side.output.name.empty()) << stage.name;
    }
  }
}

TEST(StageLog, FindsALayerOfTheLastRoundOrOfOne) {
  const InspectScene scene;
  const StageLog& log = *scene.view.motion;
  EXPECT_EQ(log.rounds(), 2);
  ASSERT_NE(log.layer("union_mask"), nullptr);
  EXPECT_EQ(cv::countNonZero(log.layer("union_mask")->image), 26 * 26 + 16 * 16);
  EXPECT_EQ(cv::countNonZero(log.layer("union_mask", 0)->image), 26 * 26);
  EXPECT_NE(log.layer("warped_backward_mask"), nullptr);
  EXPECT_EQ(log.layer("nothing"), nullptr);
  EXPECT_EQ(log.layer("difference")->limit, 20.0);
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
    scene.change([](FrameRecord& record) { record.inliers = 77; });
    scene.view.before = std::make_shared<FrameView>();
    kept = alone(scene.view);
  }
  ASSERT_NE(kept->record, nullptr);
  EXPECT_EQ(kept->record->inliers, 77);
  EXPECT_EQ(kept->before, nullptr);
}

}  // namespace
}  // namespace stillpoint::testing
