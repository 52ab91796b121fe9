#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/fingerprint.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/support/hash_of_run.hpp"
#include "tests/support/places.hpp"
#include "tests/unit/bag_example.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kExampleFrames = 8;

/// A generated sequence as a folder, and what a run of it gives: made once.
class Example {
 public:
  Example() {
    OpenOptions options;
    options.frames = kExampleFrames;
    write_sequence(*open_sequence("generated:walking_static", options), folder.path());
    source = open_sequence(folder.path());
    hash = hash_of_run(*source);
  }
  TemporaryFolder folder;
  std::unique_ptr<FrameSource> source;
  std::string hash;
};

const Example& example() {
  static const Example made;
  return made;
}

/// The recording gives what the folder gives: frames to the last bit, truth, and the run.
void expect_the_folders(const FrameSource& bag, bool with_run) {
  const FrameSource& folder = *example().source;
  ASSERT_EQ(bag.size(), folder.size());
  for (int i = 0; i < bag.size(); ++i) {
    const Frame a = bag.read(i), b = folder.read(i);
    EXPECT_EQ(a.problem, "") << i;
    EXPECT_EQ(a.timestamp, b.timestamp) << i;
    EXPECT_EQ(a.depth_timestamp, b.depth_timestamp) << i;
    ASSERT_TRUE(a.readable() && a.has_depth()) << i;
    EXPECT_EQ(cv::norm(a.colour, b.colour, cv::NORM_INF), 0) << i;
    EXPECT_EQ(cv::norm(a.depth, b.depth, cv::NORM_INF), 0) << i;
    ASSERT_TRUE(bag.truth(i).world_from_camera) << i;
    EXPECT_TRUE(bag.truth(i).world_from_camera->isApprox(*folder.truth(i).world_from_camera, 1e-9)) << i;
  }
  EXPECT_EQ(bag.ground_truth().size(), folder.ground_truth().size());
  EXPECT_EQ(bag.camera().fx, folder.camera().fx);
  EXPECT_EQ(bag.camera().cy, folder.camera().cy);
  EXPECT_THAT(bag.warnings(), IsEmpty());
  if (with_run) {
    EXPECT_EQ(hash_of_run(bag), example().hash);
  }
}

TEST(Ros1Bag, GivesTheFoldersRunWhateverItsCompression) {
  const auto messages = messages_of(*example().source);
  for (const char* compression : {"none", "bz2", "lz4"}) {
    SCOPED_TRACE(compression);
    const Recording bag(".bag");
    write_ros1_bag(bag.path, messages, compression);
    expect_the_folders(*open_sequence(bag.path), true);
  }
}

TEST(Ros1Bag, ChunksMayHoldManyMessagesOrOne) {
  BagExample kind;
  kind.truth = "pose", kind.colour = "bgr8";
  const auto messages = messages_of(*example().source, kind);
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{8} << 20}) {
    const Recording bag(".bag");
    write_ros1_bag(bag.path, messages, "lz4", bytes);
    expect_the_folders(*open_sequence(bag.path), false);
  }
}

