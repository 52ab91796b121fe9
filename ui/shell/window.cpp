#include "ui/shell/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "ui/shell/warm_up.hpp"
#include "ui/shell/window_input.hpp"

namespace stillpoint {
namespace {

constexpr double kCaretBlinkSeconds = 0.25;    // s: a caret blinks about twice a second
constexpr double kLeastSleepSeconds = 0.005;   // s: shorter naps only wake
constexpr double kLongestSleepSeconds = 60.0;  // s at most, where nothing is due and nobody does anything

std::string last_glfw_error() {
  const char* description = nullptr;
  glfwGetError(&description);
  return description == nullptr ? "no reason given" : description;
}

void start_glfw() {
  if (glfwInit() == GLFW_TRUE) return;
  throw InputError(fmt::format(
      "no window can be opened ({}); `stillpoint snapshot` draws the same panels without a display",
      last_glfw_error()));
}

GLFWwindow* create_window(const WindowOptions& options) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.gl_debug ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_MAXIMIZED, options.maximised ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHintString(GLFW_X11_CLASS_NAME, "stillpoint");
  glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "stillpoint");
  int width = options.width, height = options.height;
  if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
    int x = 0, y = 0, available_width = 0, available_height = 0;
    glfwGetMonitorWorkarea(monitor, &x, &y, &available_width, &available_height);
    float scale_x = 1.0F, scale_y = 1.0F;
    glfwGetMonitorContentScale(monitor, &scale_x, &scale_y);
    const auto size = opening_size(options, scale_x, {available_width, available_height});
    width = size[0], height = size[1];
  }
  return glfwCreateWindow(width, height, options.title.c_str(), nullptr, nullptr);
}

Window& self(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

/// Framebuffer pixels a screen coordinate: 1 on X11, more on displays that scale windows.
std::array<float, 2> pixel_ratio(GLFWwindow* window) {
  int width = 0, height = 0, pixel_width = 0, pixel_height = 0;
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &pixel_width, &pixel_height);
  if (width <= 0 || height <= 0) return {1.0F, 1.0F};
  return {static_cast<float>(pixel_width) / static_cast<float>(width),
          static_cast<float>(pixel_height) / static_cast<float>(height)};
}

void send_mouse_position(GLFWwindow* window, double x, double y) {
  const auto [ratio_x, ratio_y] = pixel_ratio(window);
  self(window).receive(MouseMoved{static_cast<float>(x) * ratio_x, static_cast<float>(y) * ratio_y});
}

bool holds_button(GLFWwindow* window) {
  for (int button = GLFW_MOUSE_BUTTON_1; button <= GLFW_MOUSE_BUTTON_LAST; ++button)
    if (glfwGetMouseButton(window, button) == GLFW_PRESS) return true;
  return false;
}

/// The modifiers held now, for events that GLFW reports without.
Modifiers held_modifiers(GLFWwindow* window) {
  const auto held = [window](int left, int right) {
    return glfwGetKey(window, left) == GLFW_PRESS || glfwGetKey(window, right) == GLFW_PRESS;
  };
  return {.ctrl = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
          .shift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT),
          .alt = held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT),
          .super = held(GLFW_KEY_LEFT_SUPER, GLFW_KEY_RIGHT_SUPER)};
}

int cursor_shape(ImGuiMouseCursor cursor) {
  switch (cursor) {
    case ImGuiMouseCursor_TextInput:
      return GLFW_IBEAM_CURSOR;
    case ImGuiMouseCursor_ResizeNS:
      return GLFW_VRESIZE_CURSOR;
    case ImGuiMouseCursor_ResizeEW:
      return GLFW_HRESIZE_CURSOR;
    case ImGuiMouseCursor_Hand:
      return GLFW_HAND_CURSOR;
    default:
      return GLFW_ARROW_CURSOR;
  }
}

/// A window's context, behind the interface that the offscreen ones have too.
class GlfwContext : public GraphicsContext {
 public:
  explicit GlfwContext(GLFWwindow* window) : window_(window) {}
  ~GlfwContext() override { release_current(); }

