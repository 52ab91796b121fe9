#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/motion/paper/cleanup.hpp"
#include "core/motion/paper/compensation.hpp"
#include "core/motion/paper/corners.hpp"
#include "core/motion/paper/difference.hpp"
#include "core/motion/paper/homography.hpp"
#include "core/motion/regions.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

using motion_test::slight_motion;
using motion_test::textured_image;

const cv::Size kImageSize(640, 480);

cv::Mat all_valid(const cv::Size& size) { return {size, CV_8UC1, cv::Scalar(255)}; }

/// Scharr derivatives as the Lucas-Kanade pyramid holds them.
cv::Mat gradients_of(const cv::Mat& gray) {
  cv::Mat dx, dy, both;
  cv::Scharr(gray, dx, CV_16S, 1, 0);
  cv::Scharr(gray, dy, CV_16S, 0, 1);
  cv::merge(std::vector<cv::Mat>{dx, dy}, both);
  return both;
}

TEST(Corners, LieAtTheCornersOfARectangle) {
  cv::Mat image(120, 160, CV_8UC1, cv::Scalar(60));
  image(cv::Rect(40, 30, 60, 50)).setTo(200);
  const auto corners = find_corners(gradients_of(image), 100, 0.1, 10);
  ASSERT_EQ(corners.size(), 4U);
  for (const cv::Point2f expected : {cv::Point2f(40, 30), {99, 30}, {40, 79}, {99, 79}}) {
    const auto near = std::count_if(corners.begin(), corners.end(), [&](const cv::Point2f& corner) {
      return cv::norm(corner - expected) <= 1.5;
    });
    EXPECT_EQ(near, 1) << expected;
  }
}

TEST(Corners, AreThoseOfTheSmallerEigenvalue) {
  const cv::Mat image = textured_image({200, 150}, 31);
  const auto corners = find_corners(gradients_of(image), 40, 0.01, 12);
  ASSERT_EQ(corners.size(), 40U);
  // OpenCV's own response, from Scharr derivatives too (aperture -1), summed over 3x3.
  cv::Mat response;
  cv::cornerMinEigenVal(image, response, 3, cv::FILTER_SCHARR);
  float last = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point at(corners[i]);
    const float value = response.at<float>(at);
    EXPECT_LE(value, last * 1.0001F) << "strongest first";
    last = value;
    double largest = 0.0;
    cv::minMaxLoc(response(cv::Rect(at.x - 1, at.y - 1, 3, 3)), nullptr, &largest);
    EXPECT_GE(value, largest * 0.9999) << "a local maximum";
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(cv::norm(corners[i] - corners[j]), 12.0);
  }
}

TEST(Corners, FlatImagesAndEdgesHaveNone) {
  EXPECT_TRUE(find_corners(gradients_of(cv::Mat(50, 50, CV_8UC1, cv::Scalar(90))), 10, 0.01, 5).empty());
  cv::Mat edge(50, 50, CV_8UC1, cv::Scalar(90));
  edge.colRange(25, 50).setTo(180);
  EXPECT_TRUE(find_corners(gradients_of(edge), 10, 0.01, 5).empty());
}

TEST(Compensation, WarpByHomographyAndItsInverseReturnsTheImage) {
  cv::Mat image;
  cv::GaussianBlur(textured_image(kImageSize, 3), image, {0, 0}, 2.0);
  const cv::Matx33d there = slight_motion();
  const CompensatedFrame gone = compensate(image, there, 3);
  const CompensatedFrame back = compensate(gone.image, there.inv(), 3);
  const cv::Mat known = back.valid & valid_area(kImageSize, cv::Matx33d::eye(), 12);
  EXPECT_GT(cv::countNonZero(known), 640 * 480 * 9 / 10);
  cv::Mat off;
  cv::absdiff(image, back.image, off);
  EXPECT_LT(cv::mean(off, known)[0], 1.0);  // grey levels; two bilinear readings of a blurred image
  double largest = 0.0;
  cv::minMaxLoc(off, nullptr, &largest, nullptr, nullptr, known);
  EXPECT_LE(largest, 8.0);
}

TEST(Compensation, WholePixelShiftIsExactAndItsBorderIsNotValid) {
  const cv::Mat image = textured_image({50, 40}, 5);
  const CompensatedFrame moved = compensate(image, {1, 0, 4, 0, 1, -7, 0, 0, 1}, 3);
  // Destination x in [4, 50) and y in [0, 33) have data; three pixels inside the source's edge are taken off.
  const cv::Rect data(4, 0, 46, 33);
  EXPECT_EQ(cv::norm(moved.image(data), image(cv::Rect(0, 7, 46, 33)), cv::NORM_INF), 0.0);
  cv::Mat expected = cv::Mat::zeros(40, 50, CV_8UC1);
  // Left margin: source x >= 3 -> destination x >= 7; right: source x <= 46 -> x <= 50, cut at the image's
  // edge, 49.
  expected(cv::Rect(7, 0, 43, 30)).setTo(255);
  EXPECT_EQ(cv::norm(moved.valid, expected, cv::NORM_INF), 0.0);
}

