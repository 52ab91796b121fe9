#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/config.hpp"
#include "core/motion/dai2020/edge_memory.hpp"
#include "core/motion/dai2020/graph_layers.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/wall_and_board.hpp"

namespace stillpoint {
namespace {

using motion_test::SceneRun;
using motion_test::WallAndBoard;

const Dai2020Config kConfig;

GraphPoint point(float x, float y, float z = 2.0F) {
  GraphPoint made;
  made.pixel = {x, y};
  made.ray = {(x - 320.0F) / 500.0F, (y - 240.0F) / 500.0F};
  made.z = z;
  return made;
}

// ---- The graph ----

TEST(PointGraph, AnEdgesVarianceIsThatAlongIt) {
  const SceneFlowNoise noise{0.001, 0.001, 1.425e-3, 0.0};
  GraphPoint a, b;
  a.z = b.z = 2.0F;
  b.ray = {0.1F, 0.0F};
  // Sideways: (2 m · 0.001)² of each, and of the second σ_z² · 0.1², σ_z = 1.425e-3 · 2² = 5.7 mm.
  EXPECT_NEAR(edge_length(a, b, noise).length, 0.2, 1e-6);
  EXPECT_NEAR(edge_length(a, b, noise).variance, 4e-6 + 4e-6 + 3.249e-5 * 0.01, 1e-10);
  // Straight ahead only depth counts: 5.7 mm and 1.425 mm.
  b.ray = {0.0F, 0.0F}, b.z = 1.0F;
  EXPECT_NEAR(edge_length(a, b, noise).length, 1.0, 1e-6);
  EXPECT_NEAR(edge_length(a, b, noise).variance, 3.249e-5 + 2.0306e-6, 1e-9);
  // Of no length: the mean of all directions.
  EXPECT_NEAR(edge_length(a, a, noise).variance, (4.0 * 4e-6 + 2.0 * 3.249e-5) / 3.0, 1e-9);
}

TEST(PointGraph, TriangulatesEachMeasuredPlaceOnce) {
  const EdgeRule all{100.0, 100.0, 1000.0};
  // A square and its middle; then the middle once more, a point without depth, and one outside.
  std::vector<GraphPoint> points{point(100, 100), point(200, 100), point(200, 200), point(100, 200),
                                 point(150, 150)};
  const std::vector<PointPair> wanted{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};
  EXPECT_EQ(delaunay_edges(points, {640, 480}, all), wanted);
  points.push_back(point(150, 150));
  points.push_back(point(120, 150, 0.0F));
  points.push_back(point(-5, 150));
  points.push_back(point(640, 150));
  EXPECT_EQ(delaunay_edges(points, {640, 480}, all), wanted);
  EXPECT_TRUE(delaunay_edges({}, {640, 480}, all).empty());
}

TEST(PointGraph, LeavesOutLongEdgesButNotShortOnesAcrossAnOutline) {
  const EdgeRule rule;  // 1 m, 0.3 m, 60 px
  const auto edges = [&](float apart_px, float z_a, float z_b) {
    return delaunay_edges(std::vector{point(300, 240, z_a), point(300 + apart_px, 240, z_b)}, {640, 480},
                          rule)
        .size();
  };
  EXPECT_EQ(edges(200, 2, 2), 1U);     // 0.8 m
  EXPECT_EQ(edges(300, 2, 2), 0U);     // 1.2 m
  EXPECT_EQ(edges(61, 2, 2.31F), 0U);  // a step of 0.31 m
  EXPECT_EQ(edges(61, 2, 2.29F), 1U);  // of 0.29 m
  EXPECT_EQ(edges(59, 2, 2.31F), 1U);  // short in the image: whatever
  EXPECT_EQ(edges(59, 2, 4), 1U);
}

TEST(PointGraph, GroupsByCountOrHull) {
  // Four points in a small square, three in a large triangle, one alone, one of which nothing is known.
  const std::vector<GraphPoint> points{point(10, 10),   point(20, 10),   point(20, 20),
                                       point(10, 20),   point(100, 100), point(300, 100),
                                       point(100, 300), point(50, 50),   point(60, 60)};
  const std::vector<PointPair> edges{{2, 3}, {0, 1}, {1, 2}, {5, 6}, {4, 6}};
  const std::vector<std::uint8_t> known{1, 1, 1, 1, 1, 1, 1, 1, 0};
  const PointGroups groups = group_points(points, edges, known);
  ASSERT_EQ(groups.groups.size(), 3U);
  EXPECT_EQ(groups.of_point, (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 2, -1}));
  EXPECT_EQ(groups.groups[1].points, (std::vector<int>{4, 5, 6}));
  EXPECT_NEAR(groups.groups[0].hull_area_px2, 100.0, 1e-6);
  EXPECT_NEAR(groups.groups[1].hull_area_px2, 20000.0, 1e-6);
  EXPECT_EQ(groups.groups[2].hull_area_px2, 0.0);
  EXPECT_EQ(groups.largest(false), 0);
  EXPECT_EQ(groups.largest(true), 1);
  EXPECT_EQ(PointGroups().largest(false), -1);
}

TEST(PointGraph, FeaturesTakeAfterThePointNearThemAtTheirDepth) {
  std::vector<MotionFeature> features(5);
  features[0].pixel = {105, 100}, features[0].depth = 2.2F;
  features[1].pixel = {105, 100},
  features[1].depth = 2.9F;        // nearer to the first, at the depth of the second
  features[2].pixel = {105, 100};  // without depth: the nearest
  features[3].pixel = {100, 113}, features[3].depth = 2.0F;  // too far
  features[4].pixel = {91, 100}, features[4].depth = 2.0F;   // nearest to what is not judged
  const std::vector<GraphPoint> points{point(103, 100, 2.0F), point(110, 100, 3.0F), point(91, 100, 2.0F)};
  const std::vector<PointVerdict> verdicts{PointVerdict::kStatic, PointVerdict::kDynamic,
                                           PointVerdict::kUnjudged};
  EXPECT_EQ(nearest_points(features, points, verdicts, 12.0, 0.3), (std::vector<int>{0, 1, 0, -1, 0}));
}

TEST(PointGraph, SpacedFeaturesKeepOffEachOtherAndOffWhatIsThere) {
  std::vector<MotionFeature> features(5);
  features[0].pixel = {100, 100};
  features[1].pixel = {107, 100};  // 7 px off the first
  features[2].pixel = {108, 100};  // 8 px
  features[3].pixel = {100, 93};   // 7 px above
  features[4].pixel = {300, 300};  // on one that is taken
  const std::vector<cv::Point2f> taken{{303, 303}};
  EXPECT_EQ(spaced_features(features, taken, 8.0), (std::vector<int>{0, 2}));
  EXPECT_EQ(spaced_features(features, {}, 8.0), (std::vector<int>{0, 2, 4}));
}

// ---- Cutting and mending ----

TEST(Dai2020, AnEdgeIsCutWhenStrainedTwiceInFive) {
  EdgeMemory edge;
  const double variance = 1e-4;  // 1 cm
  edge.measure({1.0, variance}, 1, kConfig);
  EXPECT_TRUE(std::isnan(edge.strain));
  edge.measure({1.0, variance}, 2, kConfig);
  EXPECT_DOUBLE_EQ(edge.strain, 0.0);
  // Against the mean of two: σ² = 1e-4 + 1e-4 / 2.
  edge.measure({1.05, variance}, 3, kConfig);
  EXPECT_NEAR(edge.strain, 0.05 / std::sqrt(1.5e-4), 1e-9);  // 4.08
  EXPECT_FALSE(edge.cut);
  EXPECT_NEAR(edge.mean(), 3.05 / 3.0, 1e-12);
  edge.measure({1.05, variance}, 4, kConfig);  // 2.89: not strained
  EXPECT_NEAR(edge.strain, (1.05 - 3.05 / 3.0) / std::sqrt(1e-4 * 4.0 / 3.0), 1e-9);
  EXPECT_FALSE(edge.cut);
  edge.measure({1.08, variance}, 5, kConfig);  // 0.055 / √1.25e-4 = 4.92: the second in five
  EXPECT_TRUE(edge.cut);
  EXPECT_EQ(edge.cut_at, 5);
  // Nine calm frames do not mend it, a tenth does.
  for (int i = 0; i < 9; ++i) edge.measure({edge.mean(), variance}, 6 + i, kConfig);
  EXPECT_TRUE(edge.cut);
  EXPECT_EQ(edge.cut_at, 5);
  EdgeMemory unrest = edge;
  edge.measure({edge.mean(), variance}, 15, kConfig);
  EXPECT_FALSE(edge.cut);
  EXPECT_EQ(edge.cut_at, -1);
  // A frame that is not calm, though not strained, begins the count again.
  unrest.measure({unrest.mean() + 0.025, variance}, 15, kConfig);
  EXPECT_LT(unrest.strain, kConfig.cut_sigmas);
  for (int i = 0; i < 9; ++i) unrest.measure({unrest.mean(), variance}, 16 + i, kConfig);
  EXPECT_TRUE(unrest.cut);
}

TEST(Dai2020, StrainOlderThanTheWindowIsForgotten) {
  const auto cut_after = [](int calm_between) {
    EdgeMemory edge;
    for (int i = 0; i < 20; ++i) edge.measure({1.0, 1e-4}, i, kConfig);
    edge.measure({1.05, 1e-4}, 20, kConfig);
    for (int i = 0; i < calm_between; ++i) edge.measure({1.0, 1e-4}, 21 + i, kConfig);
    edge.measure({1.05, 1e-4}, 40, kConfig);
    return edge.cut;
  };
  EXPECT_TRUE(cut_after(3));   // first and last of five
  EXPECT_FALSE(cut_after(4));  // of six
}

/// Points in a row, an edge from each to the next that was measured so often.
TrackedGraph row(int points, int life) {
  TrackedGraph graph;
  for (int i = 0; i < points; ++i) {
    graph.seen.push_back(point(100.0F + 20.0F * static_cast<float>(i), 200));
    graph.points.push_back({graph.next_id++, -1, PointVerdict::kUnjudged});
    if (i == 0) continue;
    TrackedEdge edge;
    edge.points = {i - 1, i};
    edge.memory.life = life;
    graph.edges.push_back(edge);
  }
  return graph;
}

TEST(Dai2020, TheLargestGroupIsStaticAndSmallOnesUndecided) {
  TrackedGraph graph = row(18, kConfig.settle_frames);
  graph.edges[6].memory.cut = true;                         // 7 points before
  graph.edges[14].memory.cut = true;                        // 8 between, 3 behind
  graph.edges[16].memory.life = kConfig.settle_frames - 1;  // of those the last hangs on nothing settled
  const PointGroups groups = judge_points(graph, kConfig);
  EXPECT_EQ(groups.largest(false), 1);
  for (int i = 0; i < 18; ++i)
    EXPECT_EQ(graph.points[static_cast<std::size_t>(i)].verdict, i < 7    ? PointVerdict::kDynamic
                                                                 : i < 15 ? PointVerdict::kStatic
                                                                 : i < 17 ? PointVerdict::kUndecided
                                                                          : PointVerdict::kUnjudged)
        << i;
}

TEST(Dai2020, OfTwoGroupsTheLargerByPointsOrByHullIsStatic) {
  // Eight points in a row, then six that reach down.
  TrackedGraph graph = row(14, kConfig.settle_frames);
  graph.edges[7].memory.cut = true;
  graph.seen[13].pixel.y = 400;
  graph.seen[4].pixel.y = 210;
  (void)judge_points(graph, kConfig);
  EXPECT_EQ(graph.points[0].verdict, PointVerdict::kStatic);
  EXPECT_EQ(graph.points[13].verdict, PointVerdict::kDynamic);
  Dai2020Config by_hull;
  by_hull.group_by = "hull_area";
  (void)judge_points(graph, by_hull);
  EXPECT_EQ(graph.points[0].verdict, PointVerdict::kDynamic);
  EXPECT_EQ(graph.points[13].verdict, PointVerdict::kStatic);
}

TEST(Dai2020, LosesPointsWithTheirEdges) {
  TrackedGraph graph = row(4, 7);
  const TrackedGraph left = without_lost(graph, std::vector<std::uint8_t>{1, 0, 1, 1});
  ASSERT_EQ(left.points.size(), 3U);
  EXPECT_EQ(left.points[1].id, 2);
  ASSERT_EQ(left.edges.size(), 1U);
  EXPECT_EQ(left.edges[0].points, (PointPair{1, 2}));
  EXPECT_EQ(left.edges[0].memory.life, 7);
}

TEST(Dai2020, AKeyframeAddsPointsAndEdgesAndKeepsThoseThatAre) {
  Frame frame;
  frame.index = 9;
  frame.gray = motion_test::textured_image({640, 480}, 3);
  frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(2.0));
  const GraphFrame here = make_graph_frame(frame, PixelRays(Camera(), {640, 480}, 1), kConfig.follow());
  TrackedGraph graph;
  for (const auto& at : {cv::Point2f(200, 200), cv::Point2f(240, 200), cv::Point2f(200, 240)}) {
    graph.seen.push_back(point_at(at, here));
    graph.points.push_back({graph.next_id++, 0, PointVerdict::kStatic});
  }
  // A point in between parts these two in the triangulation, and not in the graph.
  TrackedEdge known;
  known.points = {1, 2};
  known.memory.life = 11;
  known.memory.cut = true;
  graph.edges.push_back(known);
  std::vector<MotionFeature> features(3);
  features[0].pixel = {241, 201};  // on a point that is there
  features[1].pixel = {220, 220};
  features[2].pixel = {400, 400};
  frame.depth(cv::Rect(390, 390, 20, 20)).setTo(0.0);  // shared with `here`: no depth there
  EXPECT_EQ(extend_graph(graph, features, here, kConfig), 1);
  ASSERT_EQ(graph.points.size(), 4U);
  EXPECT_EQ(graph.points[3].id, 3);
  std::vector<PointPair> pairs;
  for (const TrackedEdge& edge : graph.edges) {
    pairs.push_back(edge.points);
    EXPECT_EQ(edge.memory.life, edge.points == known.points ? 11 : 0);
    EXPECT_EQ(edge.memory.cut, edge.points == known.points);
  }
  EXPECT_THAT(pairs,
              testing::IsSupersetOf(std::vector<PointPair>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  const std::size_t edges = graph.edges.size();
  EXPECT_EQ(extend_graph(graph, features, here, kConfig), 0);
  EXPECT_EQ(graph.edges.size(), edges);
}

// ---- The method as a whole ----

std::unique_ptr<MotionMethod> method(const WallAndBoard& scene, const Config& config = {}) {
  return method_named("dai2020").make(scene.camera, config);
}

struct Shares {
  double on_board = 0.0, on_wall = 0.0;  // of the features there, dropped
};

Shares dropped(const WallAndBoard& scene, int index, const MotionResult& result) {
  const auto features = scene.features(index);
  const cv::Rect box = scene.board_box(index);
  double board = 0, board_out = 0, wall = 0, wall_out = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const bool out = result.weight_of_feature.at(i) == 0.0F;
    if (box.contains(cv::Point(features[i].pixel)))
      ++board, board_out += out ? 1 : 0;
    else
      ++wall, wall_out += out ? 1 : 0;
  }
  return {board_out / board, wall_out / wall};
}

TEST(Dai2020, TheBoardComesOffTheWallAndIsDropped) {
  const WallAndBoard scene;
  SceneRun run(scene, *method(scene));
  (void)run.next();
  EXPECT_EQ(run.next().note, "the graph begins with this frame: nothing is judged");
  EXPECT_EQ(run.next().note, "no edge has settled yet: nothing is judged");
  MotionResult result;
  for (int i = 3; i < 16; ++i) result = run.next();
  EXPECT_TRUE(result.mask.empty());
  const Shares shares = dropped(scene, 15, result);
  RecordProperty("board", std::to_string(shares.on_board));
  RecordProperty("wall", std::to_string(shares.on_wall));
  EXPECT_GT(shares.on_board, 0.6);
  EXPECT_LT(shares.on_wall, 0.05);
  const StageLog log = run.describe(result);
  for (const char* id : {"flow_tracks", "strain", "cut_times", "groups", "points", "classes", "new_edges"})
    EXPECT_TRUE(log.layer(id) != nullptr && !log.layer(id)->image.empty()) << id;
  EXPECT_EQ(log.layer("classes")->marks.size(), result.weight_of_feature.size());
  EXPECT_GT(percent_above(log.layer("strain")->image, kConfig.cut_sigmas), 0.01);
  EXPECT_EQ(log.layer("strain")->limit, kConfig.cut_sigmas);
  const cv::Rect box = scene.board_box(15);
  int told = 0;
  for (const MotionFeature& feature : scene.features(15)) {
    const cv::Point at(feature.pixel);
    if (!cv::Rect(box.x + 50, box.y + 50, box.width - 100, box.height - 100).contains(at)) continue;
    const auto sentences = log.explain(feature.pixel, true);
    told += sentences.back().find("dynamic, and dropped") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(told, 3);
  EXPECT_EQ(log.explain({1, 1}, false).size(), 1U);
}

TEST(Dai2020, ClonesThreadsAndLookingTwiceChangeNothing) {
  const WallAndBoard scene;
  SceneRun one(scene, *method(scene));
  for (int i = 0; i < 12; ++i) (void)one.next();
  SceneRun other(one);
  const int threads = cv::getNumThreads();
  for (int i = 0; i < 3; ++i) {
    cv::setNumThreads(1);
    const MotionResult a = one.next(1);
    cv::setNumThreads(4);
    const MotionResult b = other.next(4);
    EXPECT_EQ(a.weight_of_feature, b.weight_of_feature);
    EXPECT_EQ(a.figures, b.figures);
    EXPECT_GT(a.figures[2], 5.0);
    EXPECT_TRUE(motion_test::same_bytes(one.describe(a).layer("strain")->image,
                                        other.describe(b).layer("strain")->image));
  }
  cv::setNumThreads(threads);
}

TEST(Dai2020, ThePresetHoldsTheDefaults) {
  const Config config = load_config("dai2020");
  EXPECT_EQ(config.run.method, "dai2020");
  EXPECT_EQ(config.of<Dai2020Config>(), Dai2020Config());
  EXPECT_TRUE(method_named("dai2020").judges_features);
}

TEST(Dai2020, ARunScoresFeaturesAndNoMaskWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 20);
  Config config;
  config.run.method = "dai2020";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  FrameScores scores;
  for (const FrameScores& score : one.scores) scores += score;
  EXPECT_FALSE(scores.mask.iou().has_value());
  EXPECT_GT(scores.removal.removed_rightly, 50);
  EXPECT_GT(scores.removal.precision(), 0.5);
}

}  // namespace
}  // namespace stillpoint
