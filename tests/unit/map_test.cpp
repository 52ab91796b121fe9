#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/odometry/bundle_adjustment.hpp"
#include "core/odometry/feature_shelf.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/mapping.hpp"
#include "core/run/run_sequence.hpp"
#include "core/run/saved_map.hpp"

namespace stillpoint {
namespace {

const Camera kCamera = camera_by_name("freiburg3");

/// A wall of points two metres off, and keyframes that slide along it; every keyframe sees every point
/// exactly.
class Wall : public ::testing::Test {
 protected:
  static constexpr int kPoints = 60;

  void SetUp() override {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> x(-0.8, 0.8), y(-0.6, 0.6), z(1.8, 2.4);
    for (int i = 0; i < kPoints; ++i) truth_.emplace_back(x(random), y(random), z(random));
  }

  static Pose camera_at(double x) {
    Pose pose = Pose::Identity();
    pose.translation().x() = -x;
    return pose;
  }

  std::shared_ptr<const FeatureSet> see(const Pose& camera_from_world) const {
    auto features = std::make_shared<FeatureSet>();
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d p = camera_from_world * truth_[static_cast<std::size_t>(i)];
      const Eigen::Vector2d u = kCamera.project(p);
      features->keypoints.emplace_back(static_cast<float>(u.x()), static_cast<float>(u.y()), 31.0F, 0.0F);
      features->keypoints.back().octave = 0;
      features->undistorted.emplace_back(static_cast<float>(u.x()), static_cast<float>(u.y()));
      Descriptor d{};
      d[static_cast<std::size_t>(i) / 32] = std::uint64_t{0xFFFF} << (i % 32);
      features->descriptors.push_back(d);
      features->depth.push_back(static_cast<float>(p.z()));
      features->static_weight.push_back(1.0F);
    }
    features->build_index(kCamera.width, kCamera.height);
    return features;
  }

  /// Adds a keyframe; it sees the points of `ids`, feature i being point i.
  int add(double x, const std::vector<int>& ids) {
    Keyframe keyframe;
    keyframe.camera_from_world = camera_at(x);
    keyframe.features = see(keyframe.camera_from_world);
    keyframe.points = ids;
    return map_.add_keyframe(keyframe);
  }

  std::vector<int> begin() {
    const int first = add(0.0, std::vector<int>(kPoints, kNone));
    EXPECT_EQ(create_points(map_, first, kCamera, config_), kPoints);
    return map_.keyframe(first).points;
  }

