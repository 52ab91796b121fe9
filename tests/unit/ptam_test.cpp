// Engine `ptam`: its parts against hand-computed values, and poses and points recovered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/odometry/odometry.hpp"
#include "core/odometry/ptam/ptam_image.hpp"
#include "core/odometry/ptam/ptam_solver.hpp"
#include "core/odometry/ptam/ptam_tracker.hpp"
#include "tests/support/bent_wall.hpp"

namespace stillpoint {
namespace {

TEST(PtamTukey, BoundIsThePublishedOne) {
  // Of 13 errors with median 2² = 4: sigma = 1.4826 (1 + 5/20) 2 = 3.7065; bound = 4.6851 sigma = 17.36532.
  std::vector<double> squared;
  for (int i = 0; i < 13; ++i) squared.push_back(i < 6 ? 1.0 : i == 6 ? 4.0 : 9.0);
  EXPECT_NEAR(std::sqrt(tukey_bound_squared(squared)), 17.36532, 1e-4);
}

TEST(PtamTukey, WeightFallsToNoughtAtTheBound) {
  EXPECT_DOUBLE_EQ(tukey_weight(0.0, 16.0), 1.0);
  EXPECT_DOUBLE_EQ(tukey_weight(8.0, 16.0), 0.25);  // (1 - 1/2)²
  EXPECT_DOUBLE_EQ(tukey_weight(16.0, 16.0), 0.0);
  EXPECT_DOUBLE_EQ(tukey_weight(100.0, 16.0), 0.0);
}

TEST(PtamLevels, PixelsKeepTheirMiddles) {
  // A quarter-size pixel 0 covers pixels 0 to 3: its middle is 1.5.
  EXPECT_TRUE(from_level({0, 0}, 2).isApprox(Eigen::Vector2d(1.5, 1.5)));
  EXPECT_TRUE(to_level({1.5, 5.5}, 2).isApprox(Eigen::Vector2d(0, 1)));
  EXPECT_TRUE(to_level(from_level({7, 9}, 3), 3).isApprox(Eigen::Vector2d(7, 9)));
}

TEST(PtamCorners, ShiTomasiIsNoughtOnAnEdgeAndHighOnACorner) {
  cv::Mat edge(40, 40, CV_8UC1, cv::Scalar(0)), corner = edge.clone();
  edge.colRange(20, 40) = 100;
  corner(cv::Rect(20, 20, 20, 20)) = 100;
  EXPECT_NEAR(shi_tomasi(edge, {20, 20}), 0.0, 1e-9);
  EXPECT_GT(shi_tomasi(corner, {20, 20}), 70.0);
  // A ramp of 1 grey level a pixel along x and 2 along y, anywhere: scatter of rank one.
  EXPECT_NEAR(shi_tomasi(corner, {10, 10}), 0.0, 1e-9);
}

TEST(PtamImages, ListTheirCornersRowByRow) {
  const auto image =
      make_ptam_image(BentWall().render(camera_by_name("generated"), Pose::Identity()).gray, PtamConfig());
  EXPECT_EQ(image->levels[3].size(), cv::Size(80, 60));
  EXPECT_EQ(image->small.size(), cv::Size(40, 30));
  EXPECT_NEAR(cv::mean(image->small)[0], 0.0, 1e-3);
  for (std::size_t level = 0; level < 4; ++level) {
    const auto& rows = image->row_begin[level];
    EXPECT_EQ(rows.back(), static_cast<int>(image->corners[level].size()));
    for (std::size_t row = 0; row + 1 < rows.size(); ++row)
      for (int i = rows[row]; i < rows[row + 1]; ++i)
        EXPECT_EQ(image->corners[level][static_cast<std::size_t>(i)].y, static_cast<int>(row));
  }
}

/// Noise that is no corner's twin.
cv::Mat speckle(int side, int seed) {
  cv::Mat image(side, side, CV_8UC1);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {0, 0}, 1.5);
  cv::normalize(image, image, 20, 230, cv::NORM_MINMAX);
  return image;
}

TEST(PtamPatches, UnwarpedAreTheImageItself) {
  const cv::Mat image = speckle(64, 1);
  const auto patch = warped_patch(image, {30, 20}, Eigen::Matrix2d::Identity());
  ASSERT_TRUE(patch);
  EXPECT_EQ(patch->level, 0);
  for (int y = 0; y < kPatch; ++y)
    for (int x = 0; x < kPatch; ++x)
      EXPECT_FLOAT_EQ(patch->values[static_cast<std::size_t>(y * kPatch + x)],
                      image.at<uchar>(16 + y, 26 + x));
  EXPECT_NEAR(patch->difference(image, {30, 20}), 0.0, 1e-3);
  EXPECT_TRUE(std::isinf(patch->difference(image, {3, 20})));
}

TEST(PtamPatches, DifferWhateverTheirMean) {
  const cv::Mat image = speckle(64, 1);
  const auto patch = warped_patch(image, {30, 20}, Eigen::Matrix2d::Identity());
  cv::Mat brighter;
  image.convertTo(brighter, CV_8U, 1.0, 15.0);
  EXPECT_NEAR(patch->difference(brighter, {30, 20}), 0.0, 1e-3);
  // One pixel of 64 off by 64: (64² - 64²/64) / 64 = 63.
  cv::Mat spotted(64, 64, CV_8UC1, cv::Scalar(100)), plain = spotted.clone();
  spotted.at<uchar>(20, 30) = 164;
  EXPECT_NEAR(warped_patch(plain, {30, 20}, Eigen::Matrix2d::Identity())->difference(spotted, {30, 20}), 63.0,
              1e-3);
}

TEST(PtamPatches, AreSearchedAtTheLevelWhereTheyHaveTheirSize) {
  const cv::Mat image = speckle(64, 1);
  const Eigen::Matrix2d same = Eigen::Matrix2d::Identity();
  EXPECT_EQ(warped_patch(image, {30, 30}, 1.7 * same)->level, 0);  // area 2.89, and 3 is the limit
  EXPECT_EQ(warped_patch(image, {30, 30}, 1.8 * same)->level, 1);  // 3.24
  EXPECT_EQ(warped_patch(image, {30, 30}, 4.0 * same)->level,
            2);  // a patch of a quarter-size image, seen from as far
  EXPECT_FALSE(warped_patch(image, {30, 30}, 0.4 * same));  // 0.16: seen from too far
  EXPECT_FALSE(warped_patch(image, {30, 30}, 30.0 * same));
  EXPECT_FALSE(warped_patch(image, {2, 30}, same));  // leaves its image
}

TEST(PtamSearch, FindsAPatchWhereItHasGoneBetweenPixelsToo) {
  const cv::Mat image = speckle(128, 2);
  cv::Mat shifted;
  const cv::Mat by = (cv::Mat_<double>(2, 3) << 1, 0, 3.4, 0, 1, -2.3);
  cv::warpAffine(image, shifted, by, image.size(), cv::INTER_CUBIC);
  PtamConfig config;
  config.fast_0 = 5;
  const auto seen = make_ptam_image(image, config), searched = make_ptam_image(shifted, config);
  int all = 0, right = 0;
  for (const cv::Point& corner : seen->corners[0]) {
    if (corner.x < 30 || corner.y < 30 || corner.x > 98 || corner.y > 98) continue;
    const auto patch = warped_patch(image, corner, Eigen::Matrix2d::Identity());
    const auto found = search_patch(*patch, *searched, {corner.x, corner.y}, 10, 500, 8);
    if (!found) continue;
    const Eigen::Vector2d off = found->pixel - Eigen::Vector2d(corner.x + 3.4, corner.y - 2.3);
    ++all;
    right += off.norm() < 0.15 ? 1 : 0;
    // Not found where it is not looked for.
    const auto elsewhere = search_patch(*patch, *searched, {corner.x - 10.0, corner.y + 8.0}, 5, 500, 8);
    EXPECT_FALSE(elsewhere && (elsewhere->pixel - found->pixel).norm() < 1.0);
  }
  EXPECT_GT(right, 20);
  EXPECT_GT(right, 0.8 * all);  // few corners have a twin near by
}

TEST(PtamTurn, IsFoundBySmallImages) {
  const Camera camera = camera_by_name("generated");
  const BentWall wall;
  Vector6d xi = Vector6d::Zero();
  xi.tail<3>() = Eigen::Vector3d(0.02, -0.03, 0.015);
  const Pose turned = se3_exp(xi);
  const auto then = make_ptam_image(wall.render(camera, Pose::Identity()).gray, PtamConfig()),
             now = make_ptam_image(wall.render(camera, turned).gray, PtamConfig());
  const SmallTurn turn = turn_between(then->small, now->small, camera);
  EXPECT_LT(rotation_angle(turn.now_from_then * turned.linear()), 0.006);  // of 0.039
  EXPECT_NEAR(rotation_angle(turn_between(then->small, then->small, camera).now_from_then), 0.0, 1e-6);
}

TEST(PtamPoses, AreFoundAmongOutliersByTukey) {
  const Camera camera = camera_by_name("generated");
  Vector6d xi;
  xi << 0.05, -0.02, 0.04, 0.01, 0.02, -0.015;
  const Pose truth = se3_exp(xi);
  cv::RNG random(3);
  std::vector<PtamSight> sights;
  for (int i = 0; i < 120; ++i) {
    PtamSight sight;
    sight.world = {random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8), random.uniform(1.5, 4.0)};
    sight.pixel = camera.project(truth * sight.world);
    if (i % 4 == 0) sight.pixel += Eigen::Vector2d(random.uniform(20.0, 60.0), random.uniform(-60.0, -20.0));
    sights.push_back(sight);
  }
  const PtamPose found = solve_ptam_pose(sights, Pose::Identity(), camera, 16.0, PtamConfig());
  EXPECT_LT(se3_log(found.camera_from_world * truth.inverse()).norm(), 1e-4);
  for (int i = 0; i < 120; ++i) EXPECT_EQ(sights[static_cast<std::size_t>(i)].weight > 0.0, i % 4 != 0) << i;
  EXPECT_DOUBLE_EQ(found.bound_px, 4.0);
}

