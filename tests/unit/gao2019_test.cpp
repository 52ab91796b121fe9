#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/config.hpp"
#include "core/motion/gao2019/block_motion.hpp"
#include "core/motion/gao2019/sparse_alignment.hpp"
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

const Gao2019Config kConfig;

// ---- Blocks ----

TEST(Gao2019, ABlocksDepthIsTheMedianOfWhatIsMeasured) {
  cv::Mat depth(4, 13, CV_32FC1, cv::Scalar(0));
  depth(cv::Rect(0, 0, 4, 4)).setTo(2.0);
  depth.at<float>(0, 0) = 9.0F;        // an outlier
  depth(cv::Rect(4, 0, 4, 1)) = 1.5F;  // a quarter of the block: enough
  depth(cv::Rect(8, 0, 3, 1)) = 1.5F;  // three pixels: not enough
  const cv::Mat depths = block_depths(depth, {3, 1}, 4);
  EXPECT_EQ(depths.at<float>(0, 0), 2.0F);
  EXPECT_EQ(depths.at<float>(0, 1), 1.5F);
  EXPECT_EQ(depths.at<float>(0, 2), 0.0F);
  EXPECT_EQ(cv::countNonZero(block_depths(cv::Mat(), {3, 1}, 4)), 0);
}

TEST(Gao2019, PlacesGoByDepthAndByTheHomographyWhereThereIsNone) {
  Camera camera;
  camera.width = 32, camera.height = 24, camera.fx = camera.fy = 100.0, camera.cx = 15.5, camera.cy = 11.5;
  const PixelRays rays(camera, {32, 24}, 4);
  cv::Mat depths = cv::Mat::zeros(6, 8, CV_32FC1);
  depths.at<float>(2, 3) = 2.0F;
  depths.at<float>(2, 4) = 1.0F;
  depths.at<float>(3, 4) = 1.0F;
  const cv::Matx33d shift(1, 0, 8, 0, 1, -4, 0, 0, 1);
  const Yi2013Places homography = yi2013_places({8, 6}, shift, 4);
  // The camera was 4 cm to the left: what is here was 4 cm farther to the right in its own axes.
  Pose last_from_here = Pose::Identity();
  last_from_here.translation().x() = 0.04;
  const Yi2013Places places = places_by_depth(depths, rays, last_from_here, camera, 4, homography);
  EXPECT_NEAR(places[2 * 8 + 3].px().x(), 3.5 + 0.5, 1e-6);  // 100 px * 0.04 / 2 = 2 px, half a block
  EXPECT_NEAR(places[2 * 8 + 3].px().y(), 2.5, 1e-6);
  EXPECT_NEAR(places[2 * 8 + 4].px().x(), 4.5 + 1.0, 1e-6);  // nearer: twice the parallax
  EXPECT_NEAR(places[1 * 8 + 1].px().x(), 1.5 + 2.0,
              1e-12);  // no depth: the homography's 8 px to the right, 4 up
  EXPECT_NEAR(places[1 * 8 + 1].px().y(), 1.5 - 1.0, 1e-12);
  last_from_here.translation() = Eigen::Vector3d(0, 0, -1.0);  // behind the last camera
  EXPECT_TRUE(
      std::isnan(places_by_depth(depths, rays, last_from_here, camera, 4, homography)[3 * 8 + 4].px().x()));
}

Yi2013Model model_of(const cv::Size& size, double mean, double variance, double age) {
  const auto of = [&](double v) { return cv::Mat(size, CV_32FC1, cv::Scalar(v)); };
  return {Yi2013Gaussians{of(mean), of(variance), of(age)}, Yi2013Gaussians{of(0), of(400), of(0)}};
}