  LocalMap map_;
  Config config_;
  std::vector<Eigen::Vector3d> truth_;
};

TEST_F(Wall, FeaturesPutByTakeNoMemoryAndComeBackToTheLastBit) {
  begin();
  const auto store = ByteStore::make();
  map_.shelve_features(*store);
  LocalMap copy = map_;
  copy.drop_features();
  EXPECT_EQ(copy.keyframe(0).features, nullptr);
  LocalMap beside = copy;
  beside.restore_features();
  EXPECT_EQ(beside.keyframe(0).features, map_.keyframe(0).features) << "the very set, while it is there";
  beside = LocalMap();

  const FeatureSet was = *map_.keyframe(0).features;
  EXPECT_EQ(map_.keyframe(0).shelved->bytes().bytes_in_memory(), 0U);
  map_.shelve_features(*store);
  EXPECT_EQ(map_.keyframe(0).shelved, copy.keyframe(0).shelved) << "each is put by once";
  std::weak_ptr<const FeatureSet> alive = map_.keyframe(0).features;
  map_ = LocalMap();
  EXPECT_TRUE(alive.expired()) << "a copy that dropped them holds none";
  copy.restore_features();
  const FeatureSet& again = *copy.keyframe(0).features;
  ASSERT_EQ(again.size(), kPoints);
  EXPECT_EQ(again.undistorted, was.undistorted);
  EXPECT_EQ(again.descriptors, was.descriptors);
  EXPECT_EQ(again.depth, was.depth);
  EXPECT_EQ(again.static_weight, was.static_weight);
  std::size_t near_some = 0;
  for (int i = 0; i < kPoints; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(again.keypoints[at].pt, was.keypoints[at].pt);
    EXPECT_EQ(again.keypoints[at].octave, was.keypoints[at].octave);
    std::vector<int> found, before;
    again.find(was.undistorted[at], 40.0F, 0, 0, found);
    was.find(was.undistorted[at], 40.0F, 0, 0, before);
    EXPECT_EQ(found, before);
    near_some += found.size();
  }
  EXPECT_GT(near_some, static_cast<std::size_t>(kPoints)) << "each finds itself, and some another";
}

TEST_F(Wall, PointsAreMadeWhereDepthSaysTheyAre) {
  const auto ids = begin();
  for (int i = 0; i < kPoints; ++i)
    EXPECT_LT(
        (map_.point(ids[static_cast<std::size_t>(i)]).position - truth_[static_cast<std::size_t>(i)]).norm(),
        1e-5);
}

TEST_F(Wall, FarPointsAreMadeWhereThereAreNoNearerOnes) {
  // Everything counts as far and none is wanted for being near: each part of the image still has its few.
  config_.map.far_depth_m = 0.5;
  config_.map.min_new_points = 0;
  config_.map.min_cell_points = 2;
  const int first = add(0.0, std::vector<int>(kPoints, kNone));
  const int made = create_points(map_, first, kCamera, config_);
  EXPECT_GT(made, 0);
  EXPECT_LT(made, kPoints);
  const Keyframe& keyframe = map_.keyframe(first);
  std::map<std::pair<int, int>, std::pair<int, int>> parts;  // features and points of each
  for (int i = 0; i < kPoints; ++i) {
    const auto f = static_cast<std::size_t>(i);
    const cv::Point2f pixel = keyframe.features->keypoints[f].pt;
    auto& [features, points] = parts[{static_cast<int>(pixel.x) / 80, static_cast<int>(pixel.y) / 80}];
    ++features;
    points += keyframe.points[f] != kNone;
  }
  for (const auto& [part, counts] : parts) EXPECT_EQ(counts.second, std::min(2, counts.first));
  config_.map.min_cell_points = 0;
  const int second = add(0.0, std::vector<int>(kPoints, kNone));
  EXPECT_EQ(create_points(map_, second, kCamera, config_), 0);
}

TEST_F(Wall, CovisibilityCountsSharedPoints) {
  auto ids = begin();
  std::fill(ids.begin() + 20, ids.end(), kNone);
  add(0.1, ids);
  EXPECT_EQ(map_.covisible(0), (std::vector<std::pair<int, int>>{{1, 20}}));
  EXPECT_TRUE(map_.covisible(0, 21).empty());
}

TEST_F(Wall, TheLocalMapIsWhatKeyframesAboutTheMatchesSee) {
  // A chain: each keyframe shares points with the one before alone; the last too few to be its neighbour.
  std::vector<int> before = begin();
  const int only_in_first = before.back();
  for (const auto& [first, shared] : {std::pair{30, 20}, {0, 20}, {30, 10}}) {
    std::vector<int> ids(kPoints, kNone);
    std::copy_n(before.begin() + first, shared, ids.begin() + first);
    const int id = add(0.0, ids);
    create_points(map_, id, kCamera, config_);
    before = map_.keyframe(id).points;
  }
  const auto seen_by = [this](const std::vector<int>& keyframes) {
    std::set<int> ids;
    for (const int keyframe : keyframes)
      for (const int point : map_.keyframe(keyframe).points) ids.insert(point);
    return std::vector<int>(ids.begin(), ids.end());
  };
  EXPECT_EQ(local_points(map_, {kNone, only_in_first}, 0, 20), seen_by({0, 1}));
  EXPECT_EQ(local_points(map_, {kNone, only_in_first}, 0, 1), seen_by({0}));
  EXPECT_EQ(local_points(map_, {}, 2, 20), seen_by({0, 1, 2}));
  EXPECT_EQ(local_points(map_, {}, 2, 2), seen_by({1, 2}));
  EXPECT_EQ(local_points(map_, {before.back()}, 0, 20), seen_by({3}));
  // Where all are among them, looking on is of no use.
  EXPECT_EQ(local_points(map_, {only_in_first, before[before.size() - 25]}, 0, 20), seen_by({0, 1, 2, 3}));
}

TEST_F(Wall, TheDescriptorNearestToAllOthersSpeaksForAPoint) {
  std::mt19937_64 random(5);
  const int point = begin().front();
  for (int keyframes = 2; keyframes < 40; ++keyframes) {
    std::vector<int> ids(kPoints, kNone);
    ids.front() = point;
    const int added = add(0.0, ids);
    // Bits that are set in few, so that distances differ, and some are equal.
    auto features = std::make_shared<FeatureSet>(*map_.keyframe(added).features);
    for (std::uint64_t& word : features->descriptors.front()) word = random() & random() & random();
    map_.keyframe(added).features = features;
    map_.update_point(point, 1.2, 8);

    const std::vector<Observation>& seen = map_.point(point).observations;
    const auto descriptor = [&](const Observation& o) {
      return map_.keyframe(o.keyframe).features->descriptors[static_cast<std::size_t>(o.feature)];
    };
    int least = 257;
    Descriptor nearest{};
    for (const Observation& one : seen) {
      std::vector<int> distances;
      for (const Observation& other : seen)
        distances.push_back(descriptor_distance(descriptor(one), descriptor(other)));
      std::sort(distances.begin(), distances.end());
      const int median = distances[(distances.size() - 1) / 2];
      if (median < least) least = median, nearest = descriptor(one);
    }
    ASSERT_EQ(seen.size(), static_cast<std::size_t>(keyframes));
    EXPECT_EQ(map_.point(point).descriptor, nearest) << keyframes;
  }
}

TEST_F(Wall, ObservationsComeAndGoOnBothSides) {
  const auto ids = begin();
  add(0.1, ids);
  map_.remove_observation(ids[3], 1);
  EXPECT_EQ(map_.keyframe(1).points[3], kNone);
  EXPECT_EQ(map_.point(ids[3]).observations.size(), 1u);
  map_.remove_observation(ids[3], 0);
  EXPECT_FALSE(map_.has_point(ids[3])) << "a point nobody sees is gone";
  map_.remove_point(ids[4]);
  EXPECT_EQ(map_.keyframe(0).points[4], kNone);
  EXPECT_EQ(map_.keyframe(1).points[4], kNone);
}

TEST_F(Wall, PointsThatMoveAreRememberedWhenTheyGo) {
  const auto ids = begin();
  const Eigen::Vector3d place = map_.point(ids[3]).position;
  map_.remove_moving_point(ids[3]);
  map_.remove_point(ids[4]);
  EXPECT_FALSE(map_.has_point(ids[3]));
  ASSERT_EQ(map_.moved_points().size(), 1U);
  EXPECT_EQ(map_.moved_points()[0].id, ids[3]);
  EXPECT_EQ(map_.moved_points()[0].position, place);
}

TEST_F(Wall, FusionJoinsTwinsOfNeighbours) {
  auto ids = begin();
  // The second keyframe missed ten matches and made points of its own there.
  std::fill(ids.begin(), ids.begin() + 10, kNone);
  const int second = add(0.1, ids);
  EXPECT_EQ(create_points(map_, second, kCamera, config_), 10);
  EXPECT_EQ(map_.point_count(), kPoints + 10u);
  EXPECT_GE(fuse_neighbours(map_, second, kCamera, config_), 10);
  EXPECT_EQ(map_.point_count(), static_cast<std::size_t>(kPoints));
  for (const int id : map_.keyframe(second).points) EXPECT_EQ(map_.point(id).observations.size(), 2u);
}

TEST_F(Wall, PointsSeldomFoundAreCulled) {
  const auto ids = begin();
  map_.point(ids[0]).visible = 10;
  map_.point(ids[0]).found = 2;  // 20 %, below the 25 % asked for
  map_.point(ids[1]).visible = 10;
  map_.point(ids[1]).found = 3;
  EXPECT_EQ(cull_points(map_, 0, config_), 1);
  EXPECT_FALSE(map_.has_point(ids[0]));
  EXPECT_TRUE(map_.has_point(ids[1]));
}

TEST_F(Wall, RedundantKeyframesRetireAndTheirPosesStayKnown) {
  const auto ids = begin();
  for (const double x : {0.05, 0.1, 0.15, 0.2}) add(x, ids);
  EXPECT_GT(cull_keyframes(map_, 4, kCamera, config_), 0);
  ASSERT_FALSE(map_.retired().empty());
  EXPECT_TRUE(map_.has_keyframe(0)) << "the first holds the map in place";
  EXPECT_TRUE(map_.has_keyframe(4)) << "the newest is not judged yet";
  for (const auto& retired : map_.retired())
    EXPECT_NEAR(map_.pose_of(retired.id).translation().x(), -0.05 * retired.id, 1e-12);
  // Many at once are found as one by one, to the last bit; also where one hangs on another that left later.
  map_.retire_keyframe(4);
  const std::vector<SavedKeyframe> saved = saved_keyframes(map_);
  EXPECT_EQ(saved.size(), map_.keyframes().size() + map_.retired().size());
  for (const SavedKeyframe& keyframe : saved)
    EXPECT_EQ(
        (keyframe.pose.world_from_camera.matrix() - map_.pose_of(keyframe.id).inverse().matrix()).norm(),
        0.0);
  for (const int id : ids)
    for (const Observation& o : map_.point(id).observations) EXPECT_TRUE(map_.has_keyframe(o.keyframe));
}

TEST_F(Wall, TheMapNeverOutgrowsItsBound) {
  config_.map.max_keyframes = 5;
  config_.map.cull_redundancy = 1.0;
  const auto ids = begin();
  for (int k = 1; k < 20; ++k) {
    const int id = add(0.02 * k, ids);
    cull_keyframes(map_, id, kCamera, config_);
    EXPECT_LE(map_.keyframes().size(), 5u);
  }
  EXPECT_NEAR(map_.pose_of(0).translation().x(), 0.0, 1e-12);
  EXPECT_NEAR(map_.pose_of(10).translation().x(), -0.2, 1e-12);
}

TEST_F(Wall, BundleAdjustmentUndoesADisturbance) {
  const auto ids = begin();
  for (const double x : {0.1, 0.2, 0.3}) add(x, ids);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.01);
  for (int k = 1; k <= 3; ++k) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = noise(random);
    map_.keyframe(k).camera_from_world = se3_exp(xi) * map_.keyframe(k).camera_from_world;
  }
  for (const int id : ids)
    map_.point(id).position += Eigen::Vector3d(noise(random), noise(random), noise(random));
  config_.bundle.iterations = 50;
  const BundleProblem problem = make_bundle_problem(map_, 3, config_);
  EXPECT_EQ(problem.views.size(), 4u);
  EXPECT_EQ(problem.edges.size(), 4u * kPoints);
  EXPECT_EQ(std::count_if(problem.views.begin(), problem.views.end(), [](const auto& v) { return v.fixed; }),
            1);

  const BundleSolution solution = solve_bundle(problem, kCamera, config_.bundle, 1.0);
  ASSERT_TRUE(solution.usable);
  EXPECT_GT(solution.initial_rms_px, 1.0);
  EXPECT_LT(solution.rms_px, 0.05);
  apply_bundle(solution, map_);
  for (int k = 1; k <= 3; ++k)
    EXPECT_LT((map_.keyframe(k).camera_from_world.inverse() * camera_at(0.1 * k)).translation().norm(), 2e-3)
        << k;
}

