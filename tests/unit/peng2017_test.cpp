#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/config.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/peng2017/held_edges.hpp"
#include "core/motion/peng2017/peng2017_config.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/wall_and_board.hpp"

namespace stillpoint {
namespace {

using motion_test::SceneRun;
using motion_test::WallAndBoard;

const Peng2017Config kConfig;

TEST(Peng2017, StrainIsTheChangeByTheDeviationOfBothFrames) {
  const SceneFlowNoise noise{0.001, 0.001, 1.425e-3, 0.0};
  std::vector<GraphPoint> last(2);
  last[0].z = last[1].z = 2.0F;
  last[1].ray = {0.1F, 0.0F};
  std::vector<GraphPoint> here = last;
  here[1].ray = {0.11F, 0.0F};
  // 0.2 m became 0.22 m; variances 8e-6 + 3.249e-5 x², x = 0.1 and 0.11.
  const double wanted = 0.02 / std::sqrt(16e-6 + 3.249e-5 * (0.01 + 0.0121));
  const std::vector<PointPair> edge{{0, 1}};
  EXPECT_NEAR(edge_strains(edge, here, last, noise).at(0), wanted, 1e-4);
  EXPECT_NEAR(edge_strains(edge, last, here, noise).at(0), -wanted, 1e-4);
  EXPECT_EQ(edge_strains(edge, last, last, noise).at(0), 0.0);
}

TEST(Peng2017, APointIsStaticWhenMostOfItsEdgesHold) {
  // Point 0 has three edges, two of which hold; 1 has two, one of which holds; 4 has none.
  const std::vector<PointPair> edges{{0, 1}, {0, 2}, {0, 3}, {1, 2}};
  const std::vector<double> strains{3.0, -2.9, 3.1, -3.1};
  const std::vector<float> shares = held_shares(5, edges, strains, 3.0);
  EXPECT_FLOAT_EQ(shares[0], 2.0F / 3.0F);
  EXPECT_FLOAT_EQ(shares[1], 0.5F);
  EXPECT_FLOAT_EQ(shares[2], 0.5F);
  EXPECT_FLOAT_EQ(shares[3], 0.0F);
  EXPECT_TRUE(std::isnan(shares[4]));
  using enum PointVerdict;
  EXPECT_EQ(verdicts_by_shares(shares, 0.5),
            (std::vector<PointVerdict>{kStatic, kDynamic, kDynamic, kDynamic, kUnjudged}));
}

std::unique_ptr<MotionMethod> method(const WallAndBoard& scene, const Config& config = {}) {
  return method_named("peng2017").make(scene.camera, config);
}

/// Less noise than a Kinect's, as the scene has none: a board that goes 6 cm a frame strains the edges across
/// its outline.
Config exact() {
  Config config;
  config.of<Peng2017Config>().depth_sigma_per_m2 = 2e-4;
  config.of<Peng2017Config>().pixel_sigma_px = 0.25;
  return config;
}

TEST(Peng2017, DropsWhatDeformsAndLetsPassWhatIsRigidInside) {
  WallAndBoard scene;
  scene.board_step = 0.06;
  SceneRun run(scene, *method(scene, exact()));
  EXPECT_TRUE(run.next().weight_of_feature.empty());
  const MotionResult result = run.next();
  const auto features = scene.features(1);
  ASSERT_EQ(result.weight_of_feature.size(), features.size());
  const cv::Rect box = scene.board_box(1);
  const cv::Rect inside(box.x + 40, box.y + 40, box.width - 80, box.height - 80),
      around(box.x - 60, box.y - 60, box.width + 120, box.height + 120);
  int far_out = 0, inside_out = 0, out = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (result.weight_of_feature[i] > 0.0F) continue;
    const cv::Point at(features[i].pixel);
    ++out;
    far_out += around.contains(at) ? 0 : 1;
    inside_out += inside.contains(at) ? 1 : 0;
  }
  EXPECT_GT(out, 3);
  EXPECT_EQ(far_out, 0);
  EXPECT_EQ(inside_out, 0);  // rigid: this is where the method fails
  const StageLog log = run.describe(result);
  for (const char* id : {"flow_tracks", "strain", "held_shares", "points", "classes"})
    EXPECT_TRUE(log.layer(id) != nullptr && !log.layer(id)->image.empty()) << id;
  EXPECT_GT(percent_above(log.layer("strain")->image, kConfig.cut_sigmas), 0.0);
  EXPECT_EQ(log.layer("classes")->marks.size(), features.size());
  EXPECT_EQ(log.explain(features[200].pixel, false).size(), 2U);
  EXPECT_EQ(log.explain({1, 1}, false).size(), 1U);
}

TEST(Peng2017, KeepsEverythingWhereNothingMoves) {
  WallAndBoard scene;
  scene.board_step = 0.0;
  SceneRun run(scene, *method(scene));
  (void)run.next();
  const MotionResult result = run.next();
  const auto out = std::count(result.weight_of_feature.begin(), result.weight_of_feature.end(), 0.0F);
  EXPECT_LE(out, static_cast<std::ptrdiff_t>(result.weight_of_feature.size() / 50));
  EXPECT_GT(result.figures.at(1), 500.0);
}

TEST(Peng2017, ThreadsChangeNothingAndThereIsNoMemory) {
  WallAndBoard scene;
  scene.board_step = 0.06;
  SceneRun one(scene, *method(scene, exact()));
  for (int i = 0; i < 3; ++i) (void)one.next();
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const MotionResult a = one.next(1);
  // The same two frames by a method that saw none before.
  cv::setNumThreads(4);
  const auto fresh = method(scene, exact());
  const Frame last = scene.frame(2), here = scene.frame(3);
  const std::vector<std::shared_ptr<const MotionPreparation>> past{fresh->prepare(last, {}, 4)};
  const auto features = scene.features(3);
  MotionInput input{here, fresh->prepare(here, past, 4)};
  input.camera_from_world = scene.camera_from_world(3);
  input.features = features;
  const MotionResult b = fresh->detect(input);
  cv::setNumThreads(threads);
  EXPECT_EQ(a.weight_of_feature, b.weight_of_feature);
  EXPECT_EQ(a.figures, b.figures);
  EXPECT_GT(a.figures.at(2), 5.0);
}

TEST(Peng2017, SaysWhyItDoesNotJudge) {
  const WallAndBoard scene;
  const auto judge = method(scene);
  const Frame last = scene.frame(0), here = scene.frame(2);
  const std::vector<std::shared_ptr<const MotionPreparation>> past{judge->prepare(last, {}, 1)};
  MotionInput input{here, judge->prepare(here, past, 1)};
  input.camera_from_world = scene.camera_from_world(2);
  EXPECT_EQ(judge->detect(input).note, "there is no frame right before, with depth, to compare with");
  const Frame next = scene.frame(1);
  MotionInput empty{next, judge->prepare(next, past, 1)};
  empty.camera_from_world = scene.camera_from_world(1);
  EXPECT_EQ(judge->detect(empty).note, "no two features could be followed with depth: nothing is judged");
}

TEST(Peng2017, ThePresetHoldsTheDefaults) {
  const Config config = load_config("peng2017");
  EXPECT_EQ(config.run.method, "peng2017");
  EXPECT_EQ(config.of<Peng2017Config>(), Peng2017Config());
  EXPECT_TRUE(method_named("peng2017").judges_features);
}

TEST(Peng2017, ARunScoresFeaturesAndNoMaskWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 8);
  Config config;
  config.run.method = "peng2017";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  FrameScores scores;
  for (const FrameScores& score : one.scores) scores += score;
  EXPECT_FALSE(scores.mask.iou().has_value());
  EXPECT_GT(scores.removal.removed_rightly, 20);
}

}  // namespace
}  // namespace stillpoint
