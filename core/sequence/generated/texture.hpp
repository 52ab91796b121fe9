#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace stillpoint::generated {

/// A repeating picture with its reduced copies (mip levels), so that distant surfaces do not glitter.
class Texture {
 public:
  /// @param bgr CV_8UC3, both sides powers of two.
  explicit Texture(const cv::Mat& bgr);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }

  /// Bilinear colour (BGR, 0 to 255) at (u, v) in repeats of the texture, v downwards, on a level (0 = full
  /// size).
  [[nodiscard]] Eigen::Vector3f sample(float u, float v, int level) const {
    const Level& l = levels_[static_cast<std::size_t>(level < last_ ? (level > 0 ? level : 0) : last_)];
    const float x = u * static_cast<float>(l.width) - 0.5f, y = v * static_cast<float>(l.height) - 0.5f;
    const int x0 = floor_of(x), y0 = floor_of(y);
    const float ax = x - static_cast<float>(x0), ay = y - static_cast<float>(y0);
    const int xm = l.width - 1, ym = l.height - 1;
    const std::uint32_t* top = texels_.data() + l.offset + static_cast<std::size_t>((y0 & ym) * l.width);
    const std::uint32_t* bottom =
        texels_.data() + l.offset + static_cast<std::size_t>(((y0 + 1) & ym) * l.width);
    const int xa = x0 & xm, xb = (x0 + 1) & xm;
    return (colour(top[xa]) * (1 - ax) + colour(top[xb]) * ax) * (1 - ay) +
           (colour(bottom[xa]) * (1 - ax) + colour(bottom[xb]) * ax) * ay;
  }

 private:
  struct Level {
    int width, height;
    std::size_t offset;  ///< of its first texel in texels_
  };
  static int floor_of(float x) {
    const int i = static_cast<int>(x);
    return i - (x < static_cast<float>(i) ? 1 : 0);
  }
  static Eigen::Vector3f colour(std::uint32_t texel) {
    return {static_cast<float>(texel & 255u), static_cast<float>(texel >> 8 & 255u),
            static_cast<float>(texel >> 16 & 255u)};
  }

  std::vector<Level> levels_;
  std::vector<std::uint32_t> texels_;
  int last_ = 0;
};

/// Every picture the scenes are covered with.
enum class Picture {
  kPlain,  ///< white: the tint alone
  kCarpet,
  kPlaster,
  kCeiling,
  kFabric,  ///< of partition walls
  kWood,
  kDarkWood,
  kMetal,
  kPaperA,  ///< printed pages
  kPaperB,
  kPaperC,
  kKeyboard,
  kScreen,  ///< lines of code
  kWhiteboard,
  kCardboard,
  kSpineA,
  kSpineB,
  kSpineC,
  kPosterA,
  kPosterB,
  kPosterC,
  kPosterD,
  kPosterE,
  kPosterF,
  kPosterG,
  kPosterH,
  kCover,  ///< of a book
  kWindow,
  kPlaid,
  kStripes,
  kCloth,  ///< plain, woven
  kSkin,
  kFace,  ///< wrapped round a head, the face in the middle
  kHair,
  kLeaf,
  kMug,
  kCount
};

/// Draws all of them; the same seed gives the same pictures. Takes some tens of milliseconds.
[[nodiscard]] std::vector<Texture> draw_pictures(unsigned seed);

}  // namespace stillpoint::generated
