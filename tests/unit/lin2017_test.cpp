#include <gtest/gtest.h>

#include <cmath>

#include "core/config.hpp"
#include "core/motion/lin2017/feature_flow.hpp"
#include "core/motion/lin2017/lin2017_stages.hpp"
#include "core/motion/lin2017/virtual_points.hpp"
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

const Lin2017Config kConfig;

// ---- Directions ----

TEST(Lin2017, DirectionsAreSortedBy45Degrees) {
  const auto bin = [](float x, float y, float z) { return direction_bin({x, y, z}, 8, 4); };
  // Elevations from straight down: -90 to -45 is 0, -45 to 0 is 1, 0 to 45 is 2, 45 to 90 is 3. Azimuths from
  // straight ahead to the right. The camera's y points down.
  EXPECT_EQ(bin(0.1F, -0.1F, 1), 2 * 8 + 0);   // ahead, a little right and up
  EXPECT_EQ(bin(0.1F, 0.1F, 1), 1 * 8 + 0);    // and down
  EXPECT_EQ(bin(1, -0.1F, 0.9F), 2 * 8 + 1);   // beyond 45 degrees to the right
  EXPECT_EQ(bin(1, -0.1F, -0.1F), 2 * 8 + 2);  // beyond 90
  EXPECT_EQ(bin(0.1F, -0.1F, -1), 2 * 8 + 3);  // to the camera, right of it
  EXPECT_EQ(bin(-0.1F, -0.1F, -1), 2 * 8 + 4);
  EXPECT_EQ(bin(-1, -0.1F, 0.1F), 2 * 8 + 6);
  EXPECT_EQ(bin(-0.1F, -0.1F, 1), 2 * 8 + 7);
  EXPECT_EQ(bin(0.1F, -2, 0.2F), 3 * 8 + 0);  // up
  EXPECT_EQ(bin(0.1F, 2, 0.2F), 0 * 8 + 0);   // down
  EXPECT_EQ(bin(0, -1, 0), 3 * 8 + 0);        // straight up is in the last one
  EXPECT_EQ(bin(0, 0, 0), -1);
  EXPECT_EQ(direction_bin({1, 0, 1}, 1, 1), 0);
}

/// A feature on the optical axis at 2 m that moved sideways.
FeatureFlow moved(float sideways) {
  FeatureFlow flow;
  flow.measured = true;
  flow.pair = {{0, 0}, {0.5F * sideways, 0}, 2.0F, 2.0F};
  return flow;
}

TEST(Lin2017, ShortFlowIsStatic) {
  // Noise of 2 m * 0.001 in each of two frames: σ = 2.83 mm sideways, and 3 σ = 8.5 mm; 2 cm is the limit
  // then.
  const SceneFlowNoise noise{0.001, 0.001, 1.425e-3, 0.0};
  std::vector<FeatureFlow> flows{moved(0.0199F), moved(0.0201F), FeatureFlow()};
  measure_flow(flows, CameraMotion(), noise, kConfig);
  EXPECT_NEAR(flows[0].sigma, 0.002 * std::sqrt(2.0), 2e-5);
  EXPECT_NEAR(flows[0].flow.x(), 0.0199, 1e-6);
  EXPECT_EQ(flows[0].kind, FeatureClass::kStatic);
  EXPECT_EQ(flows[0].bin, -1);
  EXPECT_EQ(flows[1].kind, FeatureClass::kStray);
  EXPECT_EQ(flows[1].bin, 2 * 8 + 2);  // to the right, level
  EXPECT_EQ(flows[2].kind, FeatureClass::kUnjudged);
  Lin2017Config by_noise;
  by_noise.least_flow_m = 0.0;
  std::vector<FeatureFlow> near{moved(0.0083F), moved(0.0087F)};
  measure_flow(near, CameraMotion(), noise, by_noise);
  EXPECT_EQ(near[0].kind, FeatureClass::kStatic);
  EXPECT_EQ(near[1].kind, FeatureClass::kStray);
  // Under another pose, what went along with the camera is static again.
  Pose along = Pose::Identity();
  along.translation().x() = 0.0201;
  measure_flow(flows, CameraMotion(along), noise, kConfig);
  EXPECT_EQ(flows[1].kind, FeatureClass::kStatic);
}

