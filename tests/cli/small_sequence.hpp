#pragma once

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

/// A TUM folder made in no time: a camera of 320x240 px that slides along a patterned wall 1.5 m away, 30
/// frames a second, depth and exact truth included. Frame i's images are rgb/i.png and depth/i.png.
class SmallSequence {
 public:
  static constexpr int kWidth = 320, kHeight = 240;
  static constexpr double kFocal = 260.0;  // px
  static constexpr double kDepth = 1.5;    // m
  static constexpr int kStep = 2;          // px a frame
  static constexpr double kDepthScale = 5000.0;

  explicit SmallSequence(int frames = 8) : frames_(frames) {
    folder.write(
        "camera.toml",
        fmt::format("name = \"small\"\nwidth = {}\nheight = {}\nfx = {}\nfy = {}\ncx = 159.5\ncy = 119.5\n"
                    "k1 = 0.0\nk2 = 0.0\np1 = 0.0\np2 = 0.0\nk3 = 0.0\ndepth_scale = {}\n",
                    kWidth, kHeight, kFocal, kFocal, kDepthScale));
    const cv::Mat wall = pattern(kWidth + kStep * frames);
    std::string truth;
    for (int i = 0; i < frames; ++i) {
      folder.write(colour(i), wall(cv::Rect(kStep * i, 0, kWidth, kHeight)).clone());
      folder.write(depth(i), cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(kDepth * kDepthScale)));
      truth += fmt::format("{:.4f} {:.6f} 0 0 0 0 0 1\n", stamp(i), kStep * i * kDepth / kFocal);
    }
    folder.write("groundtruth.txt", truth);
    write_lists();
  }

  [[nodiscard]] static double stamp(int i) { return 100.0 + i / 30.0; }  // s
  [[nodiscard]] static std::string colour(int i) { return fmt::format("rgb/{}.png", i); }
  [[nodiscard]] static std::string depth(int i) { return fmt::format("depth/{}.png", i); }
  [[nodiscard]] std::string path(const std::string& file = "") const { return folder.path(file); }

  /// The lists anew; `frames` may exceed those there are, which then serve again, to and fro.
  void write_lists(int frames = 0) const {
    std::string colours, depths;
    const int there = frames_, period = there > 1 ? 2 * there - 2 : 1;
    for (int i = 0; i < (frames > 0 ? frames : there); ++i) {
      const int turn = i % period, image = turn < there ? turn : period - turn;
      colours += fmt::format("{:.4f} {}\n", stamp(i), colour(image));
      depths += fmt::format("{:.4f} {}\n", stamp(i), depth(image));
    }
    folder.write("rgb.txt", colours);
    folder.write("depth.txt", depths);
  }

  TemporaryFolder folder;

 private:
  /// Grey boxes of all sizes: corners everywhere.
  static cv::Mat pattern(int width) {
    cv::Mat grey(kHeight, width, CV_8UC1, cv::Scalar(128));
    cv::RNG random(7);
    for (int i = 0; i < 1500; ++i) {
      const cv::Rect box(random.uniform(-10, width), random.uniform(-10, kHeight), random.uniform(5, 30),
                         random.uniform(5, 30));
      cv::rectangle(grey, box, cv::Scalar(random.uniform(0, 256)), cv::FILLED);
    }
    cv::Mat colour;
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
    return colour;
  }

  int frames_;
};

}  // namespace stillpoint