TEST(Compensation, ValidAreaAgreesWithWarpingAWhiteImage) {
  const cv::Matx33d tilted(0.9, 0.1, 20, -0.15, 1.05, 11, 2e-4, -3e-4, 1);
  const cv::Mat ours = valid_area(kImageSize, tilted, 0);
  cv::Mat warped;
  cv::warpPerspective(all_valid(kImageSize), warped, tilted, kImageSize, cv::INTER_NEAREST);
  // Nearest-pixel warping also takes the half pixel beyond the edge: only the outline may differ.
  EXPECT_EQ(cv::countNonZero(ours & ~warped), 0);
  EXPECT_LT(cv::countNonZero(warped & ~ours), 2 * (640 + 480));
  EXPECT_GT(cv::countNonZero(ours), 100000);
}

TEST(Compensation, WarpedMaskAgreesWithWarpingTheWholeMask) {
  cv::Mat mask = cv::Mat::zeros(kImageSize, CV_8UC1);
  cv::circle(mask, {300, 200}, 60, 255, cv::FILLED);
  cv::rectangle(mask, {600, 400, 40, 80}, 255, cv::FILLED);
  const cv::Matx33d tilted(0.9, 0.1, 20, -0.15, 1.05, 11, 2e-4, -3e-4, 1);
  cv::Mat whole;
  cv::warpPerspective(mask, whole, tilted, kImageSize, cv::INTER_NEAREST);
  const cv::Mat carried = warp_mask(mask, tilted);
  EXPECT_GT(cv::countNonZero(carried), 8000);
  EXPECT_LE(cv::countNonZero(carried != whole), 5);  // pixels exactly half-way may round either way
  EXPECT_EQ(cv::countNonZero(warp_mask(cv::Mat::zeros(kImageSize, CV_8UC1), tilted)), 0);
  EXPECT_EQ(cv::countNonZero(warp_mask(mask, {1, 0, 900, 0, 1, 0, 0, 0, 1})), 0);
}

TEST(Difference, IsTheAbsoluteDifferenceWhereValid) {
  const cv::Mat destination = (cv::Mat_<unsigned char>(1, 4) << 10, 200, 50, 7);
  const cv::Mat compensated = (cv::Mat_<unsigned char>(1, 4) << 30, 100, 50, 90);
  const cv::Mat valid = (cv::Mat_<unsigned char>(1, 4) << 255, 255, 255, 0);
  const cv::Mat expected = (cv::Mat_<unsigned char>(1, 4) << 20, 100, 0, 0);
  EXPECT_EQ(cv::norm(frame_difference(destination, compensated, valid), expected, cv::NORM_INF), 0.0);
}

TEST(Difference, AnotherExposureIsTheMedianRatioOfMidTones) {
  cv::Mat compensated(60, 80, CV_8UC1), valid(60, 80, CV_8UC1, cv::Scalar(255));
  for (int y = 0; y < compensated.rows; ++y)
    for (int x = 0; x < compensated.cols; ++x)
      compensated.at<uchar>(y, x) = static_cast<uchar>(60 + 2 * (x % 60));
  cv::Mat brighter;
  compensated.convertTo(brighter, CV_8U, 1.1);
  cv::Mat with_object = brighter.clone();
  with_object(cv::Rect(0, 0, 30, 60)) = 200;  // over a third of the image something else is seen
  EXPECT_NEAR(exposure_ratio(with_object, compensated, valid), 1.1, 0.01);
  EXPECT_NEAR(exposure_ratio(compensated, brighter, valid), 1.0 / 1.1, 0.01);
  EXPECT_EQ(exposure_ratio(compensated, compensated, valid), 1.0);
  cv::Mat slightly;
  compensated.convertTo(slightly, CV_8U, 1.01);
  EXPECT_EQ(exposure_ratio(slightly, compensated, valid), 1.0);  // as noise may have it
  valid.setTo(0);
  EXPECT_EQ(exposure_ratio(brighter, compensated, valid), 1.0);  // nothing tells
}

TEST(Difference, AnotherExposureIsToldFromTwoPercentOn) {
  // 37 columns: two groups of sixteen and some left over.
  const cv::Mat valid(8, 37, CV_8UC1, cv::Scalar(255)), hundred(8, 37, CV_8UC1, cv::Scalar(100));
  const auto of = [&](int gray) {
    return exposure_ratio(cv::Mat(8, 37, CV_8UC1, cv::Scalar(gray)), hundred, valid);
  };
  EXPECT_EQ(of(98), 1.0);
  EXPECT_EQ(of(101), 1.0);
  EXPECT_NEAR(of(97), 0.97, 0.0005);
  EXPECT_NEAR(of(102), 1.02, 0.0005);
  EXPECT_NEAR(of(199), 1.99, 0.0005);
  EXPECT_EQ(of(200), 1.0);  // twice as bright is not the camera's doing
  EXPECT_EQ(of(49), 1.0);
}

