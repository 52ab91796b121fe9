#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/sequence/source.hpp"
#include "tests/support/log_writer.hpp"
#include "tests/support/message_writer.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

/// How a sequence is written down as messages.
struct BagExample {
  bool cdr = false;
  std::string depth = "32FC1";  ///< or 16UC1, in the camera's units, or png (compressedDepth of 16UC1)
  std::string colour = "rgb8";  ///< or bgr8, or png
  std::string truth = "tf";     ///< or pose, or none
  bool with_info = true;
};

/// A stamp that was written with six decimals, in whole ns.
inline std::int64_t ns_of(double seconds) { return std::llround(seconds * 1e6) * 1000; }

inline std::string png_of(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

inline constexpr const char* kOptical = "camera_rgb_optical_frame";

/// The sensor's mounting in tf: what the camera's body and its optical frame are to each other.
inline Pose mounting() {
  Pose body_from_optical = Pose::Identity();
  body_from_optical.linear() = Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5).toRotationMatrix();
  body_from_optical.translation() = Eigen::Vector3d(0.02, -0.045, 0.0);
  return body_from_optical;
}

/// A sequence as the messages that a recording of it would hold, in the order of their stamps.
inline std::vector<LogMessage> messages_of(const FrameSource& source, const BagExample& example = {}) {
  std::vector<LogMessage> messages;
  const Camera& c = source.camera();
  const auto add = [&](const char* topic, const char* type, std::int64_t stamp, std::string bytes) {
    messages.push_back({topic, type, stamp + 3'000'000, std::move(bytes)});
  };
  for (int i = 0; i < source.size(); ++i) {
    const Frame frame = source.read(i);
    const std::int64_t stamp = ns_of(frame.timestamp), depth_stamp = ns_of(frame.depth_timestamp);
    if (example.with_info) {
      const InfoExample info{static_cast<std::uint32_t>(c.width),
                             static_cast<std::uint32_t>(c.height),
                             "plumb_bob",
                             {c.k1, c.k2, c.p1, c.p2, c.k3},
                             c.fx,
                             c.fy,
                             c.cx,
                             c.cy};
      add("/camera/rgb/camera_info", "sensor_msgs/CameraInfo", stamp, info_bytes(example.cdr, stamp, info));
    }
    cv::Mat colour = frame.colour;
    if (example.colour == "rgb8") cv::cvtColor(frame.colour, colour, cv::COLOR_BGR2RGB);
    if (example.colour == "png")
      add("/camera/rgb/image_color/compressed", "sensor_msgs/CompressedImage", stamp,
          compressed_bytes(example.cdr, stamp, kOptical, "bgr8; png compressed bgr8", png_of(colour)));
    else
      add("/camera/rgb/image_color", "sensor_msgs/Image", stamp,
          image_bytes(example.cdr, stamp, kOptical, example.colour, colour));
    if (!frame.has_depth()) continue;
    cv::Mat units;
    frame.depth.convertTo(units, CV_16U, c.depth_scale);
    if (example.depth == "png")
      add("/camera/depth/image_raw/compressedDepth", "sensor_msgs/CompressedImage", depth_stamp,
          compressed_bytes(example.cdr, depth_stamp, kOptical, "16UC1; compressedDepth",
                           std::string(12, '\0') + png_of(units)));
    else if (example.depth == "16UC1")
      add("/camera/depth/image_raw", "sensor_msgs/Image", depth_stamp,
          image_bytes(example.cdr, depth_stamp, kOptical, "16UC1", units));
    else {
      cv::Mat metres = frame.depth.clone();
      metres.setTo(std::nanf(""), frame.depth == 0);
      add("/camera/depth/image", "sensor_msgs/Image", depth_stamp,
          image_bytes(example.cdr, depth_stamp, kOptical, "32FC1", metres));
    }
  }
  const char* slash = example.cdr ? "" : "/";
  if (example.truth == "tf") {
    const char* type = example.cdr ? "tf2_msgs/TFMessage" : "tf/tfMessage";
    for (const StampedPose& pose : source.ground_truth()) {
      const std::int64_t stamp = ns_of(pose.timestamp);
      const std::vector<TransformExample> transforms = {
          {stamp, fmt::format("{}world", slash), fmt::format("{}kinect", slash),
           pose.world_from_camera * mounting().inverse()},
          {stamp, fmt::format("{}kinect", slash), fmt::format("{}{}", slash, kOptical), mounting()}};
      add("/tf", type, stamp, tf_bytes(example.cdr, transforms));
    }
  }
  if (example.truth == "pose")
    for (const StampedPose& pose : source.ground_truth())
      add("/vicon/camera/pose", "geometry_msgs/PoseStamped", ns_of(pose.timestamp),
          pose_bytes(example.cdr, ns_of(pose.timestamp), "world", pose.world_from_camera));
  std::stable_sort(messages.begin(), messages.end(),
                   [](const LogMessage& a, const LogMessage& b) { return a.time < b.time; });
  return messages;
}

/// A file in a folder whose name tells no camera.
class Recording {
 public:
  explicit Recording(const std::string& ending) : path(folder.path("recording" + ending)) {}
  TemporaryFolder folder;
  std::string path;
};

/// Of small_messages, ns.
inline std::int64_t small_stamp(int frame) { return 1'300'000'000'000'000'000 + frame * 33'000'000LL; }

/// A small recording: images of 64x48 px whose pixels tell their frame, and whatever else.
inline std::vector<LogMessage> small_messages(int frames, const InfoExample& info, bool cdr = false) {
  std::vector<LogMessage> messages;
  for (int i = 0; i < frames; ++i) {
    const std::int64_t stamp = small_stamp(i);
    messages.push_back(
        {"/cam/rgb/camera_info", "sensor_msgs/CameraInfo", stamp, info_bytes(cdr, stamp, info)});
    messages.push_back(
        {"/cam/rgb/image_raw", "sensor_msgs/Image", stamp,
         image_bytes(cdr, stamp, "cam", "bgr8", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(i)))});
    messages.push_back(
        {"/cam/depth/image", "sensor_msgs/Image", stamp,
         image_bytes(cdr, stamp, "cam", "32FC1", cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.0 + i)))});
  }
  return messages;
}

/// The same recording as a ROS 1 bag, an MCAP file and rosbag2's database, looked at one after the other.
/// @param messages gives them in ROS 1's serialisation or in CDR
inline void in_every_kind(const std::function<std::vector<LogMessage>(bool cdr)>& messages,
                          const std::function<void(const std::string& path)>& look) {
  for (const char* ending : {".bag", ".mcap", ".db3"}) {
    SCOPED_TRACE(ending);
    const Recording recording(ending);
    const std::string kind = ending;
    const auto written = messages(kind != ".bag");
    if (kind == ".bag")
      write_ros1_bag(recording.path, written);
    else if (kind == ".mcap")
      write_mcap(recording.path, written);
    else
      write_db3(recording.path, written);
    look(recording.path);
  }
}

}  // namespace stillpoint
