#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/stage_log.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/panel_stage.hpp"
#include "tests/ui/session_example.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/scene_of_session.hpp"
#include "ui/scene/scene_view.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint::testing {
namespace {

/// The example without what the method saw.
SessionView without_stages() {
  SessionView view = generated_example();
  auto current = std::make_shared<FrameView>(*view.current);
  StageLog log;
  log.method = "stillpoint";
  log.note = "there are none";
  current->motion = std::make_shared<const StageLog>(std::move(log));
  view.current = current;
  return view;
}

SessionView without_truth() {
  SessionView view = generated_example();
  auto current = std::make_shared<FrameView>(*view.current);
  current->truth = {};
  view.current = current;
  auto run = std::make_shared<RunView>(*view.run), baseline = std::make_shared<RunView>(*view.baseline);
  run->evaluation = baseline->evaluation = {};
  // The record belongs to the run shown.
  current->record = record_in(*run, run->records.size() - 1);
  view.run = run;
  view.baseline = baseline;
  view.ground_truth = {};
  view.alignment = {};
  return view;
}

/// The first frame of a sequence just opened: read, not processed.
SessionView not_processed() {
  SessionView view = generated_example();
  auto current = std::make_shared<FrameView>();
  current->frame = view.current->frame;
  view.current = current;
  view.run = std::make_shared<RunView>();
  view.baseline = nullptr;
  view.keyframes = {};
  view.map_points = {};
  view.alignment = {};
  view.processed = 0;
  return view;
}

/// A frame whose image could not be read.
SessionView unreadable() {
  SessionView view = not_processed();
  auto current = std::make_shared<FrameView>();
  current->frame.problem = "rgb/12.png is cut short.";
  view.current = current;
  return view;
}

class EveryPanel : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryPanel, IsDrawnTwiceTheSame) {
  PanelStage stage(GetParam(), {}), again(GetParam(), {});
  const cv::Mat image = stage.render(generated_example());
  EXPECT_FALSE(is_blank(image, 40));
  EXPECT_TRUE(images_agree(image, again.render(generated_example()), {0, 0.0, 0.0}));
  EXPECT_TRUE(images_agree(image, stage.render(generated_example()), {0, 0.0, 0.0}));
}

TEST_P(EveryPanel, IsDrawnWhateverIsMissing) {
  PanelStage stage(GetParam(), {ThemeName::kLight, 1.0F});
  EXPECT_FALSE(is_blank(stage.render(generated_example()), 40));
  for (const auto& make : {without_stages, without_truth, not_processed, unreadable})
    EXPECT_FALSE(is_blank(stage.render(make()), 8));
  stage.resize(40, 32);
  stage.render(generated_example());
}

INSTANTIATE_TEST_SUITE_P(Panels, EveryPanel, ::testing::ValuesIn(panel_names()),
                         [](const auto& one) { return one.param; });

TEST(Panels, HaveNamesOfTheirOwn) {
  std::set<std::string> names, titles;
  for (const auto& panel : make_panels()) {
    names.insert(panel->name());
    titles.insert(panel->title());
  }
  EXPECT_EQ(names.size(), make_panels().size());
  EXPECT_EQ(titles.size(), names.size());
  for (const char* name : {"input", "forward_mask", "backward_mask", "union_mask", "trajectory", "errors"})
    EXPECT_EQ(names.count(name), 1U) << name;
}

TEST(Panels, AClickInErrorsGoesToTheFrameThere) {
  PanelStage stage("errors", {});
  const auto left = stage.click(generated_example(), 0.4, 0.3).go_to_frame;
  ASSERT_TRUE(left);
  const auto right = stage.click(generated_example(), 0.8, 0.7).go_to_frame;
  ASSERT_TRUE(right);
  EXPECT_GT(*left, 0);
  EXPECT_LT(*left, *right);
  EXPECT_LT(*right, 14);
}

TEST(Panels, AClickInTheTimelineGoesToTheFrameThere) {
  PanelStage stage("timeline", {});
  const auto frame = stage.click(generated_example(), 0.3, 0.4).go_to_frame;
  ASSERT_TRUE(frame);
  // The lanes show all 20 frames between names and values: this place is a little left of a quarter.
  EXPECT_GE(*frame, 2);
  EXPECT_LE(*frame, 5);
  EXPECT_FALSE(stage.click(generated_example(), 0.05, 0.4).go_to_frame);
}

