// Stamps that cannot be believed.
#include "core/sequence/bag/bag_stamps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/check/findings.hpp"
#include "tests/unit/bag_example.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::int64_t kSecond = 1'000'000'000;  // ns
constexpr int kStampedFrames = 30;
const InfoExample kStampedInfo{64, 48, "plumb_bob", {0, 0, 0, 0, 0}, 60, 61, 31, 23};

/// Colour, depth and poses whose headers say what `stamp` makes of the time of recording. The camera moves a
/// metre a frame.
std::vector<LogMessage> stamped_messages(bool cdr, bool with_tf,
                                         const std::function<std::int64_t(int, std::int64_t)>& stamp) {
  std::vector<LogMessage> messages;
  for (int i = 0; i < kStampedFrames; ++i) {
    const std::int64_t time = small_stamp(i), told = stamp(i, time);
    messages.push_back(
        {"/cam/rgb/camera_info", "sensor_msgs/CameraInfo", time, info_bytes(cdr, told, kStampedInfo)});
    messages.push_back({"/cam/rgb/image_raw", "sensor_msgs/Image", time,
                        image_bytes(cdr, told, "cam", "bgr8", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(i)))});
    messages.push_back(
        {"/cam/depth/image", "sensor_msgs/Image", time,
         image_bytes(cdr, told, "cam", "32FC1", cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.0 + 0.01 * i)))});
    Pose pose = Pose::Identity();
    pose.translation().x() = i;
    if (with_tf)
      messages.push_back({"/tf", "tf2_msgs/TFMessage", time, tf_bytes(cdr, {{told, "world", "cam", pose}})});
    else
      messages.push_back(
          {"/vicon/cam", "geometry_msgs/PoseStamped", time, pose_bytes(cdr, told, "world", pose)});
  }
  return messages;
}

/// Every frame is there, in the order of recording, with its own depth and truth.
void expect_every_frame(const FrameSource& source, const std::string& told) {
  ASSERT_EQ(source.size(), kStampedFrames);
  for (int i = 0; i < kStampedFrames; ++i) {
    const Frame frame = source.read(i);
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(9, 9)[0], i);
    ASSERT_TRUE(frame.has_depth()) << i;
    EXPECT_FLOAT_EQ(frame.depth.at<float>(9, 9), static_cast<float>(1.0 + 0.01 * i));
    ASSERT_TRUE(source.truth(i).world_from_camera) << i;
    EXPECT_NEAR(source.truth(i).world_from_camera->translation().x(), i, 1e-6);
  }
  EXPECT_THAT(source.warnings(), AllOf(Contains(AllOf(HasSubstr("/image_raw:"), HasSubstr(told))),
                                       Contains(AllOf(HasSubstr("/depth/image:"), HasSubstr(told)))));
  EXPECT_THAT(check_frames(source), Each(Field(&Finding::about, "stamps")));
}

TEST(BagStamps, StandingStillTheyAreReplacedInImagesAndTruthAlike) {
  for (const bool with_tf : {false, true})
    in_every_kind(
        [&](bool cdr) { return stamped_messages(cdr, with_tf, [](int, std::int64_t) { return 0; }); },
        [&](const std::string& path) {
          const auto source = open_sequence(path);
          expect_every_frame(*source, "all stamps are 0.000 s; the times of recording were taken");
          EXPECT_THAT(source->warnings(), Contains(AllOf(HasSubstr(with_tf ? "/tf: cam:" : "/vicon/cam:"),
                                                         HasSubstr("all stamps are 0.000 s"))));
        });
}

TEST(BagStamps, AFewWithoutOneStandWhereTheyWereRecorded) {
  // The headers' clock is another than the recording's, and messages are recorded 5 ms late.
  const auto stamp = [](int i, std::int64_t time) {
    return i % 5 == 0 ? 0 : time - 1'299'999'000 * kSecond - 5'000'000;
  };
  for (const bool with_tf : {false, true})
    in_every_kind([&](bool cdr) { return stamped_messages(cdr, with_tf, stamp); },
                  [&](const std::string& path) {
                    const auto source = open_sequence(path);
                    expect_every_frame(*source, "6 of 30 messages have the stamp 0; the times of recording");
                    EXPECT_NEAR(source->timestamp(10) - source->timestamp(9), 0.033, 1e-6);
                  });
}

