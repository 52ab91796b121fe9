// How far features are believed to are static.
#include "core/odometry/static_weight.hpp"

#include <gtest/gtest.h>

#include "core/odometry/odometry.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

TEST(StaticWeight, IsHalfAtItsLogOddsAndFallsBeyond) {
  cv::Mat log_odds(2, 3, CV_32FC1, cv::Scalar(-2.0));
  log_odds.at<float>(1, 0) = -4.0F;
  log_odds.at<float>(0, 2) = 0.0F;
  // Pixels of an image four times as large.
  const auto weight = static_weights_at({{5, 1}, {2, 6}, {11, 3}}, log_odds, {12, 8}, -2.0);
  ASSERT_EQ(weight.size(), 3U);
  EXPECT_FLOAT_EQ(weight[0], 0.5F);
  EXPECT_NEAR(weight[1], 0.9820, 1e-4);  // 1 / (1 + e^-4)
  EXPECT_NEAR(weight[2], 0.0180, 1e-4);
}

TEST(StaticWeight, IsWholeWhereNothingIsKnown) {
  EXPECT_EQ(static_weights_at({{0, 0}, {639, 479}}, {}, {640, 480}, -2.0), (std::vector<float>{1.0F, 1.0F}));
}

TEST(StaticWeight, PixelsAtTheRimAreReadAtTheRim) {
  cv::Mat log_odds(2, 2, CV_32FC1, cv::Scalar(-2.0));
  log_odds.at<float>(1, 1) = 10.0F;
  const auto weight = static_weights_at({{7.9F, 7.9F}, {-0.4F, -0.4F}}, log_odds, {8, 8}, -2.0);
  EXPECT_LT(weight[0], 1e-6F);
  EXPECT_FLOAT_EQ(weight[1], 0.5F);
}

TEST(StaticWeight, EachPixelOfAnImageHasItsOwn) {
  // As large as the log-odds, twice and four times as large.
  cv::Mat log_odds(1, 8, CV_32FC1);
  for (int x = 0; x < log_odds.cols; ++x) log_odds.at<float>(0, x) = x % 2 == 0 ? -10.0F : -2.0F;
  for (const int factor : {1, 2, 4}) {
    const cv::Mat weight = static_weight_image(log_odds, {8 * factor, factor}, -2.0);
    ASSERT_EQ(weight.size(), cv::Size(8 * factor, factor));
    for (int x = 0; x < weight.cols; ++x)
      EXPECT_NEAR(weight.at<float>(factor - 1, x), x / factor % 2 == 0 ? 1.0 : 0.5, 1e-6)
          << factor << ", " << x;
  }
}

TEST(StaticWeight, WhereLittleIsKnownTheRestIsBelieved) {
  std::vector<float> known{0.9F, 0.9F, 0.9F, 0.1F};  // mean 0.7: at least 0.09
  raise_least_weight({1, 1, 1, 1}, known);
  EXPECT_EQ(known, (std::vector<float>{0.9F, 0.9F, 0.9F, 0.1F}));
  std::vector<float> unknown{0.8F, 0.0F, 0.0F, 0.0F};  // mean 0.2
  raise_least_weight({1, 1, 1, 1}, unknown);
  EXPECT_EQ(unknown[0], 0.8F);
  for (std::size_t i = 1; i < unknown.size(); ++i) EXPECT_NEAR(unknown[i], 0.64, 1e-6);
}

TEST(StaticWeight, WhatIsRemovedNeitherCountsNorChanges) {
  std::vector<float> weight{1.0F, 1.0F, 0.0F, 0.0F};
  raise_least_weight({1, 1, 0, 0}, weight);
  EXPECT_EQ(weight, (std::vector<float>{1.0F, 1.0F, 0.0F, 0.0F}));
  raise_least_weight({0, 0, 0, 0}, weight);
  EXPECT_EQ(weight[2], 0.0F);
}

/// Mean weight of what was kept, on what is truly dynamic and on what is static, over frames of slow people.
struct MeanWeight {
  double moving = 0.0, still = 0.0;
};

MeanWeight mean_weight(const Config& config) {
  const auto source = rendered("sitting_static", 40);
  Odometry odometry(source->camera(), config);
  double sum[2] = {}, count[2] = {};
  for (int i = 0; i < source->size(); ++i) {
    const FrameResult result = odometry.process(source->read(i));
    if (i < 25) continue;  // until there is a frame far enough back for slow dynamic objects
    const cv::Mat truth = source->truth(i).moving;
    for (const FeatureRecord& f : result.record.features) {
      if (f.fate == FeatureFate::removed) continue;
      const bool moves = truth.at<uchar>(cvRound(f.pixel.y), cvRound(f.pixel.x)) != 0;
      sum[moves ? 1 : 0] += static_cast<double>(f.static_weight);
      ++count[moves ? 1 : 0];
    }
  }
  return {sum[1] / count[1], sum[0] / count[0]};
}

TEST(StaticWeight, WhatWasLeftInAndMovesWeighsLess) {
  Config config;
  config.run.method = "stillpoint";
  const MeanWeight soft = mean_weight(config);
  EXPECT_GT(soft.still, 0.8);
  EXPECT_LT(soft.moving, soft.still - 0.15);
  config.tracking.soft_weights = 0;
  const MeanWeight hard = mean_weight(config);
  EXPECT_EQ(hard.still, 1.0);
  EXPECT_EQ(hard.moving, 1.0);
}

}  // namespace
}  // namespace stillpoint