  [[nodiscard]] void* get_proc_address(const char* name) const override {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
  }
  [[nodiscard]] std::string name() const override { return "GLFW"; }

 private:
  void do_make_current() override { glfwMakeContextCurrent(window_); }
  void do_release_current() override { glfwMakeContextCurrent(nullptr); }

  GLFWwindow* window_;
};

}  // namespace

std::array<int, 2> opening_size(const WindowOptions& options, float scale, std::array<int, 2> available) {
  const float factor = options.grows_with_display ? std::max(scale, 1.0F) : 1.0F;
  std::array<int, 2> size{options.width, options.height};
  for (std::size_t side = 0; side < size.size(); ++side) {
    size[side] = static_cast<int>(factor * static_cast<float>(size[side]));
    if (available[side] > 0) size[side] = std::min(size[side], available[side]);
  }
  return size;
}

Window::Window(const WindowOptions& options) {
  start_glfw();
  window_ = create_window(options);
  if (window_ == nullptr) {
    const std::string reason = last_glfw_error();
    glfwTerminate();
    throw InputError(
        fmt::format("this display offers no OpenGL 3.3 ({}); `stillpoint snapshot` draws the same panels "
                    "without a display",
                    reason));
  }
  context_ = std::make_unique<GlfwContext>(window_);
  context_->make_current();
  glfwSwapInterval(1);
  try {
    canvas_ = std::make_unique<Canvas>([this](const char* name) { return context_->get_proc_address(name); },
                                       options.look);
  } catch (...) {
    context_.reset();
    glfwDestroyWindow(window_);
    glfwTerminate();
    throw;
  }
  glfwSetWindowUserPointer(window_, this);
  connect_input();
  connect_clipboard();
  tell_display_scale();
  const auto [width, height] = framebuffer_size();
  warm_up(*canvas_, std::max(width, 1), std::max(height, 1));
  last_frame_s_ = glfwGetTime();
}

Window::~Window() {
  context_->make_current();
  picture_.reset();
  canvas_.reset();
  context_.reset();
  for (GLFWcursor* cursor : cursors_) {
    if (cursor != nullptr) glfwDestroyCursor(cursor);
  }
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::connect_input() {
  glfwSetCursorPosCallback(window_, send_mouse_position);
  // Where the mouse is outside is not told any more: what it was on last is left. A drag goes on outside.
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* window, int entered) {
    if (entered == GLFW_FALSE && !holds_button(window)) self(window).receive(kMouseNowhere);
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int modifiers) {
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(window, &x, &y);
    send_mouse_position(window, x, y);
    self(window).receive(MouseButton{button, action == GLFW_PRESS, modifiers_from_glfw(modifiers)});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double dx, double dy) {
    self(window).receive(MouseWheel{static_cast<float>(dx), static_cast<float>(dy), held_modifiers(window)});
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int code, int, int action, int modifiers) {
    // ImGui repeats held keys itself.
    if (action == GLFW_REPEAT) return;
    // The bits GLFW gives on X11 are those from before the key: wrong for the modifier keys themselves.
    const Key key = key_from_glfw(code);
    const Modifiers held = key == Key::kNone ? held_modifiers(window) : modifiers_from_glfw(modifiers);
    self(window).receive(KeyChanged{key, action == GLFW_PRESS, held});
  });
  glfwSetCharCallback(
      window_, [](GLFWwindow* window, unsigned codepoint) { self(window).receive(TextTyped{codepoint}); });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* window, int focused) {
    self(window).receive(FocusChanged{focused == GLFW_TRUE});
  });
  // What lay over the window is gone, or it has another size: what it shows is lost.
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) { self(window).stale_ = true; });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int, int) { self(window).stale_ = true; });
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
    self(window).receive(FilesDropped{{paths, paths + count}});
  });
}

void Window::connect_clipboard() {
  ImGuiIO& io = ImGui::GetIO();
  io.ClipboardUserData = window_;
  io.GetClipboardTextFn = [](void* window) {
    return glfwGetClipboardString(static_cast<GLFWwindow*>(window));
  };
  io.SetClipboardTextFn = [](void* window, const char* text) {
    glfwSetClipboardString(static_cast<GLFWwindow*>(window), text);
  };
}

