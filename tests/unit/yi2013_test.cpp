#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/config.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/motion_method.hpp"
#include "core/motion/stage_log.hpp"
#include "core/motion/yi2013/block_model.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

const Yi2013Config kConfig;

/// A block's Gaussian.
struct One {
  float mean, variance, age;
  bool operator==(const One&) const = default;
};

std::ostream& operator<<(std::ostream& out, const One& one) {
  return out << "mean " << one.mean << ", variance " << one.variance << ", age " << one.age;
}

Yi2013Gaussians filled(const cv::Size& blocks, const One& one) {
  return {cv::Mat(blocks, CV_32FC1, cv::Scalar(one.mean)),
          cv::Mat(blocks, CV_32FC1, cv::Scalar(one.variance)),
          cv::Mat(blocks, CV_32FC1, cv::Scalar(one.age))};
}

void set(Yi2013Gaussians& gaussians, int x, int y, const One& one) {
  gaussians.mean.at<float>(y, x) = one.mean;
  gaussians.variance.at<float>(y, x) = one.variance;
  gaussians.age.at<float>(y, x) = one.age;
}

One at(const Yi2013Gaussians& gaussians, int x, int y) {
  return {gaussians.mean.at<float>(y, x), gaussians.variance.at<float>(y, x), gaussians.age.at<float>(y, x)};
}

cv::Matx33d shift(double x, double y) { return {1.0, 0.0, x, 0.0, 1.0, y, 0.0, 0.0, 1.0}; }

/// Blocks that are one grey level each.
Yi2013Blocks flat_blocks(const cv::Size& blocks, int level) {
  return yi2013_blocks(cv::Mat(blocks * 4, CV_8UC1, cv::Scalar(level)), 4);
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(Yi2013, BlocksHoldMeanAndExtremesOfTheirPixelsAndNoOthers) {
  cv::Mat gray(5, 9, CV_8UC1, cv::Scalar(100));
  gray.at<std::uint8_t>(0, 4) = 132;
  for (int i = 0; i < 7; ++i) gray.at<std::uint8_t>(1 + i / 4, 4 + i % 4) = 104;
  gray.col(8).setTo(255);  // narrower than a block
  gray.row(4).setTo(0);
  const Yi2013Blocks blocks = yi2013_blocks(gray, 4);
  ASSERT_EQ(blocks.mean.size(), cv::Size(2, 1));
  EXPECT_EQ(blocks.mean.at<float>(0, 0), 100.0F);
  EXPECT_EQ(blocks.mean.at<float>(0, 1), 103.75F);  // (8 * 100 + 7 * 104 + 132) / 16
  EXPECT_EQ(blocks.least.at<std::uint8_t>(0, 1), 100);
  EXPECT_EQ(blocks.most.at<std::uint8_t>(0, 1), 132);
}

TEST(Yi2013, OfOneAgeNoMixtureIsOlder) {
  // Shares of a place between blocks, rounded to floats, may add up to more than one.
  const Yi2013Blocks blocks = flat_blocks({12, 9}, 100);
  const Yi2013Model young{filled({12, 9}, {100, 400, 1}), filled({12, 9}, {100, 400, 1})};
  for (int i = 0; i < 40; ++i) {
    const cv::Matx33d moved = shift(0.37 * i - 7.0, 5.0 - 0.29 * i);
    const cv::Mat age = yi2013_warped(young, moved, blocks, kConfig)[0].age;
    EXPECT_EQ(cv::countNonZero((age != 0.0F) & (age != 1.0F)), 0) << i;
    EXPECT_GT(cv::countNonZero(age == 1.0F), 20) << i;
  }
}

TEST(Yi2013, TheFrameAfterTheFirstJudgesNoPixel) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 1.5);
  cv::normalize(noise, noise, 60, 140, cv::NORM_MINMAX);
  for (int turn = 1; turn < 6; ++turn) {
    auto method = method_named("yi2013").make(Camera{}, Config{});
    for (int i = 0; i < 2; ++i) {
      Frame frame;
      frame.index = i;
      // A turn about the corner shares blocks in every way there is.
      const double angle = 0.004 * turn * i;
      cv::warpAffine(
          noise, frame.gray,
          cv::Matx23d(std::cos(angle), -std::sin(angle), 1.3 * i, std::sin(angle), std::cos(angle), 0.9 * i),
          noise.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
      // Something bright has come, on a fifth of the view.
      if (i == 1) frame.gray(cv::Rect(100, 100, 300, 200)) += 110;
      const MotionInput input{frame, nullptr};
      const MotionResult result = method->detect(input);
      EXPECT_EQ(result.mask_share, 0.0) << i << ", " << turn;
      method->commit(input, result, {});
    }
  }
}

