// What a recording's topics are read as where there are several of a kind, or none that can be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/bag_example.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kChoiceFrames = 6;
const InfoExample kSmallInfo{64, 48, "plumb_bob", {0, 0, 0, 0, 0}, 60, 61, 31, 23};

/// Poses that move along x by so much a frame.
void add_poses(std::vector<LogMessage>& messages, bool cdr, const std::string& topic, double metres_a_frame) {
  for (int i = 0; i < kChoiceFrames; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = metres_a_frame * i;
    const std::int64_t stamp = small_stamp(i);
    messages.push_back({topic, "geometry_msgs/PoseStamped", stamp, pose_bytes(cdr, stamp, "world", pose)});
  }
}

void add_tf(std::vector<LogMessage>& messages, bool cdr, const char* parent, const char* child, bool moves) {
  for (int i = 0; i < kChoiceFrames; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = moves ? i : 0;
    const std::int64_t stamp = small_stamp(i);
    messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp, tf_bytes(cdr, {{stamp, parent, child, pose}})});
  }
}

/// geometry_msgs/TransformStamped.
std::string transform_bytes(bool cdr, std::int64_t stamp, const char* child, const Pose& pose) {
  return MessageWriter(cdr).header(stamp, "world").text(child).pose(pose).take();
}

/// Replaces the first `count` messages of a topic.
void replace_first(std::vector<LogMessage>& messages, const std::string& topic, int count,
                   const std::string& bytes) {
  for (LogMessage& message : messages)
    if (message.topic == topic && count-- > 0) message.bytes = bytes;
}

double last_x(const FrameSource& source) {
  return source.ground_truth().back().world_from_camera.translation().x();
}

TEST(BagChoice, OfSeveralBodiesTheCamerasIsTakenAndTheOthersAreTold) {
  for (const char* camera : {"/mocap/kinect/pose", "/vicon/Camera1", "/vicon/zz_cam/pose"}) {
    SCOPED_TRACE(camera);
    in_every_kind(
        [&](bool cdr) {
          auto messages = small_messages(kChoiceFrames, kSmallInfo, cdr);
          add_poses(messages, cdr, "/a_mocap/person/pose", 2.0);
          add_poses(messages, cdr, camera, 1.0);
          return messages;
        },
        [&](const std::string& path) {
          const auto source = open_sequence(path);
          EXPECT_NEAR(last_x(*source), kChoiceFrames - 1, 1e-9);
          EXPECT_THAT(source->warnings(),
                      Contains(AllOf(HasSubstr("2 topics may be the camera's ground truth"),
                                     HasSubstr(std::string(camera) + " was taken"),
                                     HasSubstr("/a_mocap/person/pose"), HasSubstr("`--topics truth="))));
          OpenOptions options;
          options.topics = "truth=/a_mocap/person/pose";
          const auto asked = open_sequence(path, options);
          EXPECT_NEAR(last_x(*asked), 2.0 * (kChoiceFrames - 1), 1e-9);
          EXPECT_THAT(asked->warnings(), IsEmpty());
        });
  }
}

TEST(BagChoice, ABodyThatTfJoinsWithTheCameraIsItsForCertain) {
  auto messages = small_messages(kChoiceFrames, kSmallInfo);
  add_tf(messages, false, "mount", "cam", false);
  for (int i = 0; i < kChoiceFrames; ++i)
    for (const auto& [topic, body, step] :
         {std::tuple{"/vicon/camera", "stranger", 2.0}, std::tuple{"/vicon/rig", "mount", 1.0}}) {
      Pose pose = Pose::Identity();
      pose.translation().x() = step * i;
      messages.push_back({topic, "geometry_msgs/TransformStamped", small_stamp(i),
                          transform_bytes(false, small_stamp(i), body, pose)});
    }
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  EXPECT_NEAR(last_x(*source), kChoiceFrames - 1, 1e-9);
  EXPECT_THAT(source->warnings(), IsEmpty());
}