TEST_F(Wall, BundleAdjustmentDropsWrongObservations) {
  const auto ids = begin();
  for (const double x : {0.1, 0.2, 0.3}) add(x, ids);
  BundleProblem problem = make_bundle_problem(map_, 3, config_);
  problem.edges[7].pixel.x() += 40.0;
  const auto keyframe = problem.views[static_cast<std::size_t>(problem.edges[7].view)].keyframe;
  const auto point = problem.points[static_cast<std::size_t>(problem.edges[7].point)].point;
  const BundleSolution solution = solve_bundle(problem, kCamera, config_.bundle, 1.0);
  ASSERT_TRUE(solution.usable);
  EXPECT_EQ(std::count(solution.outlier.begin(), solution.outlier.end(), 1), 1);
  EXPECT_TRUE(solution.outlier[7]);
  apply_bundle(solution, map_);
  for (const Observation& o : map_.point(point).observations) EXPECT_NE(o.keyframe, keyframe);
}

TEST_F(Wall, ObservationsWithoutWeightMoveNothing) {
  const auto ids = begin();
  for (const double x : {0.1, 0.2, 0.3}) add(x, ids);
  BundleProblem problem = make_bundle_problem(map_, 3, config_);
  // Too little to be outliers, and all one way: a third of what each view but the fixed one sees.
  for (auto& edge : problem.edges)
    if (edge.point % 3 == 0 && !problem.views[static_cast<std::size_t>(edge.view)].fixed)
      edge.pixel.x() += 1.5;
  const auto worst_shift = [&](double static_weight) {
    for (auto& edge : problem.edges)
      if (edge.point % 3 == 0) edge.static_weight = static_weight;
    const BundleSolution solution = solve_bundle(problem, kCamera, config_.bundle, 1.0);
    double worst = 0.0;
    for (std::size_t i = 0; i < problem.views.size(); ++i)
      worst = std::max(
          worst, (problem.views[i].camera_from_world.inverse() * solution.problem.views[i].camera_from_world)
                     .translation()
                     .norm());
    return worst;
  };
  EXPECT_LT(worst_shift(1e-6), 1e-5);
  EXPECT_GT(worst_shift(1.0), 1e-4);
}

TEST_F(Wall, AnEmptyBundleIsNotUsable) {
  EXPECT_FALSE(solve_bundle({}, kCamera, config_.bundle, 1.0).usable);
}

TEST_F(Wall, ACopyIsACheckpoint) {
  const auto ids = begin();
  const LocalMap checkpoint = map_;
  add(0.1, ids);
  map_.remove_point(ids[0]);
  EXPECT_EQ(checkpoint.keyframes().size(), 1u);
  EXPECT_TRUE(checkpoint.has_point(ids[0]));
  EXPECT_EQ(checkpoint.keyframe(0).points[0], ids[0]);
}

}  // namespace
}  // namespace stillpoint
