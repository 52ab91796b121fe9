#include <gtest/gtest.h>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

#include "core/odometry/fast_corners.hpp"
#include "core/odometry/feature_set.hpp"
#include "core/odometry/matching.hpp"
#include "core/odometry/orb_blur.hpp"
#include "core/odometry/orb_descriptors.hpp"
#include "core/odometry/orb_extractor.hpp"
#include "core/odometry/rolling_shutter.hpp"
#include "core/odometry/smaller_level.hpp"

namespace stillpoint {
namespace {

/// Blurred random blocks: corners everywhere.
cv::Mat textured(int width, int height, unsigned seed = 1) {
  cv::Mat small(height / 8 + 1, width / 8 + 1, CV_8UC1), image;
  cv::RNG random(seed);
  random.fill(small, cv::RNG::UNIFORM, 0, 255);
  cv::resize(small, image, {width, height}, 0, 0, cv::INTER_NEAREST);
  return image;
}

TEST(Descriptor, DistanceCountsBits) {
  Descriptor a{}, b{};
  EXPECT_EQ(descriptor_distance(a, b), 0);
  b[0] = 0b1011, b[3] = ~std::uint64_t{0};
  EXPECT_EQ(descriptor_distance(a, b), 3 + 64);
}

/// Blocks, noise, and gradients that end at black and white.
cv::Mat rich(int width, int height, unsigned seed) {
  cv::Mat image = textured(width, height, seed), noise(height, width, CV_8UC1);
  cv::RNG random(seed + 1);
  random.fill(noise, cv::RNG::UNIFORM, 0, 60);
  cv::GaussianBlur(image, image, {5, 5}, 1.2);
  return image + noise - 30;
}

TEST(FastCorners, AreThoseOfOpenCv) {
  constexpr int kMargin = 3;
  // Widths about multiples of the lanes, and images that end where corners do.
  for (const auto& size : {cv::Size(7, 7), cv::Size(22, 9), cv::Size(23, 31), cv::Size(39, 40),
                           cv::Size(203, 97), cv::Size(640, 480)})
    for (const int threshold : {1, 7, 20, 60, 254}) {
      const cv::Mat image = rich(size.width, size.height, static_cast<unsigned>(size.width + threshold));
      std::vector<cv::KeyPoint> expected, found;
      cv::FAST(image, expected, threshold, true);
      const cv::Rect inside(kMargin, kMargin, size.width - 2 * kMargin, size.height - 2 * kMargin);
      append_fast_corners(image, inside, threshold, found, false);
      ASSERT_EQ(found.size(), expected.size()) << size << " at " << threshold;
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].pt, expected[i].pt);
        EXPECT_EQ(found[i].response, expected[i].response);
      }
      if (has_wide_lanes()) {
        std::vector<cv::KeyPoint> by_wide;
        append_fast_corners(image, inside, threshold, by_wide, true);
        ASSERT_EQ(by_wide.size(), found.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_EQ(by_wide[i].pt, found[i].pt);
          EXPECT_EQ(by_wide[i].response, found[i].response);
        }
      }
      if (size.width == 640 && threshold <= 20) {
        EXPECT_GT(found.size(), 1000u);
      }
    }
}

TEST(FastCorners, AreComparedWithinTheirWindowAlone) {
  const cv::Mat image = rich(200, 150, 4);
  const cv::Rect window(61, 40, 37, 32);
  std::vector<cv::KeyPoint> expected, found = {cv::KeyPoint(1.0F, 2.0F, 3.0F)};
  cv::FAST(image(cv::Rect(window.x - 3, window.y - 3, window.width + 6, window.height + 6)), expected, 10,
           true);
  append_fast_corners(image, window, 10, found);
  ASSERT_EQ(found.size(), expected.size() + 1);  // appended
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(found[i + 1].pt, expected[i].pt + cv::Point2f(58.0F, 37.0F));
  append_fast_corners(image, {}, 10, found);
  EXPECT_EQ(found.size(), expected.size() + 1);
  EXPECT_THROW(append_fast_corners(image, {2, 3, 20, 20}, 10, found), cv::Exception);
}

