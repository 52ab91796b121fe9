#include "core/evaluation/mask_scores.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/evaluation/evaluation_json.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

cv::Mat mask_of(const cv::Rect& box) {
  cv::Mat mask = cv::Mat::zeros(10, 20, CV_8UC1);
  mask(box) = 255;
  return mask;
}

TEST(MaskScore, CountsAgreeWithTwoOverlappingBoxes) {
  // Found 4x4 and true 6x4 share 2x4.
  const MaskScore score = score_mask(mask_of({0, 0, 4, 4}), mask_of({2, 0, 6, 4}));
  EXPECT_EQ(score.found_rightly, 8);
  EXPECT_EQ(score.found_wrongly, 8);
  EXPECT_EQ(score.missed, 16);
  EXPECT_EQ(score.left_rightly, 200 - 32);
  EXPECT_DOUBLE_EQ(*score.precision(), 0.5);
  EXPECT_DOUBLE_EQ(*score.recall(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(*score.iou(), 0.25);
}

TEST(MaskScore, AccumulatesPixelsNotShares) {
  MaskScore sum = score_mask(mask_of({0, 0, 4, 4}), mask_of({0, 0, 4, 4}));
  sum += score_mask(cv::Mat(), mask_of({0, 0, 4, 4}));
  EXPECT_DOUBLE_EQ(*sum.recall(), 0.5);
  EXPECT_DOUBLE_EQ(*sum.precision(), 1.0);
  EXPECT_EQ(sum.found_rightly + sum.found_wrongly + sum.missed + sum.left_rightly, 400);
}

TEST(MaskScore, IsUndefinedRatherThanInventedWhenNothingMoves) {
  const cv::Mat still = cv::Mat::zeros(10, 20, CV_8UC1);
  const MaskScore nothing = score_mask(cv::Mat(), still);
  EXPECT_FALSE(nothing.precision());
  EXPECT_FALSE(nothing.recall());
  EXPECT_FALSE(nothing.iou());
  EXPECT_EQ(nothing.left_rightly, 200);
  EXPECT_EQ(*score_mask(mask_of({0, 0, 1, 1}), still).precision(), 0.0);
  EXPECT_EQ(score_mask(mask_of({0, 0, 1, 1}), cv::Mat()).found_wrongly, 0);
  const nlohmann::json json = nothing;
  EXPECT_TRUE(json["recall"].is_null());
}

TEST(MaskScore, RefusesMasksOfAnotherSize) {
  EXPECT_THAT(input_error_of([] {
                (void)score_mask(cv::Mat::zeros(5, 5, CV_8UC1), mask_of({0, 0, 1, 1}));
              }),
              testing::HasSubstr("a mask of 5x5 px cannot be scored against a truth of 20x10 px"));
}

TEST(RemovalScore, TellsRightFromWrong) {
  const cv::Mat truth = mask_of({0, 0, 10, 10});  // the left half moves
  const RemovalScore score = score_removal({{{1, 1}, true},
                                            {{2, 2}, true},
                                            {{9.4F, 3}, true},
                                            {{9.6F, 3}, true},
                                            {{3, 3}, false},
                                            {{15, 5}, false},
                                            {{25, 5}, false},
                                            {{-3, 5}, false}},
                                           truth);
  EXPECT_EQ(score.removed_rightly, 3);
  EXPECT_EQ(score.removed_wrongly, 1);
  EXPECT_EQ(score.kept_wrongly, 2);
  EXPECT_EQ(score.kept_rightly, 2);
  EXPECT_DOUBLE_EQ(*score.precision(), 0.75);
  EXPECT_DOUBLE_EQ(*score.recall(), 0.6);
  RemovalScore sum = score;
  sum += score;
  EXPECT_EQ(sum.removed_rightly, 6);
  EXPECT_FALSE(score_removal({{{1, 1}, true}}, cv::Mat()).precision());
}

}  // namespace
}  // namespace stillpoint
