// Truth by hand: outlines become masks, masks are carried to other frames, and the sequence has them after.
#include "core/inspect/drawn_truth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "core/error.hpp"
#include "core/evaluation/mask_scores.hpp"
#include "core/inspect/mask_carrying.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

double iou_of(const cv::Mat& mask, const cv::Mat& truth) {
  return score_mask(mask, truth).iou().value_or(0.0);
}

TEST(DrawnTruth, AnOutlineHoldsThePixelsBetweenItsCornersAndThoseUnderThem) {
  const Outline square = {{10, 20}, {19, 20}, {19, 24}, {10, 24}};
  const cv::Mat mask = mask_of_outlines({square}, {40, 30});
  EXPECT_EQ(cv::countNonZero(mask), 10 * 5);
  EXPECT_EQ(mask.at<uchar>(20, 10), 255);
  EXPECT_EQ(mask.at<uchar>(19, 10), 0);
  const Outline beyond = {{30, 10}, {60, 10}, {60, 50}, {30, 50}};
  EXPECT_EQ(cv::countNonZero(mask_of_outlines({square, beyond}, {40, 30})), 50 + 10 * 20);
  EXPECT_EQ(cv::countNonZero(mask_of_outlines({}, {40, 30})), 0);
}

TEST(DrawnTruth, AMasksOutlinesMakeItAgain) {
  const cv::Mat truth = rendered("walking_xyz", 12)->truth(10).moving;
  ASSERT_GT(cv::countNonZero(truth), 5000);
  const std::vector<Outline> outlines = outlines_of_mask(truth);
  ASSERT_FALSE(outlines.empty());
  EXPECT_GT(iou_of(mask_of_outlines(outlines, truth.size()), truth), 0.97);
  std::size_t corners = 0;
  for (const Outline& outline : outlines) corners += outline.size();
  EXPECT_LT(corners, 200U);  // so that they can be corrected by hand
}

TEST(DrawnTruth, FramesArePutInByTheirNumberAndTakenOut) {
  std::vector<DrawnFrame> drawn = with_drawn({}, {7, {}});
  drawn = with_drawn(drawn, {3, {{{1, 1}, {2, 1}, {2, 2}}}});
  drawn = with_drawn(drawn, {7, {{{5, 5}, {6, 5}, {6, 6}}}});
  ASSERT_EQ(drawn.size(), 2U);
  EXPECT_EQ(drawn[0].frame, 3);
  EXPECT_EQ(drawn[1].movers.size(), 1U);
  EXPECT_EQ(drawn_at(drawn, 4), nullptr);
  ASSERT_NE(drawn_at(without_drawn(drawn, 3), 7), nullptr);
  EXPECT_EQ(drawn_at(without_drawn(drawn, 3), 3), nullptr);
}

TEST(MaskCarrying, FollowsAMoverFromFrameToFrame) {
  const auto source = rendered("walking_xyz", 16);
  cv::Mat mask = source->truth(8).moving;
  const cv::Mat start = mask.clone();
  for (int i = 9; i <= 14; ++i) mask = carried_mask(source->read(i - 1), mask, source->read(i));
  const cv::Mat truth = source->truth(14).moving;
  EXPECT_GT(iou_of(mask, truth), 0.85);
  EXPECT_GT(iou_of(mask, truth), iou_of(start, truth) + 0.05);  // it moved
}

