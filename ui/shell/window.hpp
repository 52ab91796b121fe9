#pragma once

#include <array>
#include <optional>

#include "ui/shell/canvas.hpp"

struct GLFWwindow;
struct GLFWcursor;

namespace stillpoint {

struct WindowOptions {
  int width = 1600, height = 900;  ///< screen coordinates; brought down to what the screen offers
  std::string title = "Stillpoint";
  Look look{};
  bool grows_with_display = true;  ///< a display whose letters are twice as large has a window twice as large
  bool maximised = false;
  bool gl_debug = false;  ///< a context that tells every error as it happens; slower
};

/// The size a window is opened with. @param scale of the display's letters @param available px, 0 = not known
[[nodiscard]] std::array<int, 2> opening_size(const WindowOptions& options, float scale,
                                              std::array<int, 2> available);

/// The shell with a display: a GLFW window with an OpenGL 3.3 core context, drawn when something changes.
class Window {
 public:
  /// @throws InputError when there is no display (naming `stillpoint snapshot`, which needs none) or no
  /// OpenGL 3.3.
  explicit Window(const WindowOptions& options = {});
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Draws frames until a frame function sets UiFrame::quit. Closing the window only sets
  /// UiFrame::close_requested: what is to be saved first is the frame function's to know. Sleeps while there
  /// is no input, no wake() and no redraw due.
  void run(const FrameFunction& function);

  /// Takes waiting input, draws one frame and shows it.
  UiFrame draw(const FrameFunction& function);

  /// Draws one frame as draw() does and returns what the window shows: 8UC3 BGR.
  cv::Mat capture(const FrameFunction& function);

  /// Has the next frame drawn soon; from any thread.
  static void wake();

  void send(InputEvent event) { canvas_->send(std::move(event)); }
  /// An event of the display.
  void receive(InputEvent event) {
    if (listens_) send(std::move(event));
  }
  /// Whether what a person does at the display counts; a replay takes no hints.
  void listen(bool listens) { listens_ = listens; }
  void set_title(const std::string& title);
  void resize(int width, int height);
  [[nodiscard]] Canvas& canvas() { return *canvas_; }
  [[nodiscard]] std::array<int, 2> framebuffer_size() const;  ///< px
  [[nodiscard]] std::array<int, 4> placement() const;  ///< x, y, width, height: to come back as it was left
  [[nodiscard]] GLFWwindow* handle() const { return window_; }

 private:
  void tell_display_scale();
  UiFrame draw_unshown(const FrameFunction& function);
  void show();
  void wait(double seconds) const;
  void connect_input();
  void connect_clipboard();
  void show_cursor();

  GLFWwindow* window_ = nullptr;
  std::unique_ptr<GraphicsContext> context_;
  std::unique_ptr<Canvas> canvas_;
  std::array<GLFWcursor*, 16> cursors_{};
  std::unique_ptr<Framebuffer>
      picture_;        // what is drawn, frame after frame: a window's own is lost once shown
  bool stale_ = true;  // the window may not show what was drawn last
  double last_frame_s_ = 0.0;
  bool listens_ = true;
};

}  // namespace stillpoint
