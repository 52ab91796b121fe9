// What records are packed into: masks by the lengths of their runs, kinds by their numbers.
#include "core/run/record_codec.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace stillpoint {
namespace {

TEST(PackedMasks, GiveBackWhatWasPacked) {
  EXPECT_TRUE(pack_mask({}).empty());
  EXPECT_TRUE(unpack_mask({}).empty());
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(0));
  for (const int fill : {0, 255}) {
    mask.setTo(fill);  // one run, longer than sixteen bits count
    EXPECT_EQ(cv::norm(unpack_mask(pack_mask(mask)), mask, cv::NORM_INF), 0.0);
  }
  cv::randu(mask, 0, 2);
  mask *= 255;
  EXPECT_EQ(cv::norm(unpack_mask(pack_mask(mask)), mask, cv::NORM_INF), 0.0);
  PackedMask cut = pack_mask(mask);
  cut.resize(cut.size() / 2);
  EXPECT_THROW((void)unpack_mask(cut), ByteStreamReader::Exhausted);
}

TEST(PackedMasks, AreTheLengthsOfTheirRuns) {
  // Any value but zero is set; runs go on from row to row, and end within and between eight pixels.
  constexpr int kSide = 37;
  for (const int longest : {1, 3, 9, 40, 200}) {
    cv::RNG random(static_cast<std::uint64_t>(longest));
    cv::Mat mask(kSide, kSide, CV_8UC1, cv::Scalar(0));
    PackedMask wanted = {kSide, 0, kSide, 0};
    bool set = false;
    for (int at = 0; at < kSide * kSide; set = !set) {
      const int length =
          std::min(random.uniform(wanted.size() == 4 ? 0 : 1, longest + 1), kSide * kSide - at);
      wanted.insert(wanted.end(),
                    {static_cast<std::uint8_t>(length & 0xFF), static_cast<std::uint8_t>(length >> 8)});
      for (const int end = at + length; at < end; ++at)
        mask.at<std::uint8_t>(at / kSide, at % kSide) =
            set ? static_cast<std::uint8_t>(random.uniform(1, 256)) : 0;
    }
    EXPECT_EQ(pack_mask(mask), wanted) << longest;
    cv::Mat wide(kSide, 2 * kSide, CV_8UC1, cv::Scalar(255));
    cv::Mat part = wide.colRange(3, 3 + kSide);  // whose rows do not lie one behind the other
    mask.copyTo(part);
    EXPECT_EQ(pack_mask(part), wanted) << longest;
  }
}

TEST(PackedMasks, OfNoImagesSizeAreRefused) {
  const PackedMask vast = {0xFF, 0xFF, 0xFF, 0xFF, 0, 0};  // 65535 px a side, and no pixels
  EXPECT_THROW(check_mask(vast), ByteStreamReader::Exhausted);
  EXPECT_EQ(check_mask(pack_mask(cv::Mat::zeros(3, 5, CV_8UC1))), cv::Size(5, 3));
  EXPECT_EQ(check_mask({}), cv::Size());
}

TEST(RecordCodec, RefusesWhatIsOfNoKnownKind) {
  FrameRecord record;
  record.features.resize(2);
  const auto comes_back = [&record] {
    ByteStreamWriter to;
    write_record(to, record);
    ByteStreamReader from(to.bytes());
    (void)read_record(from);
  };
  EXPECT_NO_THROW(comes_back());
  record.features[1].fate = static_cast<FeatureFate>(9);
  EXPECT_THROW(comes_back(), ByteStreamReader::Exhausted);
  record.features[1].fate = FeatureFate::removed;
  record.status = static_cast<FrameStatus>(200);
  EXPECT_THROW(comes_back(), ByteStreamReader::Exhausted);
}

}  // namespace
}  // namespace stillpoint