TEST(Panels, AClickInTimingsGoesToTheFrameThere) {
  PanelStage stage("timings", {});
  const auto frame = stage.click(generated_example(), 0.95, 0.2).go_to_frame;
  ASSERT_TRUE(frame);
  EXPECT_GE(*frame, 11);
}

/// A plot of a panel is zoomed, moved and shown whole again by the mouse at a place of it.
void expect_zoom_and_pan(const std::string& panel, double x, double y) {
  SCOPED_TRACE(panel);
  const SessionView session = handmade_example();
  PanelStage stage(panel, {}, 640, 520);
  const auto away = [&] {
    stage.play(session, {MouseMoved{-1e5F, -1e5F}});
    return stage.render(session);
  };
  const cv::Mat whole = away();
  const MouseMoved there{static_cast<float>(x * whole.cols), static_cast<float>(y * whole.rows)};
  stage.play(session, {there});
  // Under the mouse stand a hairline and the values.
  EXPECT_FALSE(images_agree(stage.render(session), whole, {2, 300.0, 0.0}));
  const auto wheeled = stage.play(session, {MouseWheel{0.0F, 4.0F, {}}});
  EXPECT_FALSE(wheeled.go_to_frame);
  const cv::Mat nearer = away();
  EXPECT_FALSE(images_agree(nearer, whole, {2, 300.0, 0.0}));

  stage.play(session, {there});
  const auto dragged = stage.play(session, {MouseButton{1, true, {}}, MouseMoved{there.x - 30.0F, there.y},
                                            MouseMoved{there.x - 60.0F, there.y}, MouseButton{1, false, {}}});
  EXPECT_FALSE(dragged.go_to_frame);
  const cv::Mat beside = away();
  EXPECT_FALSE(images_agree(beside, nearer, {2, 300.0, 0.0}));

  stage.play(session, {there});
  stage.play(session, {MouseButton{1, true, {}}, MouseMoved{there.x + 30.0F, there.y},
                       MouseMoved{there.x + 60.0F, there.y}, MouseButton{1, false, {}}});
  EXPECT_TRUE(images_agree(away(), nearer, {2, 20.0, 0.0})) << "dragged there and back";
  // Two clicks in place show everything again.
  stage.play(session, {there});
  stage.play(session, {MouseButton{0, true, {}}, MouseButton{0, false, {}}, MouseButton{0, true, {}},
                       MouseButton{0, false, {}}});
  EXPECT_TRUE(images_agree(away(), whole, {2, 20.0, 0.0})) << "shown whole again";
}

TEST(Panels, PlotsAreZoomedByTheWheelAndMovedByTheRightButton) {
  expect_zoom_and_pan("errors", 0.6, 0.3);
  expect_zoom_and_pan("errors", 0.6, 0.7);
  expect_zoom_and_pan("timings", 0.6, 0.25);
  expect_zoom_and_pan("difference", 0.6, 0.8);
}

TEST(Panels, TimingsHaveTheGhostsBesideTheRun) {
  PanelStage stage("timings", {}, 640, 420);
  SessionView session = generated_example();
  const cv::Mat alone = stage.render(session);
  auto run = std::make_shared<RunView>(*session.run);
  for (std::size_t i = 0; i < run->records.size(); ++i)
    run->records.change(i, [](FrameRecord& record) { record.ms.total *= 2.0; });
  GhostView ghost;
  ghost.name = "ghost";
  ghost.from = 4;
  ghost.run = run;
  session.debug.ghosts = {ghost};
  EXPECT_GT(cv::norm(stage.render(session), alone, cv::NORM_INF), 0.0);
}

TEST(Panels, HoldingTFlipsToTheTarget) {
  PanelStage stage("compensated", {});
  stage.send(MouseMoved{260.0F, 200.0F});
  const cv::Mat before = stage.render(generated_example());
  stage.send(KeyChanged{Key::kT, true, {}});
  EXPECT_FALSE(images_agree(stage.render(generated_example()), before, {2, 1000.0, 0.0}));
  stage.send(KeyChanged{Key::kT, false, {}});
  EXPECT_TRUE(images_agree(stage.render(generated_example()), before, {0, 0.0, 0.0}));
}

