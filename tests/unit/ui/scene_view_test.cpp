#include "ui/scene/scene_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ui/scene/scene_mesh.hpp"
#include "ui/scene/scene_widget.hpp"

namespace stillpoint {
namespace {

const Viewport kViewport{800.0, 600.0};
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

SceneView oblique() {
  SceneView view;
  view.target = {1.0, 2.0, 0.5};
  view.distance = 4.0;
  look_from(view, ViewPreset::kOblique, kUp);
  return view;
}

TEST(SceneViewTest, TargetIsInTheMiddleAtItsDistance) {
  const SceneView view = oblique();
  const auto seen = project(view, kViewport, view.target);
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->isApprox(Eigen::Vector3d(400.0, 300.0, 4.0), 1e-9));
}

TEST(SceneViewTest, ProjectAgreesWithTheMatricesGlIsGiven) {
  const SceneView view = oblique();
  const Eigen::Matrix4d clip_from_world = clip_from_view(view, kViewport) * view_from_world(view);
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1.5, 2.5, 1), Eigen::Vector3d(0, 3, -1)}) {
    const Eigen::Vector4d clip = clip_from_world * point.homogeneous();
    const auto seen = project(view, kViewport, point);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->x(), (0.5 + 0.5 * clip.x() / clip.w()) * 800.0, 1e-9);
    EXPECT_NEAR(seen->y(), (0.5 - 0.5 * clip.y() / clip.w()) * 600.0, 1e-9);
    EXPECT_NEAR(seen->z(), clip.w(), 1e-9);
  }
}

TEST(SceneViewTest, NothingIsSeenBehindTheEye) {
  const SceneView view = oblique();
  EXPECT_FALSE(project(view, kViewport, eye(view) + (eye(view) - view.target)));
  EXPECT_FALSE(project(view, kViewport, Eigen::Vector3d::Constant(std::nan(""))));
}

TEST(SceneViewTest, PresetsLookWhereTheySay) {
  SceneView view;
  look_from(view, ViewPreset::kTop, kUp);
  EXPECT_TRUE(eye(view).isApprox(Eigen::Vector3d(0.0, 0.0, 3.0)));
  const auto east = project(view, kViewport, {1.0, 0.0, 0.0}),
             north = project(view, kViewport, {0.0, 1.0, 0.0});
  EXPECT_GT(east->x(), 400.0);
  EXPECT_LT(north->y(), 300.0);
  look_from(view, ViewPreset::kFront, kUp);
  EXPECT_TRUE(eye(view).isApprox(Eigen::Vector3d(0.0, -3.0, 0.0)));
  EXPECT_LT(project(view, kViewport, kUp)->y(), 300.0);
  look_from(view, ViewPreset::kSide, kUp);
  EXPECT_TRUE(eye(view).isApprox(Eigen::Vector3d(3.0, 0.0, 0.0)));
}

TEST(SceneViewTest, PresetsServeWorldsWhereUpIsNotZ) {
  // Without ground truth the world is the first camera's: y points down.
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  SceneView view;
  for (const ViewPreset preset : {ViewPreset::kOblique, ViewPreset::kFront, ViewPreset::kSide}) {
    look_from(view, preset, up);
    EXPECT_LT(project(view, kViewport, up)->y(), 300.0);
    EXPECT_NEAR(project(view, kViewport, up)->x(), 400.0, 1e-6);
  }
}

TEST(SceneViewTest, CameraPresetSeesWhatTheCameraSees) {
  Pose camera = Pose::Identity();
  camera.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  camera.translation() = Eigen::Vector3d(4.0, -1.0, 2.0);
  SceneView view;
  look_from(view, ViewPreset::kCamera, kUp, camera);
  EXPECT_TRUE(eye(view).isApprox(camera.translation(), 1e-9));
  // Right in the camera is right on the screen, down is down.
  const auto right_below = project(view, kViewport, camera * Eigen::Vector3d(0.5, 0.25, 2.0));
  EXPECT_GT(right_below->x(), 400.0);
  EXPECT_GT(right_below->y(), 300.0);
  EXPECT_NEAR((right_below->x() - 400.0) / (right_below->y() - 300.0), 2.0, 1e-9);
}

