#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "core/sequence/source.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

inline constexpr int kInputFrames = 12;
inline constexpr double kStart = 1305031102.175;  // s since 1970

/// A folder at 30 Hz with depth 4 ms later and ground truth at 100 Hz, whose stamps and names are written as
/// told.
class InputFolder {
 public:
  explicit InputFolder(const std::string& name = "rgbd_dataset_freiburg3_test") : folder(name) {
    folder.write("camera.toml",
                 "name = \"own\"\nwidth = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 32\ncy = 24\n");
    for (int i = 0; i < kInputFrames; ++i) {
      folder.write(fmt::format("rgb/{}.png", i), cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, i)));
      folder.write(fmt::format("depth/{}.png", i), cv::Mat(48, 64, CV_16UC1, cv::Scalar(10000 + i)));
    }
    lists([](double t, int) { return fmt::format("{:.6f}", t); });
  }

  using Stamp = std::function<std::string(double seconds, int frame)>;
  /// The three lists, stamps written by `stamp`.
  void lists(const Stamp& stamp) const {
    std::string rgb, depth, truth;
    for (int i = 0; i < kInputFrames; ++i) {
      rgb += fmt::format("{} rgb/{}.png\n", stamp(kStart + i / 30.0, i), i);
      depth += fmt::format("{} depth/{}.png\n", stamp(kStart + 0.004 + i / 30.0, i), i);
      truth += fmt::format("{} {} 0 0 0 0 0 1\n", stamp(kStart + i / 30.0, i), i);
    }
    folder.write("rgb.txt", rgb);
    folder.write("depth.txt", depth);
    folder.write("groundtruth.txt", truth);
  }
  [[nodiscard]] std::unique_ptr<FrameSource> open(const OpenOptions& options = {}) const {
    return open_sequence(folder.path(), options);
  }
  void replace(const std::string& file, const std::string& what, const std::string& by) const {
    std::string text = folder.read(file);
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
      text.replace(at, what.size(), by);
    folder.write(file, text);
  }
  void each_depth(const std::function<cv::Mat(const cv::Mat&)>& make, const std::string& kind = "png") const {
    for (int i = 0; i < kInputFrames; ++i) {
      const cv::Mat depth(48, 64, CV_16UC1, cv::Scalar(10000 + i));
      folder.write(fmt::format("depth/{}.{}", i, kind), make(depth));
    }
    replace("depth.txt", ".png", "." + kind);
  }

  TemporaryFolder folder;
};

/// Every frame has its depth and its truth, 1/30 s apart, and the right ones.
inline void expect_whole(const FrameSource& source) {
  ASSERT_EQ(source.size(), kInputFrames);
  EXPECT_TRUE(source.has_depth());
  for (int i = 0; i < kInputFrames; ++i) {
    const Frame frame = source.read(i);
    EXPECT_EQ(frame.problem, "") << i;
    ASSERT_TRUE(frame.has_depth()) << i;
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5)[2], i);
    EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 5), static_cast<float>(10000 + i) / 5000.0F);
    EXPECT_LT(std::abs(frame.depth_timestamp - frame.timestamp), 0.005) << i;
    ASSERT_TRUE(source.truth(i).world_from_camera) << i;
    EXPECT_NEAR(source.truth(i).world_from_camera->translation().x(), i, 1e-3);
    EXPECT_NEAR(source.timestamp(i) - source.timestamp(0), i / 30.0, 1e-5);
  }
}

}  // namespace stillpoint
