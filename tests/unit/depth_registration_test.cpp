// Depth of a depth camera of its own, registered: against rays that meet planes, and how a camera file says
// it.
#include "core/sequence/depth_registration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "core/sequence/source.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

Camera small_camera(int width, int height, double focal) {
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = focal, camera.fy = 1.01 * focal;
  camera.cx = 0.49 * width, camera.cy = 0.52 * height;
  return camera;
}

Pose beside(double x, const Eigen::Vector3d& turn) {
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp(turn);
  pose.translation() = Eigen::Vector3d(x, 0.004, -0.003);
  return pose;
}

/// A plane n·p = d of the colour camera's frame, within |x|, |y| below `half` m.
struct Wall {
  Eigen::Vector3d normal;
  double distance, half;
};

/// The depth image of a camera before walls. @param colour_from_camera of that camera
cv::Mat depth_of(const std::vector<Wall>& walls, const Camera& camera, const Pose& colour_from_camera) {
  cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.back_project(
                                camera.undistorted({static_cast<double>(x), static_cast<double>(y)}), 1.0),
                            turned = colour_from_camera.linear() * ray,
                            from = colour_from_camera.translation();
      double nearest = 0;
      for (const Wall& wall : walls) {
        const double z = (wall.distance - wall.normal.dot(from)) / wall.normal.dot(turned);
        const Eigen::Vector3d met = from + z * turned;
        if (z <= 0 || std::abs(met.x()) > wall.half || std::abs(met.y()) > wall.half) continue;
        if (nearest == 0 || z < nearest) nearest = z;
      }
      depth.at<float>(y, x) = static_cast<float>(nearest);
    }
  return depth;
}

TEST(DepthRegistration, OfTheSameCameraChangesNothing) {
  const Camera camera = small_camera(64, 48, 60.0);
  cv::Mat depth(48, 64, CV_32FC1);
  cv::RNG random(7);
  random.fill(depth, cv::RNG::UNIFORM, 0.5, 6.0);
  cv::Mat holes(depth.size(), CV_8UC1);
  random.fill(holes, cv::RNG::UNIFORM, 0, 3);
  depth.setTo(0, holes == 0);
  depth(cv::Rect(10, 10, 30, 20)) = 2.0;  // a surface amid single pixels
  const cv::Mat result = DepthRegistration({camera, Pose::Identity()}, camera).registered(depth);
  ASSERT_EQ(result.size(), depth.size());
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      EXPECT_NEAR(result.at<float>(y, x), depth.at<float>(y, x), 1e-5) << x << " " << y;
}

/// A slanted wall, both cameras with distortion, colour twice as large: right to 0.1 mm, and no hole.
TEST(DepthRegistration, OfASlantedWallIsRightAndWithoutHoles) {
  Camera colour = small_camera(320, 240, 270.0), depth_camera = small_camera(160, 120, 120.0);
  colour.k1 = 0.08, colour.k2 = -0.1, colour.p1 = 0.002;
  depth_camera.k1 = -0.05, depth_camera.p2 = 0.001;
  const DepthCamera depth{depth_camera, beside(0.03, {0.01, -0.02, 0.015})};
  const std::vector<Wall> walls = {{Eigen::Vector3d(0.3, -0.2, 1.0).normalized(), 1.5, 50.0}};
  const cv::Mat result =
      DepthRegistration(depth, colour).registered(depth_of(walls, depth_camera, depth.colour_from_depth));
  const cv::Mat expected = depth_of(walls, colour, Pose::Identity());
  // The depth camera sees more than the colour camera but for a margin of a few pixels.
  const cv::Rect inside(8, 8, 304, 224);
  for (int y = inside.y; y < inside.br().y; ++y)
    for (int x = inside.x; x < inside.br().x; ++x) {
      ASSERT_GT(result.at<float>(y, x), 0.0F) << x << " " << y;
      ASSERT_NEAR(result.at<float>(y, x), expected.at<float>(y, x), 1e-4) << x << " " << y;
    }
}

