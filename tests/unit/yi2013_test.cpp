#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/config.hpp"
#include "core/motion/yi2013/block_model.hpp"

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

}  // namespace
}  // namespace stillpoint
