// What the paper's method does many pixels at once, held against doing it one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/motion/paper/block_warp.hpp"
#include "core/motion/paper/cleanup.hpp"
#include "core/motion/paper/corner_candidates.hpp"
#include "core/motion/paper/corners.hpp"
#include "core/motion/paper/difference.hpp"
#include "core/motion/paper/gray_warp.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

using motion_test::textured_image;

// Widths of no group, of whole groups, and of some and a rest.
const std::vector<cv::Size> kSizes = {{3, 3},   {5, 40},  {8, 9},    {9, 10},    {17, 12}, {33, 31},
                                      {64, 48}, {65, 17}, {127, 30}, {200, 150}, {301, 77}};

class PaperWide : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_wide_lanes()) GTEST_SKIP() << "the processor has no AVX2";
  }
  cv::Mat noise(const cv::Size& size, int type, double least, double most) {
    cv::Mat made(size, type);
    random_.fill(made, cv::RNG::UNIFORM, least, most);
    return made;
  }
  /// 0 or 255, the latter in a share of the pixels.
  cv::Mat mask(const cv::Size& size, double share) { return noise(size, CV_8UC1, 0, 256) < share * 256.0; }
  cv::RNG random_{42};
};

TEST_F(PaperWide, CornersAreThoseOfOneByOne) {
  std::size_t found = 0;
  for (const cv::Size& size : kSizes) {
    // As strong as Scharr's derivatives get, where sums are rounded; of few values, so that many are alike.
    for (const int most : {4080, 300, 2}) {
      const cv::Mat gradients = noise(size, CV_16SC2, -most, most + 1);
      const auto plain = corner_candidates(gradients, 0.01, false);
      EXPECT_TRUE(corner_candidates(gradients, 0.01, true) == plain) << size << most;
      found += plain.size();
    }
  }
  EXPECT_GT(found, 10000U);
}

TEST_F(PaperWide, CornersOfAPartOfAnImageAreThoseOfItsCopy) {
  const cv::Mat gradients = noise({120, 90}, CV_16SC2, -900, 900);
  const cv::Mat part = gradients(cv::Rect(13, 7, 77, 50));
  EXPECT_TRUE(corner_candidates(part, 0.05, true) == corner_candidates(part.clone(), 0.05, false));
}

TEST(PaperCorners, AreTheStrongestThatLieFarEnoughApart) {
  cv::RNG random(3);
  cv::Mat gradients(120, 230, CV_16SC2);
  random.fill(gradients, cv::RNG::UNIFORM, -900, 900);
  for (const double distance : {1.0, 1.5, 5.0, 12.0, 70.3}) {
    std::vector<cv::Point2f> expected;
    for (const CornerCandidate& candidate : corner_candidates(gradients, 0.01)) {
      const cv::Point at = candidate.at;
      const bool is_free = std::all_of(expected.begin(), expected.end(), [&](const cv::Point2f& other) {
        const cv::Point apart = cv::Point(other) - at;
        return apart.dot(apart) >= distance * distance;
      });
      if (is_free && expected.size() < 200) expected.emplace_back(at);
    }
    EXPECT_EQ(find_corners(gradients, 200, 0.01, distance), expected) << distance;
  }
}

TEST_F(PaperWide, DifferencesAndExposuresAreThoseOfFewerAtOnce) {
  for (const cv::Size& size : kSizes) {
    const cv::Mat carried = noise(size, CV_8UC1, 0, 256), valid = mask(size, 0.8);
    const cv::Mat there = noise(size, CV_8UC1, 0, 256);
    EXPECT_EQ(cv::countNonZero(frame_difference(there, carried, valid, true) !=
                               frame_difference(there, carried, valid, false)),
              0)
        << size;
    for (const double ratio : {0.6, 0.97, 0.98, 0.985, 1.0, 1.015, 1.02, 1.03, 1.9}) {
      cv::Mat brighter;
      carried.convertTo(brighter, CV_8U, ratio);
      EXPECT_EQ(exposure_ratio(brighter, carried, valid, true),
                exposure_ratio(brighter, carried, valid, false))
          << size << ratio;
    }
  }
}

TEST_F(PaperWide, ExposuresTurnAtTheSameLevels) {
  // Every pair of levels by itself: which side of each bound it falls on shows in the ratio.
  const cv::Mat valid(4, 70, CV_8UC1, cv::Scalar(255));
  int told = 0;
  for (int from = 46; from < 219; from += 3)
    for (int to = 40; to < 222; ++to) {
      const cv::Mat a(4, 70, CV_8UC1, cv::Scalar(to)), b(4, 70, CV_8UC1, cv::Scalar(from));
      const double ratio = exposure_ratio(a, b, valid, true);
      EXPECT_EQ(ratio, exposure_ratio(a, b, valid, false)) << to << " " << from;
      if (ratio != 1.0) ++told;
    }
  EXPECT_GT(told, 3000);
}

TEST_F(PaperWide, MasksAreThoseOfFewerAtOnce) {
  PaperConfig config;
  config.erode_kernel_px = 2;
  for (const cv::Size& size : kSizes) {
    const cv::Mat raw = mask(size, 0.9), valid = mask(size, 0.7);
    const cv::Mat plain = clean_mask(raw, valid, config, false);
    EXPECT_EQ(cv::countNonZero(clean_mask(raw, valid, config, true) != plain), 0) << size;
    if (size.area() > 2000) {
      EXPECT_GT(cv::countNonZero(plain), 0) << size;
    }
  }
}

