#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/config.hpp"
#include "core/motion/alcantarilla2012/flow_test.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/wall_and_board.hpp"

namespace stillpoint {
namespace {

using motion_test::overlap;
using motion_test::same_bytes;
using motion_test::SceneRun;
using motion_test::WallAndBoard;

const Alcantarilla2012Config kConfig;

TEST(Alcantarilla2012, FlowFollowsAShiftBothWaysWhateverTheThreads) {
  const cv::Mat ground = motion_test::textured_image({400, 300}, 3);
  const cv::Mat last = ground(cv::Rect(40, 30, 320, 240)), here = ground(cv::Rect(45, 28, 320, 240));
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const FlowPair one = dense_flow(here, last);
  cv::setNumThreads(4);
  const FlowPair four = dense_flow(here, last);
  cv::setNumThreads(threads);
  EXPECT_TRUE(same_bytes(one.last_from_here, four.last_from_here));
  EXPECT_TRUE(same_bytes(one.here_from_last, four.here_from_last));
  // What is at (x, y) here was at (x + 5, y - 2).
  for (const cv::Point& at : {cv::Point(60, 60), cv::Point(160, 120), cv::Point(250, 190)}) {
    const cv::Vec2f back = one.last_from_here.at<cv::Vec2f>(at), forth = one.here_from_last.at<cv::Vec2f>(at);
    EXPECT_NEAR(back[0], 5.0, 0.15);
    EXPECT_NEAR(back[1], -2.0, 0.15);
    EXPECT_NEAR(forth[0], -5.0, 0.15);
    EXPECT_NEAR(forth[1], 2.0, 0.15);
  }
}

FlowImages flat_images(float depth) {
  FlowImages images;
  images.gray = cv::Mat::zeros(6, 8, CV_8UC1);
  images.depth = cv::Mat(6, 8, CV_32FC1, cv::Scalar(static_cast<double>(depth)));
  images.rays = PixelRays(Camera(), {16, 12}, kFlowFactor);
  return images;
}

FlowPair even_flow(const cv::Vec2f& back, const cv::Vec2f& forth) {
  const auto filled = [](const cv::Vec2f& v) {
    return cv::Mat(6, 8, CV_32FC2, cv::Scalar(static_cast<double>(v[0]), static_cast<double>(v[1])));
  };
  return {filled(back), filled(forth)};
}

TEST(Alcantarilla2012, JudgesPixelsWithDepthInRangeAndFlowThatLeadsBack) {
  const FlowImages images = flat_images(2.0F);
  const auto count = [&](const FlowImages& here, const FlowImages& last, const FlowPair& flow) {
    return judged_pixels(here, last, flow, kConfig).size();
  };
  const FlowPair still = even_flow({0, 0}, {0, 0});
  EXPECT_EQ(count(images, images, still), 24U);  // all but the border
  // A miss of half a small pixel is one pixel: the limit.
  EXPECT_EQ(count(images, images, even_flow({0, 0}, {0.5F, 0})), 24U);
  EXPECT_EQ(count(images, images, even_flow({0, 0}, {0.5F, 0.05F})), 0U);
  // Two to the right: two columns lie outside or at the border there.
  EXPECT_EQ(count(images, images, even_flow({2, 0}, {-2, 0})), 16U);
  EXPECT_EQ(count(flat_images(0.49F), images, still), 0U);
  EXPECT_EQ(count(images, flat_images(5.01F), still), 0U);
  EXPECT_EQ(count(flat_images(5.0F), flat_images(0.5F), still), 24U);
  const FlowPair unknown = even_flow({std::numeric_limits<float>::quiet_NaN(), 0}, {0, 0});
  EXPECT_EQ(count(images, images, unknown), 0U);

  const std::vector<JudgedPixel> pixels =
      judged_pixels(images, flat_images(3.0F), even_flow({1, 0.25F}, {-1, -0.25F}), kConfig);
  ASSERT_FALSE(pixels.empty());
  const JudgedPixel& first = pixels.front();
  EXPECT_EQ(cv::Point(first.x, first.y), cv::Point(1, 1));
  EXPECT_EQ(first.pair.z_here, 2.0F);
  EXPECT_EQ(first.pair.z_last, 3.0F);
  EXPECT_TRUE(first.pair.ray_last.isApprox(images.rays.at(2, 1.25F)));
}

TEST(Alcantarilla2012, TestsAgainstTheLimitOfChiSquared) {
  // On the optical axis at 2 m, with 2 mm of noise across for each of the two: variance 8 mm², whatever the
  // depth's.
  const SceneFlowNoise noise{0.001, 0.001, 1.425e-3, 0.0};
  const auto pixel = [](int x, float moved) {
    return JudgedPixel{x, 0, {{0, 0}, {0.5F * moved, 0}, 2.0F, 2.0F}};
  };
  Alcantarilla2012Config config;
  config.vote_px = 1;
  // Squared lengths in variances: 12.5, and 13.005 (the ray's slant adds a little to the noise).
  const FlowTest test =
      test_flow({pixel(0, 0.010F), pixel(1, 0.0102F)}, {3, 1}, CameraMotion(), noise, config);
  EXPECT_NEAR(test.chi_squared.at<float>(0, 0), 12.5, 0.02);
  EXPECT_NEAR(test.chi_squared.at<float>(0, 1), 13.005, 0.02);
  EXPECT_NEAR(test.length.at<float>(0, 0), 0.010, 1e-7);
  EXPECT_EQ(test.moving.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(test.moving.at<std::uint8_t>(0, 1), 255);
  EXPECT_TRUE(std::isnan(test.chi_squared.at<float>(0, 2)));
  EXPECT_TRUE(same_bytes(test.voted, test.moving));
}

TEST(Alcantarilla2012, OverHalfOfTheValidNeighboursDecide) {
  cv::Mat moving = cv::Mat::zeros(9, 9, CV_8UC1), valid(9, 9, CV_8UC1, cv::Scalar(255));
  moving(cv::Rect(2, 2, 5, 5)).setTo(255);
  cv::Mat voted = vote(moving, valid, 5, 0.5);
  EXPECT_EQ(voted.at<std::uint8_t>(4, 4), 255);
  EXPECT_EQ(voted.at<std::uint8_t>(4, 2), 255);  // 15 of 25
  EXPECT_EQ(voted.at<std::uint8_t>(4, 1), 0);    // 10 of 25
  EXPECT_EQ(voted.at<std::uint8_t>(2, 2), 0);    // 9 of 25
  valid(cv::Rect(0, 0, 2, 9)).setTo(0);          // only what is judged votes: 10 of 10
  voted = vote(moving, valid, 5, 0.5);
  EXPECT_EQ(voted.at<std::uint8_t>(4, 1), 255);
  EXPECT_EQ(voted.at<std::uint8_t>(2, 2), 255);  // 9 of 15
  EXPECT_EQ(vote(moving, valid, 5, 0.6).at<std::uint8_t>(2, 2), 0);
  EXPECT_EQ(cv::countNonZero(vote(cv::Mat::zeros(9, 9, CV_8UC1), cv::Mat::zeros(9, 9, CV_8UC1), 5, 0.5)), 0);
}

std::unique_ptr<MotionMethod> method(const WallAndBoard& scene, const Config& config = {}) {
  return method_named("alcantarilla2012").make(scene.camera, config);
}

TEST(Alcantarilla2012, FindsTheBoardThatMovesAndNotTheOneThatStands) {
  WallAndBoard scene;
  SceneRun run(scene, *method(scene));
  EXPECT_TRUE(run.next().mask.empty());
  const MotionResult result = run.next();
  const auto found = overlap(result.mask, scene.truth(1));
  RecordProperty("recall", std::to_string(found.recall));
  RecordProperty("precision", std::to_string(found.precision));
  EXPECT_GT(found.recall, 0.8);
  EXPECT_GT(found.precision, 0.9);
  EXPECT_NEAR(result.mask_share, percent_set(result.mask) / 100.0, 1e-12);
  EXPECT_EQ(result.rounds, 2);
  const StageLog log = run.describe(result);
  for (const char* id :
       {"flow_tracks", "flow_length", "valid", "residual_motion", "chi_squared", "vote", "mask"})
    EXPECT_TRUE(log.layer(id) != nullptr && !log.layer(id)->image.empty()) << id;
  EXPECT_EQ(log.layer("residual_motion")->unit, "m");
  EXPECT_EQ(log.layer("chi_squared")->limit, kConfig.chi_squared);
  EXPECT_EQ(log.rounds(), 2);
  EXPECT_EQ(log.reference, 0);
  // |M| of the board is its own step, 30 mm.
  const cv::Rect box = scene.board_box(1);
  const cv::Point middle = (box.tl() + box.br()) / 2;
  EXPECT_NEAR(log.layer("residual_motion")->image.at<float>(middle / 2), 0.03, 0.002);
  const auto sentences = log.explain(middle, true);
  ASSERT_EQ(sentences.size(), 2U);
  EXPECT_NE(sentences[0].find("beyond the limit of 12.84"), std::string::npos) << sentences[0];

  scene.board_step = 0.0;
  SceneRun quiet(scene, *method(scene));
  for (int i = 0; i < 3; ++i) EXPECT_LT(quiet.next().mask_share, 0.002) << i;
}

TEST(Alcantarilla2012, ASlowerStepThanItsNoiseIsNotSeen) {
  WallAndBoard scene;
  scene.board_step = 0.002;  // m; noise at 1.5 m is 2 mm across
  SceneRun run(scene, *method(scene));
  (void)run.next();
  EXPECT_LT(run.next().mask_share, 0.005);
}

TEST(Alcantarilla2012, SolvesThePoseAgainWithoutWhatMoves) {
  // A first pose that goes along with the board a little, as when its features had a say.
  const WallAndBoard scene;
  const auto judge = method(scene);
  const Frame last = scene.frame(0), here = scene.frame(1);
  const auto before = judge->prepare(last, {}, 1);
  judge->commit({last, before}, {}, {true, scene.camera_from_world(0)});
  const auto prepared = judge->prepare(here, std::vector{before->for_later()}, 1);
  const auto features = scene.features(1);
  MotionInput input{here, prepared};
  input.features = features;
  Pose wrong = scene.camera_from_world(1);
  wrong.translation().x() += 0.006;
  input.camera_from_world = wrong;
  const MotionResult result = judge->detect(input);
  const StageLog log = judge->describe(here, result);
  ASSERT_EQ(log.rounds(), 2);
  double travelled[2] = {0.0, 0.0};
  for (const Stage& stage : log.stages)
    if (stage.id == "pose") travelled[stage.round] = stage.figures[0].value;
  EXPECT_NEAR(travelled[0], 2.0, 1e-6);  // mm: 4 one way, told 6 too far the other
  EXPECT_NEAR(travelled[1], 4.0, 0.1);
  EXPECT_GT(overlap(result.mask, scene.truth(1)).precision, 0.9);
}

TEST(Alcantarilla2012, ClonesThreadsAndLookingTwiceChangeNothing) {
  const WallAndBoard scene;
  SceneRun one(scene, *method(scene));
  for (int i = 0; i < 2; ++i) (void)one.next();
  SceneRun other(one);
  const int threads = cv::getNumThreads();
  for (int i = 0; i < 2; ++i) {
    cv::setNumThreads(1);
    const MotionResult a = one.next(1);
    cv::setNumThreads(4);
    const MotionResult b = other.next(4);
    EXPECT_GT(cv::countNonZero(a.mask), 0);
    EXPECT_TRUE(same_bytes(a.mask, b.mask));
    EXPECT_EQ(a.figures, b.figures);
    EXPECT_TRUE(same_bytes(one.describe(a).layer("chi_squared")->image,
                           other.describe(b).layer("chi_squared")->image));
  }
  cv::setNumThreads(threads);
}

TEST(Alcantarilla2012, SaysWhyItDoesNotJudge) {
  const WallAndBoard scene;
  const auto judge = method(scene);
  const Frame last = scene.frame(0), here = scene.frame(1);
  const auto before = judge->prepare(last, {}, 1);
  const auto prepared = judge->prepare(here, std::vector{before->for_later()}, 1);
  MotionInput input{here, prepared};
  input.camera_from_world = scene.camera_from_world(1);
  const std::string why = "there is no frame right before, with depth and a measured pose, to compare with";
  EXPECT_EQ(judge->detect(input).note, why);
  judge->commit({last, before}, {}, {false, scene.camera_from_world(0)});  // predicted only
  EXPECT_EQ(judge->detect(input).note, why);
  EXPECT_EQ(judge->describe(here, judge->detect(input)).note, why);
  EXPECT_TRUE(judge->detect(input).mask.empty());
  judge->commit({last, before}, {}, {true, scene.camera_from_world(0)});
  EXPECT_EQ(judge->detect(input).note, "");
  EXPECT_GT(cv::countNonZero(judge->detect(input).mask), 0);
}

TEST(Alcantarilla2012, DoubtsThePoseWhereItsOwnFeaturesMove) {
  // The last pose is 8 cm off, so that wall and board move; the features agree with this frame's pose all the
  // same.
  WallAndBoard scene;
  const auto judged = [&](double off) {
    const auto judge = method(scene);
    const Frame last = scene.frame(0), here = scene.frame(1);
    const auto before = judge->prepare(last, {}, 1);
    Pose pose = scene.camera_from_world(0);
    pose.translation().z() += off;
    judge->commit({last, before}, {}, {true, pose});
    const auto prepared = judge->prepare(here, std::vector{before->for_later()}, 1);
    const auto features = scene.features(1);
    MotionInput input{here, prepared};
    input.features = features;
    input.camera_from_world = scene.camera_from_world(1);
    const MotionResult result = judge->detect(input);
    EXPECT_GT(cv::countNonZero(judge->describe(here, result).layer("vote")->image),
              0);  // what it saw is shown
    return result;
  };
  const MotionResult wrong = judged(0.08);
  EXPECT_EQ(cv::countNonZero(wrong.mask), 0);
  EXPECT_EQ(wrong.mask_share, 0.0);
  EXPECT_NE(wrong.note.find("% of the features that agree with the pose move"), std::string::npos)
      << wrong.note;
  // A board that hides much of the wall is no reason for doubt: the features on the wall agree and stand.
  scene.board_px = {400, 300};
  cv::resize(scene.board, scene.board, scene.board_px, 0, 0, cv::INTER_CUBIC);
  const MotionResult right = judged(0.0);
  EXPECT_EQ(right.note, "");
  EXPECT_GT(overlap(right.mask, scene.truth(1)).recall, 0.7);
}

TEST(Alcantarilla2012, FramesTooSmallForFlowAndOfAnotherSizeAreNotJudged) {
  const WallAndBoard scene;
  const auto judge = method(scene);
  const auto sized = [&](int index, const cv::Size& size) {
    Frame frame = scene.frame(index);
    cv::resize(frame.gray, frame.gray, size);
    cv::resize(frame.depth, frame.depth, size, 0, 0, cv::INTER_NEAREST);
    return frame;
  };
  std::vector<std::shared_ptr<const MotionPreparation>> past;
  int index = 0;
  for (const cv::Size& size : {cv::Size(16, 12), cv::Size(16, 12), cv::Size(320, 240), cv::Size(320, 240)}) {
    const Frame frame = sized(index, size);
    const auto prepared = judge->prepare(frame, past, 1);
    MotionInput input{frame, prepared};
    input.camera_from_world = scene.camera_from_world(index);
    const MotionResult result = judge->detect(input);
    EXPECT_EQ(result.mask.empty(), index < 3) << index;
    judge->commit(input, result, {true, scene.camera_from_world(index++)});
    past = {prepared->for_later()};
  }
}

TEST(Alcantarilla2012, ThePresetHoldsTheDefaultsAndSaysWhatIsUnknown) {
  const Config config = load_config("alcantarilla2012");
  EXPECT_EQ(config.run.method, "alcantarilla2012");
  EXPECT_EQ(config.of<Alcantarilla2012Config>(), Alcantarilla2012Config());
  const MethodInfo& info = method_named("alcantarilla2012");
  EXPECT_TRUE(info.needs.depth && info.needs.matches && info.needs.first_pose);
  EXPECT_EQ(info.without_depth, "epipolar");
  EXPECT_NE(info.citation.find("ICRA 2012"), std::string::npos);
}

TEST(Alcantarilla2012, ARunGivesTheSameBytesWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 6);
  Config config;
  config.run.method = "alcantarilla2012";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  EXPECT_GT(one.records.back().mask_share, 0.01);
  ASSERT_EQ(one.records.back().motion_figures.size(), 2U);
  EXPECT_EQ(one.records.back().motion_figures[0].name, "alcantarilla2012_valid");
  FrameScores scores;
  for (const FrameScores& score : one.scores) scores += score;
  EXPECT_GT(scores.mask.precision(), 0.7);
}

}  // namespace
}  // namespace stillpoint