TEST(Panels, TheInspectorReadsThePixelUnderTheMouse) {
  // Panels of one set share what the mouse points at, so both are drawn here.
  Offscreen offscreen({.width = 900, .height = 420});
  const auto panels = make_panels();
  PanelActions actions;
  const auto draw = [&](UiFrame& frame) {
    float left = 0.0F;
    for (const auto& panel : panels) {
      if (panel->name() != "input" && panel->name() != "inspector") continue;
      ImGui::SetNextWindowPos({left, 0});
      ImGui::SetNextWindowSize({450, 420});
      ImGui::Begin(panel->name().c_str(), nullptr, ImGuiWindowFlags_NoDecoration);
      panel->draw(frame, generated_example(), actions);
      ImGui::End();
      left += 450.0F;
    }
  };
  const cv::Mat before = offscreen.render(draw);
  offscreen.send(MouseMoved{225.0F, 200.0F});
  const cv::Mat after = offscreen.render(draw);
  const cv::Rect inspector(450, 0, 450, 200);
  EXPECT_FALSE(images_agree(before(inspector), after(inspector), {2, 500.0, 0.0}));
}

/// Where a picture shows the ground of plots and of the trajectory view.
cv::Rect ground_of(const cv::Mat& image) {
  const Rgb ground = theme(ThemeName::kDark).plot;
  cv::Mat same;
  cv::inRange(image, cv::Scalar(ground.b, ground.g, ground.r), cv::Scalar(ground.b, ground.g, ground.r),
              same);
  return cv::boundingRect(same);
}

TEST(Panels, TheTrajectoryIsZoomedTurnedAndClicked) {
  const SessionView session = handmade_example();
  PanelStage stage("trajectory", {});
  const cv::Mat before = stage.render(session);
  const cv::Rect room = ground_of(before);
  ASSERT_GT(room.area(), 200 * 150);

  // Where the panel shows a pose, computed here from the same scene.
  const SessionScene scene = scene_of_session(session, {});
  const Viewport viewport{static_cast<double>(room.width), static_cast<double>(room.height)};
  SceneView view;
  look_from(view, ViewPreset::kOblique, scene.data.up);
  fit(view, viewport, sight_of(scene.data));
  constexpr std::size_t kPose = 10;
  const auto at = project(view, viewport, scene.data.paths.back().positions[kPose].cast<double>());
  ASSERT_TRUE(at);
  const double x = (room.x + at->x()) / before.cols, y = (room.y + at->y()) / before.rows;
  const auto frame = stage.click(session, x, y).go_to_frame;
  ASSERT_TRUE(frame);
  EXPECT_NEAR(*frame, static_cast<int>(kPose), 2);
  // The pose is told under the mouse, and nothing is where nothing lies.
  EXPECT_FALSE(images_agree(stage.render(session), before, {2, 300.0, 0.0}));
  EXPECT_FALSE(stage.click(session, (room.x + room.width - 3.0) / before.cols, (room.y + 3.0) / before.rows)
                   .go_to_frame);

  stage.play(session, {MouseMoved{-1e5F, -1e5F}});
  EXPECT_TRUE(images_agree(stage.render(session), before, kSceneTolerance));
  const auto middle_x = static_cast<float>(room.x + room.width / 2),
             middle_y = static_cast<float>(room.y + room.height / 2);
  stage.play(session, {MouseMoved{middle_x, middle_y}});
  stage.play(session, {MouseWheel{0.0F, 3.0F, {}}});
  stage.play(session, {MouseMoved{-1e5F, -1e5F}});
  const cv::Mat nearer = stage.render(session);
  EXPECT_FALSE(images_agree(nearer, before, {2, 1000.0, 0.0}));
  stage.play(session, {MouseMoved{middle_x, middle_y}});
  stage.play(session, {MouseButton{0, true, {}}});
  stage.play(session, {MouseMoved{middle_x + 60.0F, middle_y + 20.0F}});
  stage.play(session, {MouseButton{0, false, {}}});
  stage.play(session, {MouseMoved{-1e5F, -1e5F}});
  EXPECT_FALSE(images_agree(stage.render(session), nearer, {2, 1000.0, 0.0}));
}

