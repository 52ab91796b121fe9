#pragma once

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

  /// A reduced copy.
  struct Level {
    int width, height;    ///< powers of two
    std::int32_t offset;  ///< of its first texel
  };
  /// @param index 0 = full size; beyond the last it is the last
  [[nodiscard]] const Level& level(int index) const {
    return levels_[static_cast<std::size_t>(index < last_ ? (index > 0 ? index : 0) : last_)];
  }
  /// All levels' texels, row by row, each row followed by its first texel: blue, green and red from the
  /// lowest byte on.
  [[nodiscard]] const std::uint32_t* texels() const { return texels_.data(); }

 private:
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
