// Videos as sequences of colour images: written here, and opened by index, in any order, cut off, and at
// stamps of their own.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/media/media_module.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/source.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kVideoFrames = 40;
constexpr double kRate = 20.0;  // Hz
const cv::Size kSize(160, 120);

/// A frame that tells its number: so many bright columns of 4 px.
cv::Mat numbered(int index) {
  cv::Mat image(kSize, CV_8UC3, cv::Scalar(40, 40, 40));
  image.colRange(0, 4 * index).setTo(cv::Scalar(200, 200, 200));
  return image;
}
int number_of(const cv::Mat& gray) { return (cv::countNonZero(gray.row(60) > 120) + 2) / 4; }

/// By OpenCV's writer: with B frames, as most videos are.
void write_video(const std::string& path, const char* codec, int count = kVideoFrames) {
  cv::VideoWriter video(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]),
                        kRate, kSize);
  ASSERT_TRUE(video.isOpened()) << codec;
  for (int i = 0; i < count; ++i) video.write(numbered(i));
}

struct Kind {
  const char *ending, *codec;
};
void PrintTo(const Kind& kind, std::ostream* to) { *to << kind.ending; }
class Videos : public ::testing::TestWithParam<Kind> {
 protected:
  Videos() { write_video(path(), GetParam().codec); }
  [[nodiscard]] std::string path() const { return folder_.path(std::string("walk.") + GetParam().ending); }
  TemporaryFolder folder_;
};

TEST_P(Videos, AreSequencesOfColourAtTheirStamps) {
  const auto source = open_sequence(path());
  ASSERT_EQ(source->size(), kVideoFrames);
  EXPECT_EQ(source->name(), "walk");
  EXPECT_FALSE(source->has_depth());
  EXPECT_EQ(cv::Size(source->camera().width, source->camera().height), kSize);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("a video tells no camera; ros_default is assumed")));
  for (int i = 0; i < kVideoFrames; ++i) {
    const Frame frame = source->read(i);
    ASSERT_EQ(frame.problem, "");
    EXPECT_EQ(number_of(frame.gray), i);
    EXPECT_NEAR(frame.timestamp - source->timestamp(0), i / kRate, 1.5e-3);  // Matroska has milliseconds
  }
}

TEST_P(Videos, GiveTheSamePixelsInAnyOrder) {
  const auto forward = open_sequence(path()), anyhow = open_sequence(path());
  std::vector<cv::Mat> frames;
  for (int i = 0; i < kVideoFrames; ++i) frames.push_back(forward->read(i).colour);
  for (const int i : {39, 0, 20, 19, 12, 5, 38, 37, 1, 39, 25, 25, 24, 0})
    EXPECT_EQ(cv::norm(anyhow->read(i).colour, frames[static_cast<std::size_t>(i)], cv::NORM_INF), 0) << i;
}

TEST_P(Videos, OpenTheirFirstFramesAlone) {
  OpenOptions options;
  options.frames = 7;
  const auto source = open_sequence(path(), options);
  ASSERT_EQ(source->size(), 7);
  EXPECT_EQ(number_of(source->read(6).gray), 6);
}

INSTANTIATE_TEST_SUITE_P(Video, Videos,
                         ::testing::Values(Kind{"avi", "MJPG"}, Kind{"mp4", "mp4v"}, Kind{"mkv", "mp4v"}),
                         [](const auto& tested) { return std::string(tested.param.ending); });

TEST(Videos, ThatAreCutOffGiveWhatTheyHold) {
  const TemporaryFolder folder;
  for (const auto& [name, codec] : {std::pair("cut.avi", "MJPG"), std::pair("cut.mkv", "mp4v")}) {
    write_video(folder.path(name), codec);
    folder.truncate(name, 0.6);
    const auto source = open_sequence(folder.path(name));
    EXPECT_GT(source->size(), 10) << name;
    EXPECT_LT(source->size(), kVideoFrames) << name;
    for (int i = 0; i + 1 < source->size(); ++i) ASSERT_EQ(number_of(source->read(i).gray), i) << name;
  }
  EXPECT_THAT(open_sequence(folder.path("cut.avi"))->warnings(),
              Contains(HasSubstr("is cut off or damaged: its head says 40 frames")));
}

