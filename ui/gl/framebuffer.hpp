#pragma once

#include <opencv2/core.hpp>

#include "ui/gl/texture.hpp"

namespace stillpoint {

/// A picture to draw into: colour and depth, several samples a pixel where wanted, and its image afterwards
/// as a texture or on the CPU.
class Framebuffer {
 public:
  /// `samples` a pixel: 0 for one without resolving; more than the context offers means as many as it offers.
  /// @throws std::runtime_error when the driver refuses.
  Framebuffer(const Gl& gl, int width, int height, int samples = 0);

  /// Makes it the target of drawing, the whole of it the viewport.
  void bind() const;

  /// Brings the samples of a pixel together; to be called after drawing and before texture() or read().
  void resolve() const;

  /// Copies the resolved image, pixel by pixel, to what the context's window shows next.
  void copy_to_window() const;

  /// The resolved image; its first row is the lowest, as GL has it: draw it with v running from 1 to 0.
  [[nodiscard]] const Texture& texture() const { return colour_; }

  /// The resolved image, 8UC3 BGR, top row first. Leaves this framebuffer's resolved half bound for reading.
  [[nodiscard]] cv::Mat read() const;

  [[nodiscard]] int width() const { return width_; }      ///< px
  [[nodiscard]] int height() const { return height_; }    ///< px
  [[nodiscard]] int samples() const { return samples_; }  ///< a pixel; 0 when not multisampled

 private:
  const Gl* gl_;
  int width_, height_, samples_;
  GlObject framebuffer_;   ///< resolved; also the one drawn into when samples_ is 0
  GlObject multisampled_;  ///< drawn into when samples_ is not 0
  Texture colour_;
  GlObject colour_samples_, depth_;
};

/// Reads the framebuffer bound for reading: 8UC3 BGR, top row first.
[[nodiscard]] cv::Mat read_pixels(const Gl& gl, int width, int height);

}  // namespace stillpoint