/// Of an image, what cv::ORB blurs it to: a part of a larger one that is the image mirrored.
cv::Mat blurred_by_opencv(const cv::Mat& image) {
  constexpr int kBeside = 8;  // px
  cv::Mat larger;
  cv::copyMakeBorder(image, larger, kBeside, kBeside, kBeside, kBeside, cv::BORDER_REFLECT_101);
  cv::Mat part = larger(cv::Rect({kBeside, kBeside}, image.size()));
  cv::GaussianBlur(part, part, {7, 7}, 2, 2, cv::BORDER_REFLECT_101);
  return part;
}

TEST(OrbDescriptors, AreThoseOfOpenCv) {
  if (!has_wide_lanes() || !can_blur_wide()) GTEST_SKIP() << "this processor has no wide lanes";
  cv::RNG random(5);
  // Widths about multiples of the lanes, and the smallest there is a corner in.
  for (const auto& size : {cv::Size(39, 39), cv::Size(64, 57), cv::Size(65, 40), cv::Size(179, 134),
                           cv::Size(533, 400), cv::Size(640, 480)})
    for (const bool noise : {false, true}) {
      cv::Mat image = rich(size.width, size.height, static_cast<unsigned>(size.width));
      if (noise) random.fill(image, cv::RNG::UNIFORM, 0, 256);
      std::vector<cv::KeyPoint> corners;
      for (int i = 0; i < 500; ++i)
        corners.emplace_back(static_cast<float>(random.uniform(kOrbBorder, size.width - kOrbBorder)),
                             static_cast<float>(random.uniform(kOrbBorder, size.height - kOrbBorder)), 31.0F,
                             i == 0 ? 0.0F : random.uniform(0.0F, 360.0F));
      BlurredLevel blurred;
      std::vector<Descriptor> expected, found;
      describe_corners(image, corners, blurred, expected, false);
      describe_corners(image, corners, blurred, found, true);
      EXPECT_EQ(found, expected) << size;
      EXPECT_GT(std::set<Descriptor>(found.begin(), found.end()).size(), 100U) << size;
      const cv::Mat blurred_image = blurred.pixels.colRange(0, size.width);
      EXPECT_EQ(cv::norm(blurred_image, blurred_by_opencv(image), cv::NORM_INF), 0.0) << size;
    }
}

TEST(SmallerLevel, IsThatOfOpenCv) {
  cv::RNG random(6);
  for (int i = 0; i < 60; ++i) {
    const cv::Size size(random.uniform(16, 660), random.uniform(3, 90));
    const double scale = i % 2 == 0 ? 1.2 : random.uniform(1.0, 2.1);  // beyond 2 left to OpenCV
    const cv::Size less(std::max(1, cvRound(size.width / scale)), std::max(1, cvRound(size.height / scale)));
    cv::Mat image(size, CV_8UC1), expected, found;
    random.fill(image, cv::RNG::UNIFORM, 0, 256);
    make_smaller_level(image, less, expected, false);
    make_smaller_level(image, less, found, has_wide_lanes());
    ASSERT_EQ(found.size(), less);
    EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0) << size << " to " << less;
  }
}

TEST(OrbExtractor, KeepsNothingOfTheImageBefore) {
  OrbExtractor used({});
  (void)used.extract(textured(640, 480, 3), 2);
  (void)used.extract(textured(33, 20), 2);
  for (const cv::Size& size : {cv::Size(320, 240), cv::Size(640, 480)}) {
    const cv::Mat image = textured(size.width, size.height, 9);
    OrbExtractor copy = used;
    const OrbFeatures fresh = OrbExtractor({}).extract(image);
    ASSERT_GT(fresh.keypoints.size(), 100U) << size;
    for (const OrbFeatures& again : {used.extract(image, 2), copy.extract(image)}) {
      ASSERT_EQ(again.keypoints.size(), fresh.keypoints.size());
      EXPECT_EQ(again.descriptors, fresh.descriptors);
      for (std::size_t i = 0; i < fresh.keypoints.size(); ++i)
        EXPECT_EQ(again.keypoints[i].pt, fresh.keypoints[i].pt);
    }
  }
}

TEST(OrbExtractor, FeaturesAreSpreadOverTheImage) {
  const cv::Mat image = textured(640, 480);
  const OrbFeatures features = OrbExtractor({}).extract(image);
  EXPECT_NEAR(static_cast<double>(features.keypoints.size()), 1000, 50);
  ASSERT_EQ(features.keypoints.size(), features.descriptors.size());
  std::set<int> cells, octaves;
  for (const auto& k : features.keypoints) {
    cells.insert(static_cast<int>(k.pt.y / 80) * 8 + static_cast<int>(k.pt.x / 80));
    octaves.insert(k.octave);
  }
  EXPECT_EQ(cells.size(), 48u);  // every 80x80 cell of 8x6 has its share
  EXPECT_EQ(octaves.size(), 8u);
}