TEST(BagStamps, OfAClockThatWasSetBackAreReplaced) {
  const auto stamp = [](int i, std::int64_t time) { return i < 15 ? time : time - 400'000'000; };
  for (const bool with_tf : {false, true})
    in_every_kind([&](bool cdr) { return stamped_messages(cdr, with_tf, stamp); },
                  [&](const std::string& path) {
                    expect_every_frame(*open_sequence(path),
                                       "the clock was set back by 0.400 s before message 16 of 30");
                  });
}

TEST(BagStamps, MessagesThatCameLateAreSorted) {
  std::vector<std::int64_t> recorded, late, in_pairs;
  for (int i = 0; i < kStampedFrames; ++i) recorded.push_back(100 * kSecond + i * kSecond / 30);
  // Ten that stood in a queue while others passed: they fill the gap that they left.
  late = recorded;
  std::rotate(late.begin() + 10, late.begin() + 20, late.end());
  EXPECT_THAT(settle_bag_stamps(late, recorded).told, IsEmpty());
  EXPECT_EQ(settle_bag_stamps(late, recorded).stamps, late);
  in_pairs = recorded;
  for (std::size_t i = 1; i + 1 < in_pairs.size(); i += 2) std::swap(in_pairs[i], in_pairs[i + 1]);
  EXPECT_EQ(settle_bag_stamps(in_pairs, recorded).stamps, in_pairs);
}

TEST(BagStamps, AreWhatASentenceIsAboutWhateverTheTopicsName) {
  // Every second message is recorded after the one that follows it.
  auto messages = stamped_messages(
      false, true, [](int i, std::int64_t time) { return time + (i % 2 == 0 ? 40'000'000 : 0); });
  for (LogMessage& message : messages)
    if (message.topic.starts_with("/cam/")) message.topic.insert(4, "era");
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto findings = check_frames(*open_sequence(bag.path));
  EXPECT_THAT(findings, Contains(AllOf(
                            Field(&Finding::about, "stamps"),
                            Field(&Finding::sentence, AllOf(HasSubstr("/camera/rgb/image_raw: messages were"),
                                                            HasSubstr("another order"))))));
  EXPECT_THAT(findings, Each(Field(&Finding::about, "stamps")));
}

TEST(BagStamps, AClockThatBeginsAtZeroIsBelieved) {
  const std::vector<std::int64_t> stamps = {0, kSecond / 30, kSecond / 15};
  const BagStamps settled =
      settle_bag_stamps(stamps, {700 * kSecond, 700 * kSecond + kSecond / 25, 700 * kSecond + kSecond / 14});
  EXPECT_EQ(settled.stamps, stamps);
  EXPECT_EQ(settled.told, "");
  EXPECT_THAT(settle_bag_stamps({0}, {5}).stamps, ElementsAre(0));
  EXPECT_THAT(settle_bag_stamps({}, {}).stamps, IsEmpty());
}

TEST(BagStamps, DepthAtHalfTheRateIsNotBlamedOnItsClock) {
  for (const int first : {0, 1}) {
    SCOPED_TRACE(first);
    auto messages = stamped_messages(false, true, [](int, std::int64_t time) { return time; });
    std::erase_if(messages, [first](const LogMessage& message) {
      return message.topic == "/cam/depth/image" && (message.time - small_stamp(first)) % 66'000'000 != 0;
    });
    const Recording bag(".bag");
    write_ros1_bag(bag.path, messages);
    const auto source = open_sequence(bag.path);
    EXPECT_THAT(
        source->warnings(),
        AllOf(Contains(HasSubstr("15 of 30 colour images have no depth image within 0.02 s: there are "
                                 "only 15 depth images, one every 0.066 s where colour images come "
                                 "every 0.033 s")),
              Each(Not(HasSubstr("--depth-offset")))));
    EXPECT_FALSE(source->depth_late_s());
  }
}

TEST(BagStamps, ASingleDepthImageHasNoInterval) {
  auto messages = stamped_messages(false, true, [](int, std::int64_t time) { return time; });
  std::erase_if(messages, [](const LogMessage& message) {
    return message.topic == "/cam/depth/image" && message.time != small_stamp(0);
  });
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  EXPECT_THAT(open_sequence(bag.path)->warnings(),
              AllOf(Contains(HasSubstr("29 of 30 colour images have no depth image within 0.02 s: there is "
                                       "only 1 depth image")),
                    Each(Not(HasSubstr("one every")))));
}

}  // namespace
}  // namespace stillpoint
