#include "ui/gl/framebuffer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace stillpoint {
namespace {

GlObject attach_renderbuffer(const Gl& gl, GLenum attachment, GLenum format, int samples, int width,
                             int height) {
  GlObject buffer = make_renderbuffer(gl);
  gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.id());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.id());
  return buffer;
}

void require_complete(const Gl& gl, int width, int height) {
  const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return;
  throw std::runtime_error(
      fmt::format("the OpenGL driver refuses a {}x{} framebuffer (status 0x{:04x})", width, height, status));
}

}  // namespace

Framebuffer::Framebuffer(const Gl& gl, int width, int height, int samples)
    : gl_(&gl),
      width_(width),
      height_(height),
      samples_(samples > 1 ? std::min(samples, gl.max_samples) : 0),
      framebuffer_(make_framebuffer(gl)),
      colour_(gl, Sampling::kLinear) {
  colour_.allocate(width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_.id(), 0);
  if (samples_ > 0) {
    require_complete(gl, width, height);
    multisampled_ = make_framebuffer(gl);
    gl.BindFramebuffer(GL_FRAMEBUFFER, multisampled_.id());
    colour_samples_ = attach_renderbuffer(gl, GL_COLOR_ATTACHMENT0, GL_RGBA8, samples_, width, height);
  }
  depth_ = attach_renderbuffer(gl, GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, samples_, width, height);
  require_complete(gl, width, height);
}

void Framebuffer::bind() const {
  colour_.note_change();
  gl_->BindFramebuffer(GL_FRAMEBUFFER, samples_ > 0 ? multisampled_.id() : framebuffer_.id());
  gl_->Viewport(0, 0, width_, height_);
}

void Framebuffer::resolve() const {
  if (samples_ == 0) return;
  // A scissor left on would cut the copy.
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, multisampled_.id());
  gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.id());
  gl_->BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Framebuffer::copy_to_window() const {
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
  gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl_->BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

cv::Mat Framebuffer::read() const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
  gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
  return read_pixels(*gl_, width_, height_);
}

cv::Mat read_pixels(const Gl& gl, int width, int height) {
  // Black rather than whatever lay in memory, should a driver read nothing. Four channels are how it lies
  // there; drivers are slow to leave one out.
  cv::Mat pixels(height, width, CV_8UC4, cv::Scalar::all(0));
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data);
  cv::flip(pixels, pixels, 0);
  cv::Mat image;
  cv::cvtColor(pixels, image, cv::COLOR_RGBA2BGR);
  return image;
}

}  // namespace stillpoint