TEST(Lin2017, AClassWithEnoughSupportedFeaturesIsAThing) {
  std::vector<MotionFeature> features;
  std::vector<FeatureFlow> flows;
  const auto add = [&](float x, float y, int bin) {
    MotionFeature feature;
    feature.pixel = {x, y};
    features.push_back(feature);
    FeatureFlow flow;
    flow.bin = bin;
    flow.kind = bin < 0 ? FeatureClass::kStatic : FeatureClass::kStray;
    flows.push_back(flow);
  };
  for (int i = 0; i < 5; ++i)
    add(100.0F + 20.0F * static_cast<float>(i), 100, 3);  // five in a row, 20 px apart
  add(100, 300, 3);                                       // of the same class, far away
  for (int i = 0; i < 4; ++i) add(300.0F + 10.0F * static_cast<float>(i), 100, 9);  // only four
  add(120, 110, 17);  // among the first, another way
  add(140, 110, -1);  // static
  EXPECT_EQ(find_moving_things(features, flows, kConfig), std::vector<int>{3});
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(flows[i].kind, FeatureClass::kMoving) << i;
  for (std::size_t i = 5; i < 11; ++i) EXPECT_EQ(flows[i].kind, FeatureClass::kStray) << i;
  EXPECT_EQ(flows[11].kind, FeatureClass::kStatic);
  // A gap of 41 px leaves the last two of the row with one neighbour each: three are supported, and three are
  // too few.
  features[3].pixel.x = 181, features[4].pixel.x = 201;
  for (std::size_t i = 0; i < 5; ++i) flows[i].kind = FeatureClass::kStray;
  EXPECT_TRUE(find_moving_things(features, flows, kConfig).empty());
  EXPECT_EQ(flows[0].kind, FeatureClass::kStray);
}

// ---- Virtual points ----

TEST(Lin2017, VirtualPointsGoOnAsTheyWentAndAge) {
  VirtualPoint point;
  point.position = {1, 2, 3};
  point.velocity = {0.3, 0, -0.6};
  point.age = 9;
  const std::vector<VirtualPoint> later = moved_on({point}, 0.1, 10);
  ASSERT_EQ(later.size(), 1U);
  EXPECT_TRUE(later[0].position.isApprox(Eigen::Vector3d(1.03, 2, 2.94)));
  EXPECT_EQ(later[0].age, 10);
  EXPECT_TRUE(moved_on(later, 0.1, 10).empty());
  Pose turn = Pose::Identity();
  turn.linear() = so3_exp({0, 0, CV_PI / 2});
  turn.translation() = Eigen::Vector3d(0, 0, 1);
  const std::vector<VirtualPoint> there = transformed({point}, turn);
  EXPECT_TRUE(there[0].position.isApprox(Eigen::Vector3d(-2, 1, 4)));
  EXPECT_TRUE(there[0].velocity.isApprox(Eigen::Vector3d(0, 0.3, -0.6)));
}

TEST(Lin2017, HammingCountsUnlikeBits) {
  BinaryDescriptor a{}, b{};
  EXPECT_EQ(hamming(a, b), 0);
  b[0] = 0b101, b[31] = 0x80;
  EXPECT_EQ(hamming(a, b), 3);
  a.fill(0xFF), b.fill(0);
  EXPECT_EQ(hamming(a, b), 256);
}

TEST(Lin2017, MatchesTheMostAlikeNearTheProjection) {
  const Camera camera;
  VirtualPoint point;
  point.position = {0, 0, 2};  // in the image's middle
  VirtualPoint behind = point;
  behind.position.z() = -1;
  const std::vector<cv::Point2f> projected = projections({point, behind}, camera);
  EXPECT_NEAR(projected[0].x, 319.5, 1e-4);
  EXPECT_TRUE(std::isnan(projected[1].x));
  std::vector<MotionFeature> features(4);
  features[0].pixel = projected[0] + cv::Point2f(19.9F, 0);
  features[1].pixel = projected[0] + cv::Point2f(0, -20.1F);  // too far
  features[2].pixel = projected[0] + cv::Point2f(-5, 5);
  features[3].pixel = projected[0];
  const auto bits = [](int count) {
    BinaryDescriptor descriptor{};
    for (int i = 0; i < count; ++i)
      descriptor[static_cast<std::size_t>(i / 8)] |= static_cast<std::uint8_t>(1 << i % 8);
    return descriptor;
  };
  const auto match = [&](std::vector<BinaryDescriptor> descriptors) {
    return match_virtual_points({point, behind}, projected, features, descriptors, kConfig);
  };
  EXPECT_EQ(match({bits(50), bits(0), bits(51), bits(60)}), (std::vector<int>{0, -1}));
  EXPECT_EQ(match({bits(50), bits(0), bits(20), bits(21)}), (std::vector<int>{2, -1}));
  EXPECT_EQ(match({bits(51), bits(0), bits(51), bits(51)}), (std::vector<int>{-1, -1}));
}

