#include "core/inspect/feature_explanation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/check/findings.hpp"
#include "core/inspect/feature_selection.hpp"
#include "core/inspect/feature_trail.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/unit/ui/inspect_scene.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;

FeatureExplanation explain(const InspectScene& scene, int index, const std::vector<SavedPoint>& points = {}) {
  return explain_feature(scene.view, scene.run, scene.camera, points, index);
}

TEST(FeatureExplanation, TellsMaskRoundRegionAndMarginOfARemovedFeature) {
  InspectScene scene;
  // Of the second square, which round 2 alone found: 3 px inside the cleaned mask's edge.
  const FeatureExplanation explanation = explain(scene, scene.add_feature({110, 85}, FeatureFate::removed));
  EXPECT_THAT(explanation.verdict, HasSubstr("Removed"));
  EXPECT_EQ(explanation.region, 2);
  ASSERT_EQ(explanation.because.size(), 1U);
  EXPECT_THAT(explanation.because[0], HasSubstr("forward mask alone"));
  EXPECT_THAT(explanation.because[0], HasSubstr("region 2, 256 px"));
  EXPECT_THAT(explanation.because[0], HasSubstr("since round 2 of 2"));
  ASSERT_EQ(explanation.margins.size(), 2U);
  EXPECT_EQ(explanation.margins[0].value, 50.0);
  EXPECT_EQ(explanation.margins[0].limit, 20.0);
  EXPECT_EQ(explanation.margins[0].margin(), 30.0);
  EXPECT_EQ(explanation.mask_edge_px, 4.0);

  const FeatureExplanation first = explain(scene, scene.add_feature({50, 40}, FeatureFate::removed));
  EXPECT_THAT(first.because.at(0), HasSubstr("since round 1 of 2"));
  EXPECT_EQ(first.region, 1);
}

TEST(FeatureExplanation, WithoutDepthTheFollowedPointBesideItTells) {
  InspectScene scene;
  without_depth(scene);
  const FeatureExplanation explanation = explain(scene, scene.add_feature({53, 44}, FeatureFate::removed));
  EXPECT_THAT(explanation.verdict, HasSubstr("region 1"));
  ASSERT_EQ(explanation.because.size(), 1U);
  EXPECT_THAT(explanation.because[0], HasSubstr("5 px away for 9 frames"));
  EXPECT_THAT(explanation.because[0], HasSubstr("by the neighbours that move as it does"));
  ASSERT_EQ(explanation.margins.size(), 1U);
  EXPECT_EQ(explanation.margins[0].name, "Evidence");
  EXPECT_NEAR(explanation.margins[0].margin(), 0.2, 1e-6);
  // Another one within the mask, far from all points.
  const FeatureExplanation far = explain(scene, scene.add_feature({68, 62}, FeatureFate::removed));
  EXPECT_THAT(far.because.at(0), HasSubstr("No followed point"));
  // Of a kept one only the figures are told.
  EXPECT_TRUE(explain(scene, scene.add_feature({121, 90}, FeatureFate::unmatched)).because.empty());
}

TEST(FeatureExplanation, SaysWhenDilationAloneReachedIt) {
  InspectScene scene;
  const FeatureExplanation explanation = explain(scene, scene.add_feature({38, 40}, FeatureFate::removed));
  ASSERT_EQ(explanation.because.size(), 2U);
  EXPECT_THAT(explanation.because[1], HasSubstr("dilation"));
  EXPECT_LT(explanation.margins[0].margin(), 0.0);
}

TEST(FeatureExplanation, OfAKeptFeatureTheMaskIsOnlyADistance) {
  InspectScene scene;
  const FeatureExplanation explanation = explain(scene, scene.add_feature({32, 40}, FeatureFate::unmatched));
  EXPECT_THAT(explanation.verdict, HasSubstr("no map point"));
  EXPECT_TRUE(explanation.because.empty());
  EXPECT_EQ(explanation.mask_edge_px, -5.0);
  ASSERT_TRUE(explanation.in_world);
  EXPECT_NEAR(explanation.in_world->x(), (32 - 79.5) / 100.0 * 2.0 + 0.5, 1e-5);
}

