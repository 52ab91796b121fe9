#include "core/media/image_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/media/jpeg_codec.hpp"
#include "core/sequence/image_file.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

cv::Mat noise(int type) {
  cv::Mat image(37, 53, type);
  cv::theRNG().state = 7;
  cv::randu(image, 0, image.depth() == CV_16U ? 65536 : 256);
  return image;
}

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

class ImageCodec : public testing::TestWithParam<int> {};

TEST_P(ImageCodec, ReadsBackWhatItWroteAsOpenCvDoes) {
  const cv::Mat image = noise(GetParam());
  for (const int level : {1, 3, 9}) {
    const auto bytes = encode_png(image, level);
    ASSERT_FALSE(bytes.empty());
    EXPECT_TRUE(same_pixels(decode_pixels(bytes), image)) << level;
    EXPECT_TRUE(same_pixels(cv::imdecode(bytes, cv::IMREAD_UNCHANGED), image)) << level;
  }
}

TEST_P(ImageCodec, ReadsBackWhatACameraTook) {
  const cv::Mat image = noise(GetParam());
  const auto bytes = encode_camera_png(image);
  EXPECT_TRUE(same_pixels(decode_pixels(bytes), image));
  EXPECT_TRUE(same_pixels(cv::imdecode(bytes, cv::IMREAD_UNCHANGED), image));
}

TEST_P(ImageCodec, ReadsWhatOpenCvWrites) {
  const cv::Mat image = noise(GetParam());
  for (const char* ending : {".png", ".tiff"}) {
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(ending, image, bytes));
    EXPECT_TRUE(same_pixels(decode_pixels(bytes), image)) << ending;
  }
}

INSTANTIATE_TEST_SUITE_P(Types, ImageCodec,
                         testing::Values(CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4));

TEST(ImageCodecs, AViewIntoALargerImageIsWrittenAlone) {
  const cv::Mat whole = noise(CV_8UC1), part = whole(cv::Rect(5, 6, 20, 10));
  EXPECT_TRUE(same_pixels(decode_pixels(encode_png(part, 1)), part));
}

TEST(ImageCodecs, UnusualPngsAreReadByOpenCv) {
  // One bit a pixel, which is spread to 0 and 255.
  cv::Mat bits(8, 8, CV_8UC1, cv::Scalar(0));
  bits(cv::Rect(2, 2, 3, 3)) = 255;
  std::vector<unsigned char> bytes;
  ASSERT_TRUE(cv::imencode(".png", bits, bytes, {cv::IMWRITE_PNG_BILEVEL, 1}));
  EXPECT_TRUE(same_pixels(decode_pixels(bytes), bits));
}

TEST(ImageCodecs, WhatIsNoImageGivesNone) {
  EXPECT_TRUE(decode_pixels({'n', 'o', 't', 'h', 'i', 'n', 'g'}).empty());
  EXPECT_TRUE(encode_png(cv::Mat(), 1).empty());
  EXPECT_TRUE(encode_png(cv::Mat(4, 4, CV_32FC1, cv::Scalar(0)), 1).empty());
}

