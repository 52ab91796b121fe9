#include "core/motion/epipolar/colour_outline.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

const cv::Rect kThing(40, 30, 60, 50), kSure(55, 45, 30, 20), kMaybe(20, 15, 100, 80);

cv::Mat filled(const cv::Rect& box) {
  cv::Mat mask = cv::Mat::zeros(120, 160, CV_8UC1);
  mask(box).setTo(255);
  return mask;
}

/// @param type CV_8UC3 or CV_8UC1
cv::Mat picture(int type) {
  cv::Mat image(120, 160, type, cv::Scalar(60, 90, 140));
  image(kThing).setTo(cv::Scalar(170, 60, 50));
  return image;
}

TEST(ColourOutline, AMaskEndsWhereItsColoursDo) {
  for (const int type : {CV_8UC3, CV_8UC1}) {
    const cv::Mat settled = settle_outline(picture(type), filled(kSure), filled(kMaybe), 10);
    cv::Mat wrong = settled != filled(kThing), edge;
    cv::Mat band = filled(kThing);
    cv::morphologyEx(band, edge, cv::MORPH_GRADIENT, cv::Mat::ones(5, 5, CV_8UC1));
    EXPECT_EQ(cv::countNonZero(wrong & ~edge), 0) << type;
  }
}

TEST(ColourOutline, WhatIsSureStaysAndNothingIsAddedBeyondDoubt) {
  cv::Mat image(120, 160, CV_8UC3);
  cv::RNG random(3);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  const cv::Mat settled = settle_outline(image, filled(kSure), filled(kMaybe), 10);
  EXPECT_EQ(cv::countNonZero(filled(kSure) & ~settled), 0);
  EXPECT_EQ(cv::countNonZero(settled & ~filled(kMaybe)), 0);
}

TEST(ColourOutline, ColoursThatTellNothingAddNothing) {
  const cv::Mat plain(120, 160, CV_8UC3, cv::Scalar(80, 80, 80));
  EXPECT_EQ(cv::norm(settle_outline(plain, filled(kSure), filled(kMaybe), 10), filled(kSure), cv::NORM_INF),
            0.0);
  const cv::Mat none = cv::Mat::zeros(120, 160, CV_8UC1);
  EXPECT_EQ(cv::countNonZero(settle_outline(picture(CV_8UC3), none, none, 10)), 0);
}

}  // namespace
}  // namespace stillpoint