TEST(Gao2019, WarpsTheModelByAnyPlaces) {
  // A place half a block to the right mixes two blocks evenly; NaN is nowhere.
  Yi2013Model model = model_of({6, 6}, 100, 25, 8);
  model[0].mean.col(3).setTo(120);
  const Yi2013Blocks blocks = yi2013_blocks(cv::Mat(24, 24, CV_8UC1, cv::Scalar(7)), 4);
  Yi2013Places places(36, RasterPoint(std::nan(""), std::nan("")));
  places[2 * 6 + 2] = RasterPoint(3.0, 2.5);
  const Yi2013Model warped = yi2013_warped(model, places, blocks, kConfig.model());
  EXPECT_EQ(warped[0].mean.at<float>(2, 2), 110.0F);
  EXPECT_EQ(warped[0].variance.at<float>(2, 2), 125.0F);  // 25 + 10²
  EXPECT_EQ(warped[0].age.at<float>(2, 2), 8.0F);
  EXPECT_EQ(warped[0].mean.at<float>(3, 3), 7.0F);  // begins with what is seen
  EXPECT_EQ(warped[0].age.at<float>(3, 3), 0.0F);
}

TEST(Gao2019, DeviationIsThatOfTheFarthestPixelByTheVarianceBefore) {
  cv::Mat gray(4, 12, CV_8UC1, cv::Scalar(100));
  gray.at<std::uint8_t>(1, 2) = 130;  // 30 above
  gray.at<std::uint8_t>(2, 6) = 60;   // 40 below
  const Yi2013Blocks blocks = yi2013_blocks(gray, 4);
  Yi2013Model chosen = model_of({3, 1}, 0, 100, 2);
  chosen[0].age.at<float>(0, 2) = 1.0F;  // too young
  const Yi2013Model updated = model_of({3, 1}, 100, 9999, 3);
  const cv::Mat deviations = block_deviations(blocks, chosen, updated, 1.0);
  EXPECT_EQ(deviations.at<float>(0, 0), 9.0F);   // 900 / 100
  EXPECT_EQ(deviations.at<float>(0, 1), 16.0F);  // 1600 / 100
  EXPECT_TRUE(std::isnan(deviations.at<float>(0, 2)));
}

TEST(Gao2019, ExposureIsTheMedianRatioOfOldBlocks) {
  // 12 x 8 blocks: most became 1.1 times as bright, a third shows something else, and some are young, dark or
  // white.
  cv::Mat gray(32, 48, CV_8UC1, cv::Scalar(110));
  gray(cv::Rect(0, 0, 16, 32)).setTo(30);
  const Yi2013Blocks blocks = yi2013_blocks(gray, 4);
  Yi2013Model model = model_of({12, 8}, 100, 100, 5);
  EXPECT_NEAR(exposure_gain(blocks, model, 1.0), 1.1, 1e-6);
  model[0].mean.col(11).setTo(10);
  model[0].mean.col(10).setTo(240);
  EXPECT_NEAR(exposure_gain(blocks, model, 1.0), 1.1, 1e-6);
  model[0].age.colRange(0, 6).setTo(1);  // 6 x 8 are left, of which two columns count for nothing
  EXPECT_EQ(exposure_gain(blocks, model, 1.0), 1.0);
}

TEST(Gao2019, BrightensAllButWhatIsWhite) {
  Yi2013Model model = model_of({3, 1}, 100, 100, 5);
  model[0].mean.at<float>(0, 1) = 250.0F;
  model[0].mean.at<float>(0, 2) = 240.0F;
  brighten(model, 1.1);
  EXPECT_FLOAT_EQ(model[0].mean.at<float>(0, 0), 110.0F);
  EXPECT_EQ(model[0].mean.at<float>(0, 1), 250.0F);
  EXPECT_EQ(model[0].mean.at<float>(0, 2), 255.0F);
}

TEST(Gao2019, CleansByNeighbours) {
  cv::Mat moving = cv::Mat::zeros(8, 8, CV_8UC1);
  moving(cv::Rect(2, 2, 3, 3)).setTo(255);
  moving.at<std::uint8_t>(3, 3) = 0;                                    // a hole with 8 dynamic neighbours
  moving.at<std::uint8_t>(7, 7) = 255;                                  // alone
  moving.at<std::uint8_t>(0, 6) = moving.at<std::uint8_t>(1, 7) = 255;  // two that touch at a corner
  const cv::Mat cleaned = clean_blocks(moving, true, 5);
  EXPECT_EQ(cleaned.at<std::uint8_t>(3, 3), 255);
  EXPECT_EQ(cleaned.at<std::uint8_t>(7, 7), 0);
  EXPECT_EQ(cleaned.at<std::uint8_t>(0, 6), 255);
  EXPECT_EQ(cv::countNonZero(cleaned), 9 + 2);
  EXPECT_EQ(clean_blocks(moving, false, 5).at<std::uint8_t>(7, 7), 255);
  EXPECT_EQ(clean_blocks(moving, true, 9).at<std::uint8_t>(3, 3), 0);
  // Exactly five of eight fill.
  cv::Mat five = cv::Mat::zeros(5, 5, CV_8UC1);
  five(cv::Rect(1, 1, 3, 1)).setTo(255);
  five.at<std::uint8_t>(2, 1) = five.at<std::uint8_t>(2, 3) = 255;
  EXPECT_EQ(clean_blocks(five, true, 5).at<std::uint8_t>(2, 2), 255);
  EXPECT_EQ(clean_blocks(five, true, 6).at<std::uint8_t>(2, 2), 0);
}