TEST(Difference, HistogramCountsValidPixelsOnly) {
  const cv::Mat image = (cv::Mat_<unsigned char>(2, 5) << 0, 0, 3, 255, 3, 3, 9, 255, 0, 9);
  const cv::Mat valid = (cv::Mat_<unsigned char>(2, 5) << 255, 0, 255, 255, 255, 0, 0, 255, 255, 255);
  const Histogram levels = histogram(image, valid);
  EXPECT_EQ(levels[0], 2);
  EXPECT_EQ(levels[3], 2);
  EXPECT_EQ(levels[9], 1);
  EXPECT_EQ(levels[255], 2);
  int sum = 0;
  for (const int count : levels) sum += count;
  EXPECT_EQ(sum, 7);
}

TEST(Otsu, SplitsHandComputedHistograms) {
  // 12 pixels, sum of levels 31. Pixels and mean up to th, then above it; variance (times 144):
  //   th 0: 6 of 0, 6 of 31/6: 36 * 26.69 = 961.0
  //   th 1 to 4: 8 of 0.25, 4 of 7.25: 32 * 49 = 1568.0
  //   th 5 to 7: 9 of 7/9, 3 of 8: 27 * 52.16 = 1408.3
  Histogram levels{};
  levels[0] = 6;
  levels[1] = 2;
  levels[5] = 1;
  levels[8] = 3;
  EXPECT_EQ(otsu_threshold(levels), 1);

  Histogram two_levels{};
  two_levels[10] = 100;
  two_levels[200] = 50;
  EXPECT_EQ(otsu_threshold(two_levels), 10);
}

TEST(Otsu, OneLevelOrNothingGivesZero) {
  EXPECT_EQ(otsu_threshold(Histogram{}), 0);
  Histogram one_level{};
  one_level[77] = 1000;
  EXPECT_EQ(otsu_threshold(one_level), 0);
}

TEST(Otsu, AgreesWithOpenCvWhereEverythingIsValid) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    cv::Mat image = textured_image({120, 90}, seed);
    cv::multiply(image, image, image, 1.0 / (30.0 * seed));  // other shapes of histogram
    cv::Mat binary;
    const double expected = cv::threshold(image, binary, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
    const int ours = otsu_threshold(histogram(image, all_valid(image.size())));
    EXPECT_EQ(ours, static_cast<int>(expected)) << "seed " << seed;
    EXPECT_EQ(cv::norm(binarise(image, ours), binary, cv::NORM_INF), 0.0);
  }
}

cv::Rect extent(const cv::Mat& mask) { return cv::boundingRect(mask); }

TEST(Cleanup, ErosionTakesSixPixelsAndDilationAddsFifteen) {
  cv::Mat square = cv::Mat::zeros(100, 100, CV_8UC1);
  square(cv::Rect(40, 50, 20, 12)).setTo(255);  // x 40..59, y 50..61
  PaperConfig config;
  config.dilate_iterations = 0;
  // Each 4x4 erosion anchored at its third pixel takes 2 from the left or top and 1 from the right or bottom.
  EXPECT_EQ(extent(clean_mask(square, all_valid(square.size()), config)), cv::Rect(44, 54, 14, 6));
  config.dilate_iterations = 1;
  config.erode_iterations = 0;
  // The 16x16 dilation anchored at its eighth pixel adds 8 on the left and top, 7 on the right and bottom.
  EXPECT_EQ(extent(clean_mask(square, all_valid(square.size()), config)), cv::Rect(32, 42, 35, 27));
  config.erode_iterations = 2;
  const cv::Mat both = clean_mask(square, all_valid(square.size()), config);
  EXPECT_EQ(extent(both), cv::Rect(36, 46, 29, 21));
  EXPECT_EQ(cv::countNonZero(both), 29 * 21);
}

TEST(Cleanup, SpecksVanishAndSixPixelsAreTooThin) {
  const PaperConfig config;
  for (const int side : {1, 3, 6}) {
    cv::Mat speck = cv::Mat::zeros(60, 60, CV_8UC1);
    speck(cv::Rect(20, 20, side, 40)).setTo(255);
    EXPECT_EQ(cv::countNonZero(clean_mask(speck, all_valid(speck.size()), config)), 0) << side;
  }
  cv::Mat bar = cv::Mat::zeros(60, 60, CV_8UC1);
  bar(cv::Rect(20, 20, 7, 40)).setTo(255);
  EXPECT_GT(cv::countNonZero(clean_mask(bar, all_valid(bar.size()), config)), 0);
}

