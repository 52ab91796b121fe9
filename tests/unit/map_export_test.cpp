// Maps as PLY files: normals from depth images of a plane that is known, keyframes as pyramids.
#include "core/export/map_export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/run/map_ply.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Camera plane_camera() {
  Camera camera;
  camera.width = 160, camera.height = 120;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5, camera.cy = 59.5;
  return camera;
}

/// Depth of the plane normal · p = -2 m as the camera sees it, p in camera coordinates.
Frame plane_frame(const Eigen::Vector3d& normal) {
  const Camera camera = plane_camera();
  Frame frame;
  frame.gray = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(90));
  frame.depth.create(camera.height, camera.width, CV_32FC1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      frame.depth.at<float>(y, x) = static_cast<float>(-2.0 / normal.dot(camera.back_project({x, y}, 1.0)));
  return frame;
}

FrameRecord record_with(const std::vector<std::pair<int, cv::Point2f>>& features) {
  FrameRecord record;
  for (const auto& [point, pixel] : features) {
    FeatureRecord feature;
    feature.pixel = pixel, feature.map_point = point, feature.fate = FeatureFate::inlier;
    record.features.push_back(feature);
  }
  return record;
}

std::vector<SavedPoint> points_of(const std::vector<int>& ids) {
  std::vector<SavedPoint> points;
  for (const int id : ids) {
    points.emplace_back();
    points.back().id = id;
  }
  return points;
}

TEST(PointNormals, AreThoseOfThePlaneInTheWorld) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1.0).normalized();
  const Pose world_from_camera(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  Frame frame = plane_frame(normal);
  frame.depth(cv::Rect(100, 0, 60, 120)).setTo(5.0F);  // a step, at whose edge no surface is
  frame.depth.at<float>(64, 40) = 0.0F;
  PointNormals normals(plane_camera());
  FrameRecord record =
      record_with({{7, {60.2F, 50.4F}}, {8, {98, 50}}, {9, {40, 60}}, {10, {1, 1}}, {11, {60, 80}}});
  record.features.back().fate = FeatureFate::removed;
  normals.add(frame, record, world_from_camera);
  const auto found = normals.of(points_of({7, 8, 9, 10, 11, 12}));
  ASSERT_EQ(found.size(), 6U);
  EXPECT_LT((found[0].cast<double>() - world_from_camera.linear() * normal).norm(), 1e-4);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_TRUE(found[i].isZero(0.0F)) << i;
}

TEST(PointNormals, ThatFramesDisagreeAboutAreNotKnown) {
  PointNormals normals(plane_camera());
  const FrameRecord record = record_with({{1, {80, 60}}});
  const Pose turned(Eigen::AngleAxisd(1.6, Eigen::Vector3d::UnitY()));
  normals.add(plane_frame({0, 0, -1}), record, Pose::Identity());
  EXPECT_NEAR(static_cast<double>(normals.of(points_of({1}))[0].z()), -1.0, 1e-5);
  normals.add(plane_frame({0, 0, -1}), record, turned);
  EXPECT_TRUE(normals.of(points_of({1}))[0].isZero(0.0F));
  normals.add(Frame(), record, Pose::Identity());  // without depth: nothing is told
}

TEST(MapPly, HasColoursAndNormals) {
  std::vector<SavedPoint> points = points_of({1, 2});
  points[0].position = {1, 2, 3};
  points[0].colour = {10, 20, 30};
  const std::string text = map_ply(points, {Eigen::Vector3f(0, 0, -1), Eigen::Vector3f::Zero()}, {});
  EXPECT_THAT(text,
              HasSubstr("element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                        "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"));
  EXPECT_THAT(text, HasSubstr("end_header\n1.00000 2.00000 3.00000 0.0000 0.0000 -1.0000 30 20 10\n"
                              "0.00000 0.00000 0.00000 0.0000 0.0000 0.0000 128 128 128\n"));
  EXPECT_THAT(map_ply(points, {}, {}), Not(HasSubstr("nx")));
}

TEST(KeyframesPly, ArePyramidsOfWhatTheCameraSees) {
  std::vector<SavedKeyframe> keyframes(2);
  keyframes[1].frame_index = 9;
  keyframes[1].pose.world_from_camera.translation() = Eigen::Vector3d(2, 0, 0);
  const std::string text = keyframes_ply(keyframes, plane_camera());
  EXPECT_THAT(text, StartsWith("ply\nformat ascii 1.0\n"));
  for (const char* part :
       {"element vertex 10\n", "element face 8\n", "element edge 16\n", "property int frame\n"})
    EXPECT_THAT(text, HasSubstr(part));
  std::istringstream body(text.substr(text.find("end_header\n") + 11));
  std::vector<std::string> lines;
  for (std::string line; std::getline(body, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 10U + 8U + 16U);
  // 6 % of the way of 2 m deep; half an image, 80 by 60 px, is 0.12 m * 80 / 130 and 0.12 m * 60 / 130.
  EXPECT_EQ(lines[5], "2.00000 0.00000 0.00000 230 159 0 9");
  EXPECT_EQ(lines[6], "1.92615 -0.05538 0.12000 230 159 0 9");
  EXPECT_EQ(lines[8], "2.07385 0.05538 0.12000 230 159 0 9");
  EXPECT_EQ(lines[10], "3 0 1 2");
  EXPECT_EQ(lines[17], "3 5 9 6");
  EXPECT_EQ(lines[18], "0 1");
  EXPECT_EQ(lines.back(), "9 6");
  EXPECT_THAT(keyframes_ply({}, plane_camera()), HasSubstr("element vertex 0\n"));
}

}  // namespace
}  // namespace stillpoint