/// Four unlike blocks in the middle of six by six.
Yi2013Model four_unlike() {
  Yi2013Model model{filled({6, 6}, {100, 25, 4}), filled({6, 6}, {10, 25, 1})};
  set(model[0], 2, 2, {100, 25, 4});
  set(model[0], 3, 2, {120, 36, 8});
  set(model[0], 2, 3, {80, 49, 12});
  set(model[0], 3, 3, {60, 64, 16});
  return model;
}

TEST(Yi2013, WarpMixesFourBlocksAndTheSpreadOfTheirMeans) {
  // The centre (10, 10) was at (11, 11): shares 9/16, 3/16, 3/16, 1/16. Mean 56.25 + 22.5 + 15 + 3.75;
  // variance 9/16 (25 + 2.5²) + 3/16 (36 + 22.5²) + 3/16 (49 + 17.5²) + 1/16 (64 + 37.5²); age 2.25 + 1.5
  // + 2.25 + 1.
  const Yi2013Model warped = yi2013_warped(four_unlike(), shift(1, 1), flat_blocks({6, 6}, 0), kConfig);
  EXPECT_EQ(at(warped[0], 2, 2), (One{97.5F, 277.75F, 7.0F}));
  EXPECT_EQ(at(warped[1], 2, 2), (One{10, 25, 1}));
}

TEST(Yi2013, WarpTakesTheNeighboursOfTheSideTheCentreLiesOn) {
  // The centre (14, 14) was at (13, 13): 9/16 of 60, 3/16 of 80 and of 120, 1/16 of 100.
  const Yi2013Model warped = yi2013_warped(four_unlike(), shift(-1, -1), flat_blocks({6, 6}, 0), kConfig);
  EXPECT_EQ(at(warped[0], 3, 3).mean, 77.5F);
}

TEST(Yi2013, WarpFollowsAllOfTheHomography) {
  Yi2013Model model{filled({6, 6}, {0, 25, 1}), filled({6, 6}, {0, 25, 1})};
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x) set(model[0], x, y, {static_cast<float>(10 * x + y), 25, 1});
  // (10, 14) goes to (8, 12) / 0.8 = (10, 15), a quarter of a block below the centre of block (2, 3).
  const cv::Matx33d h(0.8, 0, 0, 0, 0.8, 0.8, 0, -1.0 / 70, 1.0);
  EXPECT_NEAR(at(yi2013_warped(model, h, flat_blocks({6, 6}, 0), kConfig)[0], 2, 3).mean, 23.25F, 1e-4F);
}

TEST(Yi2013, AgeFallsWhereUnlikeBlocksMixAndIsCapped) {
  Yi2013Model model{filled({6, 6}, {50, 25, 10}), filled({6, 6}, {0, 9, 40})};
  model[0].mean.col(3).setTo(150);
  const Yi2013Model slight = yi2013_warped(model, shift(2, 0), flat_blocks({6, 6}, 0), kConfig);
  // Half 50 and half 150: variance 25 + 50², 25 above the limit.
  EXPECT_EQ(at(slight[0], 2, 2).variance, 2525.0F);
  EXPECT_NEAR(at(slight[0], 2, 2).age, 10.0 * std::exp(-0.025), 1e-5);
  EXPECT_EQ(at(slight[0], 1, 2).age, 10.0F);         // like with like
  EXPECT_EQ(at(slight[1], 2, 2), (One{0, 25, 30}));  // at least 5², at most 30 frames
  model[0].mean.col(3).setTo(250);                   // half 50 and half 250: 25 + 100²
  const Yi2013Model strong = yi2013_warped(model, shift(2, 0), flat_blocks({6, 6}, 0), kConfig);
  EXPECT_NEAR(at(strong[0], 2, 2).age, 10.0 * std::exp(-7.525), 1e-6);
}