/// A board before a wall: the nearer one is kept, what it hides has no depth of the wall, and only its
/// outline may be off, by a pixel of depth.
TEST(DepthRegistration, KeepsTheNearerOfTwoSurfaces) {
  const Camera colour = small_camera(320, 240, 270.0), depth_camera = small_camera(320, 240, 250.0);
  const DepthCamera depth{depth_camera, beside(0.10, {0, 0, 0})};
  const std::vector<Wall> walls = {{{0, 0, 1}, 1.0, 0.2}, {{0, 0, 1}, 3.0, 50.0}};
  const cv::Mat result =
      DepthRegistration(depth, colour).registered(depth_of(walls, depth_camera, depth.colour_from_depth));
  const cv::Mat expected = depth_of(walls, colour, Pose::Identity());
  int board = 0, wrong = 0, open = 0;
  for (int y = 10; y < 230; ++y)
    for (int x = 30; x < 290; ++x) {
      const float made = result.at<float>(y, x), right = expected.at<float>(y, x);
      board += right < 2 ? 1 : 0;
      open += made == 0 ? 1 : 0;
      wrong += made > 0 && std::abs(made - right) > 0.01 ? 1 : 0;
      ASSERT_TRUE(made == 0 || std::abs(made - 1) < 0.01 || std::abs(made - 3) < 0.01) << made;
    }
  ASSERT_GT(board, 9000);
  EXPECT_LT(wrong, 500);  // about the outline of 4 x 108 px
  // Beside the board lies what it hides from the depth camera: 0.1 m (1/1 - 1/3) 270 px by 108 rows.
  EXPECT_NEAR(open, 18 * 108, 400);
}

TEST(DepthRegistration, OfASenselessPlaceIsEmpty) {
  const Camera camera = small_camera(64, 48, 60.0);
  const cv::Mat depth(48, 64, CV_32FC1, cv::Scalar(2.0));
  for (const Pose& place : {beside(500, {0, 0, 0}), beside(0, {0, M_PI, 0})})
    EXPECT_EQ(cv::countNonZero(DepthRegistration({camera, place}, camera).registered(depth)), 0);
  Camera wide = camera;
  wide.fx = wide.fy = 1e-3;  // each pixel would cover the whole image
  EXPECT_EQ(cv::countNonZero(DepthRegistration({wide, Pose::Identity()}, camera).registered(depth)), 0);
}

constexpr const char* kColourPart = "width = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 32\ncy = 24\n";
constexpr const char* kDepthPart =
    "[depth_camera]\nwidth = 32\nheight = 40\nfx = 30\nfy = 31\ncx = 16\ncy = 20\nk1 = 0.1\n";

TEST(DepthCameraFiles, AreReadAndWrittenBack) {
  const Camera read = read_camera_text(
      "c.toml", std::string(kColourPart) + kDepthPart +
                    "colour_from_depth = [[0, -1, 0, 0.05], [1, 0, 0, 0.0], [0, 0, 1, -0.01]]\n");
  ASSERT_NE(read.depth_camera, nullptr);
  const Camera again = read_camera_text("c.toml", camera_text(read));
  ASSERT_NE(again.depth_camera, nullptr);
  for (const auto& depth : {read.depth_camera, again.depth_camera}) {
    EXPECT_EQ(depth->camera.width, 32);
    EXPECT_EQ(depth->camera.height, 40);
    EXPECT_EQ(depth->camera.fy, 31);
    EXPECT_EQ(depth->camera.k1, 0.1);
    EXPECT_TRUE(
        (depth->colour_from_depth * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(-1.95, 1, 2.99)));
  }
  EXPECT_EQ(read_camera_text("c.toml", kColourPart).depth_camera, nullptr);
  EXPECT_TRUE(read_camera_text("c.toml", std::string(kColourPart) + kDepthPart)
                  .depth_camera->colour_from_depth.isApprox(Pose::Identity()));
}

