#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace stillpoint {

// What warp_gray does of most pixels, by AVX2: for processors that can_warp_blocks() alone (x86-64).

/// Where a row of the destination comes from: (x + m0 · k) / (w + m6 · k) and so on for its k-th pixel, px.
struct WarpedRow {
  double x, y, w;
};

/// Warps groups of sixteen pixels that come from beside one another, as nearly all do between two frames.
/// Where a pixel comes from is a shift from its own place, which changes so little along a block that a
/// polynomial tells it; its error is bounded, and a group with a coordinate that close to where rounding
/// turns is left.
class BlockWarp {
 public:
  static constexpr int kBlock = 64;  ///< px, of one row: what a polynomial is made for
  static constexpr int kGroup = 16;  ///< px at once

  /// @param source CV_8UC1; kept by reference @param source_from_destination row by row; likewise
  BlockWarp(const cv::Mat& source, const std::array<double, 9>& source_from_destination)
      : source_(source), m_(source_from_destination) {}

  /// Fills what it can of a block, with cv::warpPerspective's bytes.
  /// @param row where the block's first pixel comes from @param first that pixel @param count at most kBlock
  /// @param to the block's bytes in the destination
  /// @return a bit for each whole group of kGroup pixels, the first one the lowest: set where it was filled
  unsigned fill(const WarpedRow& row, const cv::Point& first, int count, unsigned char* to) const;

 private:
  const cv::Mat& source_;
  const std::array<double, 9>& m_;
};

/// Whether the processor has AVX2 and fused multiplication.
[[nodiscard]] bool can_warp_blocks();

}  // namespace stillpoint