TEST(Yi2013, WarpBeginsAnewAtTheBorderAndOutside) {
  const Yi2013Model model{filled({6, 6}, {90, 30, 8}), filled({6, 6}, {20, 30, 2})};
  const Yi2013Model still = yi2013_warped(model, shift(0, 0), flat_blocks({6, 6}, 7), kConfig);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x)
      EXPECT_EQ(at(still[0], x, y), (x % 5 == 0 || y % 5 == 0) ? (One{90, 400, 0}) : (One{90, 30, 8}));
  const Yi2013Model gone = yi2013_warped(model, shift(8, 0), flat_blocks({6, 6}, 7), kConfig);
  EXPECT_EQ(at(gone[0], 2, 2), (One{90, 30, 8}));  // was in column 4
  EXPECT_EQ(at(gone[0], 3, 2), (One{90, 400, 0}));
  EXPECT_EQ(at(gone[0], 4, 2), (One{7, 400, 0}));  // was nowhere
  EXPECT_EQ(at(gone[1], 5, 2), (One{7, 400, 0}));
  const cv::Matx33d behind(1, 0, 0, 0, 1, 0, 0, 0, -1);
  EXPECT_EQ(at(yi2013_warped(model, behind, flat_blocks({6, 6}, 7), kConfig)[0], 2, 2), (One{7, 400, 0}));
}

struct Choice {
  One apparent, candidate;
  int seen;
  Yi2013Match match;
  One apparent_after, candidate_after;
};

TEST(Yi2013, ChoosesWhatABlockBelongsTo) {
  const Choice choices[] = {
      // Within 2 * 50 of the apparent mean; at the limit no more, and in neither the candidate begins anew.
      {{100, 50, 10}, {200, 50, 3}, 109, kMatchApparent, {100, 50, 10}, {200, 50, 3}},
      {{100, 50, 10}, {200, 50, 3}, 110, kMatchNeither, {100, 50, 10}, {200, 50, 0}},
      {{100, 50, 10}, {200, 50, 3}, 191, kMatchCandidate, {100, 50, 10}, {200, 50, 3}},
      {{100, 50, 10}, {200, 50, 3}, 190, kMatchNeither, {100, 50, 10}, {200, 50, 0}},
      // The apparent one comes first where both would do.
      {{100, 50, 10}, {104, 50, 3}, 104, kMatchApparent, {100, 50, 10}, {104, 50, 3}},
      // The candidate takes its place when it is older, or as old, and not a little before.
      {{100, 50, 5}, {200, 60, 6}, 201, kMatchApparent, {200, 60, 6}, {201, 400, 0}},
      {{100, 50, 5}, {200, 60, 5}, 201, kMatchApparent, {200, 60, 5}, {201, 400, 0}},
      {{100, 50, 5}, {200, 60, 4.5F}, 201, kMatchCandidate, {100, 50, 5}, {200, 60, 4.5F}},
      {{100, 50, 5}, {200, 60, 5}, 100, kMatchCandidate, {200, 60, 5}, {100, 400, 0}},
  };
  for (const Choice& choice : choices) {
    Yi2013Model model{filled({1, 1}, choice.apparent), filled({1, 1}, choice.candidate)};
    const cv::Mat matches = yi2013_choose(model, flat_blocks({1, 1}, choice.seen), kConfig);
    const auto number = &choice - choices;
    EXPECT_EQ(matches.at<std::uint8_t>(0, 0), choice.match) << number;
    EXPECT_EQ(at(model[0], 0, 0), choice.apparent_after) << number;
    EXPECT_EQ(at(model[1], 0, 0), choice.candidate_after) << number;
  }
}

/// A block of 8 pixels at 100, 7 at 104 and one at 132, mean 103.75; as its mirror at 255 where `dark`.
Yi2013Blocks uneven_block(bool dark = false) {
  cv::Mat gray(4, 4, CV_8UC1, cv::Scalar(100));
  for (int i = 0; i < 7; ++i) gray.at<std::uint8_t>(2 + i / 4, i % 4) = 104;
  gray.at<std::uint8_t>(0, 0) = 132;
  if (dark) cv::subtract(255, gray, gray);
  return yi2013_blocks(gray, 4);
}