TEST(DepthCameraFiles, ThatCannotBeUsedAreToldInOneSentence) {
  const auto complaint = [](const std::string& text) {
    return input_error_of([&] { (void)read_camera_text("c.toml", kColourPart + text); });
  };
  const std::string depth = kDepthPart;
  EXPECT_THAT(complaint("depth_camera = 3\n"),
              HasSubstr("c.toml:7: depth_camera is a table, [depth_camera]"));
  EXPECT_THAT(complaint("[depth_camera]\nfx = 30\n"), HasSubstr("[depth_camera] has no fy"));
  EXPECT_THAT(complaint(depth + "depth_scale = 5\n"), HasSubstr("depth_scale is no key of a depth camera"));
  EXPECT_THAT(complaint(depth + "colour_from_depth = [1, 2]\n"),
              HasSubstr("takes three or four rows of four"));
  EXPECT_THAT(complaint(depth + "colour_from_depth = [[1,0,0,0],[0,1,0,0],[0,0,1]]\n"),
              HasSubstr("takes three or four rows of four"));
  EXPECT_THAT(complaint(depth + "colour_from_depth = [[2,0,0,0],[0,1,0,0],[0,0,1,0]]\n"),
              HasSubstr("is no rigid motion"));
  EXPECT_THAT(complaint(depth + "colour_from_depth = [[nan,0,0,0],[0,1,0,0],[0,0,1,0]]\n"),
              HasSubstr("is no rigid motion"));
}

/// A folder of colour 64x48 and depth 32x40 px.
struct TwoCameras {
  explicit TwoCameras(const std::string& camera) {
    folder.write("camera.toml", camera);
    std::string colours, depths;
    for (int i = 0; i < 3; ++i) {
      folder.write(fmt::format("rgb/{}.png", i), cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, i)));
      folder.write(fmt::format("depth/{}.png", i), cv::Mat(40, 32, CV_16UC1, cv::Scalar(10000)));
      colours += fmt::format("{:.3f} rgb/{}.png\n", 100 + 0.1 * i, i);
      depths += fmt::format("{:.3f} depth/{}.png\n", 100 + 0.1 * i, i);
    }
    folder.write("rgb.txt", colours);
    folder.write("depth.txt", depths);
  }
  TemporaryFolder folder;
};

TEST(DepthCameraFiles, RegisterAFoldersDepthOnReading) {
  const TwoCameras two(std::string(kColourPart) + kDepthPart);
  const auto source = open_sequence(two.folder.path());
  ASSERT_TRUE(source->has_depth()) << source->why_not(FramePart::depth);
  EXPECT_NE(source->camera().depth_camera, nullptr);
  EXPECT_EQ(registered_camera(*source).depth_camera, nullptr);
  const Frame frame = source->read(1);
  EXPECT_EQ(frame.problem, "");
  ASSERT_EQ(frame.depth.size(), cv::Size(64, 48));
  EXPECT_FLOAT_EQ(frame.depth.at<float>(24, 32), 2.0F);
}

TEST(DepthCameraFiles, AreMissedInOneSentenceWhereDepthIsOfAnotherSize) {
  const TwoCameras none{kColourPart};
  EXPECT_THAT(open_sequence(none.folder.path())->why_not(FramePart::depth),
              testing::AllOf(HasSubstr("is 32x40 px, but its colour image is 64x48 px"),
                             HasSubstr("a [depth_camera] in camera.toml registers depth of another camera")));
  std::string depth = kDepthPart;
  depth.replace(depth.find("32"), 2, "96");
  const TwoCameras other(kColourPart + depth);
  EXPECT_THAT(open_sequence(other.folder.path())->why_not(FramePart::depth),
              HasSubstr("is 32x40 px, but the depth camera is of 96x40 px"));
}

TEST(DepthCameraFiles, ThatLookElsewhereMarkTheFrames) {
  const TwoCameras two(std::string(kColourPart) + kDepthPart +
                       "colour_from_depth = [[1,0,0,900],[0,1,0,0],[0,0,1,0]]\n");
  const Frame frame = open_sequence(two.folder.path())->read(0);
  EXPECT_FALSE(frame.has_depth());
  EXPECT_THAT(frame.problem, HasSubstr("the colour camera sees nothing of its depth"));
}

}  // namespace
}  // namespace stillpoint
