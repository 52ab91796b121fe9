// MCAP files: read back by a reader that knows nothing of the writer, and message by message.
#include "core/export/mcap_export.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/message.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "core/export/foxglove_messages.hpp"
#include "core/export/mcap_writer.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"
#include "tests/cli/small_sequence.hpp"
#include "core/odometry/frame_result.hpp"

namespace stillpoint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// What a file's records say, read from the start to the end.
class McapRead {
 public:
  struct Message {
    std::string topic;
    std::uint64_t time = 0;
    std::string data;
  };

  explicit McapRead(const std::string& bytes) : bytes_(bytes) {
    EXPECT_EQ(bytes_.substr(0, 8), "\x89MCAP0\r\n");
    EXPECT_EQ(bytes_.substr(bytes_.size() - 8), "\x89MCAP0\r\n");
    std::size_t at = 8;
    while (at < bytes_.size() - 8) {
      const auto op = static_cast<unsigned char>(bytes_[at]);
      const auto size = number<std::uint64_t>(bytes_, at + 1);
      take(op, bytes_.substr(at + 9, size), at);
      at += 9 + size;
    }
    EXPECT_EQ(at, bytes_.size() - 8);
  }

  std::vector<Message> messages;
  std::map<std::string, std::pair<std::string, std::string>> schema_of;  // by topic: name and encoding
  std::map<std::string, std::string> schemas;                            // their data, by name
  int chunks = 0;
  std::map<std::uint64_t, std::uint64_t> statistics;  // by channel

  [[nodiscard]] std::size_t count(const std::string& topic) const {
    return static_cast<std::size_t>(
        std::count_if(messages.begin(), messages.end(), [&](const Message& m) { return m.topic == topic; }));
  }
  [[nodiscard]] const Message& first(const std::string& topic) const {
    return *std::find_if(messages.begin(), messages.end(),
                         [&](const Message& m) { return m.topic == topic; });
  }

 private:
  template <typename Number>
  static Number number(const std::string& from, std::size_t at) {
    Number value{};
    std::memcpy(&value, from.data() + at, sizeof(value));
    return value;
  }
  static std::string text(const std::string& from, std::size_t& at) {
    const auto size = number<std::uint32_t>(from, at);
    at += 4 + size;
    return from.substr(at - size, size);
  }

  void take(unsigned char op, const std::string& content, std::size_t at) {
    std::size_t i = 0;
    if (op == 3) {
      const auto id = number<std::uint16_t>(content, 0);
      i = 2;
      const std::string name = text(content, i), encoding = text(content, i);
      schemas[name] = text(content, i);
      named_[id] = {name, encoding};
    } else if (op == 4) {
      const auto id = number<std::uint16_t>(content, 0);
      i = 4;
      topics_[id] = text(content, i);
      schema_of[topics_[id]] = named_[number<std::uint16_t>(content, 2)];
    } else if (op == 6) {
      ++chunks;
      const auto size = number<std::uint64_t>(content, 16);
      const auto crc = number<std::uint32_t>(content, 24);
      i = 28;
      EXPECT_EQ(text(content, i), "zstd");
      const auto packed = number<std::uint64_t>(content, i);
      std::string chunk(size, '\0');
      EXPECT_EQ(ZSTD_decompress(chunk.data(), size, content.data() + i + 8, packed), size);
      EXPECT_EQ(::crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(size)), crc);
      for (std::size_t m = 0; m < size;) {
        const auto length = number<std::uint64_t>(chunk, m + 1);
        const std::string message = chunk.substr(m + 9, length);
        messages.push_back({topics_[number<std::uint16_t>(message, 0)], number<std::uint64_t>(message, 6),
                            message.substr(22)});
        m += 9 + length;
      }
    } else if (op == 0x0B) {
      EXPECT_EQ(number<std::uint64_t>(content, 0), messages.size());
    } else if (op == 8) {
      // A chunk index leads to a chunk.
      EXPECT_EQ(bytes_[number<std::uint64_t>(content, 16)], 6);
    } else if (op == 2) {
      const auto summary = number<std::uint64_t>(content, 0);
      EXPECT_EQ(bytes_[summary], 3);  // begins with the schemas
      const std::string covered = bytes_.substr(summary, at + 9 + 16 - summary);
      EXPECT_EQ(::crc32(0, reinterpret_cast<const Bytef*>(covered.data()), static_cast<uInt>(covered.size())),
                number<std::uint32_t>(content, 16));
    }
  }

  const std::string& bytes_;
  std::map<std::uint16_t, std::pair<std::string, std::string>> named_;
  std::map<std::uint16_t, std::string> topics_;
};