TEST(Lin2017, DescriptorsKnowAPlaceAgainToTheImagesBorder) {
  const cv::Mat ground = motion_test::textured_image({400, 300}, 3);
  const cv::Mat one = ground(cv::Rect(0, 0, 320, 240)).clone(),
                other = ground(cv::Rect(7, 4, 320, 240)).clone();
  std::vector<MotionFeature> here(3), there(3);
  here[0].pixel = {100, 100}, here[1].pixel = {8, 5}, here[2].pixel = {250, 180};
  for (std::size_t i = 0; i < 3; ++i) there[i].pixel = here[i].pixel - cv::Point2f(7, 4);
  const auto a = upright_descriptors(one, here), b = upright_descriptors(other, there);
  ASSERT_EQ(a.size(), 3U);
  EXPECT_LE(hamming(a[0], b[0]), 10);
  EXPECT_LE(hamming(a[2], b[2]), 10);
  EXPECT_GT(hamming(a[0], b[2]), 60);
  EXPECT_NE(a[1], BinaryDescriptor{});
}

// ---- The method as a whole ----

std::unique_ptr<MotionMethod> method(const WallAndBoard& scene, const Config& config = {}) {
  return method_named("lin2017").make(scene.camera, config);
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

TEST(Lin2017, DropsTheBoardsFeaturesAndShowsWhatItSaw) {
  const WallAndBoard scene;
  SceneRun run(scene, *method(scene));
  EXPECT_TRUE(run.next().weight_of_feature.empty());
  const MotionResult result = run.next();
  EXPECT_TRUE(result.mask.empty());
  ASSERT_EQ(result.weight_of_feature.size(), scene.features(1).size());
  const Shares shares = dropped(scene, 1, result);
  RecordProperty("board", std::to_string(shares.on_board));
  RecordProperty("wall", std::to_string(shares.on_wall));
  EXPECT_GT(shares.on_board, 0.6);
  EXPECT_LT(shares.on_wall, 0.02);
  const StageLog log = run.describe(result);
  for (const char* id : {"virtual_age", "virtual_matches", "flow_tracks", "scene_flow", "directions",
                         "classes", "virtual_new"})
    EXPECT_TRUE(log.layer(id) != nullptr && !log.layer(id)->image.empty()) << id;
  EXPECT_EQ(log.layer("scene_flow")->unit, "m");
  EXPECT_EQ(log.layer("classes")->marks.size(), result.weight_of_feature.size());
  EXPECT_EQ(log.rounds(), 2);
  // s of a feature in the middle of the board is the board's own step, 30 mm to the right and level.
  const auto features = scene.features(1);
  for (const MotionFeature& feature : features) {
    const cv::Rect box = scene.board_box(1);
    const cv::Point at(feature.pixel);
    if (!cv::Rect(box.x + 40, box.y + 40, box.width - 80, box.height - 80).contains(at)) continue;
    EXPECT_NEAR(log.layer("scene_flow")->image.at<float>(at), 0.03F, 0.002F);
    const auto sentences = log.explain(feature.pixel, true);
    ASSERT_EQ(sentences.size(), 3U);
    EXPECT_NE(sentences[2].find("belongs to a thing that moves"), std::string::npos) << sentences[2];
  }
  EXPECT_EQ(log.explain({1, 1}, false).size(), 1U);
}

TEST(Lin2017, KeepsOutWhatPausesForSomeFramesAndNoLonger) {
  WallAndBoard scene;
  scene.board_until = 3;  // moves in frames 1 to 3
  Config config;
  config.of<Lin2017Config>().virtual_frames = 4;
  SceneRun run(scene, *method(scene, config));
  std::vector<double> on_board;
  (void)run.next();
  for (int i = 1; i < 10; ++i) on_board.push_back(dropped(scene, i, run.next()).on_board);
  for (int i = 3; i < 6; ++i) EXPECT_GT(on_board[static_cast<std::size_t>(i)], 0.5) << i + 1;
  EXPECT_LT(on_board[8], 0.1);
  config.of<Lin2017Config>().virtual_frames = 0;
  SceneRun forgetful(scene, *method(scene, config));
  for (int i = 0; i < 4; ++i) (void)forgetful.next();
  EXPECT_LT(dropped(scene, 4, forgetful.next()).on_board, 0.1);
}

TEST(Lin2017, VirtualPointsGoOnWhileFramesAreNotJudged) {
  const WallAndBoard scene;  // the board goes 30 mm a frame, the camera 4 mm
  const auto judge = method(scene);
  std::shared_ptr<const Lin2017Trace> before, after;
  for (int i = 0; i < 7; ++i) {
    const Frame frame = scene.frame(i);
    const auto features = scene.features(i);
    MotionInput input{frame, judge->prepare(frame, {}, 1)};
    input.camera_from_world = scene.camera_from_world(i);
    input.features = features;
    const MotionResult result = judge->detect(input);
    if (i == 4) before = std::static_pointer_cast<const Lin2017Trace>(result.trace);
    if (i == 6) after = std::static_pointer_cast<const Lin2017Trace>(result.trace);
    // Frame 4 is lost, so that frame 5 has nothing to be compared with.
    EXPECT_EQ(result.trace == nullptr, i == 0 || i == 5) << i;
    judge->commit(input, result, {i != 4, scene.camera_from_world(i)});
  }
  ASSERT_TRUE(before && after);
  const auto middle = [](const std::vector<VirtualPoint>& points) {
    double sum = 0.0;
    for (const VirtualPoint& point : points) sum += point.position.x();
    return sum / static_cast<double>(points.size());
  };
  ASSERT_GT(before->virtual_after.size(), 10U);
  ASSERT_EQ(after->virtual_before.size(), before->virtual_after.size());
  EXPECT_NEAR(middle(after->virtual_before) - middle(before->virtual_after), 2 * (0.030 - 0.004), 0.004);
}

TEST(Lin2017, ClonesThreadsAndLookingTwiceChangeNothing) {
  const WallAndBoard scene;
  SceneRun one(scene, *method(scene));
  for (int i = 0; i < 3; ++i) (void)one.next();
  SceneRun other(one);
  const int threads = cv::getNumThreads();
  for (int i = 0; i < 3; ++i) {
    cv::setNumThreads(1);
    const MotionResult a = one.next(1);
    cv::setNumThreads(4);
    const MotionResult b = other.next(4);
    EXPECT_EQ(a.weight_of_feature, b.weight_of_feature);
    EXPECT_EQ(a.figures, b.figures);
    EXPECT_GT(a.figures[4], 10.0);
    EXPECT_TRUE(motion_test::same_bytes(one.describe(a).layer("scene_flow")->image,
                                        other.describe(b).layer("scene_flow")->image));
  }
  cv::setNumThreads(threads);
}

TEST(Lin2017, SaysWhyItDoesNotJudge) {
  const WallAndBoard scene;
  const auto judge = method(scene);
  const Frame last = scene.frame(0), here = scene.frame(1);
  judge->commit({last, judge->prepare(last, {}, 1)}, {}, {false, scene.camera_from_world(0)});
  const auto prepared = judge->prepare(here, {}, 1);
  const auto features = scene.features(1);
  MotionInput input{here, prepared};
  input.camera_from_world = scene.camera_from_world(1);
  input.features = features;
  EXPECT_EQ(judge->detect(input).note,
            "there is no earlier frame with depth and a measured pose to compare with");
  EXPECT_TRUE(judge->detect(input).weight_of_feature.empty());
  judge->commit({last, judge->prepare(last, {}, 1)}, {}, {true, scene.camera_from_world(0)});
  EXPECT_EQ(judge->detect(input).note, "");
  input.features = {};
  EXPECT_EQ(judge->detect(input).note, "no feature could be followed with depth: only virtual points judge");
}

TEST(Lin2017, ThePresetHoldsTheDefaults) {
  const Config config = load_config("lin2017");
  EXPECT_EQ(config.run.method, "lin2017");
  EXPECT_EQ(config.of<Lin2017Config>(), Lin2017Config());
  EXPECT_TRUE(method_named("lin2017").judges_features);
  EXPECT_EQ(method_named("lin2017").without_depth, "epipolar");
}

TEST(Lin2017, ARunScoresFeaturesAndNoMaskWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 8);
  Config config;
  config.run.method = "lin2017";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  FrameScores scores;
  for (const FrameScores& score : one.scores) scores += score;
  EXPECT_FALSE(scores.mask.recall().has_value());
  EXPECT_FALSE(scores.mask.iou().has_value());
  EXPECT_GT(scores.removal.removed_rightly, 50);
  EXPECT_GT(scores.removal.precision(), 0.5);
}

}  // namespace
}  // namespace stillpoint
