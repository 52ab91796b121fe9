#include "core/run/figure_pairs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;

FigurePairs pairs_of(std::vector<double> x, std::vector<double> y) {
  return {std::move(x), std::move(y), {}};
}

TEST(FigurePairsOfAFrame, AreThoseOfWhichBothAreKnownInOrderOfTheFirst) {
  std::vector<FrameRecord> records(4);
  for (int i = 0; i < 4; ++i) {
    records[static_cast<std::size_t>(i)].index = 10 + i;
    records[static_cast<std::size_t>(i)].inliers = 40 - 10 * i;
    records[static_cast<std::size_t>(i)].status = FrameStatus::tracked;
    records[static_cast<std::size_t>(i)].estimated = true;
    records[static_cast<std::size_t>(i)].matches = 100 + i;
    records[static_cast<std::size_t>(i)].rms_px = i == 2 ? std::nan("") : 0.5 * (i + 1);
  }
  const MeasuredFrames measured{records};
  const FigurePairs inliers = figure_pairs(measured, frame_figure("inliers"), frame_figure("matches"));
  EXPECT_THAT(inliers.frames, ElementsAre(13, 12, 11, 10));
  EXPECT_THAT(inliers.x, ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(inliers.y, ElementsAre(103, 102, 101, 100));
  EXPECT_NEAR(rank_correlation(inliers).value(), -1.0, 1e-12);
  const int residual = frame_figure("residual");
  ASSERT_GE(residual, 0);
  EXPECT_THAT(figure_pairs(measured, frame_figure("inliers"), residual).frames, ElementsAre(13, 11, 10));
}

TEST(RankCorrelation, GoesByRanksAlone) {
  EXPECT_NEAR(rank_correlation(pairs_of({1, 2, 3, 4}, {1, 10, 100, 1e6})).value(), 1.0, 1e-12);
  // By hand: ranks 0 1 2 3 4 and 1 0 3 2 4: 1 - 6 * 4 / (5 * 24) = 0.8.
  EXPECT_NEAR(rank_correlation(pairs_of({1, 2, 3, 4, 5}, {20, 10, 40, 30, 50})).value(), 0.8, 1e-12);
  // Ties share their mean rank: x 0 0.. , ranks of y 0.5 0.5 2.
  EXPECT_NEAR(rank_correlation(pairs_of({1, 2, 3}, {7, 7, 9})).value(), 1.5 / std::sqrt(2.0 * 1.5), 1e-12);
  EXPECT_FALSE(rank_correlation(pairs_of({1, 2}, {1, 2})));
  EXPECT_FALSE(rank_correlation(pairs_of({1, 2, 3}, {5, 5, 5})));
}

}  // namespace
}  // namespace stillpoint