TEST(SceneViewTest, OrbitKeepsTargetDistanceAndHorizon) {
  SceneView view = oblique();
  for (const Eigen::Vector2d& drag :
       {Eigen::Vector2d(30, 10), Eigen::Vector2d(-250, 44), Eigen::Vector2d(5, -80)}) {
    orbit(view, kViewport, drag, kUp);
    EXPECT_NEAR((eye(view) - view.target).norm(), 4.0, 1e-9);
    EXPECT_NEAR((view.world_from_view * Eigen::Vector3d::UnitX()).dot(kUp), 0.0, 1e-9);
  }
}

TEST(SceneViewTest, OrbitFollowsTheMouseAndStopsAtThePole) {
  SceneView view = oblique();
  const Eigen::Vector3d near_point = view.target + 0.5 * (eye(view) - view.target).normalized();
  const auto before = project(view, kViewport, near_point);
  orbit(view, kViewport, {20.0, 0.0}, kUp);
  EXPECT_GT(project(view, kViewport, near_point)->x(), before->x());
  orbit(view, kViewport, {0.0, 1e5}, kUp);
  const double from_pole = std::acos((eye(view) - view.target).normalized().dot(kUp));
  EXPECT_NEAR(from_pole, 0.01, 1e-6);
  orbit(view, kViewport, {0.0, -1e5}, kUp);
  EXPECT_NEAR(std::acos((eye(view) - view.target).normalized().dot(kUp)), std::numbers::pi - 0.01, 1e-6);
}

TEST(SceneViewTest, OrbitLeavesAPlanWithoutATurn) {
  SceneView view;
  look_from(view, ViewPreset::kTop, kUp);
  orbit(view, kViewport, {0.0, 0.0}, kUp);
  EXPECT_TRUE(eye(view).isApprox(Eigen::Vector3d(0.0, 0.0, 3.0), 1e-9));
}

TEST(SceneViewTest, PanCarriesThePointUnderTheMouse) {
  SceneView view = oblique();
  const Eigen::Vector3d held = point_at_target(view, kViewport, {250.0, 410.0});
  pan(view, kViewport, {60.0, -25.0});
  EXPECT_TRUE(project(view, kViewport, held)->head<2>().isApprox(Eigen::Vector2d(310.0, 385.0), 1e-9));
}

TEST(SceneViewTest, ZoomKeepsThePointUnderTheCursor) {
  SceneView view = oblique();
  const Eigen::Vector2d cursor{120.0, 500.0};
  const Eigen::Vector3d held = point_at_target(view, kViewport, cursor);
  zoom(view, kViewport, cursor, 0.5);
  EXPECT_DOUBLE_EQ(view.distance, 2.0);
  EXPECT_TRUE(project(view, kViewport, held)->head<2>().isApprox(cursor, 1e-9));
}

TEST(SceneViewTest, FitShowsTheWholeBoxAndLittleMore) {
  const SceneBounds box{{-2.0, 1.0, 0.0}, {5.0, 2.0, 1.5}};
  for (const Viewport viewport : {Viewport{800, 600}, Viewport{300, 900}}) {
    for (const ViewPreset preset : {ViewPreset::kOblique, ViewPreset::kTop, ViewPreset::kSide}) {
      SceneView view;
      look_from(view, preset, kUp);
      fit(view, viewport, box);
      double reach = 0.0;
      for (int corner = 0; corner < 8; ++corner) {
        const auto seen = project(
            view, viewport,
            {(corner & 1) != 0 ? 5.0 : -2.0, (corner & 2) != 0 ? 2.0 : 1.0, (corner & 4) != 0 ? 1.5 : 0.0});
        ASSERT_TRUE(seen);
        reach = std::max(
            {reach, std::abs(seen->x() / viewport.width - 0.5), std::abs(seen->y() / viewport.height - 0.5)});
      }
      EXPECT_LT(reach, 0.5);
      EXPECT_GT(reach, 0.4);
    }
  }
}