TEST(OrbExtractor, FaintCornersCountWhereNothingElseIs) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(100));
  cv::rectangle(image, {400, 200, 60, 60}, cv::Scalar(112),
                cv::FILLED);  // 12 grey levels: below fast_threshold
  FeatureConfig config;
  EXPECT_GT(OrbExtractor(config).extract(image).keypoints.size(), 0u);
  config.fast_threshold_low = config.fast_threshold;
  EXPECT_EQ(OrbExtractor(config).extract(image).keypoints.size(), 0u);
}

TEST(OrbExtractor, FlatAndTinyImagesHaveNoFeatures) {
  EXPECT_TRUE(OrbExtractor({}).extract(cv::Mat::zeros(480, 640, CV_8UC1)).keypoints.empty());
  EXPECT_TRUE(OrbExtractor({}).extract(textured(33, 20)).keypoints.empty());
}

TEST(OrbExtractor, CoarseLevelsLieWhereTheyAre) {
  // An image and the same doubled: the coarse features of one lie at the doubled places of the other's,
  // halves and all.
  const cv::Mat image = textured(320, 240);
  cv::Mat doubled;
  cv::resize(image, doubled, {640, 480}, 0, 0, cv::INTER_NEAREST);
  cv::Mat dot = cv::Mat::zeros(480, 640, CV_8UC1);
  cv::rectangle(dot, {200, 100, 120, 160}, cv::Scalar(255), cv::FILLED);
  FeatureConfig config;
  const OrbFeatures features = OrbExtractor(config).extract(dot);
  ASSERT_FALSE(features.keypoints.empty());
  const std::vector<cv::Point2f> corners = {{200, 100}, {319, 100}, {200, 259}, {319, 259}};
  std::vector<float> mean_offset;
  for (const auto& k : features.keypoints) {
    float nearest = 1e9F;
    for (const auto& c : corners) nearest = std::min(nearest, static_cast<float>(cv::norm(k.pt - c)));
    EXPECT_LT(nearest, 4.0F * static_cast<float>(std::pow(config.scale_factor, k.octave)))
        << "octave " << k.octave;
  }
}

TEST(OrbExtractor, AnglesFollowTheImage) {
  // Smooth: of the two like pixels at the corner of a block, FAST keeps neither.
  cv::Mat patch = textured(640, 480), turned;
  cv::GaussianBlur(patch, patch, {7, 7}, 1.5);
  cv::rotate(patch, turned, cv::ROTATE_90_CLOCKWISE);
  FeatureConfig config;
  config.levels = 1;
  const OrbFeatures before = OrbExtractor(config).extract(patch),
                    after = OrbExtractor(config).extract(turned);
  // (x, y) turns to (479 - y, x); angles grow by 90 degrees.
  int same = 0, close = 0;
  for (const auto& a : before.keypoints)
    for (const auto& b : after.keypoints)
      if (std::abs(b.pt.x - (479 - a.pt.y)) < 0.5 && std::abs(b.pt.y - a.pt.x) < 0.5) {
        ++same;
        const double turn = std::fmod(b.angle - a.angle + 360.0, 360.0);
        close += std::abs(turn - 90.0) < 2.0;
      }
  EXPECT_GT(same, 100);
  EXPECT_GT(close, same * 95 / 100);
}

TEST(Spread, TakesTheBestOfEachNeighbourhoodFirst) {
  std::vector<cv::KeyPoint> candidates;
  for (int i = 0; i < 10; ++i)
    candidates.emplace_back(cv::Point2f(10.0F + static_cast<float>(i), 10), 1, -1,
                            50.0F + static_cast<float>(i));
  candidates.emplace_back(cv::Point2f(90, 90), 1, -1, 1.0F);  // weak, but alone
  const auto chosen = spread(candidates, 2, 100, 100);
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_EQ(chosen[0].response, 59.0F);
  EXPECT_EQ(chosen[1].response, 1.0F);
  EXPECT_TRUE(spread(candidates, 0, 100, 100).empty());
  EXPECT_EQ(spread(candidates, 50, 100, 100).size(), 11u);
}

}  // namespace
}  // namespace stillpoint
