// The room without what moves: depth images fused, and background filled in, against a wall that is known.
#include "core/export/dense_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::HasSubstr;

constexpr int kMapWidth = 160, kMapHeight = 120;
constexpr double kWall = 2.0, kBoard = 1.0;  // m

Camera small_camera() {
  Camera camera;
  camera.width = kMapWidth, camera.height = kMapHeight;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5, camera.cy = 59.5;
  return camera;
}

/// The colour of the wall at a place on it, m: a chequer of 10 cm.
cv::Vec3b wall_colour(double x, double y) {
  const bool odd = (static_cast<int>(std::floor(x / 0.1)) + static_cast<int>(std::floor(y / 0.1))) % 2 != 0;
  return odd ? cv::Vec3b(40, 80, 120) : cv::Vec3b(200, 160, 90);
}

struct MapScene {
  Frame frame;
  cv::Mat mask;
  Pose world_from_camera = Pose::Identity();
};

/// A wall before a camera that stands `right` m to the right, and a red board between columns `from` and
/// `to`.
MapScene scene(int index, double right, int from, int to) {
  const Camera camera = small_camera();
  MapScene made;
  made.world_from_camera.translation().x() = right;
  made.frame.index = index;
  made.frame.gray = cv::Mat(kMapHeight, kMapWidth, CV_8UC1, cv::Scalar(90));
  made.frame.colour.create(kMapHeight, kMapWidth, CV_8UC3);
  made.frame.depth.create(kMapHeight, kMapWidth, CV_32FC1);
  made.mask = cv::Mat::zeros(kMapHeight, kMapWidth, CV_8UC1);
  for (int y = 0; y < kMapHeight; ++y)
    for (int x = 0; x < kMapWidth; ++x) {
      const bool board = x >= from && x < to;
      const Eigen::Vector3d point = camera.back_project({x, y}, kWall);
      made.frame.depth.at<float>(y, x) = static_cast<float>(board ? kBoard : kWall);
      made.frame.colour.at<cv::Vec3b>(y, x) =
          board ? cv::Vec3b(0, 0, 255) : wall_colour(point.x() + right, point.y());
      made.mask.at<std::uint8_t>(y, x) = board ? 255 : 0;
    }
  return made;
}

TEST(DenseMaps, HoldTheWallAndNothingOfTheBoard) {
  DenseMap map(small_camera(), {});
  for (int i = 0; i < 4; ++i) {
    const MapScene s = scene(i, 0.05 * i, 20 + 30 * i, 50 + 30 * i);
    map.add(s.frame, s.world_from_camera, s.mask);
  }
  const std::vector<DensePoint> points = map.points();
  ASSERT_GT(points.size(), 5000U);
  for (const DensePoint& point : points) {
    ASSERT_NEAR(point.position.z(), kWall, 1e-4);
    ASSERT_NEAR(point.normal.z(), -1.0, 1e-3);
    ASSERT_LT(point.colour[2], 200);
  }
}

TEST(DenseMaps, WithoutMasksTheBoardIsThere) {
  DenseMapOptions options;
  options.min_seen = 1;
  DenseMap map(small_camera(), options);
  const MapScene s = scene(0, 0.0, 20, 50);
  map.add(s.frame, s.world_from_camera, {});
  int red = 0;
  for (const DensePoint& point : map.points()) red += point.colour[2] > 200 ? 1 : 0;
  EXPECT_GT(red, 100);
}

TEST(DenseMaps, WhatOneFrameAloneSawIsLeftOut) {
  DenseMap map(small_camera(), {});
  const MapScene a = scene(0, 0.0, 0, 0), b = scene(1, 0.0, 80, kMapWidth);
  map.add(a.frame, a.world_from_camera, a.mask);
  map.add(b.frame, b.world_from_camera, b.mask);
  for (const DensePoint& point : map.points()) ASSERT_LT(point.position.x(), 0.05F);
  EXPECT_GT(map.points().size(), 3000U);
}

TEST(DenseMaps, AreWrittenWithNormalsAndColours) {
  const TemporaryFolder folder;
  DensePoint point;
  point.position = {1, 2, 3};
  point.normal = {0, 0, -1};
  point.colour = {10, 20, 30};
  write_dense_ply(folder.path("a.ply"), {point, point});
  const std::string bytes = folder.read("a.ply");
  EXPECT_THAT(bytes, HasSubstr("element vertex 2\n"));
  EXPECT_EQ(bytes.size() - bytes.find("end_header\n") - 11, 2U * 27U);
  EXPECT_EQ(bytes.substr(bytes.size() - 3), std::string("\x1E\x14\x0A"));
  EXPECT_THAT(input_error_of([&] { write_dense_ply("/dev/full", {point}); }), HasSubstr("cannot be written"));
}

TEST(FilledFrames, ShowTheWallWhereTheBoardWas) {
  BackgroundFiller filler(small_camera(), {});
  for (int i = 0; i < 4; ++i) {
    const MapScene s = scene(i, 0.05 * i, 20 + 30 * i, 50 + 30 * i);
    filler.add(s.frame, s.world_from_camera, s.mask);
  }
  const MapScene wanted = scene(1, 0.05, 50, 80);
  const FilledFrame filled = filler.fill(wanted.frame, wanted.world_from_camera, wanted.mask);
  EXPECT_LT(filled.unknown, 0.01);
  const MapScene clean = scene(1, 0.05, 0, 0);
  cv::Mat difference;
  cv::absdiff(filled.image, clean.frame.colour, difference);
  // All but the chequer's edges, a pixel to and fro.
  int off = 0;
  for (int y = 0; y < kMapHeight; ++y)
    for (int x = 0; x < kMapWidth; ++x) off += difference.at<cv::Vec3b>(y, x) != cv::Vec3b(0, 0, 0) ? 1 : 0;
  EXPECT_LT(off, kMapWidth * kMapHeight / 10);
  EXPECT_EQ(cv::countNonZero(filled.filled(cv::Rect(50, 0, 30, kMapHeight))), 30 * kMapHeight);
}

TEST(FilledFrames, WhatNobodySawIsBlackAndCounted) {
  BackgroundFiller filler(small_camera(), {});
  const MapScene s = scene(0, 0.0, 50, 80);
  filler.add(s.frame, s.world_from_camera, s.mask);
  const FilledFrame filled = filler.fill(s.frame, s.world_from_camera, s.mask);
  EXPECT_GT(filled.unknown, 0.9);
  EXPECT_EQ(filled.image.at<cv::Vec3b>(60, 65), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(filler.fill(s.frame, s.world_from_camera, {}).unknown, 0.0);
}

}  // namespace
}  // namespace stillpoint