TEST(PtamPoses, ErrorsOfLargePatchesCountForLess) {
  const Camera camera = camera_by_name("generated");
  PtamSight sight;
  sight.world = {0, 0, 2};
  sight.level = 2;
  sight.pixel = camera.project(sight.world) + Eigen::Vector2d(8, 0);
  std::vector<PtamSight> one{sight};
  PtamConfig config;
  config.iterations = 1;
  config.prior = 1e6;  // it stays where it is
  (void)solve_ptam_pose(one, Pose::Identity(), camera, 16.0, config);
  EXPECT_NEAR(one[0].squared_px, 4.0, 0.2);  // (8 px / 4)²
}

TEST(PtamBundles, MendViewsAndPointsAndTellOutliers) {
  const Camera camera = camera_by_name("generated");
  cv::RNG random(5);
  PtamBundle bundle;
  std::vector<Pose> truth;
  for (int i = 0; i < 4; ++i) {
    Vector6d xi;
    xi << 0.1 * i, 0.02 * i, -0.03 * i, 0.01 * i, -0.02 * i, 0.0;
    truth.push_back(se3_exp(xi));
    bundle.views.push_back({i, truth.back(), i == 0});
  }
  std::vector<Eigen::Vector3d> points;
  for (int p = 0; p < 80; ++p) {
    points.emplace_back(random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(1.5, 3.5));
    bundle.points.push_back({p, points.back() * (1.0 + random.uniform(-0.01, 0.01))});
    for (int i = 0; i < 4; ++i) {
      PtamBundle::Measurement one{i, p, camera.project(truth[static_cast<std::size_t>(i)] * points.back())};
      one.depth = (truth[static_cast<std::size_t>(i)] * points.back()).z();
      if (p == 7 && i == 2) one.pixel.x() += 40.0;
      bundle.measurements.push_back(one);
    }
  }
  for (int i = 1; i < 4; ++i) {
    Vector6d off = Vector6d::Constant(0.004);
    bundle.views[static_cast<std::size_t>(i)].camera_from_world =
        se3_exp(off) * truth[static_cast<std::size_t>(i)];
  }
  solve_ptam_bundle(bundle, camera, PtamConfig());
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(se3_log(bundle.views[static_cast<std::size_t>(i)].camera_from_world *
                      truth[static_cast<std::size_t>(i)].inverse())
                  .norm(),
              1e-3)
        << i;
  EXPECT_GT(bundle.rms_before_px, 1.0);
  EXPECT_LT(bundle.rms_after_px, 0.05);
  for (const auto& one : bundle.measurements) EXPECT_TRUE(one.outlier || one.point != 7 || one.view != 2);
  EXPECT_GT(bundle.iterations, 1);
  EXPECT_EQ((bundle.views[0].camera_from_world.matrix() - truth[0].matrix()).norm(), 0.0);
}