TEST(FeatureExplanation, AStaticFeatureIsWhereItsMapPointIs) {
  InspectScene scene;
  // A point straight before frame 5's camera, 2 m away; it is seen 3 px beside.
  const int index = scene.add_feature({82.5F, 59.5F}, FeatureFate::outlier, 7, 3.0F);
  const FeatureExplanation explanation = explain(scene, index, {{3, {}, 1}, {7, {0.5, 0.0, 2.0}, 4}});
  EXPECT_EQ(explanation.observations, 4);
  ASSERT_TRUE(explanation.if_static);
  EXPECT_NEAR(*explanation.own_motion_px(), 3.0, 1e-6);
  EXPECT_THAT(explanation.verdict, HasSubstr("map point 7"));
  EXPECT_THAT(explanation.static_by, HasSubstr("map point"));
}

TEST(FeatureExplanation, AMovingFeatureIsHeldAgainstTheCamerasMotion) {
  InspectScene scene;
  // The track from (45, 40) to (52, 40): the wall there would have come to (40, 40).
  const FeatureExplanation explanation = explain(scene, scene.add_feature({52, 40}, FeatureFate::removed));
  ASSERT_TRUE(explanation.if_static);
  EXPECT_NEAR(explanation.if_static->x(), 40.0, 1e-3);
  EXPECT_NEAR(*explanation.own_motion_px(), 12.0, 1e-3);
  EXPECT_THAT(explanation.static_by, HasSubstr("depth"));
}

TEST(FeatureExplanation, FollowsMapPointsThenFlowThenNeighbours) {
  InspectScene scene;
  const int matched = scene.add_feature({100, 60}, FeatureFate::inlier, 9, 0.5F);
  const int moving = scene.add_feature({52, 40}, FeatureFate::removed);
  const auto past = [](int frame, std::vector<FeatureRecord> features) {
    auto record = std::make_shared<FrameRecord>();
    record->index = frame;
    record->features = std::move(features);
    return record;
  };
  const FeatureRecord plain{{}, 2.0F, 0.0F, kNone, 0, FeatureFate::unmatched};
  const auto at = [&](float x, float y, int map_point = kNone) {
    FeatureRecord feature = plain;
    feature.pixel = {x, y};
    feature.map_point = map_point;
    return feature;
  };
  FeatureRecord far = at(45.5F, 40);
  far.depth = 3.0F;  // nearer by place, but not by depth
  scene.view.history = {past(4, {at(20, 20, 9), far, at(46, 40)}), past(3, {at(39, 41)}),
                        past(2, {at(90, 90)})};
  const std::vector<TrailPoint> still = trail_of(scene.view, matched);
  ASSERT_EQ(still.size(), 2U);
  EXPECT_EQ(still[1].link, TrailLink::kMapPoint);
  EXPECT_EQ(still[1].feature.pixel.x, 20.0F);
  const std::vector<TrailPoint> moved = trail_of(scene.view, moving);
  ASSERT_EQ(moved.size(), 3U);
  EXPECT_EQ(moved[1].link, TrailLink::kFlow);
  EXPECT_EQ(moved[1].feature.pixel.x, 46.0F);
  EXPECT_EQ(moved[2].link, TrailLink::kNearby);
  EXPECT_EQ(moved[2].frame, 3);
}

TEST(FeatureExplanation, TellsWhatWeighsLittle) {
  InspectScene scene;
  const int trusted = scene.add_feature({100, 60}, FeatureFate::inlier, 9, 0.5F);
  const int suspected = scene.add_feature({52, 40}, FeatureFate::inlier, 10, 0.5F);
  scene.change([](FrameRecord& record) { record.features.back().static_weight = 0.07F; });
  EXPECT_THAT(explain(scene, trusted).verdict, ::testing::Not(HasSubstr("weighs")));
  EXPECT_THAT(explain(scene, suspected).verdict, HasSubstr("weighs 7 %"));
  EXPECT_EQ(weighing_little(scene.record().features), 1);
}

