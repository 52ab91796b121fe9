#include "ui/shell/canvas.hpp"

#include <algorithm>

#include "ui/gl/imgui_renderer.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

// Times the design size: text stays readable, and panels have room.
constexpr float kLeastScale = 0.5F, kMostScale = 4.0F;

}  // namespace

Canvas::Canvas(const GetProcAddress& get_proc_address, const Look& look)
    : gl_(std::make_unique<Gl>(load_gl(get_proc_address))),
      errors_(std::make_unique<GlErrorLog>(*gl_)),
      imgui_(ImGui::CreateContext()),
      look_(look) {
  ImGui::SetCurrentContext(imgui_);
  ImGuiIO& io = ImGui::GetIO();
  // Layout and settings are the workbench's to keep, and images must not depend on a file that lies about.
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset | ImGuiBackendFlags_HasMouseCursors;
  io.BackendRendererName = "stillpoint";
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  set_up_imgui_keys();
  renderer_ = std::make_unique<ImGuiRenderer>(*gl_);
}

Canvas::~Canvas() {
  renderer_.reset();
  ImGui::DestroyContext(imgui_);
}

void Canvas::dress() {
  const float scale = std::clamp(look_.scale * display_scale_, kLeastScale, kMostScale);
  if (scale == dressed_scale_ && look_.theme == dressed_theme_) return;
  if (scale != dressed_scale_) {
    fonts_ = load_fonts(scale);
    renderer_->upload_fonts();
  }
  apply_theme(theme(look_.theme), scale);
  dressed_scale_ = scale;
  dressed_theme_ = look_.theme;
}

std::vector<std::string> Canvas::take_input() {
  std::vector<std::string> dropped;
  for (const InputEvent& event : input_.next_frame()) {
    apply_to_imgui(event);
    if (listener_) listener_(event);
    if (const auto* files = std::get_if<FilesDropped>(&event)) {
      dropped.insert(dropped.end(), files->paths.begin(), files->paths.end());
    }
  }
  return dropped;
}

UiFrame Canvas::build(int width, int height, double delta_s, const FrameFunction& function,
                      bool close_requested) {
  ImGui::SetCurrentContext(imgui_);
  dress();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  io.DeltaTime = static_cast<float>(std::max(delta_s, 1e-6));
  time_s_ += delta_s;
  UiFrame frame{.gl = *gl_,
                .fonts = fonts_,
                .theme = theme(look_.theme),
                .size = io.DisplaySize,
                .scale = dressed_scale_,
                .time_s = time_s_,
                .dropped_files = take_input(),
                .close_requested = close_requested,
                .pace = &pace_,
                .wanted_look = look_};
  ImGui::NewFrame();
  function(frame);
  ImGui::Render();
  look_ = frame.wanted_look;
  was_busy_ = frame.busy;
  return frame;
}

UiFrame Canvas::frame_unseen(int width, int height, double delta_s, const FrameFunction& function) {
  return build(width, height, delta_s, function, false);
}

UiFrame Canvas::frame(const Framebuffer& target, double delta_s, const FrameFunction& function,
                      bool close_requested) {
  UiFrame frame = build(target.width(), target.height(), delta_s, function, close_requested);
  frame.changed = renderer_->draw(*ImGui::GetDrawData(), target, to_vec4(frame.theme.background));
  return frame;
}

}  // namespace stillpoint
