#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/config.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/wang2014/dense_labels.hpp"
#include "core/motion/wang2014/motion_segments.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/wall_and_board.hpp"

namespace stillpoint {
namespace {

using motion_test::SceneRun;
using motion_test::WallAndBoard;

const Wang2014Config kConfig;

// ---- Affinities ----

TEST(Wang2014, AffinityIsAHalfAtFiveCentimetresASecondAndThirtyCentimetres) {
  EXPECT_NEAR(affinity(0.05, 0.3, kConfig), 0.5, 1e-12);
  EXPECT_NEAR(affinity(0.10, 0.3, kConfig), 1.0 / 16.0, 1e-12);
  EXPECT_NEAR(affinity(0.05, 0.6, kConfig), 1.0 / 16.0, 1e-12);
  EXPECT_NEAR(affinity(0.025, 0.6, kConfig), 0.5, 1e-12);
  EXPECT_EQ(affinity(0.0, 5.0, kConfig), 1.0);
  Wang2014Config wider;
  wider.half_distance_m = 0.6;
  EXPECT_NEAR(affinity(0.05, 0.6, wider), 0.5, 1e-12);
}

ResidualVelocity velocity(float x, float variance) {
  return {true, {x, 0.0F, 0.0F}, Eigen::Matrix3f::Identity() * variance};
}

TEST(Wang2014, VelocitiesDifferByTheLargestAtOneTimeBeyondNoise) {
  const Velocities still{velocity(0, 0), velocity(0, 0), velocity(0, 0)};
  const Velocities moves{velocity(0.1F, 0), velocity(-0.4F, 0), ResidualVelocity{}};
  EXPECT_NEAR(speed_difference(still, moves, 3.0), 0.4, 1e-6);
  // Deviations 3 cm/s and 4 cm/s make 5 cm/s; two of them are 10 cm/s.
  const Velocities a{velocity(0.0F, 0.0009F)}, b{velocity(0.25F, 0.0016F)}, c{velocity(0.09F, 0.0016F)};
  EXPECT_NEAR(speed_difference(a, b, 2.0), 0.15, 1e-6);
  EXPECT_EQ(speed_difference(a, c, 2.0), 0.0);
  EXPECT_EQ(speed_difference(a, {ResidualVelocity{}}, 2.0), -1.0);
  EXPECT_EQ(speed_difference({}, b, 2.0), -1.0);
}

TEST(Wang2014, DistanceIsTheMeanOfFramesInWhichBothAreMeasured) {
  TrajectoryPoint near, far, unmeasured;
  near.z = 1.0F, far.z = 3.0F;
  const PointTrajectory a{near, near, near}, b{far, unmeasured, near};  // 2 m, not known, 0 m
  EXPECT_NEAR(mean_distance(a, b), 1.0, 1e-6);
  EXPECT_NEAR(mean_distance(a, {far}), 2.0, 1e-6);  // newest against newest
  EXPECT_EQ(mean_distance(a, {unmeasured}), -1.0);
}

// ---- Spectrum ----

TEST(Wang2014, TheLaplaciansSpectrumIsTheOneKnownOfSmallGraphs) {
  // A path of three: 0, 1, 2. Two pairs apart: 0, 0, 2, 2.
  const Spectrum path = laplacian_spectrum(3, std::vector<AffinityEdge>{{0, 1, 0.3}, {1, 2, 0.3}}, 8);
  ASSERT_EQ(path.values.size(), 3);
  EXPECT_NEAR(path.values[0], 0.0, 1e-12);
  EXPECT_NEAR(path.values[1], 1.0, 1e-12);
  EXPECT_NEAR(path.values[2], 2.0, 1e-12);
  // The first is the root of the degrees: 1, √2, 1 by 2.
  EXPECT_NEAR(path.vectors(1, 0), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(path.vectors(0, 0), 0.5, 1e-12);
  const Spectrum pairs = laplacian_spectrum(4, std::vector<AffinityEdge>{{0, 2, 1.0}, {1, 3, 0.1}}, 3);
  ASSERT_EQ(pairs.values.size(), 3);
  EXPECT_NEAR(pairs.values[1], 0.0, 1e-12);
  EXPECT_NEAR(pairs.values[2], 2.0, 1e-12);
}

TEST(Wang2014, TheLargestEigengapTellsHowManyClusters) {
  Eigen::VectorXd values(7);
  values << 0.0, 0.01, 0.02, 0.5, 0.6, 0.62, 0.7;
  EXPECT_EQ(clusters_by_eigengap(values, 2, 6), 3);
  EXPECT_EQ(clusters_by_eigengap(values, 4, 6), 4);  // gaps 0.1, 0.02, 0.08
  EXPECT_EQ(clusters_by_eigengap(values, 5, 6), 6);
  EXPECT_EQ(clusters_by_eigengap(values.head(3), 2, 6), 2);
  EXPECT_EQ(clusters_by_eigengap(values.head(1), 2, 6), 1);
}

TEST(Wang2014, WeaklyLinkedPartsBecomeClustersNumberedBySize) {
  // Complete parts of 3, 6 and 4 points, linked one to the next.
  std::vector<AffinityEdge> edges;
  const std::vector<std::pair<int, int>> parts{{0, 3}, {3, 9}, {9, 13}};
  for (const auto& [first, end] : parts)
    for (int a = first; a < end; ++a)
      for (int b = a + 1; b < end; ++b) edges.push_back({a, b, 1.0});
  edges.push_back({2, 3, 0.001});
  edges.push_back({8, 9, 0.001});
  const Spectrum spectrum = laplacian_spectrum(13, edges, 8);
  EXPECT_EQ(clusters_by_eigengap(spectrum.values, 2, 6), 3);
  EXPECT_EQ(cluster_rows(spectrum.vectors, 3), (std::vector<int>{2, 2, 2, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(cluster_rows(spectrum.vectors, 1), std::vector<int>(13, 0));
}

// ---- Rigid motions ----

/// Points on a wavy surface, moved; every `spoiled`-th goes elsewhere.
std::vector<ScenePair> moved_points(int count, const Pose& motion, int spoiled = 0) {
  std::vector<ScenePair> pairs;
  cv::RNG random(3);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d last(random.uniform(-0.8, 0.8), random.uniform(-0.6, 0.6),
                               random.uniform(1.5, 2.5));
    Eigen::Vector3d here = motion * last;
    if (spoiled > 0 && i % spoiled == 0) here += Eigen::Vector3d(0.3, 0.2, 0.1);
    pairs.push_back({(last.head<2>() / last.z()).cast<float>(), (here.head<2>() / here.z()).cast<float>(),
                     static_cast<float>(last.z()), static_cast<float>(here.z())});
  }
  return pairs;
}

const SceneFlowNoise kNoise{0.002, 0.002, 1.425e-3, 0.002};

TEST(Wang2014, FindsARigidMotionAmongOthers) {
  Vector6d xi;
  xi << 0.1, -0.05, 0.02, 0.05, -0.1, 0.2;
  const Pose motion = se3_exp(xi);
  const RigidFit fit = fit_rigid(moved_points(90, motion, 3), kNoise, 3.0, 100, 1);
  ASSERT_TRUE(fit.found);
  EXPECT_EQ(fit.explained, 60);
  EXPECT_LT((fit.motion.translation() - motion.translation()).norm(), 1e-4);
  EXPECT_LT(rotation_angle(fit.motion.linear().transpose() * motion.linear()), 1e-4);
  EXPECT_FALSE(fit_rigid(moved_points(2, motion), kNoise, 3.0, 100, 1).found);
  // A mirror image is no rigid motion.
  const std::vector<Eigen::Vector3f> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      mirrored{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  EXPECT_NEAR(rigid_motion(from, mirrored)->linear().determinant(), 1.0, 1e-9);
}

TEST(Wang2014, ClustersOfOneMotionBecomeOne) {
  Vector6d one, other;
  one << 0.02, 0.0, 0.0, 0.0, 0.05, 0.0;
  other << 0.3, 0.0, 0.0, 0.0, 0.0, 0.0;
  std::vector<ScenePair> pairs = moved_points(40, se3_exp(one));
  const std::vector<ScenePair> moving = moved_points(20, se3_exp(other));
  pairs.insert(pairs.end(), moving.begin(), moving.end());
  std::vector<int> cluster(60, 2);
  for (std::size_t i = 0; i < 40; ++i) cluster[i] = i < 25 ? 0 : 1;
  cluster[59] = -1;
  const MergedClusters merged = merge_clusters(pairs, cluster, 3, kNoise, kConfig);
  EXPECT_EQ(merged.merged, (std::vector<int>{0, 0, 2}));
  EXPECT_NEAR(explained_share(merged.motions[0].motion, pairs, cluster, 1, kNoise, 3.0), 1.0, 1e-12);
  EXPECT_NEAR(explained_share(merged.motions[0].motion, pairs, cluster, 2, kNoise, 3.0), 0.0, 1e-12);
  EXPECT_EQ(explained_share(merged.motions[0].motion, pairs, cluster, 7, kNoise, 3.0), 0.0);
}

// ---- Trajectories and pixels ----

TrajectoryFrame plane(double timestamp) {
  Frame frame;
  frame.gray = motion_test::textured_image({640, 480}, 3);
  frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(2.0));
  TrajectoryFrame made;
  made.timestamp = timestamp;
  made.view = make_rgbd_view(frame.gray, frame.depth, Camera(), kFlowFactor);
  made.view.gray.convertTo(made.gray, CV_8U);
  made.rays = PixelRays(Camera(), {640, 480}, kFlowFactor);
  return made;
}

TEST(Wang2014, TrajectoriesFollowFlowThatLeadsThereAndBack) {
  Wang2014Config config;
  config.window_frames = 3;
  TrajectorySet set = advanced({}, nullptr, plane(0.0), config);
  EXPECT_EQ(set.all.size(), 80U * 60U);
  // 4 small px to the right; in the lower half it does not lead back: 0.9 small px are 1.8 px, and 1 px and 5
  // % of 8 px are 1.4 px.
  FlowPair flow{cv::Mat(240, 320, CV_32FC2, cv::Scalar(-4, 0)),
                cv::Mat(240, 320, CV_32FC2, cv::Scalar(4, 0))};
  flow.last_from_here.rowRange(120, 240).setTo(cv::Scalar(-4.9, 0));
  const cv::Point2f first = set.all[0].back().small;
  for (int i = 1; i <= 5; ++i) {
    set = advanced(set, &flow, plane(0.1 * i), config);
    EXPECT_EQ(set.all.size(), 80U * 60U);  // what leaves or is lost begins anew
    EXPECT_EQ(set.timestamps.size(), static_cast<std::size_t>(std::min(i + 1, 4)));
  }
  const auto longest = std::count_if(set.all.begin(), set.all.end(),
                                     [](const PointTrajectory& one) { return one.size() == 4; });
  EXPECT_EQ(longest, 30 * 77);  // of 80 columns three came in meanwhile
  const auto kept = std::find_if(set.all.begin(), set.all.end(), [&](const PointTrajectory& one) {
    return std::abs(one.back().small.x - (first.x + 20.0F)) < 0.01F && one.back().small.y == first.y;
  });
  ASSERT_NE(kept, set.all.end());
  EXPECT_NEAR(kept->front().small.x, first.x + 8.0F, 0.01F);
  EXPECT_EQ(set.back(static_cast<std::size_t>(kept - set.all.begin()), 4), nullptr);
  EXPECT_NEAR(kept->back().z, 2.0F, 1e-6F);
  config.least_frames = 4;
  config.most_trajectories = 100;
  EXPECT_EQ(clustered_trajectories(set, config).size(), 100U);
  config.least_frames = 5;
  EXPECT_TRUE(clustered_trajectories(set, config).empty());
}

TEST(Wang2014, FlowCarriesLabelsAndWhatComesFromOutsideHasNone) {
  cv::Mat image = cv::Mat::zeros(40, 50, CV_8UC1);
  image(cv::Rect(0, 10, 20, 10)).setTo(3);
  const cv::Mat here = carried(image, cv::Mat(40, 50, CV_32FC2, cv::Scalar(-5.3, 2)));
  EXPECT_EQ(cv::countNonZero(here), 20 * 10);
  EXPECT_EQ(cv::boundingRect(here), cv::Rect(5, 8, 20, 10));
  EXPECT_EQ(here.at<std::uint8_t>(8, 5), 3);
  EXPECT_EQ(cv::countNonZero(carried(image, cv::Mat(40, 50, CV_32FC2, cv::Scalar(NAN, NAN)))), 0);
}

TEST(Wang2014, FillsSmallHolesAndNoOpenOnes) {
  cv::Mat mask = cv::Mat::zeros(100, 100, CV_8UC1);
  mask(cv::Rect(10, 10, 60, 60)).setTo(255);
  mask(cv::Rect(20, 20, 9, 9)).setTo(0);    // 81 px: less than a hundredth
  mask(cv::Rect(40, 40, 10, 10)).setTo(0);  // 100 px: not
  mask(cv::Rect(66, 30, 4, 4)).setTo(0);    // open to the side
  const cv::Mat filled = holes_filled(mask);
  EXPECT_EQ(cv::countNonZero(filled), 3600 - 100 - 16);
  EXPECT_EQ(filled.at<std::uint8_t>(24, 24), 255);
}

TEST(Wang2014, PixelsTakeAfterTrajectoriesNearInPlaceAndDepth) {
  TrajectoryFrame frame = plane(0.0);
  frame.gray.setTo(100), frame.view.gray.setTo(100.0F);
  frame.view.depth.colRange(0, 160).setTo(1.0F);
  frame.view.depth.rowRange(0, 40).setTo(0.0F);
  TrajectorySet set;
  const auto add = [&](float x, float y, float z) {
    TrajectoryPoint point;
    point.small = {x, y}, point.z = z;
    set.all.push_back({point});
  };
  std::vector<int> chosen, label;
  for (int y = 10; y < 200; y += 15)
    for (int x = 10; x < 320; x += 15) {
      if (std::abs(x - 160) < 20) continue;  // none about the outline, where depth alone tells
      chosen.push_back(static_cast<int>(set.all.size()));
      label.push_back(x < 160 ? 4 : 0);
      add(static_cast<float>(x), static_cast<float>(y), x < 160 ? 1.0F : 2.0F);
    }
  const cv::Mat labels = dense_labels(frame, set, chosen, label, kConfig);
  EXPECT_EQ(cv::countNonZero(labels(cv::Rect(0, 45, 158, 140)) != 5), 0);
  EXPECT_EQ(cv::countNonZero(labels(cv::Rect(162, 45, 158, 140)) != 1), 0);
  EXPECT_EQ(labels.at<std::uint8_t>(20, 50), 5);  // without depth: by place
  const std::vector<int> areas = label_areas(labels, 5);
  EXPECT_EQ(areas[1], 0);
  EXPECT_GT(areas[0], 160 * 150);
}

TEST(Wang2014, ALonelyTrajectoryLabelsNothingFarAway) {
  TrajectoryFrame frame = plane(0.0);
  frame.gray.setTo(100), frame.view.gray.setTo(100.0F);
  TrajectorySet set;
  TrajectoryPoint point;
  point.small = {30, 30}, point.z = 2.0F;
  set.all.push_back({point});
  const cv::Mat labels = dense_labels(frame, set, std::vector<int>{0}, std::vector<int>{0}, kConfig);
  EXPECT_EQ(labels.at<std::uint8_t>(32, 32), 1);
  EXPECT_EQ(labels.at<std::uint8_t>(32, 80), 1);   // 100 px of 20 off: 5, and 6 is the limit
  EXPECT_EQ(labels.at<std::uint8_t>(32, 110), 0);  // 160 px
}

// ---- The method as a whole ----

std::unique_ptr<MotionMethod> method(const WallAndBoard& scene, const Config& config = {}) {
  return method_named("wang2014").make(scene.camera, config);
}

TEST(Wang2014, SeparatesABoardFromTheWall) {
  const WallAndBoard scene;
  SceneRun run(scene, *method(scene));
  (void)run.next();
  EXPECT_EQ(run.next().note, "too few trajectories of 6 frames with depth yet");
  MotionResult result;
  int segmented = 0, carried_on = 0;
  for (int i = 2; i < 14; ++i) {
    result = run.next();
    if (result.mask.empty()) continue;
    ++(result.figures.at(2) > 0.0 ? segmented : carried_on);
    const auto shares = motion_test::overlap(result.mask, scene.truth(i));
    EXPECT_GT(shares.recall, 0.8) << i;
    EXPECT_GT(shares.precision, 0.8) << i;
  }
  EXPECT_EQ(segmented, 2);
  EXPECT_EQ(carried_on, 6);
}

TEST(Wang2014, ShowsWhatItSaw) {
  const WallAndBoard scene;
  SceneRun run(scene, *method(scene));
  MotionResult result;
  for (int i = 0; i < 7; ++i) {
    result = run.next();
    if (!result.mask.empty()) break;
  }
  ASSERT_FALSE(result.mask.empty());
  const StageLog log = run.describe(result);
  for (const char* id : {"flow_tracks", "affinity_row", "affinity_neighbours", "eigenvector_2",
                         "eigenvector_8", "clusters", "merged", "labels", "mask"})
    EXPECT_TRUE(log.layer(id) != nullptr && !log.layer(id)->image.empty()) << id;
  EXPECT_EQ(log.small_factor, kFlowFactor);
  double highest = 0.0;
  cv::minMaxLoc(log.layer("affinity_row")->image, nullptr, &highest);
  EXPECT_NEAR(highest, 1.0, 1e-6);  // of the chosen one with itself
  const cv::Rect box = scene.board_box(run.last_index());
  const cv::Point2f middle(static_cast<float>(box.x) + 70.0F, static_cast<float>(box.y) + 90.0F);
  EXPECT_EQ(log.explain(middle, true).back(), "So it is dynamic.");
  EXPECT_EQ(log.explain({600, 400}, false).back(), "So it is static.");
}

TEST(Wang2014, NothingIsDynamicWhereNothingMoves) {
  WallAndBoard scene;
  scene.board_step = 0.0;
  SceneRun run(scene, *method(scene));
  MotionResult result;
  for (int i = 0; i < 7; ++i) result = run.next();
  ASSERT_FALSE(result.mask.empty());
  EXPECT_LT(result.mask_share, 0.01);
}

TEST(Wang2014, ClonesThreadsAndLookingTwiceChangeNothing) {
  const WallAndBoard scene;
  SceneRun one(scene, *method(scene));
  for (int i = 0; i < 4; ++i) (void)one.next();
  SceneRun other(one);
  const int threads = cv::getNumThreads();
  for (int i = 0; i < 4; ++i) {
    cv::setNumThreads(1);
    const MotionResult a = one.next(1);
    cv::setNumThreads(4);
    const MotionResult b = other.next(4);
    EXPECT_EQ(a.mask.empty(), b.mask.empty());
    EXPECT_TRUE(a.mask.empty() || motion_test::same_bytes(a.mask, b.mask));
    EXPECT_EQ(a.figures, b.figures);
    if (i == 3) {
      EXPECT_GT(a.mask_share, 0.02);
    }
  }
  cv::setNumThreads(threads);
}

TEST(Wang2014, ThePresetHoldsTheDefaults) {
  const Config config = load_config("wang2014");
  EXPECT_EQ(config.run.method, "wang2014");
  EXPECT_EQ(config.of<Wang2014Config>(), Wang2014Config());
  EXPECT_FALSE(method_named("wang2014").needs.first_pose);
}

TEST(Wang2014, ARunIsTheSameWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 10);
  Config config;
  config.run.method = "wang2014";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  FrameScores scores;
  for (const FrameScores& score : one.scores) scores += score;
  ASSERT_TRUE(scores.mask.precision().has_value());
  EXPECT_GT(*scores.mask.precision(), 0.5);
}

}  // namespace
}  // namespace stillpoint
