#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <random>

#include "core/sequence/bag/message_log.hpp"
#include "core/sequence/source.hpp"
#include "tests/unit/bag_example.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kFrameCount = 20;
constexpr std::int64_t kStart = 1'300'000'000'000'000'000;

/// Frames whose pixels tell their number.
std::vector<LogMessage> numbered_messages(bool cdr) {
  std::vector<LogMessage> messages;
  const InfoExample info{64, 48, "plumb_bob", {0, 0, 0, 0, 0}, 60, 60, 32, 24};
  for (int i = 0; i < kFrameCount; ++i) {
    const std::int64_t stamp = kStart + i * 33'000'000LL;
    messages.push_back({"/rgb/camera_info", "sensor_msgs/CameraInfo", stamp, info_bytes(cdr, stamp, info)});
    messages.push_back({"/rgb/image", "sensor_msgs/Image", stamp,
                        image_bytes(cdr, stamp, "c", "bgr8", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(i)))});
    messages.push_back(
        {"/depth/image", "sensor_msgs/Image", stamp,
         image_bytes(cdr, stamp, "c", "32FC1", cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.0 + i)))});
    Pose pose = Pose::Identity();
    pose.translation().x() = i;
    messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp, tf_bytes(cdr, {{stamp, "world", "c", pose}})});
  }
  return messages;
}

struct Kind {
  const char* name;
  const char* ending;
  void (*write)(const std::string& path);
};

const Kind kKinds[] = {
    {"bag", ".bag", [](const std::string& p) { write_ros1_bag(p, numbered_messages(false), "none", 40000); }},
    {"bag_bz2", ".bag",
     [](const std::string& p) { write_ros1_bag(p, numbered_messages(false), "bz2", 40000); }},
    {"bag_lz4", ".bag",
     [](const std::string& p) { write_ros1_bag(p, numbered_messages(false), "lz4", 40000); }},
    {"mcap", ".mcap", [](const std::string& p) { write_mcap(p, numbered_messages(true), "", 40000); }},
    {"mcap_lz4", ".mcap", [](const std::string& p) { write_mcap(p, numbered_messages(true), "lz4", 40000); }},
    {"mcap_zstd", ".mcap",
     [](const std::string& p) { write_mcap(p, numbered_messages(true), "zstd", 40000); }},
    {"mcap_unchunked", ".mcap",
     [](const std::string& p) { write_mcap(p, numbered_messages(true), "unchunked"); }},
    {"db3", ".db3", [](const std::string& p) { write_db3(p, numbered_messages(true)); }},
};

class DamagedBag : public ::testing::TestWithParam<Kind> {
 protected:
  DamagedBag() : path_(folder_.path(std::string("r") + GetParam().ending)) {
    GetParam().write(path_);
    whole_ = folder_.read(std::string("r") + GetParam().ending);
  }
  void put(const std::string& bytes) const { folder_.write(std::string("r") + GetParam().ending, bytes); }

  TemporaryFolder folder_;
  std::string path_, whole_;
};

/// Opens it and reads all it has: what it gives is what was written.
int frames_of(const std::string& path, std::vector<std::string>* warnings = nullptr) {
  const auto source = open_sequence(path);
  for (int i = 0; i < source->size(); ++i) {
    const Frame frame = source->read(i);
    if (!frame.readable()) continue;
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(40, 60)[1], i);
    if (frame.has_depth()) {
      EXPECT_FLOAT_EQ(frame.depth.at<float>(40, 60), static_cast<float>(1 + i));
    }
  }
  if (warnings != nullptr) *warnings = source->warnings();
  return source->size();
}

TEST_P(DamagedBag, WholeItSaysNothing) {
  std::vector<std::string> warnings;
  EXPECT_EQ(frames_of(path_, &warnings), kFrameCount);
  EXPECT_THAT(warnings, IsEmpty());
}

TEST_P(DamagedBag, CutOffItGivesWhatItHolds) {
  int last = kFrameCount;
  for (const double share : {0.99, 0.8, 0.6, 0.4}) {
    SCOPED_TRACE(share);
    put(whole_.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole_.size()))));
    std::vector<std::string> warnings;
    const int frames = frames_of(path_, &warnings);
    EXPECT_LE(frames, last);
    EXPECT_GE(frames, static_cast<int>((share - 0.25) * kFrameCount));
    EXPECT_THAT(warnings, Contains(HasSubstr("is cut off")));
    last = frames;
  }
}

TEST_P(DamagedBag, WhateverItHoldsItEndsInASentenceOrInFrames) {
  std::mt19937 random(17);
  const auto any = [&](std::size_t below) {
    return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
  };
  int opened = 0, refused = 0;
  for (int round = 0; round < 150; ++round) {
    std::string bytes = whole_;
    const std::size_t faults = 1 + any(8);
    for (std::size_t i = 0; i < faults; ++i) {
      // Heads of records are where lengths stand; the beginning and the end hold most of them.
      const std::size_t at = any(3) == 0 ? any(std::min<std::size_t>(bytes.size(), 6000)) : any(bytes.size());
      bytes[at] = static_cast<char>(any(2) == 0 ? 0xFF : any(256));
    }
    if (any(4) == 0) bytes.resize(any(bytes.size()));
    put(bytes);
    try {
      const auto source = open_sequence(path_);
      for (int i = 0; i < source->size(); i += 5) (void)source->read(i);
      ++opened;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(GetParam().ending));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_EQ(opened + refused, 150);
  EXPECT_GT(opened, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedBag, ::testing::ValuesIn(kKinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST(DamagedLengths, AreBelievedOnlyAsFarAsTheFileGoes) {
  const TemporaryFolder folder;
  const auto u32 = [](std::uint32_t value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  folder.write("r.bag", "#ROSBAG V2.0\n" + u32(0xFFFFFFF0) + "op=");
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(folder.path("r.bag")); }), HasSubstr("is damaged"));
  folder.write("r.bag", std::string("#ROSBAG V1.2\n"));
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(folder.path("r.bag")); }), HasSubstr("older format"));
  folder.write("r.mcap", std::string("\x89MCAP0\r\n") + '\x03' + std::string(8, '\x7F'));
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(folder.path("r.mcap")); }),
              HasSubstr("holds no colour images"));
}

TEST(Rosbag2, OfViewsIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.path("views.db3");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(
      sqlite3_exec(
          database,
          "CREATE VIEW topics AS SELECT 1 AS id, '/a' AS name, 'b' AS type, 'cdr' AS serialization_format;"
          "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);",
          nullptr, nullptr, nullptr),
      SQLITE_OK);
  sqlite3_close(database);
  EXPECT_THAT(input_error_of([&] { (void)open_rosbag2_db3(path, path); }), HasSubstr("are tables there"));
}

}  // namespace
}  // namespace stillpoint
