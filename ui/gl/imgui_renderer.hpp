#pragma once

#include <imgui.h>

#include "ui/gl/program.hpp"
#include "ui/gl/texture.hpp"

namespace stillpoint {

/// Draws ImGui's draw lists with shaders/imgui.*. ImGui's own OpenGL backend resolves its functions through
/// libGL and does not start on an OSMesa context.
class ImGuiRenderer {
 public:
  explicit ImGuiRenderer(const Gl& gl);

  /// Uploads the font atlas of the current ImGui context and names the texture in it.
  void upload_fonts();

  /// Draws into the bound framebuffer, whose height in pixels is `framebuffer_height`. All state it relies on
  /// is set here; on return blending and the scissor test are off.
  void draw(const ImDrawData& data, int framebuffer_height);

 private:
  void set_state(const ImDrawData& data, int framebuffer_width, int framebuffer_height) const;

  const Gl* gl_;
  Program program_;
  Texture fonts_;
  GlObject vertex_array_, vertices_, indices_;
};

}  // namespace stillpoint