One updated(const One& before, const Yi2013Blocks& blocks, Yi2013Match match = kMatchApparent) {
  const One other{1, 2, 3};
  Yi2013Model model{filled({1, 1}, other), filled({1, 1}, other)};
  const std::size_t mode = match == kMatchApparent ? 0 : 1;
  model[mode] = filled({1, 1}, before);
  const cv::Mat matches(1, 1, CV_8UC1, cv::Scalar(match));
  const Yi2013Model after = yi2013_updated(model, matches, blocks, kConfig);
  EXPECT_EQ(at(after[1 - mode], 0, 0), other);
  EXPECT_EQ(at(model[mode], 0, 0), before);
  return at(after[mode], 0, 0);
}

TEST(Yi2013, UpdateAveragesByAgeAndTakesTheLargestDeviation) {
  // Age 3 keeps 3/4: mean 75 + 25.9375, then (132 - 100.9375)² = 964.87890625 goes in with 1/4.
  const One bright{100.9375F, 277.9697265625F, 4};
  EXPECT_EQ(updated({100, 49, 3}, uneven_block()), bright);
  EXPECT_EQ(updated({100, 49, 3}, uneven_block(), kMatchCandidate), bright);
  EXPECT_EQ(updated({100, 49, 3}, uneven_block(), kMatchNeither), bright);
  EXPECT_EQ(updated({155, 49, 3}, uneven_block(true)), (One{255 - 100.9375F, 277.9697265625F, 4}));
}

TEST(Yi2013, UpdateOfAYoungGaussianTakesTheBlocksOwnMean) {
  const One young = updated({20, 49, 0.5F}, uneven_block());
  EXPECT_EQ(young.mean, 103.75F);
  EXPECT_NEAR(young.variance, 49.0 / 3 + 2.0 / 3 * 28.25 * 28.25, 1e-3);
  EXPECT_EQ(young.age, 1.5F);
  EXPECT_EQ(updated({20, 49, 0}, uneven_block()), (One{103.75F, 798.0625F, 1}));  // 28.25², above 20²
  EXPECT_EQ(updated({20, 49, 0}, flat_blocks({1, 1}, 60)), (One{60, 400, 1}));
}

TEST(Yi2013, UpdateHasALeastVarianceAndAGreatestAge) {
  EXPECT_EQ(updated({60, 25, 29.5F}, flat_blocks({1, 1}, 60)), (One{60, 25, 30}));
}

TEST(Yi2013, DetectsBeyondTwoSigmaAndOnlyByOlderGaussians) {
  // One row of four blocks of ages 0, 1, 1.5 and 20, and a strip beside and below.
  Yi2013Model chosen{filled({4, 1}, {200, 25, 20}), filled({4, 1}, {0, 1, 30})};
  for (int x = 0; x < 3; ++x) chosen[0].age.at<float>(0, x) = std::array{0.0F, 1.0F, 1.5F}[std::size_t(x)];
  const Yi2013Model after{filled({4, 1}, {100, 5000, 21}), filled({4, 1}, {0, 1, 30})};
  const auto count = [&](int level) {
    const cv::Mat mask = yi2013_moving(cv::Mat(6, 18, CV_8UC1, cv::Scalar(level)), chosen, after, kConfig);
    EXPECT_EQ(cv::countNonZero(mask), cv::countNonZero(mask(cv::Rect(8, 0, 8, 4)))) << level;
    return cv::countNonZero(mask);
  };
  EXPECT_EQ(count(100), 0);
  EXPECT_EQ(count(110), 0);  // 10² = 4 * 25
  EXPECT_EQ(count(111), 32);
  EXPECT_EQ(count(90), 0);
  EXPECT_EQ(count(89), 32);
}

// ---- The method as a whole ----

std::unique_ptr<MotionMethod> method() { return method_named("yi2013").make(Camera(), Config()); }

MotionResult next(MotionMethod& method, const cv::Mat& gray, int index, int threads = 1) {
  Frame frame;
  frame.index = index;
  frame.gray = gray;
  MotionInput input{frame};
  input.threads = threads;
  MotionResult result = method.detect(input);
  method.commit(input, result, {});
  return result;
}

StageLog described(const MotionMethod& method, const cv::Mat& gray, int index, const MotionResult& result) {
  Frame frame;
  frame.index = index;
  frame.gray = gray;
  return method.describe(frame, result);
}

