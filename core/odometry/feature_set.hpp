#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// A 256-bit ORB descriptor.
using Descriptor = std::array<std::uint64_t, 4>;

/// The number of differing bits, 0 to 256.
[[nodiscard]] inline int descriptor_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

/// The features of one frame, and an index to find them by place. Immutable once built.
struct FeatureSet {
  std::vector<cv::KeyPoint> keypoints;   ///< pixel in the image as it is, octave, angle (deg), response
  std::vector<cv::Point2f> undistorted;  ///< the same pixels as a pinhole would see them, px
  std::vector<Descriptor> descriptors;
  std::vector<float> depth;          ///< m; 0 where the frame has no measurement
  std::vector<float> static_weight;  ///< 0 to 1: how likely each is static; its weight in every pose

  [[nodiscard]] int size() const { return static_cast<int>(keypoints.size()); }

  /// Sorts the features into the place index; called once, when the vectors above are complete.
  void build_index(int width, int height);

  /// Appends to `found` the features within `radius` px (a square window, as the field does) of an
  /// undistorted pixel, of octaves `min_octave` to `max_octave`, in order of the index cells.
  void find(const cv::Point2f& pixel, float radius, int min_octave, int max_octave,
            std::vector<int>& found) const;

  /// All of it as bytes, and from them to the last bit. @pre `bytes` are packed()'s
  [[nodiscard]] std::vector<std::uint8_t> packed() const;
  [[nodiscard]] static FeatureSet unpacked(const std::vector<std::uint8_t>& bytes);

 private:
  void place();

  static constexpr int kCell = 16;  // px; a few features a cell
  int columns_ = 0, rows_ = 0;
  /// What finding asks of a feature, side by side.
  struct Placed {
    cv::Point2f pixel;  // undistorted, px
    int octave = 0, feature = 0;
  };
  std::vector<int> cell_start_;  // CSR: first entry of each cell in placed_
  std::vector<Placed> placed_;
};

/// The features of `all` for which keep[i] is non-zero, undistorted and indexed anew.
[[nodiscard]] FeatureSet subset(const FeatureSet& all, const std::vector<std::uint8_t>& keep, int width,
                                int height);

/// Reads each pixel's depth (m) from a CV_32FC1 image; 0 where the image is empty or has no measurement.
[[nodiscard]] std::vector<float> depth_at(const std::vector<cv::Point2f>& pixels, const cv::Mat& depth);

/// The same from a depth image taken a moment before or after, when the camera stood elsewhere: each pixel is
/// looked up where its point was seen then, and its depth brought back to when colour's row was taken.
/// @param pixels in the image as it is; @param undistorted the same ones as a pinhole would see them
/// @param velocity of the camera, a second; @param lag_s from the frame's time to depth's stamp; nothing =
/// depth is taken as it is, its camera's delay and readout included
[[nodiscard]] std::vector<float> depth_at(const std::vector<cv::Point2f>& pixels,
                                          const std::vector<cv::Point2f>& undistorted, const cv::Mat& depth,
                                          const Camera& camera, const Vector6d& velocity,
                                          std::optional<double> lag_s);

}  // namespace stillpoint
