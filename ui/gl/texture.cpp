#include "ui/gl/texture.hpp"

#include <fmt/format.h>

#include <atomic>
#include <stdexcept>

#include "ui/gl/mipmaps.hpp"

namespace stillpoint {
namespace {

constexpr int kAllLevels = 1000;                            // as GL has it for a new texture
constexpr std::uint64_t kOpaque = std::uint64_t{1} << 63U;  // the highest bit, which no texture's number has

struct PixelFormat {
  GLint internal;
  GLenum format;
  GLenum type;
};

PixelFormat pixel_format(int type) {
  switch (type) {
    case CV_8UC1:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case CV_8UC3:
      return {GL_RGB8, GL_BGR, GL_UNSIGNED_BYTE};
    case CV_8UC4:
      return {GL_RGBA8, GL_BGRA, GL_UNSIGNED_BYTE};
    case CV_32FC1:
      return {GL_R32F, GL_RED, GL_FLOAT};
    default:
      throw std::invalid_argument(fmt::format("no texture is made of images of OpenCV type {}", type));
  }
}

}  // namespace

Texture::Texture(const Gl& gl, Sampling sampling, OneChannel one_channel)
    : gl_(&gl), texture_(make_texture(gl)), sampling_(sampling), one_channel_(one_channel) {
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  const GLint magnified = sampling == Sampling::kLinear ? GL_LINEAR : GL_NEAREST;
  const GLint reduced = sampling == Sampling::kNearest  ? GL_NEAREST
                        : sampling == Sampling::kLinear ? GL_LINEAR
                                                        : GL_LINEAR_MIPMAP_LINEAR;
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, magnified);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, reduced);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void Texture::upload(const cv::Mat& image) {
  note_change();
  if (image.empty()) {
    width_ = height_ = 0;
    return;
  }
  const PixelFormat format = pixel_format(image.type());
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_->PixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(image.step[0] / image.elemSize()));
  const bool has_room = image.cols == width_ && image.rows == height_ && image.type() == type_;
  if (has_room) {
    gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, format.format, format.type, image.data);
  } else {
    gl_->TexImage2D(GL_TEXTURE_2D, 0, format.internal, image.cols, image.rows, 0, format.format, format.type,
                    image.data);
    width_ = image.cols;
    height_ = image.rows;
    type_ = image.type();
    const GLint grey[] = {GL_RED, GL_RED, GL_RED, GL_ONE}, cover[] = {GL_ONE, GL_ONE, GL_ONE, GL_RED};
    const GLint colour[] = {GL_RED, GL_GREEN, GL_BLUE, image.channels() == 4 ? GL_ALPHA : GL_ONE};
    gl_->TexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA,
                        image.channels() > 1                 ? colour
                        : one_channel_ == OneChannel::kCover ? cover
                                                             : grey);
  }
  gl_->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  if (sampling_ == Sampling::kPixels) upload_levels(image, has_room);
}

void Texture::upload_levels(const cv::Mat& image, bool has_room) {
  // Drawn in software, a driver's own way takes a compiler first and then as long as drawing does.
  const PixelFormat format = pixel_format(image.type());
  const std::vector<cv::Mat> levels = halved_levels(image);
  const int last = levels.empty() ? kAllLevels : static_cast<int>(levels.size());
  if (last != last_level_) gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, last);
  last_level_ = last;
  if (levels.empty()) gl_->GenerateMipmap(GL_TEXTURE_2D);
  for (int i = 0; i < static_cast<int>(levels.size()); ++i) {
    const cv::Mat& level = levels[static_cast<std::size_t>(i)];
    if (has_room)
      gl_->TexSubImage2D(GL_TEXTURE_2D, i + 1, 0, 0, level.cols, level.rows, format.format, format.type,
                         level.data);
    else
      gl_->TexImage2D(GL_TEXTURE_2D, i + 1, format.internal, level.cols, level.rows, 0, format.format,
                      format.type, level.data);
  }
}

void Texture::allocate(int width, int height) {
  note_change();
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  width_ = width;
  height_ = height;
  type_ = CV_8UC4;
}

void Texture::note_change() const {
  static std::atomic<std::uint32_t> last{0};
  content_ = ++last;
}

// ImTextureID is a pointer in older versions of ImGui and an integer in newer ones, 64 bits in both; a
// C-style cast serves both. What is drawn with another content has another name, and so is drawn again.
ImTextureID Texture::imgui_id() const {
  static_assert(sizeof(ImTextureID) == sizeof(std::uint64_t));
  const bool opaque =
      type_ >= 0 && CV_MAT_CN(type_) < 4 && (CV_MAT_CN(type_) > 1 || one_channel_ == OneChannel::kGrey);
  return (ImTextureID)((opaque ? kOpaque : 0) | (std::uint64_t{content_ & 0x7FFFFFFFU} << 32U) |
                       texture_.id());
}

bool is_opaque(ImTextureID id) { return ((std::uint64_t)id & kOpaque) != 0; }

GLuint from_imgui_texture(ImTextureID id) { return static_cast<GLuint>((std::uint64_t)id); }

}  // namespace stillpoint