TEST(ImageCodecs, JpegsAreReadAndWrittenAsByOpenCv) {
  for (const int type : {CV_8UC1, CV_8UC3})
    for (const int quality : {0, 50, 95, 100}) {
      cv::Mat image = noise(type);
      cv::GaussianBlur(image, image, {}, 1.5);
      std::vector<unsigned char> theirs;
      ASSERT_TRUE(cv::imencode(".jpg", image, theirs, {cv::IMWRITE_JPEG_QUALITY, quality}));
      EXPECT_EQ(encode_jpeg(image, quality), theirs) << quality;
      EXPECT_TRUE(same_pixels(decode_plain_jpeg(theirs), cv::imdecode(theirs, cv::IMREAD_UNCHANGED)))
          << quality;
    }
  std::vector<unsigned char> progressive;
  const cv::Mat image = noise(CV_8UC3);
  ASSERT_TRUE(cv::imencode(".jpg", image, progressive, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  EXPECT_TRUE(same_pixels(decode_plain_jpeg(progressive), cv::imdecode(progressive, cv::IMREAD_UNCHANGED)));
}

TEST(ImageCodecs, OfADamagedJpegThereIsWhatCanBeDecoded) {
  std::vector<unsigned char> bytes = encode_jpeg(noise(CV_8UC3), 90);
  ASSERT_FALSE(bytes.empty());
  const std::size_t whole = bytes.size();
  bytes.resize(whole / 2);
  bool is_damaged = true;
  EXPECT_EQ(decode_plain_jpeg(bytes, &is_damaged).size(), noise(CV_8UC3).size());
  EXPECT_FALSE(is_damaged);
  bytes.resize(12);
  EXPECT_TRUE(decode_plain_jpeg(bytes, &is_damaged).empty());
  EXPECT_TRUE(is_damaged);
  EXPECT_TRUE(decode_plain_jpeg({0xFF, 0xD8, 0xFF}).empty());
  EXPECT_TRUE(encode_jpeg(noise(CV_16UC1), 90).empty());
  EXPECT_TRUE(encode_jpeg(cv::Mat(), 90).empty());
}

TEST(ImageCodecs, AJpegIsNearAndAFileIsWhatItsNameSays) {
  const TemporaryFolder folder;
  const cv::Mat plain(40, 40, CV_8UC3, cv::Scalar(20, 120, 220));
  EXPECT_LT(cv::norm(cv::imdecode(encode_jpeg(plain, 90), cv::IMREAD_COLOR), plain, cv::NORM_INF), 4.0);
  for (const char* name : {"a.png", "a.jpg", "a.BMP"}) {
    ASSERT_TRUE(save_image(folder.path(name), plain)) << name;
    EXPECT_LT(cv::norm(cv::imread(folder.path(name)), plain, cv::NORM_INF), 4.0) << name;
  }
  EXPECT_FALSE(save_image(folder.path("nowhere/a.png"), plain));
}

/// What is said of a file that should be no image.
std::string problem_of(std::vector<unsigned char> bytes) {
  return decode_image("a.image", std::move(bytes)).problem;
}

TEST(ImageClaims, OfMorePixelsThanAPngsBytesCanHoldAreRefused) {
  auto bytes = encode_png(cv::Mat::zeros(6, 8, CV_8UC1), 6);
  ASSERT_EQ(problem_of(bytes), "");
  // A width of 16000 px, and the header's checksum made right.
  bytes[18] = 0x3E, bytes[19] = 0x80;
  const auto crc = ::crc32_z(0, bytes.data() + 12, 17);
  for (std::size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<unsigned char>(crc >> (24 - 8 * i));
  EXPECT_THAT(problem_of(bytes), ::testing::HasSubstr("claims 16000x6 px, more than its"));
}

TEST(ImageClaims, OfMorePixelsThanAJpegsBytesCanHoldAreRefused) {
  auto bytes = encode_jpeg(cv::Mat::zeros(6, 8, CV_8UC1), 90);
  ASSERT_EQ(problem_of(bytes), "");
  const std::vector<unsigned char> frame = {0xFF, 0xC0};
  const auto at = std::search(bytes.begin(), bytes.end(), frame.begin(), frame.end());
  ASSERT_NE(at, bytes.end());
  at[5] = at[7] = 0x3E;
  EXPECT_THAT(problem_of(bytes), ::testing::HasSubstr("px, more than its"));
}

TEST(ImageClaims, AJpegOfMoreScansThanAnyEncoderMakesIsRefused) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", cv::Mat::zeros(6, 8, CV_8UC1), bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  ASSERT_EQ(problem_of(bytes), "");
  const std::vector<unsigned char> scan = {0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 0, 0};
  for (int i = 0; i < 100; ++i) bytes.insert(bytes.end() - 2, scan.begin(), scan.end());
  EXPECT_THAT(problem_of(bytes), ::testing::HasSubstr("has more than 100 scans"));
}

TEST(ImageClaims, FlatImagesOfAnySizeAreRead) {
  // What packs best of all: their bytes must do.
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const cv::Mat flat(4000, 6000, type, cv::Scalar::all(7));
    EXPECT_EQ(problem_of(encode_png(flat, 9)), "");
    if (type == CV_16UC1) continue;
    EXPECT_EQ(problem_of(encode_jpeg(flat, 1)), "");
  }
  cv::Mat flat(4000, 6000, CV_8UC3, cv::Scalar::all(7));
  std::vector<unsigned char> progressive;
  cv::imencode(".jpg", flat, progressive,
               {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_OPTIMIZE, 1, cv::IMWRITE_JPEG_QUALITY, 1});
  EXPECT_EQ(problem_of(progressive), "");
}

TEST(ImageFormats, OthersAreHandedToNoDecoder) {
  EXPECT_THAT(problem_of(std::vector<unsigned char>(200, 'x')), ::testing::HasSubstr("is no image"));
  const cv::Mat image = noise(CV_8UC3);
  for (const char* ending : {".bmp", ".tiff", ".ppm", ".webp"}) {
    std::vector<unsigned char> bytes;
    cv::imencode(ending, image, bytes);
    EXPECT_EQ(problem_of(bytes), "") << ending;
  }
}

}  // namespace
}  // namespace stillpoint