TEST(Ros1Bag, OfRosItselfGivesTheFoldersRun) {
  const std::string python = "/usr/bin/python3 ";
  if (std::system((python + "-c 'import rosbag, sensor_msgs.msg, tf2_msgs.msg' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "needs Debian's python3-rosbag, python3-sensor-msgs and python3-tf2-msgs";
  const TemporaryFolder parts("parts");
  std::string manifest;
  int count = 0;
  for (const LogMessage& message : messages_of(*example().source)) {
    const std::string name = fmt::format("{}.bin", count++);
    parts.write(name, message.bytes);
    manifest += fmt::format("{} {} {} {}\n", message.topic, message.type, message.time, name);
  }
  parts.write("manifest", manifest);
  for (const char* compression : {"none", "bz2", "lz4"}) {
    SCOPED_TRACE(compression);
    const Recording bag(".bag");
    const std::string script = places::source() + "/tests/support/write_rosbag.py";
    ASSERT_EQ(std::system(
                  fmt::format("{}{} {} {} {}", python, script, parts.path("manifest"), bag.path, compression)
                      .c_str()),
              0);
    expect_the_folders(*open_sequence(bag.path), true);
  }
}

TEST(Mcap, GivesTheFoldersRunWhateverItsCompression) {
  BagExample kind;
  kind.cdr = true;
  const auto messages = messages_of(*example().source, kind);
  for (const char* compression : {"", "lz4", "zstd", "unchunked"}) {
    SCOPED_TRACE(compression);
    const Recording file(".mcap");
    write_mcap(file.path, messages, compression);
    expect_the_folders(*open_sequence(file.path), true);
  }
}

TEST(Mcap, HoldsRos1MessagesToo) {
  const Recording file(".mcap");
  write_mcap(file.path, messages_of(*example().source), "zstd", 1 << 20, "ros1");
  expect_the_folders(*open_sequence(file.path), false);
}

TEST(Rosbag2Database, GivesTheFoldersRunAsAFileAndAsAFolder) {
  BagExample kind;
  kind.cdr = true;
  const Recording file(".db3");
  write_db3(file.path, messages_of(*example().source, kind));
  expect_the_folders(*open_sequence(file.path), true);
  file.folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  version: 5\n");
  expect_the_folders(*open_sequence(file.folder.path()), false);
}

TEST(Bags, HoldCompressedImagesAndDepthOfSixteenBits) {
  OpenOptions options;
  options.depth_scale = example().source->camera().depth_scale;
  for (const char* depth : {"16UC1", "png"}) {
    BagExample kind;
    kind.depth = depth, kind.colour = "png", kind.truth = "pose";
    const Recording bag(".bag");
    write_ros1_bag(bag.path, messages_of(*example().source, kind), "none");
    expect_the_folders(*open_sequence(bag.path, options), false);
    // ROS counts millimetres; these images do not, which their range cannot tell.
    EXPECT_EQ(open_sequence(bag.path)->camera().depth_scale, 1000.0);
  }
}

TEST(Bags, TopicsAreListedAndChosen) {
  auto messages = messages_of(*example().source);
  const cv::Mat infrared(480, 640, CV_8UC1, cv::Scalar(9));
  const auto all = messages;
  for (const LogMessage& message : all)
    if (message.topic == "/camera/rgb/image_color")
      messages.push_back({"/camera/ir/image", "sensor_msgs/Image", message.time,
                          image_bytes(false, message.time, "ir", "mono8", infrared)});
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  EXPECT_THAT(source->contents(),
              AllOf(Contains(AllOf(HasSubstr("/camera/rgb/image_color"), HasSubstr("8 messages"),
                                   HasSubstr("read as colour"))),
                    Contains(AllOf(HasSubstr("/camera/depth/image"), HasSubstr("read as depth"))),
                    Contains(AllOf(HasSubstr("/tf"), HasSubstr("read as truth"))),
                    Contains(AllOf(HasSubstr("camera_info"), HasSubstr("read as info"))),
                    Contains(AllOf(HasSubstr("/camera/ir/image"), Not(HasSubstr("read as"))))));
  OpenOptions options;
  options.topics = "colour=/camera/ir/image,depth=none,truth=none";
  const auto chosen = open_sequence(bag.path, options);
  EXPECT_FALSE(chosen->has_depth());
  EXPECT_TRUE(chosen->ground_truth().empty());
  EXPECT_EQ(chosen->read(3).gray.at<unsigned char>(7, 7), 9);
  EXPECT_TRUE(chosen->read(3).colour.empty());
}

TEST(Bags, TopicsThatDoNotFitAreToldInOneSentence) {
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages_of(*example().source));
  const auto sentence = [&](const std::string& topics) {
    OpenOptions options;
    options.topics = topics;
    return input_error_of([&] { (void)open_sequence(bag.path, options); });
  };
  EXPECT_THAT(sentence("colour=/nothing"),
              AllOf(HasSubstr("has no topic /nothing"), HasSubstr("/camera/depth/image")));
  EXPECT_THAT(sentence("colour=/tf"), HasSubstr("/tf holds tf/tfMessage, which cannot be read as colour"));
  EXPECT_THAT(sentence("colours=/tf"), HasSubstr("expected colour=TOPIC"));
  EXPECT_THAT(sentence("depth"), HasSubstr("expected colour=TOPIC"));
  EXPECT_THAT(sentence("info=none,info=none"), HasSubstr("named twice"));
  OpenOptions options;
  options.topics = "colour=/a";
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(example().folder.path(), options); }),
              HasSubstr("--topics goes with a bag"));
}

TEST(Bags, WithoutImagesSayWhatTheyHold) {
  const Recording bag(".bag");
  write_ros1_bag(bag.path, {{"/tf", "tf/tfMessage", 5, tf_bytes(false, {})}});
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(bag.path); }),
              HasSubstr("it holds /tf (tf/tfMessage)"));
  const Recording mcap(".mcap");
  write_mcap(mcap.path, {{"/image", "foxglove/RawImage", 5, "{}"}}, "", 100, "json");
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(mcap.path); }),
              HasSubstr("/image (foxglove/RawImage, as 'json')"));
  const Recording none(".bag");
  none.folder.write("recording.bag", std::string("nothing of the kind"));
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(none.path); }),
              HasSubstr("is a file, expected a folder"));
}

}  // namespace
}  // namespace stillpoint
