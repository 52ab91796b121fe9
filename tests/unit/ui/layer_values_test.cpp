#include "core/inspect/layer_values.hpp"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(Developed, IsAChannelTimesAPowerOfTwo) {
  const cv::Mat colour(2, 3, CV_8UC3, cv::Scalar(10, 20, 200));  // BGR
  EXPECT_EQ(developed(colour, Channel::red, 0.0).at<std::uint8_t>(1, 2), 200);
  EXPECT_EQ(developed(colour, Channel::green, 1.0).at<std::uint8_t>(0, 0), 40);
  EXPECT_EQ(developed(colour, Channel::blue, -1.0).at<std::uint8_t>(0, 0), 5);
  EXPECT_EQ(developed(colour, Channel::red, 1.0).at<std::uint8_t>(0, 0), 255);  // cut off at white
  EXPECT_EQ(developed(colour, Channel::all, 1.0).at<cv::Vec3b>(0, 0), cv::Vec3b(20, 40, 255));
  // 0.114 * 10 + 0.587 * 20 + 0.299 * 200 = 72.7
  EXPECT_EQ(developed(colour, Channel::grey, 0.0).at<std::uint8_t>(0, 0), 73);
  const cv::Mat grey(2, 3, CV_8UC1, cv::Scalar(30));
  for (const Channel channel : {Channel::all, Channel::grey, Channel::red, Channel::blue})
    EXPECT_EQ(developed(grey, channel, 2.0).at<std::uint8_t>(1, 1), 120);
  EXPECT_EQ(grey.at<std::uint8_t>(1, 1), 30);  // the picture itself stays
}

TEST(LevelHistogram, CountsEveryValueOnce) {
  cv::Mat picture(2, 2, CV_8UC3, cv::Scalar(1, 2, 2));
  picture.at<cv::Vec3b>(0, 1) = {9, 9, 9};
  const LevelHistogram histogram = level_histogram(picture);
  EXPECT_EQ(histogram.pixels[1], 3.0);
  EXPECT_EQ(histogram.pixels[2], 6.0);
  EXPECT_EQ(histogram.pixels[9], 3.0);
  EXPECT_EQ(histogram.highest, 10.0);
}

}  // namespace
}  // namespace stillpoint
