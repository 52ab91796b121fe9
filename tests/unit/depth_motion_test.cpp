#include "core/motion/stillpoint/depth_motion.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/motion/stillpoint/depth_evidence.hpp"
#include "core/motion/stillpoint/label_propagation.hpp"
#include "core/motion/stillpoint/superpixel_motion.hpp"
#include "core/motion/stillpoint/superpixels.hpp"
#include "tests/support/board_scene.hpp"

namespace stillpoint {
namespace {

ReferenceView reference(const BoardScene& then, const BoardScene& now) {
  Pose reference_from_current = Pose::Identity();
  reference_from_current.translation().x() = now.camera_x - then.camera_x;
  return {std::make_shared<const RgbdView>(then.view()), reference_from_current};
}

StillpointTrace detect(const BoardScene& now, const std::vector<ReferenceView>& references,
                       const MotionPrior* prior = nullptr) {
  cv::Mat gray, depth;
  now.render(gray, depth);
  const RgbdView view = make_rgbd_view(gray, depth, board_camera(), 4);
  return detect_depth_motion(view, make_superpixels(view, {}), depth, references, prior, Pose::Identity(),
                             {});
}

double overlap(const cv::Mat& mask, const cv::Mat& truth) {
  return static_cast<double>(cv::countNonZero(mask & truth)) / std::max(1, cv::countNonZero(mask | truth));
}

TEST(DepthMotion, NothingMovesUnderAMovingCamera) {
  // Parallax, and an exposure that changed: neither is motion.
  const BoardScene now{0.15, 0.0, 1.0, true, 12.0};
  const StillpointTrace trace = detect(now, {reference({0.10}, now), reference({0.0}, now)});
  EXPECT_EQ(cv::countNonZero(trace.mask), 0) << "a frame in which nothing moves has an empty mask";
  EXPECT_EQ(trace.references.size(), 2u);
}

TEST(DepthMotion, AMoverIsCoveredToItsOutline) {
  const BoardScene now{0.06, 0.30};
  const StillpointTrace trace = detect(now, {reference({0.04, 0.25}, now), reference({0.0, 0.0}, now)});
  cv::Mat gray, depth, truth;
  now.render(gray, depth, &truth);
  EXPECT_GT(overlap(trace.mask, truth), 0.85);
}

TEST(DepthMotion, MotionAlongTheOpticalAxisIsSeen) {
  BoardScene now;
  now.board_z = 0.9;
  const StillpointTrace trace = detect(now, {reference({}, now)});
  cv::Mat gray, depth, truth;
  now.render(gray, depth, &truth);
  EXPECT_GT(overlap(trace.mask, truth), 0.8);
}

TEST(DepthMotion, WhatLeavesRevealsBackgroundOfFullWeight) {
  // The board was here a moment ago and is gone: what is seen now is the wall, and the wall is static.
  BoardScene now;
  now.board = false;
  const StillpointTrace trace = detect(now, {reference({}, now)});
  EXPECT_EQ(cv::countNonZero(trace.mask), 0);
}

TEST(DepthMotion, AMoverThatStopsIsRememberedForAWhile) {
  const BoardScene now{0.0, 0.30}, before{0.0, 0.30};
  const StillpointTrace moving =
      detect(before, {reference({0.0, 0.20}, before), reference({0.0, 0.0}, before)});
  ASSERT_GT(cv::countNonZero(moving.mask), 0);
  MotionPrior prior{std::make_shared<const RgbdView>(before.view()), moving.log_odds};
  EXPECT_GT(cv::countNonZero(detect(now, {reference(before, now)}, &prior).mask), 0);
  EXPECT_EQ(cv::countNonZero(detect(now, {reference(before, now)}).mask), 0) << "without prior it is static";
  int frames = 0;
  for (cv::Mat odds = moving.log_odds; frames < 300; ++frames) {
    prior.log_odds = odds;
    const StillpointTrace trace = detect(now, {reference(before, now)}, &prior);
    if (cv::countNonZero(trace.mask) == 0) break;
    odds = trace.log_odds;
  }
  EXPECT_GE(frames, 2);
  EXPECT_LT(frames, 300) << "what is static for ten seconds is furniture again";
}

TEST(DepthMotion, ASlowMoverIsSeenOverTime) {
  // Five millimetres in some tenths of a second: too little for any pixel, not for superpixels.
  const BoardScene now{0.0, 0.105, 1.0, true, 0.0, true}, before{0.0, 0.100, 1.0, true, 0.0, true};
  ReferenceView then = reference(before, now);
  cv::Mat gray, depth, truth;
  now.render(gray, depth, &truth);
  const auto detect_three_times = [&] {
    MotionPrior prior{std::make_shared<const RgbdView>(now.view()), cv::Mat::zeros(120, 160, CV_32FC1)};
    StillpointTrace trace;
    for (int i = 0; i < 3; ++i) {
      trace = detect(now, {then}, &prior);
      prior.log_odds = trace.log_odds;
    }
    return trace;
  };
  EXPECT_EQ(cv::countNonZero(detect_three_times().mask), 0) << "pixel by pixel it is not seen";
  then.old = true;
  const StillpointTrace trace = detect_three_times();
  EXPECT_GT(overlap(trace.mask, truth), 0.7);
  EXPECT_EQ(trace.slow.size(), trace.log_odds.size());
}

TEST(DepthMotion, WhatIsNotMeasuredInsideAMoverMovesWithIt) {
  const BoardScene now{0.06, 0.30};
  cv::Mat gray, depth;
  now.render(gray, depth);
  // The board's middle as the camera sees it, without depth as hair would be.
  const cv::Point middle(cvRound(board_camera().cx + board_camera().fx * (0.30 - 0.06)),
                         cvRound(board_camera().cy));
  const cv::Rect hole(middle.x - 10, middle.y - 10, 20, 20);
  depth(hole).setTo(0);
  const RgbdView view = make_rgbd_view(gray, depth, board_camera(), 4);
  const StillpointTrace trace = detect_depth_motion(
      view, make_superpixels(view, {}), depth, {reference({0.04, 0.25}, now), reference({0.0, 0.0}, now)},
      nullptr, Pose::Identity(), {});
  EXPECT_EQ(cv::countNonZero(trace.mask(hole)), hole.area());
}

TEST(DepthMotion, AGapOpenToOneSideIsNoPartOfTheMover) {
  const BoardScene now{0.06, 0.30};
  cv::Mat gray, depth, truth;
  now.render(gray, depth, &truth);
  // A strip without depth along the board's right side, as wide as the sensor's shadow.
  const cv::Rect board = cv::boundingRect(truth);
  const cv::Rect shadow(board.br().x, board.y, 12, board.height);
  depth(shadow).setTo(0);
  const RgbdView view = make_rgbd_view(gray, depth, board_camera(), 4);
  const StillpointTrace trace = detect_depth_motion(
      view, make_superpixels(view, {}), depth, {reference({0.04, 0.25}, now), reference({0.0, 0.0}, now)},
      nullptr, Pose::Identity(), {});
  EXPECT_GT(overlap(trace.mask, truth), 0.8);
  EXPECT_LT(cv::countNonZero(trace.mask(shadow)), 0.1 * shadow.area());
}

TEST(DepthMotion, ASlantedSurfaceSeenAPixelOffIsNoMover) {
  const BoardScene now{0.0, 0.0, 1.0, false, 0.0, true},
      then{0.0, 0.0, 1.1, false, 0.0, true};  // hills alone
  ReferenceView exact = reference(then, now), off = exact;
  off.reference_from_current.translation().x() +=
      2.0 * 4.0 * 2.0 / board_camera().fx;  // 2 downsampled px at 2 m
  const ReferenceEvidence known = detect(now, {exact}).references.front();
  EXPECT_LT(known.registration_error_px, 0.2);
  const StillpointTrace trace = detect(now, {off});
  EXPECT_GT(trace.references.front().registration_error_px, 0.2);
  EXPECT_EQ(cv::countNonZero(trace.mask), 0);
}

/// The superpixels of a scene against an earlier one, from a pose that is off by `error`.
SuperpixelMotions patches_of(const BoardScene& now, const BoardScene& before, const Pose& error,
                             std::vector<Superpixel>& superpixels) {
  const RgbdView view = now.view();
  const Superpixels made = make_superpixels(view, {});
  superpixels = made.all;
  ReferenceView then = reference(before, now);
  then.reference_from_current = error * then.reference_from_current;
  return measure_superpixels(view, then, made.labels, superpixels,
                             cv::Mat::zeros(view.depth.size(), CV_32FC1), {});
}

TEST(SuperpixelMotion, ShiftsAreMeasuredAndWeighed) {
  const BoardScene now{0.0, 0.105, 1.0, true, 0.0, true}, before{0.0, 0.100, 1.0, true, 0.0, true};
  std::vector<Superpixel> superpixels;
  const SuperpixelMotions motions = patches_of(now, before, Pose::Identity(), superpixels);
  const double expected = -board_camera().fx / 4 * 0.005 / 1.0;  // px: the board was farther left
  int board = 0, wall = 0, board_moves = 0, wall_moves = 0;
  double shift = 0.0;
  for (std::size_t i = 0; i < superpixels.size(); ++i) {
    if (superpixels[i].pixels < 40) continue;
    const SuperpixelMotion& superpixel = motions.motions[i];
    const bool on_board = superpixels[i].depth < 1.04F;
    ++(on_board ? board : wall);
    (on_board ? board_moves : wall_moves) += superpixel.log_odds > 0;
    if (on_board) shift += superpixel.shift[0];
  }
  ASSERT_GT(board, 10);
  ASSERT_GT(wall, 50);
  EXPECT_NEAR(shift / board, expected, 0.2 * std::abs(expected));
  EXPECT_GT(board_moves, 0.9 * board);
  EXPECT_LT(wall_moves, 0.1 * wall);
}

TEST(SuperpixelMotion, AnInexactPoseIsMadeGoodByWhatMostPatchesSay) {
  Pose error = Pose::Identity();
  error.translation() = Eigen::Vector3d(0.008, -0.004, 0.0);
  const BoardScene now{0.02, 0.105}, before{0.0, 0.100};
  std::vector<Superpixel> superpixels;
  const SuperpixelMotions motions = patches_of(now, before, error, superpixels);
  // A sideways slide and a turn look alike on a wall: what counts is where the wall's points come to lie.
  for (const double x : {-0.6, 0.0, 0.6}) {
    const Eigen::Vector3d p(x, 0.3, 2.0), there = motions.reference_from_current * p;
    const Eigen::Vector3d truth = p + Eigen::Vector3d(0.02, 0, 0);
    EXPECT_LT((board_camera().project(there) - board_camera().project(truth)).norm(), 0.5)
        << "px, of 2.3 put in";
  }
}

/// How many of the board's superpixels are found to move, and how far back most of them stepped.
struct Receding {
  int superpixels = 0, moving = 0;
  float step = 0.0F;  // m, mean of the moving ones
};

Receding receding(const BoardScene& now, const BoardScene& before) {
  std::vector<Superpixel> superpixels;
  const SuperpixelMotions motions = patches_of(now, before, Pose::Identity(), superpixels);
  Receding result;
  for (std::size_t i = 0; i < superpixels.size(); ++i) {
    if (superpixels[i].pixels < 40 ||
        std::abs(superpixels[i].depth - static_cast<float>(now.board_z)) > 0.04F)
      continue;
    ++result.superpixels;
    if (motions.motions[i].log_odds <= 0) continue;
    ++result.moving;
    result.step += motions.motions[i].step;
  }
  if (result.moving > 0) result.step /= static_cast<float>(result.moving);
  return result;
}

TEST(AxialMotion, WhatGoesBackAlongTheLineOfSightMoves) {
  // Far more than depth's noise: the superpixels' own surface is not found where they are expected.
  const Receding board = receding({0.0, 0.1, 1.15}, {0.0, 0.1, 1.0});
  ASSERT_GT(board.superpixels, 10);
  EXPECT_GT(board.moving, 0.8 * board.superpixels);
  EXPECT_NEAR(board.step, -0.15F, 0.01F);
  // Near the rim, along the optical axis (which takes it outwards by pixels) and along its own ray.
  const Receding axis = receding({0.0, 0.35, 1.15}, {0.0, 0.35, 1.0}),
                 ray = receding({0.0, 0.4025, 1.15}, {0.0, 0.35, 1.0});
  EXPECT_GT(axis.moving, 0.7 * axis.superpixels);
  EXPECT_GT(ray.moving, 0.7 * ray.superpixels);
  const Receding sideways = receding({0.0, 0.12, 1.15}, {0.0, 0.1, 1.0});
  EXPECT_GT(sideways.moving, 0.8 * sideways.superpixels) << "two centimetres sideways are followed too";
}

TEST(AxialMotion, WhatAnotherThingStoodBeforeDoesNotMove) {
  BoardScene before{0.0, 0.1, 1.0};
  before.board_pitch = 1.9;
  const Receding revealed = receding({0.0, 0.1, 1.15}, before);
  ASSERT_GT(revealed.superpixels, 10);
  EXPECT_LT(revealed.moving, 0.1 * revealed.superpixels);
}

TEST(AxialMotion, ABoardThatGoesBackIsMaskedAndOnlyByThem) {
  const BoardScene now{0.0, 0.1, 1.15}, before{0.0, 0.1, 1.0};
  cv::Mat gray, depth, truth;
  now.render(gray, depth, &truth);
  const RgbdView view = make_rgbd_view(gray, depth, board_camera(), 4);
  ReferenceView then = reference(before, now);
  then.old = true;
  const auto mask = [&](int find_axial_motion) {
    StillpointConfig config;
    config.find_axial_motion = find_axial_motion;
    MotionPrior prior{std::make_shared<const RgbdView>(now.view()), cv::Mat::zeros(120, 160, CV_32FC1)};
    StillpointTrace trace;
    for (int i = 0; i < 2; ++i) {
      trace = detect_depth_motion(view, make_superpixels(view, config), depth, {then}, &prior,
                                  Pose::Identity(), config);
      prior.log_odds = trace.log_odds;
    }
    return trace.mask;
  };
  EXPECT_GT(overlap(mask(1), truth), 0.7);
  EXPECT_EQ(cv::countNonZero(mask(0)), 0);
}

/// A board that reaches over the image's right rim, seen by a camera that slides to it: what the frame before
/// knew, and what lay outside it.
struct Entered {
  RgbdView view = BoardScene{0.0, 0.5}.view();
  Superpixels superpixels = make_superpixels(view, {});
  cv::Mat prior = cv::Mat::zeros(view.depth.size(), CV_32FC1);
  cv::Mat newly_observed;
  cv::Mat fresh_board, fresh_wall;