TEST(McapWriter, WhatIsWrittenIsThere) {
  const TemporaryFolder folder;
  McapWriter writer(folder.path("a.mcap"));
  const auto schema = writer.add_schema("thing", "jsonschema", "{}");
  const auto one = writer.add_channel("/one", "json", schema),
             two = writer.add_channel("/two", "json", schema);
  const std::string large(3 << 20, 'x');
  writer.write(one, 30, "{}");
  writer.write(two, 10, large);
  writer.write(one, 20, large);
  writer.write(one, 40, "last");
  writer.finish();
  const std::string bytes = folder.read("a.mcap");
  const McapRead read(bytes);
  EXPECT_EQ(read.chunks, 2);
  ASSERT_EQ(read.messages.size(), 4U);
  EXPECT_EQ(read.messages[1].topic, "/two");
  EXPECT_EQ(read.messages[1].data, large);
  EXPECT_EQ(read.messages[3].time, 40U);
  EXPECT_EQ(read.schema_of.at("/one").first, "thing");
}

TEST(McapWriter, AFullDiskIsTold) {
  EXPECT_THAT(input_error_of([] {
                McapWriter writer("/dev/full");
                const auto channel = writer.add_channel("/a", "json", 0);
                writer.write(channel, 1, std::string(1 << 20, 'x'));
                writer.finish();
              }),
              HasSubstr("cannot be written"));
  EXPECT_THAT(input_error_of([] { McapWriter("/nowhere/a.mcap"); }), HasSubstr("cannot be written"));
}

TEST(FoxgloveMessages, DescribeThemselves) {
  google::protobuf::FileDescriptorSet set;
  ASSERT_TRUE(set.ParseFromString(foxglove_descriptors()));
  ASSERT_EQ(set.file_size(), 2);
  EXPECT_EQ(set.file(0).name(), "google/protobuf/timestamp.proto");
  EXPECT_EQ(set.file(1).package(), "foxglove");
  const auto message = make_foxglove_message("CompressedImage");
  MessageFields(*message).time("timestamp", 1'500'000'002).text("format", "png").text("data", "\x01\x02");
  // Wire format: field 1 (the stamp: 1 s, 500000002 ns), 2 (data), 3 (format).
  EXPECT_EQ(message->SerializeAsString(),
            std::string("\x0A\x08\x08\x01\x10\x82\xCA\xB5\xEE\x01\x12\x02\x01\x02\x1A\x03png"));
}

TEST(McapExport, ARunInFoxglovesSchemas) {
  const SmallSequence sequence(6);
  const auto source = open_sequence(sequence.path());
  Config config;
  config.run.method = "paper";
  McapExport file(sequence.path("run.mcap"), source->camera());
  RunOptions options;
  options.on_frame = [&](const FrameResult& frame) {
    file.add(source->read(frame.record.index), frame.record, frame.mask);
  };
  const RunResult run = run_sequence(*source, config, options);
  file.finish(run, source->ground_truth());
  const std::string bytes = sequence.folder.read("run.mcap");
  const McapRead read(bytes);
  for (const char* topic : {"/camera/colour", "/camera/depth", "/camera/features", "/features", "/figures"})
    EXPECT_EQ(read.count(topic), 6U) << topic;
  EXPECT_EQ(read.count("/tf"), 12U);  // estimate and truth
  for (const char* topic : {"/camera/calibration", "/estimate", "/truth", "/map"})
    EXPECT_EQ(read.count(topic), 1U) << topic;
  EXPECT_EQ(read.schema_of.at("/camera/depth"),
            std::pair(std::string("foxglove.RawImage"), std::string("protobuf")));
  EXPECT_EQ(read.first("/camera/colour").time, 100'000'000'000U);
  const auto depth = make_foxglove_message("RawImage");
  ASSERT_TRUE(depth->ParseFromString(read.first("/camera/depth").data));
  const std::string text = depth->ShortDebugString();
  EXPECT_THAT(text, HasSubstr("width: 320 height: 240 encoding: \"16UC1\" step: 640"));
  const auto& figure = read.first("/figures");
  EXPECT_EQ(nlohmann::json::parse(figure.data)["frame"], 0);
  EXPECT_TRUE(nlohmann::json::parse(figure.data).contains("inliers"));
}

TEST(McapExport, TheLayoutNamesTopicsThatThereAre) {
  const auto layout = nlohmann::json::parse(foxglove_layout());
  EXPECT_EQ(layout["configById"]["Image!colour"]["imageMode"]["imageTopic"], "/camera/colour");
  EXPECT_EQ(layout["layout"]["direction"], "row");
}

}  // namespace
}  // namespace stillpoint