TEST(BagChoice, TruthThatIsNotTakenIsTold) {
  const auto why_not = [](const auto& add) {
    auto messages = small_messages(kChoiceFrames, kSmallInfo);
    add(messages);
    const Recording bag(".bag");
    write_ros1_bag(bag.path, messages);
    const auto source = open_sequence(bag.path);
    EXPECT_TRUE(source->ground_truth().empty());
    return source->why_not(FramePart::truth);
  };
  EXPECT_THAT(why_not([](auto& messages) { add_poses(messages, false, "/slam/pose", 1.0); }),
              HasSubstr("/slam/pose (geometry_msgs/PoseStamped) may be an estimate and was not taken for "
                        "ground truth (`--topics truth=/slam/pose` takes it)"));
  EXPECT_THAT(why_not([](auto& messages) {
                add_poses(messages, false, "/slam/pose", 1.0);
                add_poses(messages, false, "/vio/pose", 1.0);
              }),
              AllOf(HasSubstr("/vio/pose"), HasSubstr("may be estimates and were not taken")));
  EXPECT_THAT(why_not([](auto& messages) { add_tf(messages, false, "world", "tracker", true); }),
              HasSubstr("has the way of tracker in world, to which the colour images' frame, cam, is not"));
  // Joints that move in the robot alone are no truth.
  EXPECT_EQ(why_not([](auto& messages) { add_tf(messages, false, "base_link", "wheel", true); }), "");
}

TEST(BagChoice, OfSeveralCamerasDepthIsOfColoursAndTheOthersAreTold) {
  in_every_kind(
      [](bool cdr) {
        auto messages = small_messages(kChoiceFrames, kSmallInfo, cdr);
        for (int i = 0; i < kChoiceFrames; ++i) {
          const std::int64_t stamp = small_stamp(i);
          // Registered, by its name, to a colour that is another camera's.
          messages.push_back(
              {"/rear/aligned_depth_to_color/image_raw", "sensor_msgs/Image", stamp,
               image_bytes(cdr, stamp, "rear", "32FC1", cv::Mat(48, 64, CV_32FC1, cv::Scalar(9.0)))});
          messages.push_back(
              {"/rear/color/image_raw", "sensor_msgs/Image", stamp,
               image_bytes(cdr, stamp, "rear", "bgr8", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(99)))});
        }
        return messages;
      },
      [](const std::string& path) {
        const auto source = open_sequence(path);
        EXPECT_EQ(source->read(2).colour.at<cv::Vec3b>(9, 9)[0], 2);
        EXPECT_FLOAT_EQ(source->read(2).depth.at<float>(9, 9), 3.0F);
        EXPECT_THAT(source->warnings(),
                    Contains(HasSubstr("2 cameras have colour and depth, /cam, /rear; /cam was taken "
                                       "(`--topics colour=TOPIC` takes another)")));
        OpenOptions options;
        options.topics = "colour=/rear/color/image_raw";
        const auto rear = open_sequence(path, options);
        EXPECT_FLOAT_EQ(rear->read(2).depth.at<float>(9, 9), 9.0F);
        EXPECT_THAT(rear->warnings(), Each(Not(HasSubstr("cameras have colour and depth"))));
      });
}

TEST(BagChoice, ColourIsOfTheCameraThatHasDepth) {
  auto messages = small_messages(kChoiceFrames, kSmallInfo);
  for (int i = 0; i < kChoiceFrames; ++i)
    messages.push_back({"/a_webcam/rgb/image_raw", "sensor_msgs/Image", small_stamp(i),
                        image_bytes(false, small_stamp(i), "webcam", "bgr8",
                                    cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(99)))});
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  EXPECT_EQ(source->read(2).colour.at<cv::Vec3b>(9, 9)[0], 2);
  EXPECT_THAT(source->warnings(), IsEmpty());
}