void Window::show_cursor() {
  const ImGuiMouseCursor wanted = ImGui::GetMouseCursor();
  if (wanted < 0 || static_cast<std::size_t>(wanted) >= cursors_.size()) return;
  GLFWcursor*& cursor = cursors_[static_cast<std::size_t>(wanted)];
  if (cursor == nullptr) cursor = glfwCreateStandardCursor(cursor_shape(wanted));
  glfwSetCursor(window_, cursor);
}

void Window::tell_display_scale() {
  float content_x = 1.0F, content_y = 1.0F;
  glfwGetWindowContentScale(window_, &content_x, &content_y);
  // Where windows are scaled by the system the two agree; on X11 only the content scale speaks.
  canvas_->set_display_scale(std::max(content_x, pixel_ratio(window_)[0]));
}

UiFrame Window::draw_unshown(const FrameFunction& function) {
  context_->make_current();
  const auto [pixels_x, pixels_y] = framebuffer_size();
  const int width = std::max(pixels_x, 1), height = std::max(pixels_y, 1);
  if (!picture_ || picture_->width() != width || picture_->height() != height)
    picture_ = std::make_unique<Framebuffer>(canvas_->gl(), width, height);
  tell_display_scale();
  const double now = glfwGetTime();
  const double delta_s = now - last_frame_s_;
  last_frame_s_ = now;
  const bool close = glfwWindowShouldClose(window_) == GLFW_TRUE;
  if (close) glfwSetWindowShouldClose(window_, GLFW_FALSE);
  UiFrame frame = canvas_->frame(*picture_, delta_s, function, close);
  show_cursor();
  return frame;
}

void Window::show() {
  picture_->copy_to_window();
  glfwSwapBuffers(window_);
  stale_ = false;
}

UiFrame Window::draw(const FrameFunction& function) {
  const double begin = glfwGetTime();
  glfwPollEvents();
  UiFrame frame = draw_unshown(function);
  if (frame.changed || stale_) show();
  canvas_->note_pace(1000.0 * (glfwGetTime() - begin));
  return frame;
}

cv::Mat Window::capture(const FrameFunction& function) {
  glfwPollEvents();
  draw_unshown(function);
  show();
  return picture_->read();
}

void Window::wait(double seconds) const {
  // A hidden window has nothing to draw for, however often it is asked to.
  if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE) seconds = std::max(seconds, 0.25);
  if (seconds <= 0.0)
    glfwPollEvents();
  else
    glfwWaitEventsTimeout(std::min(seconds, kLongestSleepSeconds));
}

void Window::run(const FrameFunction& function) {
  for (int unsettled = kSettlingFrames;;) {
    const UiFrame frame = draw(function);
    if (frame.quit) return;
    if (canvas_->has_pending_input()) unsettled = kSettlingFrames;
    if (--unsettled > 0 || canvas_->has_pending_input()) continue;
    const double blink = ImGui::GetIO().WantTextInput ? kCaretBlinkSeconds : kLongestSleepSeconds;
    // A frame that shows nothing new does not wait for the display, and so waits here.
    const double least = frame.changed ? 0.0 : kLeastSleepSeconds;
    wait(std::max(std::min(frame.redraw_after_s, blink), least));
    unsettled = canvas_->has_pending_input() ? kSettlingFrames : 1;
  }
}

void Window::wake() { glfwPostEmptyEvent(); }

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::resize(int width, int height) { glfwSetWindowSize(window_, width, height); }

std::array<int, 2> Window::framebuffer_size() const {
  std::array<int, 2> size{};
  glfwGetFramebufferSize(window_, &size[0], &size[1]);
  return size;
}

std::array<int, 4> Window::placement() const {
  std::array<int, 4> place{};
  glfwGetWindowPos(window_, &place[0], &place[1]);
  glfwGetWindowSize(window_, &place[2], &place[3]);
  return place;
}

}  // namespace stillpoint
