#include "core/inspect/point_readings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/pins.hpp"
#include "core/inspect/run_view.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/unit/ui/inspect_scene.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;

Reading reading(const std::vector<ReadingGroup>& groups, const std::string& group, const std::string& name) {
  for (const ReadingGroup& one : groups)
    for (const Reading& reading : one.readings)
      if (one.title == group && reading.name == name) return reading;
  throw std::logic_error("no reading " + name);
}

std::vector<ReadingGroup> read(const InspectScene& scene, double x, double y) {
  const SessionView session = scene.session();
  return read_point(*session.current, pair_geometry(*session.current, *session.run, session.camera), {x, y});
}

TEST(PointReadings, ReadEveryLayerAtAPointOfTheScene) {
  InspectScene scene;
  scene.add_feature({113, 84}, FeatureFate::removed);
  const auto groups = read(scene, 110, 84);
  EXPECT_EQ(reading(groups, "Place", "Depth").value, "2.000 m");
  EXPECT_EQ(reading(groups, "Place", "… in frame 4").value, "115.0, 84.0 by depth");
  EXPECT_EQ(reading(groups, "Place", "In the camera").value, "0.610, 0.490, 2.000 m");
  EXPECT_EQ(reading(groups, "Place", "In the world").value, "1.110, 0.490, 2.000 m");
  // 40 + (110 + 25) % 100, and the same point of the wall 5 px further right in frame 4.
  EXPECT_EQ(reading(groups, "Brightness", "Frame t").value, "75 of 255");
  EXPECT_EQ(reading(groups, "Brightness", "Frame 4, same scene point").value, "75 of 255");
  const Reading difference = reading(groups, "paper: Round 2", "Difference, Forward");
  EXPECT_EQ(difference.value, "50 > 20 grey levels");
  EXPECT_TRUE(difference.speaks);
  EXPECT_EQ(reading(groups, "paper: Round 1", "Difference, Forward").value, "0 ≤ 20 grey levels");
  EXPECT_EQ(reading(groups, "paper: Round 2", "Threshold, Forward").value, "yes");
  EXPECT_EQ(reading(groups, "paper: Round 2", "Clean-up, Forward").value, "yes");
  EXPECT_EQ(reading(groups, "paper: Round 2", "Union and regions").value, "yes");
  EXPECT_EQ(reading(groups, "paper: Round 1", "Union and regions").value, "no");
  EXPECT_EQ(reading(groups, "Result", "Removed").value, "yes");
  EXPECT_EQ(reading(groups, "Result", "Feature near it").value, "3.0 px off, removed");
}

TEST(PointReadings, AMaskThatNobodyLeftSaysNothing) {
  InspectScene scene;
  scene.view.mask.release();
  EXPECT_EQ(reading(read(scene, 110, 84), "Result", "Removed").value, "no");
  scene.change([](FrameRecord& record) { record.measured.mask = false; });
  EXPECT_EQ(reading(read(scene, 110, 84), "Result", "Removed").value, "–");
}

TEST(PointReadings, ReadWhatFollowedPointsSayWithoutDepth) {
  InspectScene scene;
  without_depth(scene);
  const std::string points = "stillpoint: Judgement", back = "stillpoint: 6 frames back";
  const auto moving = read(scene, 53, 44);
  EXPECT_EQ(reading(moving, points, "Evidence").value, "5.0 px off, dynamic");
  EXPECT_TRUE(reading(moving, back, "Epipolar residual").speaks);
  EXPECT_EQ(reading(moving, points, "Propagation").value, "+0.50 > 0.30");
  EXPECT_EQ(reading(moving, points, "Mask").value, "yes");
  const auto nothing = read(scene, 150, 10);
  EXPECT_EQ(reading(nothing, points, "Evidence").value, "–");
  EXPECT_EQ(reading(nothing, back, "Epipolar residual").value, "–");
  EXPECT_EQ(reading(nothing, points, "Mask").value, "no");
}

TEST(PointReadings, SayWhereALayerHasNothing) {
  InspectScene scene;
  scene.view.frame.depth.setTo(0.0);
  scene.paper.pair.rounds[1].forward.valid.setTo(0);
  scene.describe();
  const auto groups = read(scene, 20, 20);
  EXPECT_EQ(reading(groups, "Place", "Depth").value, "not measured");
  EXPECT_EQ(reading(groups, "Place", "In the world").value, "–");
  EXPECT_THAT(reading(groups, "Place", "… in frame 4").value, HasSubstr("by homography"));
  EXPECT_EQ(reading(groups, "paper: Round 2", "Difference, Forward").value, "no data");
}

TEST(PointReadings, AreTheSameRowsForEveryPointOfAFrame) {
  InspectScene scene;
  scene.config.run.method = "stillpoint";
  StillpointTrace& trace = scene.own.judged;
  trace.log_odds = trace.prior = cv::Mat(30, 40, CV_32FC1, cv::Scalar(0.5));
  trace.labels = cv::Mat(30, 40, CV_32SC1, cv::Scalar(-1));
  trace.labels.at<int>(5, 5) = 0;
  trace.superpixels = {{{}, 2.0F, 12, 0.1F, 0.9F, true}};
  trace.small_mask = cv::Mat::zeros(30, 40, CV_8UC1);
  trace.mask = cv::Mat::zeros(120, 160, CV_8UC1);
  scene.describe();
  const auto one = read(scene, 21.5, 21.5), other = read(scene, 158, 119);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t g = 0; g < one.size(); ++g) {
    EXPECT_EQ(one[g].title, other[g].title);
    ASSERT_EQ(one[g].readings.size(), other[g].readings.size()) << one[g].title;
    for (std::size_t r = 0; r < one[g].readings.size(); ++r)
      EXPECT_EQ(one[g].readings[r].name, other[g].readings[r].name);
  }
  EXPECT_EQ(reading(one, "stillpoint: Judgement", "Superpixels").value, "+0.90 > 0.35 log-odds");
  EXPECT_EQ(reading(other, "stillpoint: Judgement", "Superpixels").value, "–");
  EXPECT_EQ(reading(one, "stillpoint: Judgement", "Prior").value, "+0.50 > 0.35 log-odds");
}

TEST(Pins, AreSetTakenOutAndNamed) {
  std::vector<Pin> pins = with_pin_toggled({}, 3, 10, 20);
  ASSERT_EQ(pins.size(), 1U);
  EXPECT_EQ(pins[0], (Pin{3, 10.0, 20.0, "A"}));
  pins = with_pin_toggled(pins, 3, 30, 20);
  EXPECT_EQ(pins[1].name, "B");
  pins = with_pin_toggled(pins, 9, 10, 20);  // the same pixel again, in whatever frame
  ASSERT_EQ(pins.size(), 1U);
  EXPECT_EQ(pins[0].name, "B");
  EXPECT_EQ(free_pin_name(pins), "A");
  pins.clear();
  for (int i = 0; i < 26; ++i) pins = with_pin_toggled(pins, 0, 5 * i, 0);
  EXPECT_EQ(free_pin_name(pins), "A1");
  EXPECT_EQ(pin_near(pins, 11.0, 0.0, 2.0), 2U);
  EXPECT_FALSE(pin_near(pins, 12.5, 0.0, 2.0));
}

}  // namespace
}  // namespace stillpoint::testing
