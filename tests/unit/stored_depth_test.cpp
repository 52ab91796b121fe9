// Depth of any range as 16 bits hold it.
#include "core/media/stored_depth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "core/sequence/excerpt.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/memory_source.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

constexpr double kTumUnits = 5000.0;

std::vector<int> stored(const std::vector<float>& metres, double units, std::uint16_t none = 0) {
  const StoredDepth depth = stored_depth(cv::Mat(metres).reshape(1, 1), units, none);
  return {depth.image.begin<std::uint16_t>(), depth.image.end<std::uint16_t>()};
}

TEST(StoredDepth, RoundsToNearest) {
  EXPECT_EQ(stored({1.0F, 2.00014F, 2.00006F, 0.00009F, 0.00011F}, kTumUnits),
            (std::vector<int>{5000, 10001, 10000, 0, 1}));
}

TEST(StoredDepth, WhatIsTooFarIsNotMeasured) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  // 13.1068 m is the farthest; OpenCV makes 65535 of the next and 0 of those beyond 2^31 units.
  const std::vector<float> metres = {13.1068F, 13.2F, 80.0F, 1e10F, kInfinite};
  EXPECT_EQ(stored(metres, kTumUnits), (std::vector<int>{65534, 0, 0, 0, 0}));
  EXPECT_EQ(stored(metres, kTumUnits, 7), (std::vector<int>{65534, 7, 7, 7, 7}));
  EXPECT_EQ(stored_depth(cv::Mat(metres).reshape(1, 1), kTumUnits).too_far, 4);
}

TEST(StoredDepth, WhatIsNoDepthIsNotMeasuredNorTooFar) {
  const std::vector<float> metres = {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                                     -std::numeric_limits<float>::infinity()};
  EXPECT_EQ(stored(metres, kTumUnits, 9), (std::vector<int>{9, 9, 9, 9}));
  EXPECT_EQ(stored_depth(cv::Mat(metres).reshape(1, 1), kTumUnits).too_far, 0);
}

/// A generated sequence with a wall far outside.
class FarSource : public MemorySource {
 public:
  explicit FarSource(const FrameSource& source)
      : MemorySource(source, 2, {source.camera().width, source.camera().height}) {}
  [[nodiscard]] Frame read(int index) const override {
    Frame frame = MemorySource::read(index);
    frame.depth = frame.depth.clone();
    frame.depth(cv::Rect(0, 0, 10, 10)) = 30.0F;
    return frame;
  }
};

TEST(StoredDepth, AnExportedSequenceHasNoWallWhereItEnds) {
  const TemporaryFolder folder;
  const auto room = make_generated_sequence("room", 2, 1);
  const FarSource source(*room);
  const ExportedFrames exported = export_frames(source, {0, 1}, folder.path("out"), false);
  EXPECT_EQ(exported.too_far, 200);
  EXPECT_THAT(too_far_told(exported.too_far, exported.depth_units), ::testing::HasSubstr("13.1 m"));
  const auto read = open_sequence(folder.path("out"));
  ASSERT_EQ(read->size(), 2);
  for (int i = 0; i < 2; ++i) {
    const cv::Mat depth = read->read(i).depth;
    EXPECT_EQ(cv::countNonZero(depth(cv::Rect(0, 0, 10, 10))), 0);
    EXPECT_LT(cv::norm(depth(cv::Rect(20, 20, 100, 100)), source.read(i).depth(cv::Rect(20, 20, 100, 100)),
                       cv::NORM_INF),
              1e-4);
  }
}

TEST(StoredDepth, NothingIsToldWhereAllIsHeld) { EXPECT_EQ(too_far_told(0, kTumUnits), ""); }

TEST(StoredDepth, IsReadAsOpenCvConvertsIt) {
  cv::Mat stored(256, 256, CV_16UC1);
  for (int i = 0; i < 65536; ++i) stored.at<std::uint16_t>(i / 256, i % 256) = static_cast<std::uint16_t>(i);
  for (const double units : {1000.0, 5000.0, 5208.0, 6553.5}) {
    cv::Mat expected;
    stored.convertTo(expected, CV_32F, 1.0 / units);
    expected.at<float>(255, 255) = 0.0F;
    for (const bool wide : {false, has_wide_lanes()}) {
      EXPECT_EQ(cv::norm(metres_of(stored, units, wide), expected, cv::NORM_INF), 0.0) << units;
      const cv::Range some(3, 14);  // a register's pixels and three more
      EXPECT_EQ(
          cv::norm(metres_of(stored.colRange(some), units, wide), expected.colRange(some), cv::NORM_INF),
          0.0);
    }
  }
}

}  // namespace
}  // namespace stillpoint