TEST_F(PaperWide, WhatIsAboveAThresholdIsOpenCvs) {
  for (const cv::Size& size : kSizes) {
    const cv::Mat image = noise(size, CV_8UC1, 0, 256);
    for (const double threshold :
         {-3.0, -1.0, -0.5, 0.0, 0.4, 17.0, 17.9, 127.0, 128.0, 253.0, 254.0, 254.5, 255.0, 300.0}) {
      cv::Mat expected;
      cv::threshold(image, expected, threshold, 255, cv::THRESH_BINARY);
      EXPECT_EQ(cv::countNonZero(binarise(image, threshold, true) != expected), 0) << size << threshold;
    }
  }
}

TEST_F(PaperWide, HistogramsCountEachPixel) {
  for (const cv::Size& size : kSizes)
    for (const int most : {8, 32, 33, 40, 256}) {  // pairs of levels below 32 are counted at once
      const cv::Mat image = noise(size, CV_8UC1, 0, most), valid = mask(size, 0.8);
      Histogram expected{};
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          if (valid.at<uchar>(y, x) != 0) ++expected[image.at<uchar>(y, x)];
      EXPECT_EQ(histogram(image, valid), expected) << size << most;
    }
}

TEST(GrayWarp, IsOpenCvsOfManySlightMotions) {
  cv::RNG random(7);
  for (int i = 0; i < 120; ++i) {
    const cv::Size size(random.uniform(1, 400), random.uniform(1, 120));
    const cv::Mat image = textured_image(size, static_cast<unsigned>(i));
    const double strength = std::pow(10.0, random.uniform(-3.0, 0.3));
    const double turn = 0.02 * strength * random.uniform(-1.0, 1.0);
    const double scale = 1.0 + 0.02 * strength * random.uniform(-1.0, 1.0);
    // Every fourth is a shift by 1/64 px and such, all of whose coordinates lie where rounding turns.
    const bool is_tie = i % 4 == 0;
    const cv::Point2d shift =
        is_tie ? cv::Point2d(random.uniform(-400, 400) / 64.0, random.uniform(-99, 99) / 64.0)
               : cv::Point2d(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
    const double tilt = is_tie ? 0.0 : 4e-5 * strength;
    const cv::Matx33d matrix(is_tie ? 1.0 : scale * std::cos(turn), is_tie ? 0.0 : -scale * std::sin(turn),
                             shift.x, is_tie ? 0.0 : scale * std::sin(turn),
                             is_tie ? 1.0 : scale * std::cos(turn), shift.y, tilt * random.uniform(-1.0, 1.0),
                             tilt * random.uniform(-1.0, 1.0), 1.0);
    cv::Mat expected;
    cv::warpPerspective(image, expected, matrix, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    EXPECT_EQ(cv::countNonZero(warp_gray(image, matrix) != expected), 0) << i << size << matrix;
  }
}

#if defined(__x86_64__)

TEST(BlockWarp, FillsNearlyAllOfASlightMotion) {
  if (!can_warp_blocks()) GTEST_SKIP() << "the processor has no AVX2, or no fused multiplication";
  const cv::Mat image = textured_image({640, 480}, 4);
  const cv::Matx33d back = motion_test::slight_motion().inv();
  const std::array<double, 9> m = std::to_array(back.val);
  const BlockWarp warp(image, m);
  int filled = 0, groups = 0;
  std::array<unsigned char, BlockWarp::kBlock> block{};
  for (int y = 20; y < 460; ++y)
    for (int x = BlockWarp::kBlock; x < 640 - BlockWarp::kBlock; x += BlockWarp::kBlock) {
      const WarpedRow row{m[0] * x + m[1] * y + m[2], m[3] * x + m[4] * y + m[5], m[6] * x + m[7] * y + m[8]};
      filled += std::popcount(warp.fill(row, {x, y}, BlockWarp::kBlock, block.data()));
      groups += BlockWarp::kBlock / BlockWarp::kGroup;
    }
  EXPECT_GT(filled, 0.95 * groups);
}

TEST(BlockWarp, LeavesCoordinatesWhereRoundingTurns) {
  if (!can_warp_blocks()) GTEST_SKIP() << "the processor has no AVX2, or no fused multiplication";
  const cv::Mat image = textured_image({640, 480}, 4);
  std::array<unsigned char, BlockWarp::kBlock> block{};
  const auto filled_by_shift = [&](double shift) {
    const std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};
    return BlockWarp(image, m).fill({64.0 + shift, 100.0, 1.0}, {64, 100}, BlockWarp::kBlock, block.data());
  };
  EXPECT_EQ(filled_by_shift(0.0), 0xFU);
  EXPECT_EQ(filled_by_shift(1.0 / 64), 0U);
  EXPECT_EQ(filled_by_shift(1.0 / 64 + 1e-7), 0U);
  EXPECT_EQ(filled_by_shift(1.0 / 64 + 1e-3), 0xFU);
  EXPECT_EQ(filled_by_shift(-700.0), 0U);  // from outside the image
}

#endif

}  // namespace
}  // namespace stillpoint