TEST(SceneViewTest, FollowKeepsTheViewersPlaceBesideTheCamera) {
  Pose first = Pose::Identity(), second = Pose::Identity();
  first.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  second.translation() = Eigen::Vector3d(1.5, 0.25, 0.0);
  second.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (const Follow mode : {Follow::kPosition, Follow::kPose}) {
    SceneView view = oblique();
    view.follow = mode;
    follow(view, first);
    const auto before = project(view, kViewport, first.translation());
    const auto ahead = project(view, kViewport, first * Eigen::Vector3d(0.0, 0.3, 0.0));
    follow(view, second);
    EXPECT_TRUE(project(view, kViewport, second.translation())->isApprox(*before, 1e-9));
    const bool turned =
        project(view, kViewport, second * Eigen::Vector3d(0.0, 0.3, 0.0))->isApprox(*ahead, 1e-9);
    EXPECT_EQ(turned, mode == Follow::kPose);
  }
  SceneView still = oblique();
  follow(still, first);
  follow(still, second);
  EXPECT_EQ(still.target, oblique().target);
}

TEST(PickTest, FindsTheNearestWithinReach) {
  const SceneView view = oblique();
  std::vector<Eigen::Vector3f> positions;
  for (int i = 0; i < 100; ++i) positions.emplace_back(0.02F * static_cast<float>(i), 2.0F, 0.5F);
  const auto place = project(view, kViewport, positions[37].cast<double>());
  const auto picked = pick(view, kViewport, positions, place->head<2>() + Eigen::Vector2d(0.4, 1.0), 8.0);
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->index, 37U);
  EXPECT_FALSE(pick(view, kViewport, positions, {5.0, 5.0}, 8.0));
  EXPECT_FALSE(pick(view, kViewport, {}, {400.0, 300.0}, 8.0));
}

TEST(PickTest, PrefersTheNearerOfTwoInLine) {
  const SceneView view = oblique();
  const Eigen::Vector3d towards = (eye(view) - view.target).normalized();
  const std::vector<Eigen::Vector3f> positions{(view.target - towards).cast<float>(),
                                               (view.target + towards).cast<float>(),
                                               (view.target - 2.0 * towards).cast<float>()};
  EXPECT_EQ(pick(view, kViewport, positions, {400.0, 300.0}, 5.0)->index, 1U);
}

TEST(SceneBoundsTest, IgnoresGapsAndFarPoints) {
  SceneData scene;
  EXPECT_EQ(bounds(scene).low, Eigen::Vector3d::Constant(-0.5));
  scene.points.push_back({{100.0F, 0.0F, 0.0F}, false});
  EXPECT_EQ(bounds(scene).high.x(), 100.0);
  scene.paths.push_back({.positions = {{1, 2, 3}, Eigen::Vector3f::Constant(std::nanf("")), {-1, 0, 5}}});
  EXPECT_EQ(bounds(scene).low, Eigen::Vector3d(-1, 0, 3));
  EXPECT_EQ(bounds(scene).high, Eigen::Vector3d(1, 2, 5));
}

