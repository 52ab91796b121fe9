// Pairs as cameras take them, which are rectified on opening.
#include "core/sequence/stereo/stereo_rectification.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

// ---- rectification

/// What a camera that is turned and has a lens sees where an ideal one sees `ideal`.
cv::Mat seen_by(const Camera& camera, const Eigen::Matrix3d& ideal_from_camera, const cv::Mat& ideal,
                const Camera& ideal_camera) {
  cv::Mat from(camera.height, camera.width, CV_32FC2), image;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = ideal_from_camera * camera.back_project(camera.undistorted({x, y}), 1.0);
      const Eigen::Vector2d at = ideal_camera.project(ray);
      from.at<cv::Vec2f>(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    }
  cv::remap(ideal, image, from, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return image;
}

std::string yaml_of(const Camera& c, const Pose& body_from_camera) {
  std::string rows;
  for (int i = 0; i < 16; ++i)
    rows += fmt::format("{}{:.15g}", i == 0 ? "" : ", ", body_from_camera.matrix()(i / 4, i % 4));
  return fmt::format(
      "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\nresolution: [{}, {}]\ncamera_model: "
      "pinhole\nintrinsics: [{}, {}, {}, {}]\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [{}, {}, {}, {}]\n",
      rows, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2);
}

/// A pair with lenses, turned against each other, whose truth is the body's.
TEST(StereoRectification, APairAsItCameIsRectifiedOnOpening) {
  TemporaryFolder folder("raw");
  const auto ideal = make_generated_sequence("room:stereo", 4, 1);
  Camera left = ideal->camera(), right = left;
  left.k1 = -0.12, left.k2 = 0.03, left.p1 = 2e-4, right.k1 = -0.10, right.k2 = 0.02, right.p2 = -3e-4;
  right.fx = 530, right.cy = 240;
  const Eigen::Matrix3d turn_left = so3_exp({0.01, -0.012, 0.008}),
                        turn_right = so3_exp({-0.006, 0.01, -0.01});
  Pose body_from_ideal = Pose::Identity();
  body_from_ideal.linear() = so3_exp({0.3, -0.2, 1.2});
  body_from_ideal.translation() << 0.05, -0.02, 0.1;
  Pose left_pose = body_from_ideal, right_pose = body_from_ideal;
  left_pose.linear() = left_pose.linear() * turn_left;
  right_pose.translate(Eigen::Vector3d(0.12, 0, 0));
  right_pose.linear() = right_pose.linear() * turn_right;
  folder.write("mav0/cam0/sensor.yaml", yaml_of(left, left_pose));
  folder.write("mav0/cam1/sensor.yaml", yaml_of(right, right_pose));
  std::string truth = "#timestamp, p_RS_R_x [m], p_y, p_z, q_RS_w [], q_x, q_y, q_z\n";
  for (int i = 0; i < ideal->size(); ++i) {
    const Frame frame = ideal->read(i);
    const long long stamp = std::llround(ideal->timestamp(i) * 1e6) * 1000;
    folder.write(fmt::format("mav0/cam0/data/{}.png", stamp),
                 seen_by(left, turn_left, frame.gray, ideal->camera()));
    folder.write(fmt::format("mav0/cam1/data/{}.png", stamp),
                 seen_by(right, turn_right, to_gray(frame.stereo->right), ideal->camera()));
    const Pose body = *ideal->truth(i).world_from_camera * body_from_ideal.inverse();
    const Eigen::Quaterniond q(body.linear());
    truth +=
        fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", stamp, body.translation().x(),
                    body.translation().y(), body.translation().z(), q.w(), q.x(), q.y(), q.z());
  }
  folder.write("mav0/state_groundtruth_estimate0/data.csv", truth);

  const auto read = open_sequence(folder.path());
  EXPECT_NEAR(read->camera().baseline_m, 0.12, 1e-9);
  EXPECT_FALSE(read->camera().has_distortion());
  EXPECT_THAT(read->warnings(), Each(Not(HasSubstr("not rectified"))));
  const Frame frame = read->read(2);
  ASSERT_TRUE(frame.has_depth());
  // Both say where the same points lie: through the poses, in the world.
  const Pose ideal_from_read =
      ideal->truth(2).world_from_camera->inverse() * *read->truth(2).world_from_camera;
  EXPECT_LT(ideal_from_read.translation().norm(), 1e-5);  // m: rectifying turns the camera where it stands
  const cv::Mat exact = ideal->truth(2).depth;
  std::vector<double> errors;  // px, of disparity
  for (int y = 10; y < frame.depth.rows - 10; y += 4)
    for (int x = 10; x < frame.depth.cols - 10; x += 4) {
      const double z = frame.depth.at<float>(y, x);
      if (z <= 0) continue;
      const Eigen::Vector3d p = ideal_from_read * read->camera().back_project({x, y}, z);
      const Eigen::Vector2d at = ideal->camera().project(p);
      const cv::Point pixel(cvRound(at.x()), cvRound(at.y()));
      if (!cv::Rect(0, 0, exact.cols, exact.rows).contains(pixel)) continue;
      errors.push_back(std::abs(1.0 / p.z() - 1.0 / exact.at<float>(pixel)) * read->camera().fx * 0.12);
    }
  ASSERT_GT(errors.size(), 5000U);
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.5);
}

TEST(StereoRectification, ARectifiedPairIsLeftAsItIs) {
  Camera camera = camera_by_name("generated");
  Pose right_from_left = Pose::Identity();
  right_from_left.translation().x() = -0.2;
  const StereoRectification plain(camera, camera, right_from_left, "here");
  EXPECT_FALSE(plain.resamples());
  EXPECT_EQ(plain.camera().baseline_m, 0.2);
  EXPECT_EQ(plain.camera().fx, camera.fx);
  const cv::Mat image(480, 640, CV_8UC1, cv::Scalar(3));
  EXPECT_EQ(plain.rectified(image, StereoRectification::kLeft).data, image.data);
  right_from_left.linear() = so3_exp({0, 0, 0.01});
  EXPECT_TRUE(StereoRectification(camera, camera, right_from_left, "here").resamples());
}

}  // namespace
}  // namespace stillpoint