TEST(MaskCarrying, AnEmptyMaskStaysEmpty) {
  const auto source = rendered("walking_xyz", 12);
  const cv::Mat none = cv::Mat::zeros(source->read(0).gray.size(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero(carried_mask(source->read(4), none, source->read(5))), 0);
}

TEST(MaskCarrying, BetweenTwoMasksLiesTheOneHalfwayThere) {
  cv::Mat left = cv::Mat::zeros(60, 100, CV_8UC1), right = left.clone();
  left(cv::Rect(20, 20, 20, 20)) = 255;
  right(cv::Rect(28, 20, 20, 20)) = 255;
  cv::Mat expected = cv::Mat::zeros(60, 100, CV_8UC1);
  expected(cv::Rect(24, 20, 20, 20)) = 255;
  EXPECT_GT(iou_of(blended_mask(left, right, 0.5), expected), 0.88);
  EXPECT_EQ(cv::countNonZero(blended_mask(left, right, 0.0) != left), 0);
  EXPECT_EQ(cv::countNonZero(blended_mask(left, right, 1.0) != right), 0);
  const cv::Mat none = cv::Mat::zeros(60, 100, CV_8UC1);
  EXPECT_EQ(cv::countNonZero(blended_mask(left, none, 0.4) != left), 0);  // the nearer one's word stands
  EXPECT_EQ(cv::countNonZero(blended_mask(left, none, 0.6)), 0);
}

/// A rendered sequence in a folder, without its masks.
class WrittenTruth : public ::testing::Test {
 protected:
  static constexpr int kFrames = 13;

  WrittenTruth() : film_(rendered("walking_xyz", kFrames)) {
    write_sequence(*film_, folder_.path("s"));
    fs::remove_all(folder_.path("s/mask"));
    fs::remove(folder_.path("s/mask.txt"));
    source_ = open_sequence(folder_.path("s"));
  }
  [[nodiscard]] DrawnFrame drawn(int frame) const {
    return {frame, outlines_of_mask(film_->truth(frame).moving)};
  }
  [[nodiscard]] std::optional<CarriedTruth> write(const std::vector<DrawnFrame>& frames,
                                                  const ExportControl& control = {}) const {
    return write_drawn_truth(*source_, frames, folder_.path("s"), control);
  }
  [[nodiscard]] std::string problem(const std::vector<DrawnFrame>& frames) const {
    try {
      (void)write(frames);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  std::shared_ptr<const FrameSource> film_;
  TemporaryFolder folder_;
  std::unique_ptr<FrameSource> source_;
};

TEST_F(WrittenTruth, EveryFrameHasAMaskAfterwardsTheDrawnOnesTheirs) {
  ASSERT_FALSE(source_->has_masks());
  const auto carried = write({drawn(4), drawn(10)});
  ASSERT_TRUE(carried);
  EXPECT_EQ(carried->drawn, 2);
  EXPECT_EQ(carried->carried, kFrames - 2);
  ASSERT_EQ(carried->scores.size(), 2U);  // onwards and backwards
  EXPECT_GT(carried->scores[0].iou, 0.9);
  EXPECT_THAT(carried->told(), HasSubstr("13 masks: 2 drawn, 11 carried. Carried from one drawn frame"));
  const auto again = open_sequence(folder_.path("s"));
  ASSERT_TRUE(again->has_masks());
  for (int i = 0; i < kFrames; ++i)
    EXPECT_GT(iou_of(again->truth(i).moving, film_->truth(i).moving), i == 4 || i == 10 ? 0.97 : 0.85) << i;
  EXPECT_FALSE(fs::exists(folder_.path("s/mask.part")));
}

TEST_F(WrittenTruth, AFrameInWhichNothingMovesCountsAsDrawn) {
  ASSERT_TRUE(write({{0, {}}, {12, {}}}));
  const auto again = open_sequence(folder_.path("s"));
  ASSERT_TRUE(again->has_masks());
  EXPECT_EQ(cv::countNonZero(again->truth(6).moving), 0);
}

TEST_F(WrittenTruth, WhatWasDrawnEarlierIsReplacedAndMasksOfAnotherOriginAreNot) {
  ASSERT_TRUE(write({drawn(4)}));
  ASSERT_TRUE(write({drawn(4), drawn(8)}));
  EXPECT_THAT(folder_.read("s/mask.txt"), HasSubstr("drawn on frames 4, 8"));
  folder_.write("s/mask.txt", "1305031102.0 mask/000000.png\n");
  EXPECT_THAT(problem({drawn(4)}), HasSubstr("has masks that were not drawn here, and keeps them"));
  EXPECT_TRUE(fs::exists(folder_.path("s/mask/000000.png")));
}

TEST_F(WrittenTruth, StoppedItLeavesTheMasksAsTheyWere) {
  ASSERT_TRUE(write({drawn(4)}));
  const std::string before = folder_.read("s/mask.txt");
  const std::atomic<bool> stop = true;
  ExportControl control;
  control.stop = &stop;
  EXPECT_FALSE(write({drawn(6)}, control));
  EXPECT_EQ(folder_.read("s/mask.txt"), before);
  EXPECT_FALSE(fs::exists(folder_.path("s/mask.part")));
}

TEST_F(WrittenTruth, AFrameThatCannotBeReadHasNoMaskAndIsTold) {
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(folder_.path("s/rgb"))) images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  ASSERT_EQ(images.size(), static_cast<std::size_t>(kFrames));
  folder_.write("s/rgb/" + images[6].filename().string(), std::string("no image"));
  source_ = open_sequence(folder_.path("s"));
  const auto carried = write({drawn(4), drawn(10)});
  ASSERT_TRUE(carried);
  EXPECT_THAT(carried->unreadable, ElementsAre(6));
  EXPECT_THAT(carried->told(), HasSubstr("frames 6 cannot be read"));
  EXPECT_THAT(problem({{6, {}}}), HasSubstr("frame 6, which was drawn, cannot be read"));
  EXPECT_THAT(problem({}), HasSubstr("no frame has been drawn yet"));
}

}  // namespace
}  // namespace stillpoint
