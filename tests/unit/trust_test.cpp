// How far features are believed to stand still.
#include "core/odometry/trust.hpp"

#include <gtest/gtest.h>

#include "core/odometry/odometry.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

TEST(Trust, IsHalfAtItsLogOddsAndFallsBeyond) {
  cv::Mat log_odds(2, 3, CV_32FC1, cv::Scalar(-2.0));
  log_odds.at<float>(1, 0) = -4.0F;
  log_odds.at<float>(0, 2) = 0.0F;
  // Pixels of an image four times as large.
  const auto trust = trust_at({{5, 1}, {2, 6}, {11, 3}}, log_odds, {12, 8}, -2.0);
  ASSERT_EQ(trust.size(), 3U);
  EXPECT_FLOAT_EQ(trust[0], 0.5F);
  EXPECT_NEAR(trust[1], 0.9820, 1e-4);  // 1 / (1 + e^-4)
  EXPECT_NEAR(trust[2], 0.0180, 1e-4);
}

TEST(Trust, IsWholeWhereNothingIsKnown) {
  EXPECT_EQ(trust_at({{0, 0}, {639, 479}}, {}, {640, 480}, -2.0), (std::vector<float>{1.0F, 1.0F}));
}

TEST(Trust, PixelsAtTheRimAreReadAtTheRim) {
  cv::Mat log_odds(2, 2, CV_32FC1, cv::Scalar(-2.0));
  log_odds.at<float>(1, 1) = 10.0F;
  const auto trust = trust_at({{7.9F, 7.9F}, {-0.4F, -0.4F}}, log_odds, {8, 8}, -2.0);
  EXPECT_LT(trust[0], 1e-6F);
  EXPECT_FLOAT_EQ(trust[1], 0.5F);
}

TEST(Trust, WhereLittleIsKnownTheRestIsBelieved) {
  std::vector<float> known{0.9F, 0.9F, 0.9F, 0.1F};  // mean 0.7: at least 0.09
  raise_least_trust({1, 1, 1, 1}, known);
  EXPECT_EQ(known, (std::vector<float>{0.9F, 0.9F, 0.9F, 0.1F}));
  std::vector<float> unknown{0.8F, 0.0F, 0.0F, 0.0F};  // mean 0.2
  raise_least_trust({1, 1, 1, 1}, unknown);
  EXPECT_EQ(unknown[0], 0.8F);
  for (std::size_t i = 1; i < unknown.size(); ++i) EXPECT_NEAR(unknown[i], 0.64, 1e-6);
}

TEST(Trust, WhatIsRemovedNeitherCountsNorChanges) {
  std::vector<float> trust{1.0F, 1.0F, 0.0F, 0.0F};
  raise_least_trust({1, 1, 0, 0}, trust);
  EXPECT_EQ(trust, (std::vector<float>{1.0F, 1.0F, 0.0F, 0.0F}));
  raise_least_trust({0, 0, 0, 0}, trust);
  EXPECT_EQ(trust[2], 0.0F);
}

/// Mean trust of what was kept, on what truly moves and on what stands still, over frames of slow people.
struct MeanTrust {
  double moving = 0.0, still = 0.0;
};

MeanTrust mean_trust(const Config& config) {
  OpenOptions options;
  options.frames = 40;
  const auto source = open_sequence("generated:sitting_static", options);
  Odometry odometry(source->camera(), config);
  double sum[2] = {}, count[2] = {};
  for (int i = 0; i < source->size(); ++i) {
    const FrameResult result = odometry.process(source->read(i));
    if (i < 25) continue;  // until there is a frame far enough back for slow movers
    const cv::Mat truth = source->truth(i).moving;
    for (const FeatureRecord& f : result.record.features) {
      if (f.fate == FeatureFate::removed) continue;
      const bool moves = truth.at<uchar>(cvRound(f.pixel.y), cvRound(f.pixel.x)) != 0;
      sum[moves ? 1 : 0] += static_cast<double>(f.trust);
      ++count[moves ? 1 : 0];
    }
  }
  return {sum[1] / count[1], sum[0] / count[0]};
}

TEST(Trust, WhatWasLeftInAndMovesIsTrustedLess) {
  Config config;
  config.run.method = "stillpoint";
  const MeanTrust soft = mean_trust(config);
  EXPECT_GT(soft.still, 0.8);
  EXPECT_LT(soft.moving, soft.still - 0.15);
  config.tracking.soft_weights = 0;
  const MeanTrust hard = mean_trust(config);
  EXPECT_EQ(hard.still, 1.0);
  EXPECT_EQ(hard.moving, 1.0);
}

}  // namespace
}  // namespace stillpoint
