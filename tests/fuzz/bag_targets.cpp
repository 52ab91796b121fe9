// Recordings of messages: ROS 1 bags, MCAP files and rosbag2's databases, down to their frames.
#include <opencv2/imgproc.hpp>

#include "core/media/image_codec.hpp"
#include "core/sequence/bag/bag_input.hpp"
#include "core/sequence/listed_sequence.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/log_writer.hpp"
#include "tests/support/message_writer.hpp"

namespace stillpoint::fuzz {
namespace {

using Seeds = std::vector<std::string>;

/// Colour, depth, the camera and where it was, at two moments.
std::vector<LogMessage> example(bool cdr, bool is_compressed) {
  std::vector<LogMessage> messages;
  const cv::Mat colour(32, 32, CV_8UC3, cv::Scalar::all(90)), depth(32, 32, CV_16UC1, cv::Scalar::all(1500));
  const auto png = [](const cv::Mat& image) {
    const auto bytes = encode_png(image, 6);
    return std::string(bytes.begin(), bytes.end());
  };
  for (const std::int64_t stamp : {1'000'000'000LL, 1'033'000'000LL}) {
    messages.push_back(
        {"/rgb/camera_info", "sensor_msgs/CameraInfo", stamp,
         info_bytes(
             cdr, stamp,
             {.width = 32, .height = 32, .d = {0, 0, 0, 0, 0}, .fx = 30, .fy = 30, .cx = 16, .cy = 16})});
    if (is_compressed) {
      messages.push_back({"/rgb/image/compressed", "sensor_msgs/CompressedImage", stamp,
                          compressed_bytes(cdr, stamp, "camera", "bgr8; png compressed bgr8", png(colour))});
      messages.push_back({"/depth/image/compressedDepth", "sensor_msgs/CompressedImage", stamp,
                          compressed_bytes(cdr, stamp, "camera", "16UC1; compressedDepth",
                                           std::string(12, '\0') + png(depth))});
    } else {
      messages.push_back(
          {"/rgb/image", "sensor_msgs/Image", stamp, image_bytes(cdr, stamp, "camera", "bgr8", colour)});
      messages.push_back(
          {"/depth/image", "sensor_msgs/Image", stamp, image_bytes(cdr, stamp, "camera", "16UC1", depth)});
    }
    messages.push_back({"/tf", cdr ? "tf2_msgs/TFMessage" : "tf/tfMessage", stamp,
                        tf_bytes(cdr, {{stamp, "world", "camera", Pose::Identity()}})});
  }
  return messages;
}

/// Makes a sequence of a recording and reads its first frames.
void read_frames(std::unique_ptr<MessageLog> log) {
  const OpenOptions options;
  const ListedSequence sequence(make_bag_input(std::move(log), options), options);
  for (int i = 0; i < std::min(sequence.size(), 2); ++i) {
    (void)sequence.read(i);
    (void)sequence.truth(i);
  }
}

void read_bag(std::string_view bytes) { read_frames(open_ros1_bag(file_of(bytes, "a.bag"), "a.bag")); }
Seeds bag_seeds() {
  Seeds seeds;
  for (const char* compression : {"none", "bz2", "lz4"})
    seeds.push_back(written(
        "a.bag", [&](const std::string& path) { write_ros1_bag(path, example(false, true), compression); }));
  seeds.push_back(
      written("a.bag", [](const std::string& path) { write_ros1_bag(path, example(false, false), "lz4"); }));
  return seeds;
}

void read_mcap(std::string_view bytes) { read_frames(open_mcap(file_of(bytes, "a.mcap"), "a.mcap")); }
Seeds mcap_seeds() {
  Seeds seeds;
  for (const char* compression : {"", "zstd", "lz4", "unchunked"})
    seeds.push_back(written(
        "a.mcap", [&](const std::string& path) { write_mcap(path, example(true, true), compression); }));
  seeds.push_back(
      written("a.mcap", [](const std::string& path) { write_mcap(path, example(true, false), "zstd"); }));
  return seeds;
}

void read_db3(std::string_view bytes) { read_frames(open_rosbag2_db3(file_of(bytes, "a.db3"), "a.db3")); }
Seeds db3_seeds() {
  return {written("a.db3", [](const std::string& path) {
    std::remove(path.c_str());
    write_db3(path, example(true, true));
  })};
}

}  // namespace

std::vector<Target> bag_targets() {
  // A block of zstd that is one byte over and over packs 32768 into one, bzip2 little less, and a chunk is
  // held twice while it grows; zstd's window may be 128 MB beside. A database's pages lie there as they are.
  constexpr std::size_t kUnpacked = 4 * 32768;
  return {{"bag", {8 << 20, kUnpacked}, read_bag, bag_seeds},
          {"mcap", {(128 + 8) << 20, kUnpacked}, read_mcap, mcap_seeds},
          {"db3", {4 << 20, 8000}, read_db3, db3_seeds}};
}

}  // namespace stillpoint::fuzz