TEST(Panels, PointsThatLeftTheMapBecauseTheyMovedAreRemovedOnes) {
  SessionView session = handmade_example();
  const auto removed = [&] {
    const SessionScene scene = scene_of_session(session, {});
    return std::count_if(scene.data.points.begin(), scene.data.points.end(),
                         [](const ScenePoint& point) { return point.removed; });
  };
  const auto before = removed();
  std::vector<SavedPoint> points = *session.map_points;
  points.push_back({.id = 9000, .position = {0.1, 0.2, 0.3}, .observations = 0, .moved = true});
  session.map_points = std::move(points);
  EXPECT_EQ(removed(), before + 1);
}

TEST(Panels, WhatIsMissingIsSaidInstead) {
  // A sentence is little ink: nearly all of the panel is its ground, as with a picture it is not.
  const auto ground_share = [](const cv::Mat& image) {
    const cv::Vec3b ground = image.at<cv::Vec3b>(image.rows - 4, image.cols / 2);
    cv::Mat same;
    cv::inRange(image, ground, ground, same);
    return static_cast<double>(cv::countNonZero(same)) / static_cast<double>(image.total());
  };
  const auto expect_sentence = [&](const std::string& name, const SessionView& lacking) {
    PanelStage stage(name, {});
    EXPECT_LT(ground_share(stage.render(generated_example())), 0.8) << name;
    EXPECT_GT(ground_share(stage.render(lacking)), 0.95) << name;
  };
  expect_sentence("motion", without_stages());
  expect_sentence("errors", without_truth());
  expect_sentence("features_after", not_processed());
  expect_sentence("union_mask", unreadable());
}

TEST(Panels, WithoutMaskAndFeaturesTheFrameIsSeen) {
  // Another program's run may have left its poses alone.
  SessionView session = generated_example();
  FrameRecord record = *session.current->record;
  record.measured.mask = record.measured.features = false;
  record.features.clear();
  auto current = std::make_shared<FrameView>(*session.current);
  current->record = &record;
  current->mask.release();
  session.current = current;
  for (const char* name : {"mask", "features_before", "features_after"}) {
    PanelStage stage(name, {});
    const cv::Mat image = stage.render(session), middle = image(cv::Rect(180, 150, 160, 120));
    cv::Scalar mean, deviation;
    cv::meanStdDev(middle, mean, deviation);
    EXPECT_GT(deviation[1], 15.0) << name << " shows no picture";
  }
}

TEST(Panels, BesideAnotherProgramsRunEachRunLiesInItsOwnWorld) {
  SessionView session = debug_example();
  ASSERT_FALSE(session.debug.ghosts.empty());
  GhostView& ghost = session.debug.ghosts[0];
  ghost.outside = false;
  auto run = std::make_shared<RunView>(*ghost.run);
  run->evaluation.ate.alignment.truth_from_estimate = session.alignment.truth_from_estimate;
  run->evaluation.ate.alignment.truth_from_estimate.translation().x() += 100.0;
  ghost.run = run;
  const auto ghost_x = [&] {
    const SessionScene scene = scene_of_session(session, {});
    return scene.data.paths[scene.ghost_paths.at(0)].positions.at(0).x();
  };
  const float together = ghost_x();
  session.outside = "orb3";
  EXPECT_NEAR(ghost_x() - together, 100.0F, 1e-3F);
}

TEST(Panels, RemovalIsCheckedOfARunThatRemovesSomething) {
  PanelStage stage("removal", {});
  const auto asked = [&](const SessionView& session) {
    return stage.click(session, 0.115, 0.05).requests.size();
  };
  SessionView session = generated_example();
  ASSERT_TRUE(session.debug.removal->empty());
  EXPECT_EQ(asked(session), 1U);
  // Of another program's run nothing can be solved again, and the baseline removes nothing.
  session.outside = "orb3";
  EXPECT_EQ(asked(session), 0U);
  session.outside.clear();
  session.config.run.method = "none";
  EXPECT_EQ(asked(session), 0U);
}

TEST(Panels, ANewFrameIsShownAtOnce) {
  PanelStage stage("input", {});
  const cv::Mat before = stage.render(generated_example());
  SessionView other = generated_example();
  auto current = std::make_shared<FrameView>(*other.current);
  current->frame.colour = cv::Mat(current->frame.colour.size(), CV_8UC3, cv::Scalar(200, 40, 90));
  other.current = current;
  EXPECT_FALSE(images_agree(stage.render(other), before, {}));
}

}  // namespace
}  // namespace stillpoint::testing
