#pragma once

#include <imgui.h>

#include <cstdint>
#include <opencv2/core.hpp>

#include "ui/gl/gl.hpp"

namespace stillpoint {

/// How a texture is read between its pixels.
enum class Sampling {
  kNearest,  ///< sharp pixels at every size
  kLinear,   ///< smooth at every size
  kPixels,   ///< sharp pixels when enlarged, smooth (by mipmaps) when reduced: for images one inspects
};

/// What an image of one channel says.
enum class OneChannel {
  kGrey,   ///< how bright it is
  kCover,  ///< how much of a colour covers what lies below: white, with the channel as alpha
};

/// A picture on the graphics card.
class Texture {
 public:
  explicit Texture(const Gl& gl, Sampling sampling = Sampling::kPixels,
                   OneChannel one_channel = OneChannel::kGrey);

  /// Takes over an image: 8UC1 and 32FC1 (0 to 1) are what `one_channel` says, 8UC3 is BGR, 8UC4 is BGRA.
  /// Rows may be padded. Storage is kept while size and type stay the same. An empty image leaves the texture
  /// empty.
  /// @throws std::invalid_argument for another type.
  void upload(const cv::Mat& image);

  /// Makes uninitialised RGBA storage to draw into.
  void allocate(int width, int height);

  [[nodiscard]] bool empty() const { return width_ == 0; }
  [[nodiscard]] int width() const { return width_; }    ///< px
  [[nodiscard]] int height() const { return height_; }  ///< px
  [[nodiscard]] GLuint id() const { return texture_.id(); }

  /// The name under which ImGui's draw lists know it, another one after each change of what it holds.
  [[nodiscard]] ImTextureID imgui_id() const;

  /// What it holds is about to change from outside, by drawing into it.
  void note_change() const;

 private:
  void upload_levels(const cv::Mat& image, bool has_room);

  const Gl* gl_;
  GlObject texture_;
  Sampling sampling_;
  OneChannel one_channel_;
  int width_ = 0, height_ = 0, type_ = -1, last_level_ = -1;
  mutable std::uint32_t content_ = 0;  // no two contents of any texture have the same
};

/// Whether a texture known by this name has no alpha of its own.
[[nodiscard]] bool is_opaque(ImTextureID id);

/// The GL texture meant by Texture::imgui_id().
[[nodiscard]] GLuint from_imgui_texture(ImTextureID id);

}  // namespace stillpoint