TEST(PtamTracking, RelocalisesByTheSmallImagesAfterThreeLostFrames) {
  const Camera camera = camera_by_name("generated");
  Config config;
  config.run.odometry = "ptam";
  config.run.method = "none";
  config.of<PtamConfig>().fine_subpixel_steps = 8;  // the wall is smooth: its corners are whole pixels off
  Odometry odometry(camera, config);
  const BentWall wall;
  for (int i = 0; i < 3; ++i) (void)odometry.process(wall.render(camera, Pose::Identity(), i));
  for (int i = 3; i < 6; ++i) {
    Frame dark = wall.render(camera, Pose::Identity(), i);
    dark.gray.setTo(0);
    EXPECT_EQ(odometry.process(dark).record.status, FrameStatus::lost);
  }
  Vector6d xi;
  xi << 0.02, 0.0, 0.01, 0.02, 0.03, 0.0;  // elsewhere than where it was lost
  const FrameResult again = odometry.process(wall.render(camera, se3_exp(xi), 6));
  EXPECT_EQ(again.record.status, FrameStatus::relocalised);
  EXPECT_TRUE(dynamic_cast<const PtamTrace&>(*again.engine).relocalised);
  EXPECT_LT(se3_log(again.record.world_from_camera.inverse() * se3_exp(xi)).norm(), 5e-3);
}

TEST(PtamTracking, MakesAKeyframeWhenFarEnoughAndLateEnough) {
  const Camera camera = camera_by_name("generated");
  Config config;
  config.run.odometry = "ptam";
  config.run.method = "none";
  config.of<PtamConfig>().fine_subpixel_steps = 8;  // the wall is smooth: its corners are whole pixels off
  Odometry odometry(camera, config);
  std::vector<int> keyframes;
  for (int i = 0; i < 45; ++i) {
    Vector6d xi = Vector6d::Zero();
    xi[0] = i < 30 ? 0.004 * i : 0.12;  // 0.1 m at frame 25, then it rests
    const FrameResult result = odometry.process(BentWall().render(camera, se3_exp(xi), i));
    if (result.record.keyframe) keyframes.push_back(i);
    EXPECT_LT(se3_log(result.record.world_from_camera.inverse() * se3_exp(xi)).norm(), 8e-3) << i;
  }
  ASSERT_EQ(keyframes.size(), 2U);
  EXPECT_NEAR(keyframes[1], 26, 2);
}

}  // namespace
}  // namespace stillpoint
