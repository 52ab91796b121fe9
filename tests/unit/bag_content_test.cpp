// What a bag's messages mean: its camera, depth, colours, truth and stamps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/bag_example.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Camera camera_read(const InfoExample& info, std::vector<std::string>* warnings = nullptr,
                   const std::string& colour = "/cam/rgb/image_raw") {
  const Recording bag(".bag");
  auto messages = small_messages(3, info);
  for (LogMessage& message : messages)
    if (message.topic == "/cam/rgb/image_raw") message.topic = colour;
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  if (warnings != nullptr) *warnings = source->warnings();
  return source->camera();
}

TEST(Bags, CameraComesFromCameraInfo) {
  InfoExample info{64, 48, "plumb_bob", {0.1, -0.2, 0.001, 0.002, 0.3}, 60, 61, 31, 23};
  std::vector<std::string> warnings;
  Camera camera = camera_read(info, &warnings);
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_EQ(camera.fx, 60);
  EXPECT_EQ(camera.fy, 61);
  EXPECT_EQ(camera.k3, 0.3);
  EXPECT_EQ(camera.p2, 0.002);
  // Rectified images are of P, without distortion.
  camera = camera_read(info, &warnings, "/cam/rgb/image_rect_color");
  EXPECT_EQ(camera.fx, 30);
  EXPECT_FALSE(camera.has_distortion());
  info.model = "equidistant";
  camera = camera_read(info, &warnings);
  EXPECT_THAT(warnings, Contains(AllOf(HasSubstr("'equidistant' with 5 coefficients, is not supported"),
                                       HasSubstr("ros_default is assumed"))));
  info.fx = 0, info.model = "plumb_bob";
  camera_read(info, &warnings);
  EXPECT_THAT(warnings, Contains(HasSubstr("not calibrated")));
}

TEST(Bags, ARegionOfInterestIsShiftedAndBinningScaled) {
  // Images of 64x48 px from a camera of 128x96, as its driver says they are made.
  InfoExample info{128, 96, "plumb_bob", {0.1, 0, 0, 0, 0}, 120, 121, 70, 50};
  info.roi = {20, 10, 64, 48};
  std::vector<std::string> warnings;
  Camera camera = camera_read(info, &warnings);
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.fx, 120);
  EXPECT_EQ(camera.fy, 121);
  EXPECT_EQ(camera.cx, 50);
  EXPECT_EQ(camera.cy, 40);
  EXPECT_EQ(camera.k1, 0.1);
  // Rectified ones likewise: P is of the whole image, too.
  camera = camera_read(info, &warnings, "/cam/rgb/image_rect_color");
  EXPECT_EQ(camera.fx, 60);
  EXPECT_EQ(camera.cx, 50);
  // Pixels' centres: what is 2c + 0.5 in the whole image is c where two pixels became one.
  info.roi = {}, info.binning = 2;
  camera = camera_read(info, &warnings);
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_EQ(camera.fx, 60);
  EXPECT_DOUBLE_EQ(camera.cx, (70 - 0.5) / 2);
  info.width = 256, info.height = 192, info.roi = {40, 20, 128, 96};
  camera = camera_read(info, &warnings);
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_DOUBLE_EQ(camera.cx, (70 - 40 - 0.5) / 2);
  // What goes beyond the image, and what images of the whole size were not made by, is not believed.
  info.width = 64, info.height = 48, info.roi = {10, 10, 64, 48}, info.binning = 0;
  EXPECT_EQ(camera_read(info).cx, 70);
  info.roi = {10, 10, 40, 36}, info.binning = 1;
  EXPECT_EQ(camera_read(info).cx, 70);
}

TEST(Bags, ACameraThatChangesIsTold) {
  const InfoExample first{64, 48, "plumb_bob", {0, 0, 0, 0, 0}, 60, 61, 31, 23};
  InfoExample later = first;
  later.fx = 40;
  const auto warnings = [&](int from) {
    const Recording bag(".bag");
    auto messages = small_messages(20, first);
    for (LogMessage& message : messages)
      if (message.topic == "/cam/rgb/camera_info" && message.time >= small_stamp(from))
        message.bytes = info_bytes(false, message.time, later);
    write_ros1_bag(bag.path, messages);
    const auto source = open_sequence(bag.path);
    EXPECT_EQ(source->camera().fx, 60);
    return source->warnings();
  };
  for (const int from : {10, 19})
    EXPECT_THAT(warnings(from),
                Contains(AllOf(HasSubstr("the camera changes: fx 60.0,"), HasSubstr("fx 40.0,"),
                               HasSubstr("the first was taken for all images"))));
  EXPECT_THAT(warnings(20), IsEmpty());
}