TEST(Yi2013, StaticNoiseIsNotDynamic) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(11).fill(noise, cv::RNG::UNIFORM, 64, 192);
  const auto yi = method();
  MotionResult result;
  for (int i = 0; i < 6; ++i) {
    result = next(*yi, noise, i);
    EXPECT_EQ(cv::countNonZero(result.mask), 0) << "frame " << i;
  }
  // All but the outermost ring of blocks is judged.
  const StageLog log = described(*yi, noise, 5, result);
  EXPECT_NEAR(percent_known(log.layer("deviation")->image), 100.0 * 158 * 118 / (160 * 120), 0.01);
}

/// A camera that goes over a plane by the same homography each frame, and a patch that goes its own way once
/// it is there.
struct Scene {
  int enters = 8;  ///< frame in which the patch appears
  cv::Matx33d last_from_here = motion_test::slight_motion();
  cv::Mat ground = motion_test::textured_image({1100, 900}, 5),
          patch = motion_test::textured_image({120, 120}, 9);

  Scene() {
    cv::add(ground * 0.6, 0, ground);
    cv::add(patch * 0.6, 100, patch);
  }
  [[nodiscard]] static cv::Rect patch_at(int frame) { return {200 + 9 * frame, 150 + 5 * frame, 120, 120}; }
  [[nodiscard]] cv::Mat frame(int index) const {
    cv::Matx33d ground_from_here(1, 0, 200, 0, 1, 200, 0, 0, 1);
    for (int i = 0; i < index; ++i) ground_from_here = ground_from_here * last_from_here;
    cv::Mat image;
    cv::warpPerspective(ground, image, ground_from_here, {640, 480}, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                        cv::BORDER_REFLECT);
    if (index >= enters) patch.copyTo(image(patch_at(index)));
    return image;
  }
};

constexpr int kFrames = 14;

TEST(Yi2013, FindsAMovingPatchBeforeAMovingBackground) {
  const Scene scene;
  const auto yi = method();
  MotionResult result;
  for (int i = 0; i < kFrames; ++i) result = next(*yi, scene.frame(i), i);
  cv::Mat truth = cv::Mat::zeros(480, 640, CV_8UC1), at_patch = truth.clone();
  truth(Scene::patch_at(kFrames - 1)).setTo(255);
  cv::bitwise_and(result.mask, truth, at_patch);
  const double found = percent_set(at_patch) / percent_set(truth);
  const double right = percent_set(at_patch) / percent_set(result.mask);
  RecordProperty("found", std::to_string(found));
  RecordProperty("right", std::to_string(right));
  EXPECT_GT(found, 0.9);
  EXPECT_GT(right, 0.9);
  EXPECT_NEAR(result.mask_share, percent_set(result.mask) / 100.0, 1e-12);

  const StageLog log = described(*yi, scene.frame(kFrames - 1), kFrames - 1, result);
  EXPECT_EQ(log.reference, kFrames - 2);
  ASSERT_TRUE(log.backward && log.forward);
  for (const cv::Point2d& corner : {cv::Point2d(0, 0), cv::Point2d(639, 0), cv::Point2d(320, 479)}) {
    const cv::Vec3d p(corner.x, corner.y, 1.0);
    const cv::Vec3d measured = *log.backward * p, known = scene.last_from_here * p;
    EXPECT_NEAR(measured[0] / measured[2], known[0] / known[2], 0.3);
    EXPECT_NEAR(measured[1] / measured[2], known[1] / known[2], 0.3);
    const cv::Vec3d again = *log.forward * measured;
    EXPECT_NEAR(again[0] / again[2], corner.x, 1e-6);
  }
  const cv::Point2f middle(cv::Point(Scene::patch_at(kFrames - 1).tl()) + cv::Point(60, 60));
  const auto sentences = log.explain(middle, true);
  ASSERT_EQ(sentences.size(), 2U);
  EXPECT_EQ(log.layer("mask")->image.at<std::uint8_t>(cv::Point(middle)) != 0,
            sentences[0].find("beyond the limit of 2.0 σ") != std::string::npos);
}

TEST(Yi2013, StaysQuietWhereNothingMovesButTheCamera) {
  Scene scene;
  scene.enters = kFrames;
  const auto yi = method();
  for (int i = 0; i < kFrames; ++i) {
    const MotionResult result = next(*yi, scene.frame(i), i);
    EXPECT_LT(result.mask_share, 0.01) << "frame " << i;
  }
}