TEST(Cleanup, KernelsOfOneSizePutASquareBackWhereItWas) {
  PaperConfig config;
  config.erode_kernel_px = config.dilate_kernel_px = 4;
  config.erode_iterations = config.dilate_iterations = 2;
  cv::Mat square = cv::Mat::zeros(60, 60, CV_8UC1);
  square(cv::Rect(20, 25, 15, 11)).setTo(255);
  EXPECT_EQ(cv::norm(clean_mask(square, all_valid(square.size()), config), square, cv::NORM_INF), 0.0);
}

TEST(Cleanup, NothingGrowsWhereTheWarpHasNoData) {
  cv::Mat raw = cv::Mat::zeros(60, 60, CV_8UC1);
  raw(cv::Rect(5, 5, 30, 30)).setTo(255);
  cv::Mat valid = all_valid(raw.size());
  valid.colRange(0, 10).setTo(0);
  const cv::Mat mask = clean_mask(raw, valid, PaperConfig{});
  EXPECT_GT(cv::countNonZero(mask), 0);
  EXPECT_EQ(cv::countNonZero(mask & ~valid), 0);
}

TEST(Cleanup, IsOpenCvsErosionAndDilation) {
  struct Kernels {
    cv::Size size;
    int erode_px, erosions, dilate_px, dilations;
  };
  for (const Kernels& k : {Kernels{{640, 480}, 4, 2, 16, 1},
                           {{131, 70}, 3, 1, 99, 2},
                           {{64, 40}, 1, 0, 7, 3},
                           {{203, 9}, 5, 3, 40, 1},
                           {{3, 80}, 2, 1, 2, 0}}) {
    const cv::Mat raw = textured_image(k.size, 12) > 96, valid = textured_image(k.size, 13) > 60;
    PaperConfig config;
    config.erode_kernel_px = k.erode_px;
    config.erode_iterations = k.erosions;
    config.dilate_kernel_px = k.dilate_px;
    config.dilate_iterations = k.dilations;
    const auto square = [](int side) { return cv::Mat::ones(side, side, CV_8UC1); };
    cv::Mat expected;
    cv::erode(raw, expected, square(k.erode_px), {k.erode_px / 2, k.erode_px / 2}, k.erosions);
    const int anchor = (k.dilate_px - 1) / 2;
    cv::dilate(expected, expected, square(k.dilate_px), {anchor, anchor}, k.dilations);
    expected &= valid;
    EXPECT_EQ(cv::countNonZero(clean_mask(raw, valid, config) != expected), 0) << k.size << k.dilate_px;
  }
}

TEST(Regions, TellBoxCentroidAndArea) {
  cv::Mat mask = cv::Mat::zeros(40, 50, CV_8UC1);
  mask(cv::Rect(30, 2, 4, 3)).setTo(255);
  mask(cv::Rect(5, 10, 2, 6)).setTo(255);
  mask(cv::Rect(7, 16, 3, 1)).setTo(255);  // touches the one above by a corner
  const LabelledRegions found = find_regions(mask);
  ASSERT_EQ(found.regions.size(), 2U);
  EXPECT_EQ(found.regions[0].box, cv::Rect(30, 2, 4, 3));
  EXPECT_EQ(found.regions[0].area, 12);
  EXPECT_DOUBLE_EQ(found.regions[0].centroid.x, 31.5);
  EXPECT_DOUBLE_EQ(found.regions[0].centroid.y, 3.0);
  EXPECT_EQ(found.regions[1].box, cv::Rect(5, 10, 5, 7));
  EXPECT_EQ(found.regions[1].area, 15);
  EXPECT_DOUBLE_EQ(found.regions[1].centroid.x, (12 * 5.5 + 3 * 8.0) / 15);
  EXPECT_DOUBLE_EQ(found.regions[1].centroid.y, (12 * 12.5 + 3 * 16.0) / 15);
  EXPECT_EQ(found.labels.at<int>(3, 31), 1);
  EXPECT_EQ(found.labels.at<int>(16, 8), 2);
  EXPECT_EQ(found.labels.at<int>(0, 0), 0);
  EXPECT_EQ(found.area, 27);
}

TEST(Regions, NoneInAnEmptyMaskAndOneInAFullOne) {
  EXPECT_TRUE(find_regions(cv::Mat::zeros(33, 47, CV_8UC1)).regions.empty());
  const LabelledRegions full = find_regions(all_valid({47, 33}));
  ASSERT_EQ(full.regions.size(), 1U);
  EXPECT_EQ(full.regions[0].area, 47 * 33);
}

}  // namespace
}  // namespace stillpoint