  explicit Entered(double step_m) {
    Pose previous_from_current = Pose::Identity();
    previous_from_current.translation().x() = step_m;
    const MotionPrior nothing{std::make_shared<const RgbdView>(view),
                              cv::Mat::zeros(view.depth.size(), CV_32FC1)};
    newly_observed = warp_prior(view, nothing, previous_from_current, {}).newly_observed;
    const cv::Mat board = (view.depth > 0) & (view.depth < 1.2F), wall = view.depth >= 1.2F;
    prior.setTo(5.0F, board & ~newly_observed);
    prior.setTo(-2.0F, wall & ~newly_observed);
    fresh_board = board & newly_observed;
    fresh_wall = wall & newly_observed;
  }
  void inherit() { propagate_labels(newly_observed, superpixels, prior); }
};

TEST(WarpPrior, TellsWhatLayOutsideTheFrameBefore) {
  const Entered newly_observed(0.03);
  // Slid by 3 cm, a surface at z metres has newly_observed by fx * 0.03 / z downsampled pixels at the right.
  const double fx = board_camera().fx / 4;
  const cv::Rect rim(160 - static_cast<int>(fx * 0.03 / 2.0) - 1, 10, 1, 5);
  EXPECT_EQ(cv::countNonZero(newly_observed.newly_observed(rim)), 5) << "the wall's, two metres off";
  EXPECT_EQ(cv::countNonZero(newly_observed.newly_observed(cv::Rect(2, 2, 140, 116))), 0);
  RgbdView unmeasured = newly_observed.view;
  unmeasured.depth = cv::Mat::zeros(unmeasured.depth.size(), CV_32FC1);
  const MotionPrior nothing{std::make_shared<const RgbdView>(newly_observed.view),
                            cv::Mat::zeros(unmeasured.depth.size(), CV_32FC1)};
  EXPECT_EQ(cv::countNonZero(warp_prior(unmeasured, nothing, Pose::Identity(), {}).newly_observed), 0);
}

TEST(References, FarOnesTakeTurns) {
  StillpointConfig config;
  config.near_reference = 2, config.far_reference = 10, config.slow_reference = 24;
  EXPECT_EQ(reference_gaps(config, 6), (std::array<int, 2>{2, 10}));
  EXPECT_EQ(reference_gaps(config, 7), (std::array<int, 2>{2, 24}));
  EXPECT_EQ(farthest_reference(config), 24);
  config.slow_reference = 3;
  EXPECT_EQ(farthest_reference(config), 10);
}

TEST(Entering, TakesOverWhatItsSurfaceIsKnownToDo) {
  Entered newly_observed(0.03);
  ASSERT_GT(cv::countNonZero(newly_observed.fresh_board), 100);
  ASSERT_GT(cv::countNonZero(newly_observed.fresh_wall), 100);
  newly_observed.prior.setTo(-1.0F,
                             newly_observed.fresh_wall);  // so that it is seen whether anything is written
  newly_observed.inherit();
  EXPECT_GT(cv::mean(newly_observed.prior, newly_observed.fresh_board)[0], 4.0);
  EXPECT_EQ(cv::mean(newly_observed.prior, newly_observed.fresh_wall)[0], 0.0)
      << "to are static is not inherited";
  EXPECT_EQ(cv::countNonZero(newly_observed.prior == -2.0F),
            cv::countNonZero((newly_observed.view.depth > 1.2F) & (newly_observed.fresh_wall == 0)))
      << "what was seen before keeps what it had";
}

TEST(Entering, NeighboursAloneMakeNothingFirm) {
  // So much of the board is new that whole superpixels are.
  Entered newly_observed(0.2);
  ASSERT_GT(cv::countNonZero(newly_observed.fresh_board), 1500);
  newly_observed.inherit();
  const double mean = cv::mean(newly_observed.prior, newly_observed.fresh_board)[0];
  EXPECT_GT(mean, 1.0);
  EXPECT_LT(mean, StillpointConfig{}.confident_log_odds);
}

TEST(DepthMotion, WithoutReferencesOrDepthThereIsNoMask) {
  const StillpointTrace alone = detect({}, {});
  EXPECT_EQ(cv::countNonZero(alone.mask), 0);
  EXPECT_FALSE(alone.note.empty());
  const cv::Mat gray(480, 640, CV_8UC1, cv::Scalar(90)), none = cv::Mat::zeros(480, 640, CV_32FC1);
  const RgbdView view = make_rgbd_view(gray, none, board_camera(), 4);
  const StillpointTrace blind = detect_depth_motion(view, make_superpixels(view, {}), none,
                                                    {reference({}, {})}, nullptr, Pose::Identity(), {});
  EXPECT_EQ(cv::countNonZero(blind.mask), 0);
}

}  // namespace
}  // namespace stillpoint