TEST(Gao2019, TheMaskCoversBlocksAndNoStrip) {
  cv::Mat blocks = cv::Mat::zeros(2, 2, CV_8UC1);
  blocks.at<std::uint8_t>(1, 1) = 255;
  const cv::Mat mask = mask_of_blocks(blocks, 4, {10, 9});
  EXPECT_EQ(cv::countNonZero(mask), 16);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(4, 4, 4, 4))), 16);
}

// ---- The first pose ----

TEST(Gao2019, CornersHaveDepthAndOneACell) {
  const WallAndBoard scene;
  Frame frame = scene.frame(0);
  frame.depth(cv::Rect(0, 0, 320, 480)).setTo(0);
  const auto points = corner_points(frame.gray, frame.depth, scene.camera, kConfig);
  ASSERT_GT(points.size(), 100U);
  std::set<std::pair<int, int>> cells;
  for (const AlignmentPoint& point : points) {
    EXPECT_GT(point.pixel.x, 320.0F);
    EXPECT_TRUE(
        cells.insert({static_cast<int>(point.pixel.x) / 16, static_cast<int>(point.pixel.y) / 16}).second);
    const Eigen::Vector2d seen = scene.camera.project(point.point);
    EXPECT_NEAR(seen.x(), point.pixel.x, 1e-3);
    EXPECT_NEAR(point.point.z(), frame.depth.at<float>(cv::Point(point.pixel)), 1e-6);
  }
  EXPECT_TRUE(corner_points(frame.gray, cv::Mat(), scene.camera, kConfig).empty());
}

TEST(Gao2019, AlignmentFindsTheCamerasMotionPastTheBoards) {
  WallAndBoard scene;
  scene.camera_step = 0.02;  // 3.5 px of the wall
  const Frame last = scene.frame(0), here = scene.frame(1);
  const auto points = corner_points(last.gray, last.depth, scene.camera, kConfig);
  const SparseAlignment found =
      align_sparsely(alignment_pyramid(last.gray, 4), points, alignment_pyramid(here.gray, 4),
                     Pose::Identity(), scene.camera, kConfig);
  ASSERT_TRUE(found.found) << found.note;
  const Pose truth = scene.camera_from_world(1) * scene.camera_from_world(0).inverse();
  const Pose off = found.here_from_last * truth.inverse();
  // A wall without relief tells a small turn from a small step badly: what counts is where the wall lies.
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(40, 40), Eigen::Vector2d(600, 60), Eigen::Vector2d(320, 440)}) {
    const Eigen::Vector3d point = scene.camera.back_project(pixel, WallAndBoard::kWall);
    EXPECT_LT((scene.camera.project(off * point) - pixel).norm(), 0.15);
  }
  EXPECT_EQ(found.here.size(), points.size());
  EXPECT_GT(found.iterations, 4);
}

TEST(Gao2019, AlignmentTakesOffACommonOffsetAndSaysWhenThereIsTooLittle) {
  WallAndBoard scene;
  scene.board_step = 0.0;
  const Frame last = scene.frame(0);
  Frame here = scene.frame(1);
  here.gray += 12;  // exposure
  auto points = corner_points(last.gray, last.depth, scene.camera, kConfig);
  const auto align = [&] {
    return align_sparsely(alignment_pyramid(last.gray, 4), points, alignment_pyramid(here.gray, 4),
                          Pose::Identity(), scene.camera, kConfig);
  };
  const SparseAlignment brighter = align();
  ASSERT_TRUE(brighter.found);
  EXPECT_NEAR(brighter.here_from_last.translation().x(), -scene.camera_step, 0.0008);
  EXPECT_LT(brighter.sigma, 3.0);
  points.resize(29);
  const SparseAlignment few = align();
  EXPECT_FALSE(few.found);
  EXPECT_NE(few.note.find("30 are needed to align"), std::string::npos) << few.note;
  EXPECT_TRUE(few.here_from_last.isApprox(Pose::Identity()));
}

