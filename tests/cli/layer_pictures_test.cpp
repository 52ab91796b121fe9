// Layers as the image files that `stillpoint motion` writes.
#include "app/layer_pictures.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillpoint {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(),
                kInfinite = std::numeric_limits<float>::infinity();

/// The grey levels that one row of values is drawn in.
std::vector<int> levels_of(LayerKind kind, double range, const std::vector<float>& values) {
  Layer layer;
  layer.kind = kind;
  layer.range = range;
  layer.image = cv::Mat(values, true).reshape(1, 1);
  const cv::Mat picture = draw_layer(layer);
  EXPECT_EQ(picture.type(), CV_8UC1);
  return {picture.begin<std::uint8_t>(), picture.end<std::uint8_t>()};
}

TEST(LayerPictures, SignedValuesAreGreyAtZero) {
  EXPECT_EQ(levels_of(LayerKind::kSigned, 2.0, {-2.0F, -1.0F, 0.0F, 1.0F, 2.0F}),
            (std::vector<int>{0, 64, 128, 192, 255}));
  EXPECT_EQ(levels_of(LayerKind::kSigned, 2.0, {kNaN, -9.0F, 9.0F, -kInfinite, kInfinite}),
            (std::vector<int>{128, 0, 255, 0, 255}));
}

TEST(LayerPictures, LengthsAreBlackAtZero) {
  EXPECT_EQ(levels_of(LayerKind::kLength, 5.0, {0.0F, 1.0F, 5.0F, 7.0F, kNaN, kInfinite}),
            (std::vector<int>{0, 51, 255, 255, 0, 255}));
}

TEST(LayerPictures, GreyLevelsKeepTheirValues) {
  EXPECT_EQ(levels_of(LayerKind::kPhoto, 0.0, {0.0F, 99.6F, 300.0F}), (std::vector<int>{0, 100, 255}));
}

TEST(LayerPictures, EightBitsStayAsTheyAre) {
  Layer layer;
  layer.kind = LayerKind::kMask;
  layer.image = (cv::Mat_<std::uint8_t>(1, 3) << 0, 7, 255);
  EXPECT_EQ(cv::norm(draw_layer(layer), layer.image, cv::NORM_INF), 0.0);
  EXPECT_TRUE(draw_layer(Layer()).empty());
}

TEST(LayerPictures, MarksStandOverTheDimmedImage) {
  Layer layer;
  layer.image = cv::Mat(60, 200, CV_8UC1, cv::Scalar(100));
  layer.marks = {{{20.0F, 30.0F}, cv::Point2f(10.0F, 30.0F), MarkKind::kOutlier},
                 {{150.0F, 30.0F}, std::nullopt, MarkKind::kRemoved}};
  const cv::Mat picture = draw_layer(layer);
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_GT(picture.rows, 60);  // a legend
  EXPECT_EQ(picture.at<cv::Vec3b>(5, 100), cv::Vec3b(60, 60, 60));
  EXPECT_GT(picture.at<cv::Vec3b>(30, 14)[1], 150);                  // the outlier's way, yellow
  EXPECT_EQ(picture.at<cv::Vec3b>(30, 150), cv::Vec3b(60, 60, 60));  // a square about its place
  EXPECT_GT(picture.at<cv::Vec3b>(30, 153)[2], 150);                 // vermilion
}

}  // namespace
}  // namespace stillpoint