TEST(SceneMeshTest, PathsBreakAtGaps) {
  ScenePath path;
  const Eigen::Vector3f gap = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  path.positions = {{0, 0, 0}, {1, 0, 0}, gap, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  EXPECT_EQ(path_segments(path, ThemeName::kDark).size(), 2U * 3U);
}

TEST(SceneMeshTest, SimplifiedPathsStayWithinTolerance) {
  std::vector<Eigen::Vector3f> path;
  for (int i = 0; i < 1000; ++i) {
    const float angle = 0.01F * static_cast<float>(i);
    path.emplace_back(std::cos(angle), std::sin(angle), i == 500 ? std::nanf("") : 0.0F);
  }
  const auto fewer = simplified(path, 0.05);
  EXPECT_LT(fewer.size(), 250U);
  EXPECT_EQ(fewer.front(), path.front());
  EXPECT_EQ(fewer.back(), path.back());
  EXPECT_EQ(std::count_if(fewer.begin(), fewer.end(), [](const auto& p) { return !p.allFinite(); }), 1);
  for (const Eigen::Vector3f& position : path) {
    if (!position.allFinite()) continue;
    float nearest = 1.0F;
    for (const Eigen::Vector3f& kept : fewer) {
      if (kept.allFinite()) nearest = std::min(nearest, (kept - position).norm());
    }
    EXPECT_LE(nearest, 0.05F);
  }
  EXPECT_EQ(simplified(path, 0.0).size(), path.size());
}

TEST(SceneMeshTest, UnseenDetailIsUnderHalfAPixel) {
  SceneView view = oblique();
  const SceneBounds box{{0.5, 1.5, 0.0}, {1.5, 2.5, 1.0}};
  const double detail = unseen_detail(view, kViewport, box);
  ASSERT_GT(detail, 0.0);
  const Eigen::Vector3d right = view.world_from_view * Eigen::Vector3d::UnitX();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d place{(corner & 1) != 0 ? 1.5 : 0.5, (corner & 2) != 0 ? 2.5 : 1.5,
                                (corner & 4) != 0 ? 1.0 : 0.0};
    const auto from = project(view, kViewport, place), to = project(view, kViewport, place + detail * right);
    EXPECT_LE((from->head<2>() - to->head<2>()).norm(), 0.5);
  }
  view.distance = 0.3;
  EXPECT_EQ(unseen_detail(view, kViewport, box), 0.0);
}

TEST(SceneMeshTest, FrustumCornersProjectToTheImageCorners) {
  const FrustumShape shape{.half_width = 320.0F / 535.0F, .half_height = 240.0F / 535.0F};
  const auto corners = frustum_image_corners(Pose::Identity(), shape, 0.5F);
  EXPECT_NEAR(corners[0].x() / corners[0].z() * 535.0F, -320.0F, 1e-3F);
  EXPECT_NEAR(corners[3].y() / corners[3].z() * 535.0F, 240.0F, 1e-3F);
  EXPECT_FLOAT_EQ(corners[2].z(), 0.5F);
}

TEST(SceneMeshTest, GridSpacingIsRoundAndGrowsWithDistance) {
  SceneView view;
  double last = 0.0;
  for (view.distance = 0.1; view.distance < 1000.0; view.distance *= 1.3) {
    const double spacing = grid_spacing(view);
    EXPECT_GE(spacing, last);
    const double leading = spacing / std::pow(10.0, std::floor(std::log10(spacing) + 1e-9));
    EXPECT_TRUE(std::abs(leading - 1) < 1e-6 || std::abs(leading - 2) < 1e-6 || std::abs(leading - 5) < 1e-6)
        << leading;
    last = spacing;
  }
}

TEST(SceneMeshTest, GridLiesOnTheGroundAtWholeSteps) {
  SceneView view = oblique();
  const Segments grid = grid_segments(view, kUp, -0.25, theme(ThemeName::kDark));
  ASSERT_FALSE(grid.empty());
  for (const SceneVertex& vertex : grid) EXPECT_FLOAT_EQ(vertex.position.z(), -0.25F);
}

TEST(ScaleBarTest, IsRoundAndFits) {
  EXPECT_DOUBLE_EQ(scale_bar_length(0.01, 120.0), 1.0);
  EXPECT_DOUBLE_EQ(scale_bar_length(0.01, 99.0), 0.5);
  EXPECT_DOUBLE_EQ(scale_bar_length(0.002, 100.0), 0.2);
  EXPECT_EQ(length_text(0.2), "20 cm");
  EXPECT_EQ(length_text(0.005), "5 mm");
  EXPECT_EQ(length_text(2000.0), "2 km");
}

}  // namespace
}  // namespace stillpoint