// ---- The method as a whole ----

std::unique_ptr<MotionMethod> method(const WallAndBoard& scene, const Config& config = {}) {
  return method_named("gao2019").make(scene.camera, config);
}

TEST(Gao2019, FindsTheBoardOnceItMovesAndShowsWhatItSaw) {
  WallAndBoard scene;
  scene.board_from = 8;
  SceneRun run(scene, *method(scene));
  MotionResult result;
  for (int i = 0; i < 8; ++i) {
    result = run.next();
    EXPECT_LT(result.mask_share, 0.01) << i;
  }
  for (int i = 8; i < 11; ++i) result = run.next();
  const auto found = overlap(result.mask, scene.truth(10));
  RecordProperty("recall", std::to_string(found.recall));
  RecordProperty("precision", std::to_string(found.precision));
  EXPECT_GT(found.recall, 0.35);
  EXPECT_GT(found.precision, 0.6);  // what it uncovers is new to the model, too
  EXPECT_NEAR(result.mask_share, percent_set(result.mask) / 100.0, 1e-12);

  const StageLog log = run.describe(result);
  EXPECT_EQ(log.reference, 9);
  EXPECT_EQ(log.small_factor, kConfig.block_px);
  for (const char* id : {"flow_tracks", "block_depth", "deviation", "moving_blocks", "mask"})
    EXPECT_TRUE(log.layer(id) != nullptr && !log.layer(id)->image.empty()) << id;
  for (const char* id : {"mean", "sigma", "age", "mean_1", "sigma_1", "age_1"})
    EXPECT_TRUE(log.layer(id) != nullptr && log.layer(id)->image.size() == cv::Size(160, 120)) << id;
  EXPECT_EQ(log.layer("deviation")->limit, kConfig.moving_limit);
  int poses = 0;
  for (const Stage& stage : log.stages)
    for (const StageFigure& figure : stage.figures)
      if (figure.name == "Travelled, first pose" || figure.name == "Travelled, second pose") {
        EXPECT_NEAR(figure.value, 4.0, 1.5) << figure.name;  // mm
        EXPECT_EQ(figure.unit, "mm");
        ++poses;
      }
  EXPECT_EQ(poses, 2);
  EXPECT_GE(log.explain({320, 240}, true).size(), 2U);
}

TEST(Gao2019, ParallaxIsNotMotion) {
  // The board stands before a wall that the camera passes: what a homography's model sees move on it does not
  // by depth.
  WallAndBoard scene;
  scene.board_step = 0.0;
  scene.camera_step = 0.03;  // 5 px of the wall, 10 px of the board
  SceneRun by_depth(scene, *method(scene)),
      by_homography(scene, *method_named("yi2013").make(scene.camera, Config()));
  double depth = 0.0, homography = 0.0;
  for (int i = 0; i < 8; ++i) {
    const cv::Rect box = scene.board_box(i);
    const cv::Rect inside(box.x + 20, box.y + 20, box.width - 40, box.height - 40);
    if (const cv::Mat mask = by_depth.next().mask; !mask.empty()) depth += cv::countNonZero(mask(inside));
    if (const cv::Mat mask = by_homography.next().mask; !mask.empty())
      homography += cv::countNonZero(mask(inside));
  }
  RecordProperty("by depth, px", std::to_string(depth));
  RecordProperty("by homography, px", std::to_string(homography));
  EXPECT_GT(homography, 2000.0);
  EXPECT_LT(depth, 0.1 * homography);
}

