#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/motion/epipolar/colour_motion.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

const std::string kData = places::source() + "/../shared/data/";
const cv::Size kSize(640, 480);

/// The man who walks through 16 frames of freiburg3_walking_rpy: outlines drawn by hand, px, by frame.
const std::map<int, std::vector<cv::Point>> kOutlines = {
    {3, {{457, 0},   {454, 21},  {451, 46},  {422, 54},  {382, 86},  {368, 123}, {360, 161},
         {349, 177}, {349, 214}, {359, 230}, {359, 268}, {360, 327}, {379, 348}, {382, 375},
         {363, 439}, {366, 480}, {478, 480}, {481, 428}, {494, 370}, {497, 343}, {500, 300},
         {502, 214}, {509, 161}, {505, 102}, {502, 78},  {521, 70},  {532, 54},  {556, 0}}},
    {7, {{504, 0},   {496, 27},  {482, 37},  {456, 40},  {442, 54},  {405, 80},  {391, 112}, {383, 155},
         {375, 198}, {382, 214}, {378, 268}, {378, 311}, {394, 345}, {405, 375}, {391, 445}, {394, 480},
         {496, 480}, {504, 418}, {515, 370}, {520, 343}, {520, 268}, {525, 209}, {533, 161}, {531, 102},
         {533, 80},  {541, 72},  {560, 56},  {584, 37},  {587, 0}}},
    {11, {{509, 0},   {508, 27},  {494, 37},  {475, 40},  {462, 56},  {422, 78},  {408, 118},
          {400, 161}, {395, 241}, {393, 305}, {406, 337}, {425, 353}, {435, 407}, {433, 480},
          {520, 480}, {526, 423}, {537, 370}, {540, 343}, {542, 289}, {545, 214}, {556, 150},
          {553, 91},  {556, 72},  {580, 54},  {607, 35},  {609, 0}}},
    {14, {{520, 0},   {514, 28},  {490, 27},  {468, 45},  {435, 70},  {422, 110}, {417, 160},
          {413, 215}, {413, 270}, {417, 310}, {430, 345}, {440, 352}, {446, 400}, {443, 440},
          {446, 480}, {540, 480}, {538, 450}, {550, 420}, {558, 385}, {560, 365}, {556, 345},
          {560, 335}, {558, 300}, {563, 280}, {565, 230}, {572, 180}, {574, 150}, {567, 110},
          {562, 85},  {570, 80},  {568, 66},  {580, 60},  {605, 40},  {615, 0}}},
    {15, {{536, 0},   {531, 29},  {515, 37},  {488, 54},  {448, 86},  {440, 118}, {434, 161}, {426, 214},
          {426, 268}, {434, 321}, {456, 348}, {466, 407}, {466, 480}, {565, 480}, {571, 428}, {579, 370},
          {582, 289}, {587, 214}, {592, 155}, {587, 96},  {582, 64},  {611, 51},  {627, 16},  {627, 0}}},
};

cv::Mat drawn(int frame) {
  cv::Mat mask = cv::Mat::zeros(kSize, CV_8UC1);
  cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{kOutlines.at(frame)}, cv::Scalar(255));
  return mask;
}

cv::Point2d middle(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask, true);
  return {m.m10 / m.m00, m.m01 / m.m00};
}

/// Distance to the outline, positive within, the mask's middle carried to `to`.
cv::Mat distance_about(const cv::Mat& mask, const cv::Point2d& to) {
  cv::Mat within, without, moved;
  cv::distanceTransform(mask, within, cv::DIST_L2, 5);
  cv::distanceTransform(255 - mask, without, cv::DIST_L2, 5);
  const cv::Point2d by = to - middle(mask);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, by.x, 0, 1, by.y);
  cv::warpAffine(within - without, moved, shift, kSize, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return moved;
}

/// Between two drawn outlines, what lies between them.
cv::Mat man(int frame) {
  const auto next = kOutlines.lower_bound(frame);
  if (next->first == frame) return drawn(frame);
  const int from = std::prev(next)->first, to = next->first;
  const double share = static_cast<double>(frame - from) / (to - from);
  const cv::Mat a = drawn(from), b = drawn(to);
  const cv::Point2d at = middle(a) * (1.0 - share) + middle(b) * share;
  return (distance_about(a, at) * (1.0 - share) + distance_about(b, at) * share) > 0.0;
}

double share_within(const cv::Mat& part, const cv::Mat& whole) {
  return static_cast<double>(cv::countNonZero(part & whole)) / cv::countNonZero(whole);
}

TEST(ColourMotionOfPeople, TheWalkingManIsMaskedFromTheFourthFrameOnAndWhatStandsStillIsNot) {
  if (!std::filesystem::exists(kData + "fr3_walking_rpy_16")) GTEST_SKIP() << "the real frames are not here";
  const auto source = open_sequence(kData + "fr3_walking_rpy_16");
  ASSERT_EQ(source->size(), 16);
  ColourMotionDetector detector(source->camera(), EpipolarConfig{});
  for (int i = 0; i < source->size(); ++i) {
    const Frame frame = source->read(i);
    const EpipolarTrace trace = detector.next(frame.colour, frame.timestamp);
    if (i < 3) continue;
    const cv::Mat truth = man(i);
    EXPECT_GT(share_within(trace.mask, truth), 0.5) << i;
    EXPECT_LT(share_within(trace.mask, ~truth), 0.02) << i;
  }
}

TEST(ColourMotionOfPeople, ARoomWithoutThemStaysNearlyEmpty) {
  if (!std::filesystem::exists(kData + "fr1_xyz_clip")) GTEST_SKIP() << "the real clip is not here";
  const auto source = open_sequence(kData + "fr1_xyz_clip");
  ColourMotionDetector detector(source->camera(), EpipolarConfig{});
  double masked = 0.0;
  constexpr int kFrames = 60;
  for (int i = 0; i < kFrames; ++i) {
    const Frame frame = source->read(i);
    masked += detector.next(frame.colour, frame.timestamp).mask_share / kFrames;
  }
  EXPECT_LT(masked, 0.003);
}

}  // namespace
}  // namespace stillpoint