TEST(BagChoice, ATopicIsKnownByItsFirstMessageThatCanBeRead) {
  struct Fault {
    const char* topic;
    std::string (*bytes)(bool cdr);
  };
  const Fault faults[] = {
      {"/cam/rgb/image_raw", [](bool cdr) { return image_bytes(cdr, small_stamp(0), "", "", cv::Mat()); }},
      {"/cam/rgb/image_raw", [](bool) { return std::string(3, '\1'); }},
      {"/cam/depth/image", [](bool cdr) { return image_bytes(cdr, small_stamp(0), "", "", cv::Mat()); }},
      {"/cam/depth/image", [](bool) { return std::string(3, '\1'); }},
      {"/cam/rgb/camera_info",
       [](bool cdr) {
         return info_bytes(cdr, 1, {64, 48, "plumb_bob", {}, 0, 0});
       }},
      {"/cam/rgb/camera_info", [](bool) { return std::string(3, '\1'); }}};
  for (const Fault& fault : faults)
    in_every_kind(
        [&](bool cdr) {
          auto messages = small_messages(kChoiceFrames, kSmallInfo, cdr);
          replace_first(messages, fault.topic, 1, fault.bytes(cdr));
          return messages;
        },
        [&](const std::string& path) {
          SCOPED_TRACE(fault.topic);
          const auto source = open_sequence(path);
          EXPECT_TRUE(source->has_depth());
          EXPECT_EQ(source->camera().fx, 60);
          const Frame last = source->read(source->size() - 1);
          EXPECT_EQ(last.colour.at<cv::Vec3b>(9, 9)[0], kChoiceFrames - 1);
          EXPECT_TRUE(last.has_depth());
        });
}

TEST(BagChoice, ATopicWithoutAReadableImageIsNamed) {
  auto messages = small_messages(kChoiceFrames, kSmallInfo);
  replace_first(messages, "/cam/depth/image", kChoiceFrames, image_bytes(false, 1, "", "", cv::Mat()));
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(source->warnings(),
              Contains(HasSubstr("/cam/depth/image: none of its first 6 messages says what image it holds")));
}

TEST(BagChoice, ACameraInfoIsFoundByItsFrame) {
  const auto open = [](std::vector<std::string> topics, const std::string& asked = "") {
    auto messages = small_messages(kChoiceFrames, kSmallInfo);
    InfoExample info = kSmallInfo;
    for (LogMessage& message : messages)
      if (message.topic == "/cam/rgb/camera_info") {
        message.topic = topics[0], info.frame = topics[1];
        message.bytes = info_bytes(false, message.time, info);
      }
    const Recording bag(".bag");
    write_ros1_bag(bag.path, messages);
    OpenOptions options;
    options.topics = asked;
    const auto source = open_sequence(bag.path, options);
    return std::pair(source->camera(), source->warnings());
  };
  const auto [camera, none] = open({"/foo/bar", "cam"});
  EXPECT_EQ(camera.fx, 60);
  EXPECT_THAT(none, IsEmpty());
  const auto [assumed, of_another] = open({"/foo/bar", "elsewhere"});
  EXPECT_EQ(assumed.name, "ros_default");
  EXPECT_THAT(of_another, Contains(AllOf(HasSubstr("holds no sensor_msgs/CameraInfo of the colour images"),
                                         HasSubstr("`--topics info=/foo/bar` takes"))));
  EXPECT_EQ(open({"/foo/bar", "elsewhere"}, "info=/foo/bar").first.fx, 60);
  const auto [left_out, told] = open({"/cam/rgb/camera_info", "cam"}, "info=none");
  EXPECT_EQ(left_out.name, "ros_default");
  EXPECT_THAT(told, AllOf(Contains(HasSubstr("its CameraInfo is left out")),
                          Each(Not(HasSubstr("holds no sensor_msgs/CameraInfo")))));
}

}  // namespace
}  // namespace stillpoint