TEST(Bags, RationalDistortionIsFittedAndTold) {
  // An Azure Kinect's.
  const InfoExample info{
      64, 48, "rational_polynomial", {0.52, -2.67, 0.0006, -0.0002, 1.53, 0.40, -2.49, 1.46}, 60, 60, 32, 24};
  const Camera camera = camera_read(info);
  const auto rational = [&](double r2) {
    const auto& d = info.d;
    return (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / (1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  };
  for (const double r : {0.1, 0.3, 0.5, 0.6}) {
    const double fitted = 1 + r * r * (camera.k1 + r * r * (camera.k2 + r * r * camera.k3));
    EXPECT_NEAR(r * fitted * 60, r * rational(r * r) * 60, 0.2) << r;  // px
  }
  // With a denominator of 1 it is plumb_bob's.
  const Camera plain =
      camera_read({64, 48, "rational_polynomial", {0.1, 0.2, 0, 0, 0.3, 0, 0, 0}, 60, 60, 32, 24});
  EXPECT_EQ(plain.k1, 0.1);
  EXPECT_EQ(plain.k2, 0.2);
  EXPECT_EQ(plain.k3, 0.3);
}

TEST(Bags, AKnownCamerasNameIsBelievedBeforeADriversDefault) {
  const TemporaryFolder folder("rgbd");
  const std::string path = folder.path("rgbd_dataset_freiburg1_xyz.bag");
  write_ros1_bag(path, small_messages(3, {64, 48, "plumb_bob", {0, 0, 0, 0, 0}}));
  const auto source = open_sequence(path);
  EXPECT_EQ(source->name(), "rgbd_dataset_freiburg1_xyz");
  EXPECT_EQ(source->camera().name, "freiburg1");
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("that of freiburg1 was taken")));
}

TEST(Bags, DepthIsChecked) {
  const Recording bag(".bag");
  auto messages = small_messages(6, {64, 48, "", {}, 60, 60, 32, 24});
  for (LogMessage& message : messages)
    if (message.topic == "/cam/depth/image")
      message.bytes =
          image_bytes(false, message.time, "depth", "32FC1", cv::Mat(48, 64, CV_32FC1, cv::Scalar(2000.0)));
  write_ros1_bag(bag.path, messages);
  EXPECT_THAT(open_sequence(bag.path)->warnings(),
              AllOf(Contains(AllOf(HasSubstr("`--depth-scale 1000` takes it for millimetres"),
                                   HasSubstr("reads 2000.00 to 2000.00 m, 2000.00 m in the middle"))),
                    Contains(HasSubstr("as if it were registered"))));
  OpenOptions options;
  options.depth_scale = 1000;
  EXPECT_FLOAT_EQ(open_sequence(bag.path, options)->read(0).depth.at<float>(3, 3), 2.0F);
  for (LogMessage& message : messages)
    if (message.topic == "/cam/depth/image")
      message.bytes =
          image_bytes(false, message.time, "cam", "32FC1", cv::Mat(24, 32, CV_32FC1, cv::Scalar(2.0)));
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(source->why_not(FramePart::depth), HasSubstr("is 32x24 px, but its colour image is 64x48 px"));
}

TEST(Bags, RealSenseRecordingsAreBagsToo) {
  const auto messages = [](double depth_focal) {
    std::vector<LogMessage> all = {{"/device_0/sensor_0/option/Depth_Units/value", "std_msgs/Float32", 1,
                                    MessageWriter(false).number(0.0001F).take()}};
    for (int i = 0; i < 4; ++i) {
      const std::int64_t stamp = 1'600'000'000'000'000'000 + i * 33'000'000LL;
      const cv::Mat infrared(48, 64, CV_8UC1, cv::Scalar(7));
      const auto info = [&](double focal) {
        return info_bytes(false, stamp, {64, 48, "Brown Conrady", {0, 0, 0, 0, 0}, focal, focal, 32, 24});
      };
      all.push_back({"/device_0/sensor_0/Depth_0/image/data", "sensor_msgs/Image", stamp,
                     image_bytes(false, stamp, "0", "mono16", cv::Mat(48, 64, CV_16UC1, cv::Scalar(12000)))});
      all.push_back({"/device_0/sensor_0/Depth_0/info/camera_info", "sensor_msgs/CameraInfo", stamp,
                     info(depth_focal)});
      all.push_back({"/device_0/sensor_0/Infrared_1/image/data", "sensor_msgs/Image", stamp,
                     image_bytes(false, stamp, "0", "mono8", infrared)});
      all.push_back({"/device_0/sensor_1/Color_0/image/data", "sensor_msgs/Image", stamp,
                     image_bytes(false, stamp, "0", "rgb8", cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3)))});
      all.push_back(
          {"/device_0/sensor_1/Color_0/info/camera_info", "sensor_msgs/CameraInfo", stamp, info(61)});
    }
    return all;
  };
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages(61));
  const auto source = open_sequence(bag.path);
  EXPECT_THAT(source->warnings(), IsEmpty());
  EXPECT_EQ(source->read(2).colour.at<cv::Vec3b>(9, 9), cv::Vec3b(3, 2, 1));
  EXPECT_NEAR(source->read(2).depth.at<float>(9, 9), 1.2, 1e-6);  // in units of 0.1 mm
  EXPECT_EQ(source->camera().fx, 61);
  write_ros1_bag(bag.path, messages(40));
  EXPECT_THAT(open_sequence(bag.path)->warnings(),
              Contains(HasSubstr("depth is of a camera of 40.0 px and colour of one of 61.0 px")));
}

