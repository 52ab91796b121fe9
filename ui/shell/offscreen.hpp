#pragma once

#include <opencv2/core.hpp>

#include "ui/shell/canvas.hpp"

namespace stillpoint {

struct OffscreenOptions {
  int width = 1600, height = 900;  ///< px
  Look look{};
  OffscreenBackend backend = OffscreenBackend::kAny;
};

/// The shell without a display: the same frames as in a window, as images. Its clock ticks a sixtieth of a
/// second a frame, so the same calls give the same bytes.
class Offscreen {
 public:
  /// @throws InputError when no offscreen context can be had, or the size is not between 16 and 16384 px.
  explicit Offscreen(const OffscreenOptions& options = {});
  ~Offscreen();
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  /// Draws one frame.
  UiFrame draw(const FrameFunction& function);

  /// Draws until nothing moves: ImGui sizes new windows over two frames, and sent input may take several.
  /// @returns the last frame's image, 8UC3 BGR.
  cv::Mat render(const FrameFunction& function);

  /// The last drawn frame, 8UC3 BGR.
  [[nodiscard]] cv::Mat image() const;

  void resize(int width, int height);
  void send(InputEvent event) { canvas_->send(std::move(event)); }
  void set_look(const Look& look) { canvas_->set_look(look); }
  [[nodiscard]] std::vector<std::string> take_gl_errors();
  [[nodiscard]] const Gl& gl() const { return canvas_->gl(); }
  [[nodiscard]] Canvas& canvas() { return *canvas_; }
  [[nodiscard]] std::string context_name() const { return context_->name(); }

  /// Makes its GL and ImGui contexts current; needed only between uses of several shells.
  void make_current() const;

 private:
  std::unique_ptr<GraphicsContext> context_;
  std::unique_ptr<Canvas> canvas_;
  std::unique_ptr<Framebuffer> framebuffer_;
};

}  // namespace stillpoint