TEST(FeatureExplanation, AChoiceIsFoundAgainInTheNextFrame) {
  InspectScene scene;
  scene.add_feature({10, 10}, FeatureFate::inlier, 4);
  scene.add_feature({52, 40}, FeatureFate::removed);
  FeatureSelection selected{5, 1, scene.record().features[1]};
  EXPECT_EQ(find_selected(scene.view, selected), 1);
  selected.feature.map_point = 4;
  selected.frame = 2;
  EXPECT_EQ(find_selected(scene.view, selected), 0);
  selected = {4, 0, {}};
  selected.feature.pixel = {45, 40};  // where the track begins that ends at the second
  EXPECT_EQ(find_selected(scene.view, selected), 1);
  selected = {0, 0, {}};
  selected.feature.pixel = {52, 40};
  EXPECT_EQ(find_selected(scene.view, selected), std::nullopt);
  EXPECT_EQ(find_selected(scene.view, {5, 99, {}}), std::nullopt);
}

TEST(FeatureExplanation, OfStillpointsMaskTheSuperpixelDecides) {
  InspectScene scene;
  scene.config.run.method = "stillpoint";
  const int index = scene.add_feature({52, 40}, FeatureFate::removed);
  StillpointTrace& trace = scene.own.judged;
  trace.log_odds = trace.prior = cv::Mat::zeros(30, 40, CV_32FC1);
  trace.labels = cv::Mat::zeros(30, 40, CV_32SC1);
  trace.superpixels = {{{}, 2.0F, 30, 1.5F, 1.25F, true}};
  trace.mask = cv::Mat::zeros(120, 160, CV_8UC1);
  ReferenceEvidence evidence;
  evidence.depth_residual = cv::Mat(30, 40, CV_32FC1, cv::Scalar(9.0));
  evidence.intensity_residual = cv::Mat(30, 40, CV_32FC1, cv::Scalar(std::nanf("")));
  evidence.log_odds = cv::Mat(30, 40, CV_32FC1, cv::Scalar(0.5));
  trace.references = {evidence};
  scene.describe();
  const FeatureExplanation explanation = explain(scene, index);
  const auto margin = [&](const std::string& begin) {
    for (const Margin& one : explanation.margins)
      if (one.name.starts_with(begin)) return one;
    return Margin{};
  };
  EXPECT_EQ(margin("Superpixels").value, 1.25);
  EXPECT_EQ(margin("Superpixels").limit, scene.config.of<StillpointConfig>().moving_log_odds);
  EXPECT_EQ(margin("Depth residual").value, 9.0);
  EXPECT_TRUE(margin("Brightness residual").name.empty()) << "nothing is known of its brightness";
  ASSERT_EQ(explanation.because.size(), 1U);
  EXPECT_THAT(explanation.because[0], HasSubstr("30 downsampled pixels at 2.00 m"));
}

TEST(FeatureExplanation, TheEdgeOfAMaskIsMeasuredFromBothSides) {
  cv::Mat mask = cv::Mat::zeros(50, 50, CV_8UC1);
  mask(cv::Rect(10, 10, 20, 20)).setTo(255);
  EXPECT_EQ(distance_to_edge(mask, {19, 19}), 10.0);
  EXPECT_EQ(distance_to_edge(mask, {6, 13}), -4.0);
  EXPECT_FALSE(distance_to_edge(mask, {19, 19}, 5));
  EXPECT_FALSE(distance_to_edge(mask, {-5, 19}));
  EXPECT_FALSE(distance_to_edge({}, {1, 1}));
}

TEST(FeatureExplanation, WithoutAChoiceTheRemovedOneInTheMiddleIsTold) {
  InspectScene scene;
  EXPECT_FALSE(telling_feature(scene.record(), scene.view.frame.gray.size()));
  scene.add_feature({80, 60}, FeatureFate::inlier, 1, 0.4F);
  scene.add_feature({10, 60}, FeatureFate::outlier, 2, 7.0F);
  EXPECT_EQ(telling_feature(scene.record(), scene.view.frame.gray.size()), 1);
  scene.add_feature({20, 20}, FeatureFate::removed);
  scene.add_feature({60, 60}, FeatureFate::removed);
  EXPECT_EQ(telling_feature(scene.record(), scene.view.frame.gray.size()), 3);
}

}  // namespace
}  // namespace stillpoint::testing