TEST(Bags, EncodingsGiveTheSameColours) {
  const cv::Mat bgr(48, 64, CV_8UC3, cv::Scalar(200, 100, 40));
  const auto read = [&](const char* encoding, const cv::Mat& stored) {
    const Recording bag(".bag");
    write_ros1_bag(bag.path,
                   {{"/image", "sensor_msgs/Image", 7, image_bytes(false, 7, "f", encoding, stored)}});
    return open_sequence(bag.path)->read(0);
  };
  cv::Mat stored;
  cv::cvtColor(bgr, stored, cv::COLOR_BGR2RGBA);
  EXPECT_EQ(cv::norm(read("rgba8", stored).colour, bgr, cv::NORM_INF), 0);
  cv::cvtColor(bgr, stored, cv::COLOR_BGR2BGRA);
  EXPECT_EQ(cv::norm(read("bgra8", stored).colour, bgr, cv::NORM_INF), 0);
  // Red stands first in the first row, blue last in the second.
  cv::Mat bayer(48, 64, CV_8UC1);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      bayer.at<unsigned char>(y, x) = y % 2 == 0 ? (x % 2 == 0 ? 40 : 100) : (x % 2 == 0 ? 100 : 200);
  EXPECT_EQ(cv::norm(read("bayer_rggb8", bayer).colour, bgr, cv::NORM_INF), 0);
  // YUY2 of a grey: Y U Y V.
  cv::Mat yuy2(48, 64, CV_8UC2, cv::Scalar(126, 128));
  EXPECT_LE(cv::norm(read("yuv422_yuy2", yuy2).colour, cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(128)),
                     cv::NORM_INF),
            2);
  const Recording bag(".bag");
  write_ros1_bag(bag.path, {{"/image", "sensor_msgs/Image", 7, image_bytes(false, 7, "f", "64FC9", bgr)}});
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(bag.path); }),
              HasSubstr("has the encoding '64FC9', which is not read"));
}

TEST(Bags, EstimatesAreNotTakenForTruthUnasked) {
  auto messages = small_messages(12, {64, 48, "", {}, 60, 60, 32, 24});
  for (int i = 0; i < 12; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = i;
    const std::int64_t stamp = 1'300'000'000'000'000'000 + i * 33'000'000LL;
    messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp, tf_bytes(false, {{stamp, "odom", "cam", pose}})});
  }
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  EXPECT_TRUE(source->ground_truth().empty());
  EXPECT_THAT(source->why_not(FramePart::truth), HasSubstr("`--topics truth=/tf` takes it"));
  OpenOptions options;
  options.topics = "truth=/tf";
  EXPECT_EQ(open_sequence(bag.path, options)->ground_truth().size(), 12U);
}

TEST(Bags, StampsThatStandStillAreReplacedByTheRecordings) {
  auto messages = small_messages(5, {64, 48, "", {}, 60, 60, 32, 24});
  for (LogMessage& message : messages)
    if (message.topic == "/cam/rgb/image_raw")
      message.bytes = image_bytes(false, 0, "cam", "bgr8", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(1)));
  const Recording bag(".bag");
  write_ros1_bag(bag.path, messages);
  const auto source = open_sequence(bag.path);
  ASSERT_EQ(source->size(), 5);
  EXPECT_TRUE(source->read(4).has_depth());
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("the times of recording were taken instead")));
}

}  // namespace
}  // namespace stillpoint
