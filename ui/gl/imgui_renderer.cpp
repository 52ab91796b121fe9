#include "ui/gl/imgui_renderer.hpp"

#include <algorithm>
#include <cstddef>

namespace stillpoint {
namespace {

constexpr GLenum kIndexType = sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

/// Maps ImGui's coordinates (origin top left) to clip space.
Eigen::Matrix4f projection(const ImDrawData& data) {
  const float left = data.DisplayPos.x, right = left + data.DisplaySize.x;
  const float top = data.DisplayPos.y, bottom = top + data.DisplaySize.y;
  Eigen::Matrix4f clip_from_display = Eigen::Matrix4f::Identity();
  clip_from_display(0, 0) = 2.0F / (right - left);
  clip_from_display(1, 1) = 2.0F / (top - bottom);
  clip_from_display(2, 2) = -1.0F;
  clip_from_display(0, 3) = (right + left) / (left - right);
  clip_from_display(1, 3) = (top + bottom) / (bottom - top);
  return clip_from_display;
}

}  // namespace

ImGuiRenderer::ImGuiRenderer(const Gl& gl)
    : gl_(&gl),
      program_(Program::embedded(gl, "imgui")),
      fonts_(gl, Sampling::kLinear),
      vertex_array_(make_vertex_array(gl)),
      vertices_(make_buffer(gl)),
      indices_(make_buffer(gl)) {
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  const auto stride = static_cast<GLsizei>(sizeof(ImDrawVert));
  for (GLuint attribute = 0; attribute < 3; ++attribute) gl.EnableVertexAttribArray(attribute);
  gl.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ImDrawVert, pos)));
  gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ImDrawVert, uv)));
  gl.VertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(ImDrawVert, col)));
  gl.BindVertexArray(0);
}

void ImGuiRenderer::upload_fonts() {
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
  // White with coverage as alpha: the order of the colour channels does not matter.
  fonts_.upload(cv::Mat(height, width, CV_8UC4, pixels));
  atlas.SetTexID(fonts_.imgui_id());
}

void ImGuiRenderer::set_state(const ImDrawData& data, int framebuffer_width, int framebuffer_height) const {
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_FUNC_ADD);
  gl_->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->Disable(GL_CULL_FACE);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->Disable(GL_STENCIL_TEST);
  gl_->Disable(GL_PRIMITIVE_RESTART);
  gl_->Enable(GL_SCISSOR_TEST);
  gl_->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl_->Viewport(0, 0, framebuffer_width, framebuffer_height);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindSampler(0, 0);
  program_.use();
  program_.set("image", 0);
  program_.set("clip_from_display", projection(data));
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
}

void ImGuiRenderer::draw(const ImDrawData& data, int framebuffer_height) {
  const ImVec2 scale = data.FramebufferScale;
  const int framebuffer_width = static_cast<int>(data.DisplaySize.x * scale.x);
  if (framebuffer_width <= 0 || framebuffer_height <= 0) return;
  set_state(data, framebuffer_width, framebuffer_height);
  for (int n = 0; n < data.CmdListsCount; ++n) {
    const ImDrawList& list = *data.CmdLists[n];
    gl_->BufferData(GL_ARRAY_BUFFER, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data, GL_STREAM_DRAW);
    gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.size_in_bytes(), list.IdxBuffer.Data,
                    GL_STREAM_DRAW);
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback == ImDrawCallback_ResetRenderState) {
        set_state(data, framebuffer_width, framebuffer_height);
        continue;
      }
      if (command.UserCallback != nullptr) {
        command.UserCallback(&list, &command);
        continue;
      }
      const ImVec2 low{std::max((command.ClipRect.x - data.DisplayPos.x) * scale.x, 0.0F),
                       std::max((command.ClipRect.y - data.DisplayPos.y) * scale.y, 0.0F)};
      const ImVec2 high{(command.ClipRect.z - data.DisplayPos.x) * scale.x,
                        (command.ClipRect.w - data.DisplayPos.y) * scale.y};
      if (high.x <= low.x || high.y <= low.y) continue;
      gl_->Scissor(static_cast<GLint>(low.x),
                   static_cast<GLint>(static_cast<float>(framebuffer_height) - high.y),
                   static_cast<GLsizei>(high.x - low.x), static_cast<GLsizei>(high.y - low.y));
      gl_->BindTexture(GL_TEXTURE_2D, from_imgui_texture(command.GetTexID()));
      gl_->DrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), kIndexType,
                                  offset(command.IdxOffset * sizeof(ImDrawIdx)),
                                  static_cast<GLint>(command.VtxOffset));
    }
  }
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Disable(GL_BLEND);
  gl_->BindVertexArray(0);
}

}  // namespace stillpoint