TEST(Yi2013, ClonesAndThreadsAndLookingTwiceChangeNothing) {
  Scene scene;
  scene.enters = 4;
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = method();
  for (int i = 0; i < 5; ++i) (void)next(*one, scene.frame(i), i);
  const auto copy = one->clone();
  (void)next(*copy, scene.frame(9), 9);  // of no consequence to the original
  const auto other = one->clone();
  for (int i = 5; i < 8; ++i) {
    const cv::Mat gray = scene.frame(i);
    cv::setNumThreads(4);
    Frame frame;
    frame.gray = gray;
    (void)other->detect({frame});  // judged, and not committed
    const MotionResult there = next(*other, gray, i, 4);
    cv::setNumThreads(1);
    const MotionResult here = next(*one, gray, i, 1);
    EXPECT_GT(cv::countNonZero(here.mask), 0);
    EXPECT_TRUE(same(here.mask, there.mask)) << i;
    EXPECT_EQ(here.figures, there.figures);
    const StageLog a = described(*one, gray, i, here), b = described(*other, gray, i, there);
    for (const char* id : {"mean_0", "mean_1", "sigma_0", "sigma_1", "age_0", "age_1", "matches"}) {
      ASSERT_NE(a.layer(id), nullptr) << id;
      EXPECT_TRUE(same(a.layer(id)->image, b.layer(id)->image)) << id << ", frame " << i;
    }
    EXPECT_FALSE(same(described(*copy, gray, i, copy->detect({frame})).layer("age_0")->image,
                      a.layer("age_0")->image));
  }
  cv::setNumThreads(threads);
}

TEST(Yi2013, FramesOfAnotherSizeBeginTheModelAnew) {
  const Scene scene;
  const auto seasoned = method(), fresh = method();
  for (int i = 0; i < 4; ++i) (void)next(*seasoned, scene.frame(i), i);
  // As many blocks as before, so that only the frames' size tells.
  for (int i = 4; i < 8; ++i) {
    const cv::Mat wider = [&] {
      cv::Mat image;
      cv::resize(scene.frame(i), image, {642, 480});
      return image;
    }();
    const MotionResult a = next(*seasoned, wider, i), b = next(*fresh, wider, i);
    EXPECT_TRUE(same(a.mask, b.mask));
    EXPECT_EQ(a.note.empty(), i > 4) << a.note;
    EXPECT_EQ(a.figures.empty(), i == 4);
  }
}

TEST(Yi2013, SaysWhenThereIsNothingToFollow) {
  const cv::Mat flat(480, 640, CV_8UC1, cv::Scalar(90));
  const auto yi = method();
  (void)next(*yi, flat, 0);
  const MotionResult result = next(*yi, flat, 1);
  EXPECT_EQ(result.note, "only 0 points could be followed: the camera is taken to be static");
  const StageLog log = described(*yi, flat, 1, result);
  EXPECT_EQ(cv::norm(*log.backward - cv::Matx33d::eye()), 0.0);
  EXPECT_EQ(next(*method(), cv::Mat(3, 3, CV_8UC1, cv::Scalar(0)), 0).note,
            "the image is smaller than a block of the background model");
}

TEST(Yi2013, ThePresetHoldsThePublishedConstants) {
  const Config config = load_config("yi2013");
  EXPECT_EQ(config.run.method, "yi2013");
  EXPECT_EQ(config.of<Yi2013Config>(), Yi2013Config());
}

TEST(Yi2013, NoOtherFigureBearsItsFiguresNames) {
  // A figure whose name is taken is left out of the list.
  for (const FigureInfo& mine : method_named("yi2013").figures) {
    int listed = 0;
    for (const FigureInfo& info : frame_figure_infos()) listed += info.help == mine.help ? 1 : 0;
    EXPECT_EQ(listed, 1) << mine.name;
  }
}

TEST(Yi2013, ARunGivesTheSameBytesWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 6);
  Config config;
  config.run.method = "yi2013";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  EXPECT_GT(one.records.back().mask_share, 0.0);
  ASSERT_EQ(one.records.back().motion_figures.size(), 3U);
  EXPECT_EQ(one.records.back().motion_figures[0].name, "yi2013_tracks");
}

}  // namespace
}  // namespace stillpoint