TEST(Gao2019, FramesWithoutDepthGoByTheHomography) {
  WallAndBoard scene;
  const auto judge = method(scene);
  EXPECT_FALSE(method_named("gao2019").needs.depth);
  MotionResult result;
  for (int i = 0; i < 4; ++i) {
    Frame frame = scene.frame(i);
    frame.depth.release();
    const auto prepared = judge->prepare(frame, {}, 1);
    MotionInput input{frame, prepared};
    input.camera_from_world = scene.camera_from_world(i);
    result = judge->detect(input);
    judge->commit(input, result, {true, scene.camera_from_world(i)});
    EXPECT_EQ(result.note == "the background model begins with this frame", i == 0) << result.note;
  }
  EXPECT_FALSE(result.mask.empty());
  EXPECT_EQ(result.note,
            "only 0 patches are in view; 30 are needed to align: the odometry's first pose stands in");
}

TEST(Gao2019, ClonesThreadsAndLookingTwiceChangeNothing) {
  const WallAndBoard scene;
  SceneRun one(scene, *method(scene));
  for (int i = 0; i < 4; ++i) (void)one.next();
  SceneRun other(one);
  const int threads = cv::getNumThreads();
  for (int i = 0; i < 3; ++i) {
    cv::setNumThreads(1);
    const MotionResult a = one.next(1);
    cv::setNumThreads(4);
    const MotionResult b = other.next(4);
    EXPECT_GT(cv::countNonZero(a.mask), 0);
    EXPECT_TRUE(same_bytes(a.mask, b.mask));
    EXPECT_EQ(a.figures, b.figures);
    EXPECT_TRUE(same_bytes(one.describe(a).layer("sigma")->image, other.describe(b).layer("sigma")->image));
  }
  cv::setNumThreads(threads);
}

TEST(Gao2019, AFrameThatWasNotJudgedGoesIntoTheModelAllTheSame) {
  const WallAndBoard scene;
  const auto judge = method(scene);
  for (int i = 0; i < 3; ++i) {
    const Frame frame = scene.frame(i);
    judge->commit({frame, judge->prepare(frame, {}, 1)}, {}, {true, scene.camera_from_world(i)});
    EXPECT_EQ(judge->settled(), i > 0);
  }
  // Its pose was only predicted: nothing tells where its blocks were, and the model begins anew.
  const Frame lost = scene.frame(3);
  judge->commit({lost, judge->prepare(lost, {}, 1)}, {}, {false, scene.camera_from_world(3)});
  EXPECT_FALSE(judge->settled());
}

TEST(Gao2019, WhereNothingTellsTheCamerasMotionItSaysSo) {
  const WallAndBoard scene;
  Config config;
  config.of<Gao2019Config>().min_patches = 10000;  // alignment never has enough
  const auto judge = method_named("gao2019").make(scene.camera, config);
  const auto note_of = [&](int i, bool estimated) {
    const Frame frame = scene.frame(i);
    const auto features = scene.features(i);
    MotionInput input{frame, judge->prepare(frame, {}, 1)};
    input.camera_from_world = scene.camera_from_world(i);
    input.features = features;
    const MotionResult result = judge->detect(input);
    judge->commit(input, result, {estimated, scene.camera_from_world(i)});
    return result.note;
  };
  (void)note_of(0, true);
  EXPECT_NE(note_of(1, false).find(": the odometry's first pose stands in"), std::string::npos);
  EXPECT_NE(note_of(2, true).find(": the camera is taken to be static, for the last frame has no pose"),
            std::string::npos);
}

TEST(Gao2019, ThePresetHoldsTheDefaults) {
  const Config config = load_config("gao2019");
  EXPECT_EQ(config.run.method, "gao2019");
  EXPECT_EQ(config.of<Gao2019Config>(), Gao2019Config());
  // The model's constants are method 7's.
  EXPECT_EQ(Gao2019Config().model(), Yi2013Config());
  EXPECT_NE(method_named("gao2019").citation.find("j.cnki.robot.180362"), std::string::npos);
}

TEST(Gao2019, ARunGivesTheSameBytesWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 8);
  Config config;
  config.run.method = "gao2019";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  EXPECT_GT(one.records.back().mask_share, 0.0);
  ASSERT_EQ(one.records.back().motion_figures.size(), 4U);
  EXPECT_EQ(one.records.back().motion_figures[0].name, "gao2019_patches");
}

}  // namespace
}  // namespace stillpoint