TEST(Videos, ThatCannotBeDecodedAreToldInOneSentence) {
  const TemporaryFolder folder;
  write_video(folder.path("cut.mp4"), "mp4v");
  folder.truncate("cut.mp4", 0.6);  // its index comes last
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(folder.path("cut.mp4")); }),
              HasSubstr("cut.mp4: is no video that can be decoded"));
  folder.write("noise.mkv", "\x1A\x45\xDF\xA3" + std::string(5000, 'x'));
  EXPECT_THAT(
      input_error_of([&] { (void)open_sequence(folder.path("noise.mkv")); }),
      AnyOf(HasSubstr("is no video that can be decoded"), HasSubstr("none of its frames can be decoded")));
  write_video(folder.path("walk.avi"), "MJPG", 2);
  OpenOptions options;
  options.topics = "colour=/a";
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(folder.path("walk.avi"), options); }),
              HasSubstr("--topics goes with a bag, and this is a video"));
  EXPECT_TRUE(is_sequence_file(folder.path("walk.avi")));
}

std::uint32_t big_endian_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}
std::string big_endian_bytes(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFFU);
  return bytes;
}

/// An MP4 whose frames last differently: `stts`, the table of durations, is written anew, and the boxes that
/// it lies in grow with it (ISO 14496-12, 8.6.1.2).
void make_variable(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::size_t table = bytes.rfind("stts");
  ASSERT_NE(table, std::string::npos);
  ASSERT_LT(bytes.rfind("mdat"), table) << "the frames' offsets would move";
  const std::size_t entries = big_endian_at(bytes, table + 8);
  ASSERT_EQ(entries, 1U);
  const std::uint32_t count = big_endian_at(bytes, table + 12), step = big_endian_at(bytes, table + 16);
  const std::string changed = big_endian_bytes(2) + big_endian_bytes(10) + big_endian_bytes(step) +
                              big_endian_bytes(count - 10) + big_endian_bytes(3 * step);
  bytes.replace(table + 8, 12, changed);
  // The edit list says how much of the track is shown.
  if (const std::size_t edits = bytes.rfind("elst"); edits != std::string::npos && edits < table)
    bytes.replace(edits + 12, 4, big_endian_bytes(3 * big_endian_at(bytes, edits + 12)));
  for (const char* box : {"moov", "trak", "mdia", "minf", "stbl", "stts"}) {
    const std::size_t at = bytes.rfind(box) - 4;
    bytes.replace(at, 4, big_endian_bytes(big_endian_at(bytes, at) + 8));
  }
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(Videos, OfVariableRateHaveTheirOwnStamps) {
  const TemporaryFolder folder;
  write_video(folder.path("walk.mp4"), "mp4v");
  make_variable(folder.path("walk.mp4"));
  const auto source = open_sequence(folder.path("walk.mp4"));
  ASSERT_EQ(source->size(), kVideoFrames);
  for (int i = 0; i < kVideoFrames; ++i) {
    const double expected = i <= 10 ? i / kRate : 10 / kRate + 3 * (i - 10) / kRate;
    EXPECT_NEAR(source->timestamp(i) - source->timestamp(0), expected, 1e-3) << i;
  }
}

TEST(Videos, RunWithoutDepth) {
  const TemporaryFolder folder;
  const auto scene = make_generated_sequence("walking_xyz", 4, 1);
  const auto video = media_module().video();
  ASSERT_TRUE(video->open(folder.path("walk.avi"), {640, 480}, 1.0 / 30.0));
  for (int i = 0; i < scene->size(); ++i) ASSERT_TRUE(video->write(scene->read(i).colour, i / 30.0));
  ASSERT_TRUE(video->close());
  const auto source = open_sequence(folder.path("walk.avi"));
  ASSERT_EQ(source->size(), 4);
  EXPECT_EQ(source->camera().name, "ros_default");
  EXPECT_LT(cv::norm(source->read(2).colour, scene->read(2).colour, cv::NORM_L1) / (3.0 * 640 * 480), 6.0);
  Config config;
  config.run.method = "epipolar";
  const RunResult run = run_sequence(*source, config);
  ASSERT_EQ(run.records.size(), 4U);
  EXPECT_GT(run.records[3].features_found, 100);
}

const std::array<double, 12> kUneven = {0.0,  0.04, 0.08, 0.5,  0.54, 1.2,
                                        1.24, 1.28, 1.32, 1.36, 1.46, 1.5};  // s

void write_own(const std::string& path, const cv::Size& size, const cv::Scalar& bgr) {
  const auto video = media_module().video();
  ASSERT_TRUE(video->open(path, size, 0.04)) << path;
  for (const double seconds : kUneven) ASSERT_TRUE(video->write(cv::Mat(size, CV_8UC3, bgr), seconds));
  ASSERT_TRUE(video->close());
}

TEST(WrittenVideos, AreTaggedAsTheyAreCoded) {
  const TemporaryFolder folder;
  const cv::Scalar red(0, 0, 255);
  for (const char* name : {"red.mp4", "red.mkv"}) write_own(folder.path(name), kSize, red);
  // ISO 14496-12, 12.1.5: primaries, transfer and matrix 1 (BT.709), and a byte whose first bit says full
  // range.
  const std::string mp4 = folder.read("red.mp4"), nclx("colrnclx\0\1\0\1\0\1\0", 15);
  EXPECT_NE(mp4.find(nclx), std::string::npos);
  // Matroska's Colour: matrix, transfer, primaries 1; range 1 (limited).
  const std::string mkv = folder.read("red.mkv");
  for (const char* element : {"\x55\xB1\x81\x01", "\x55\xBA\x81\x01", "\x55\xBB\x81\x01", "\x55\xB9\x81\x01"})
    EXPECT_NE(mkv.find(element), std::string::npos) << mkv.find("\x55\xB0");
  // Red is Y 63, Cb 102, Cr 240 by BT.709. OpenCV's reader hears no tags, and takes that by BT.601 for
  // 1.164 (63 - 16) + 1.596 (240 - 128) = 233; coded by BT.601 it would read 254.
  for (const char* name : {"red.mp4", "red.mkv"}) {
    const auto reader = media_module().video_reader();
    ASSERT_TRUE(reader->open(folder.path(name)) && reader->next());
    const cv::Scalar read = cv::mean(reader->image());
    EXPECT_NEAR(read[2], 233.0, 4.0) << name;
    EXPECT_LT(read[1], 4.0) << name;
  }
  // JPEG has colours of its own, BT.601 at full range, and no tags.
  write_own(folder.path("red.avi"), kSize, red);
  const auto reader = media_module().video_reader();
  ASSERT_TRUE(reader->open(folder.path("red.avi")) && reader->next());
  EXPECT_NEAR(cv::mean(reader->image())[2], 254.0, 3.0);
}

TEST(WrittenVideos, HaveTheirFramesTimesAndTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"own.mp4", "own.mkv", "own.avi"}) {
    SCOPED_TRACE(name);
    write_own(folder.path(name), kSize, cv::Scalar(90, 120, 60));
    const auto source = open_sequence(folder.path(name));
    ASSERT_EQ(source->size(), static_cast<int>(kUneven.size()));
    const bool steady = std::string(name).ends_with("avi");
    for (int i = 0; i < source->size(); ++i)
      EXPECT_NEAR(source->timestamp(i) - source->timestamp(0),
                  steady ? 0.04 * i : kUneven[static_cast<std::size_t>(i)], 1.1e-3);
    const std::string bytes = folder.read(name);
    std::filesystem::remove(folder.path(name));
    write_own(folder.path(name), kSize, cv::Scalar(90, 120, 60));
    EXPECT_TRUE(folder.read(name) == bytes);
  }
}

TEST(WrittenVideos, OfAFewFramesHaveStampsToo) {
  // OpenCV gives no frame of so short a Matroska file a stamp.
  const TemporaryFolder folder;
  const auto video = media_module().video();
  ASSERT_TRUE(video->open(folder.path("short.mkv"), kSize, 0.04));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(video->write(numbered(i), 0.04 * i));
  ASSERT_TRUE(video->close());
  const auto source = open_sequence(folder.path("short.mkv"));
  ASSERT_EQ(source->size(), 5);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(source->timestamp(i) - source->timestamp(0), 0.04 * i, 1.1e-3);
}

TEST(WrittenVideos, OfOddSizesKeepThemOrAreNotBegun) {
  const TemporaryFolder folder;
  write_own(folder.path("odd.avi"), {161, 121}, cv::Scalar(90, 120, 60));
  const auto reader = media_module().video_reader();
  ASSERT_TRUE(reader->open(folder.path("odd.avi")) && reader->next());
  EXPECT_EQ(reader->image().size(), cv::Size(161, 121));
  EXPECT_FALSE(media_module().video()->open(folder.path("odd.mp4"), {161, 121}, 0.04));
}

}  // namespace
}  // namespace stillpoint
