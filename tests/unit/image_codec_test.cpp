#include "core/media/image_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/media/jpeg_codec.hpp"
#include "core/media/png_decoder.hpp"
#include "core/media/png_encoder.hpp"
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

TEST_P(ImageCodec, QuickPngsOfAnySizeAreWholeAndTheSameEachTime) {
  // Of noise, which does not pack, and of one value, which does; wider than tall and the other way round.
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 7}, {7, 1}, {2, 2}, {53, 37}, {1001, 3}, {1201, 677}})
    for (const bool noisy : {true, false}) {
      cv::Mat image(height, width, GetParam(), cv::Scalar(3, 250, 77, 128));
      if (noisy) cv::randu(image, 0, image.depth() == CV_16U ? 65536 : 256);
      const auto bytes = encode_png(image, 1);
      EXPECT_TRUE(same_pixels(cv::imdecode(bytes, cv::IMREAD_UNCHANGED), image)) << image.size() << noisy;
      EXPECT_TRUE(same_pixels(decode_pixels(bytes), image)) << image.size() << noisy;
      EXPECT_EQ(encode_png(image, 1), bytes);
      if (!noisy && image.total() > 100000) {
        EXPECT_LT(bytes.size(), image.total() * image.elemSize() / 50);
      }
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

/// A PNG whose rows are filtered as `filters` says, in turn, by the standard's own words.
/// @param parts how many chunks the packed pixels lie in
/// @param words chunks that say nothing about pixels stand among them
std::vector<unsigned char> filtered_png(const cv::Mat& image, const std::vector<unsigned char>& filters,
                                        std::size_t parts = 1, bool words = false) {
  cv::Mat stored = image.clone();
  if (image.channels() == 3) cv::cvtColor(image, stored, cv::COLOR_BGR2RGB);
  if (image.channels() == 4) cv::cvtColor(image, stored, cv::COLOR_BGRA2RGBA);
  const std::size_t pixel = image.elemSize(), bytes = pixel * static_cast<std::size_t>(image.cols);
  std::vector<unsigned char> rows, above(bytes, 0), row(bytes);
  for (int y = 0; y < image.rows; ++y) {
    std::copy_n(stored.ptr(y), bytes, row.begin());
    if (image.depth() == CV_16U)
      for (std::size_t i = 0; i < bytes; i += 2) std::swap(row[i], row[i + 1]);
    const unsigned char filter = filters[static_cast<std::size_t>(y) % filters.size()];
    rows.push_back(filter);
    for (std::size_t i = 0; i < bytes; ++i) {
      const int a = i < pixel ? 0 : row[i - pixel], b = above[i], c = i < pixel ? 0 : above[i - pixel];
      const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      const int nearest = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      const std::array<int, 5> predicted{0, a, b, (a + b) / 2, nearest};
      rows.push_back(static_cast<unsigned char>(row[i] - predicted[std::min<std::size_t>(filter, 4)]));
    }
    above = row;
  }
  uLongf packed_size = compressBound(rows.size());
  std::vector<unsigned char> packed(packed_size);
  EXPECT_EQ(compress(packed.data(), &packed_size, rows.data(), rows.size()), Z_OK);
  packed.resize(packed_size);
  std::vector<unsigned char> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const auto number = [](std::uint32_t n) {
    return std::vector<unsigned char>{static_cast<unsigned char>(n >> 24),
                                      static_cast<unsigned char>(n >> 16), static_cast<unsigned char>(n >> 8),
                                      static_cast<unsigned char>(n)};
  };
  const auto append = [&](const std::string& name, const std::vector<unsigned char>& data) {
    const auto length = number(static_cast<std::uint32_t>(data.size()));
    std::vector<unsigned char> named(name.begin(), name.end());
    named.insert(named.end(), data.begin(), data.end());
    const auto sum =
        number(static_cast<std::uint32_t>(crc32(0, named.data(), static_cast<uInt>(named.size()))));
    for (const auto& part : {length, named, sum}) png.insert(png.end(), part.begin(), part.end());
  };
  std::vector<unsigned char> header = number(static_cast<std::uint32_t>(image.cols));
  const auto height = number(static_cast<std::uint32_t>(image.rows));
  header.insert(header.end(), height.begin(), height.end());
  const int colour = image.channels() == 1 ? 0 : image.channels() == 3 ? 2 : 6;
  header.insert(header.end(), {static_cast<unsigned char>(image.depth() == CV_16U ? 16 : 8),
                               static_cast<unsigned char>(colour), 0, 0, 0});
  append("IHDR", header);
  if (words) append("tEXt", {'b', 'y', 0, 'u', 's'});
  for (std::size_t part = 0; part < parts; ++part)
    append("IDAT", {packed.begin() + static_cast<std::ptrdiff_t>(part * packed.size() / parts),
                    packed.begin() + static_cast<std::ptrdiff_t>((part + 1) * packed.size() / parts)});
  if (words) append("tIME", {7, 234, 11, 30, 12, 0, 0});
  append("IEND", {});
  return png;
}

TEST_P(ImageCodec, UndoesEveryFilterAndAnyOrderOfThem) {
  const std::vector<std::vector<unsigned char>> orders{{0},
                                                       {1},
                                                       {2},
                                                       {3},
                                                       {4},
                                                       {4, 1, 2, 0},
                                                       {3, 3, 3, 3, 3, 3, 3, 3, 0, 4, 2, 4, 1},
                                                       {3, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                       {2, 4, 0, 4, 1, 4, 3}};
  for (const auto& [width, height] : {std::pair{53, 37}, {1, 1}, {2, 9}, {3, 64}, {640, 5}})
    for (const auto& order : orders) {
      cv::Mat image = noise(GetParam());
      cv::resize(image, image, {width, height}, 0, 0, cv::INTER_NEAREST);
      const auto bytes = filtered_png(image, order);
      EXPECT_TRUE(same_pixels(decode_plain_png(bytes), image))
          << width << "x" << height << " filter " << int{order.front()} << " of " << order.size();
      EXPECT_TRUE(same_pixels(cv::imdecode(bytes, cv::IMREAD_UNCHANGED), image));
    }
}

TEST_P(ImageCodec, ReadsPixelsThatLieInSeveralChunksWithOthersAmongThem) {
  const cv::Mat image = noise(GetParam());
  for (const std::size_t parts : {1, 2, 3, 50})
    for (const bool words : {false, true}) {
      const auto bytes = filtered_png(image, {4, 1, 2, 0}, parts, words);
      EXPECT_TRUE(same_pixels(decode_plain_png(bytes), image)) << parts;
      const ImageRead read = decode_image("a.png", bytes);
      EXPECT_EQ(read.problem, "");
      EXPECT_TRUE(same_pixels(read.image, image)) << parts;
      auto damaged = bytes;
      damaged[words ? 8 + 25 + 9 : damaged.size() - 12 - 5] ^= 1U;  // of the text; of the pixels' checksum
      EXPECT_THAT(decode_image("a.png", damaged).problem, testing::HasSubstr("a checksum is wrong")) << parts;
    }
}

TEST_P(ImageCodec, OfADamagedPngThereIsNothing) {
  const cv::Mat image = noise(GetParam());
  EXPECT_TRUE(decode_plain_png(filtered_png(image, {5})).empty());  // there are five filters, 0 to 4
  const auto whole = filtered_png(image, {4});
  for (std::size_t size = 0; size < whole.size() - 16; size += 7)
    EXPECT_TRUE(decode_plain_png({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}).empty());
}

TEST_P(ImageCodec, AViewIntoALargerImageIsWrittenAlone) {
  const cv::Mat whole = noise(GetParam()), part = whole(cv::Rect(5, 6, 20, 10));
  for (const int level : {1, 3})
    EXPECT_TRUE(same_pixels(decode_pixels(encode_png(part, level)), part)) << level;
}

TEST(ImageCodecs, AQuickPngIsWhatTheStandardSays) {
  // Two pixels beside each other: what is left of the second is taken off it, in the order red, green, blue.
  cv::Mat image(1, 2, CV_8UC3);
  image.at<cv::Vec3b>(0, 0) = {10, 20, 30};
  image.at<cv::Vec3b>(0, 1) = {13, 19, 34};
  const auto bytes = encode_plain_png(image);
  ASSERT_GT(bytes.size(), 57U);
  const auto number = [&](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24U | std::uint32_t{bytes[at + 1]} << 16U |
           std::uint32_t{bytes[at + 2]} << 8U | bytes[at + 3];
  };
  const std::uint32_t packed = number(33);
  EXPECT_EQ(bytes.size(), 33U + 12U + packed + 12U);
  std::array<unsigned char, 16> rows{};
  uLongf size = rows.size();
  ASSERT_EQ(uncompress(rows.data(), &size, bytes.data() + 41, packed), Z_OK);
  const std::array<unsigned char, 7> wanted{1, 30, 20, 10, 4, 255, 3};
  ASSERT_EQ(size, wanted.size());
  EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), rows.begin()));
  // Each chunk's checksum by zlib: the header's, the data's and the end's.
  for (const auto& [type, content] :
       {std::pair<std::size_t, std::uint32_t>{12, 13}, {37, packed}, {49 + packed, 0}})
    EXPECT_EQ(number(type + 4 + content), crc32(0, bytes.data() + type, content + 4)) << type;
  for (const int other : {CV_16UC1, CV_8UC2, CV_32FC1, CV_8SC1})
    EXPECT_TRUE(encode_plain_png(cv::Mat(4, 4, other, cv::Scalar(0))).empty()) << other;
  EXPECT_TRUE(encode_plain_png(cv::Mat()).empty());
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
