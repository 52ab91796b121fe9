#include "ui/shell/offscreen.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr double kFrameSeconds = 1.0 / 60.0;  // s, as a usual display draws
// From what anything can be seen in, to what drivers have textures for.
constexpr int kSmallestSide = 16, kLargestSide = 16384;  // px

void require_size(int width, int height) {
  if (width >= kSmallestSide && height >= kSmallestSide && width <= kLargestSide && height <= kLargestSide)
    return;
  throw InputError(fmt::format("an image of {}x{} px cannot be drawn; each side must be between {} and {} px",
                               width, height, kSmallestSide, kLargestSide));
}

}  // namespace

Offscreen::Offscreen(const OffscreenOptions& options) {
  require_size(options.width, options.height);
  context_ = make_offscreen_context(options.backend);
  context_->make_current();
  canvas_ = std::make_unique<Canvas>([this](const char* name) { return context_->get_proc_address(name); },
                                     options.look);
  framebuffer_ = std::make_unique<Framebuffer>(canvas_->gl(), options.width, options.height);
}

Offscreen::~Offscreen() {
  context_->make_current();
  framebuffer_.reset();
  canvas_.reset();
  context_->release_current();
}

void Offscreen::make_current() const {
  context_->make_current();
  ImGui::SetCurrentContext(&canvas_->imgui());
}

UiFrame Offscreen::draw(const FrameFunction& function) {
  make_current();
  const Stopwatch watch;
  UiFrame frame = canvas_->frame(*framebuffer_, kFrameSeconds, function);
  // Drawn, not only asked for: as in a window, where showing the frame waits for it.
  canvas_->gl().Finish();
  canvas_->note_pace(watch.milliseconds());
  return frame;
}

cv::Mat Offscreen::render(const FrameFunction& function) {
  make_current();
  // Only the last frame is looked at.
  for (int left = kSettlingFrames - 1; left > 0; --left) {
    if (canvas_->has_pending_input()) left = kSettlingFrames;
    canvas_->frame_unseen(framebuffer_->width(), framebuffer_->height(), kFrameSeconds, function);
  }
  draw(function);
  return image();
}

cv::Mat Offscreen::image() const {
  make_current();
  framebuffer_->resolve();
  return framebuffer_->read();
}

void Offscreen::resize(int width, int height) {
  require_size(width, height);
  if (width == framebuffer_->width() && height == framebuffer_->height()) return;
  make_current();
  framebuffer_ = std::make_unique<Framebuffer>(canvas_->gl(), width, height);
}

std::vector<std::string> Offscreen::take_gl_errors() {
  make_current();
  return canvas_->take_gl_errors();
}

}  // namespace stillpoint
