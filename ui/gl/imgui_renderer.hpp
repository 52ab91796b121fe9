#pragma once

#include <imgui.h>

#include <vector>

#include "ui/gl/changed_regions.hpp"
#include "ui/gl/framebuffer.hpp"
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

  /// Brings `target` from the frame it was given last to this one: only what has changed is drawn, over
  /// `background`. All state it relies on is set here; on return blending and the scissor test are off.
  /// @returns whether anything had changed
  bool draw(const ImDrawData& data, const Framebuffer& target, const ImVec4& background);

 private:
  /// What one call draws.
  struct Part {
    Drawing drawing = Drawing::kBlended;
    const DrawnCommand* of = nullptr;
    PixelRect scissor;
    std::size_t first = 0, count = 0;  // in chosen_
    ImU32 colour = 0;                  // of a fill
  };
  void add_parts(const ImDrawList& list, const DrawnCommand& command, const PixelRect& scissor);
  void set_state(const ImDrawData& data) const;
  void draw_list(const ImDrawList& list, const std::vector<DrawnCommand>& commands,
                 const std::vector<PixelRect>& regions, int height);

  const Gl* gl_;
  Program program_;
  Texture fonts_;
  GlObject vertex_array_, vertices_, indices_;
  ChangedRegions changes_;
  GLuint drawn_into_ = 0;  // the texture that holds what was drawn last
  std::vector<Part> parts_;
  ImVec4 background_;
  std::vector<ImDrawIdx> chosen_;  // those of a list that lie where something has changed
};

}  // namespace stillpoint
