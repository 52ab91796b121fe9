#include "ui/gl/imgui_renderer.hpp"

#include <cstddef>
#include <utility>

#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr int kLarge = 4096;  // px: what covers less is not worth a draw call of its own
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

bool same_colour(const ImVec4& a, const ImVec4& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

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

void ImGuiRenderer::set_state(const ImDrawData& data) const {
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_FUNC_ADD);
  gl_->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->Disable(GL_CULL_FACE);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->Disable(GL_STENCIL_TEST);
  gl_->Disable(GL_PRIMITIVE_RESTART);
  gl_->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindSampler(0, 0);
  program_.use();
  program_.set("image", 0);
  program_.set("clip_from_display", projection(data));
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
}

void ImGuiRenderer::draw_list(const ImDrawList& list, const std::vector<DrawnCommand>& commands,
                              const std::vector<PixelRect>& regions, int height) {
  parts_.clear();
  chosen_.clear();
  for (const DrawnCommand& command : commands)
    for (const PixelRect& region : regions) add_parts(list, command, command.clip.cut_to(region));
  if (parts_.empty()) return;
  gl_->BufferData(GL_ARRAY_BUFFER, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data, GL_STREAM_DRAW);
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(chosen_.size() * sizeof(ImDrawIdx)),
                  chosen_.data(), GL_STREAM_DRAW);
  bool blends = true;
  for (const Part& part : parts_) {
    const PixelRect& r = part.scissor;
    gl_->Scissor(r.x0, height - r.y1, r.x1 - r.x0, r.y1 - r.y0);
    if (part.drawing == Drawing::kFill) {
      const ImVec4 colour = ImGui::ColorConvertU32ToFloat4(part.colour);
      gl_->ClearColor(colour.x, colour.y, colour.z, 1.0F);
      gl_->Clear(GL_COLOR_BUFFER_BIT);
      continue;
    }
    if (const bool blended = part.drawing == Drawing::kBlended; blended != std::exchange(blends, blended))
      blended ? gl_->Enable(GL_BLEND) : gl_->Disable(GL_BLEND);
    gl_->BindTexture(GL_TEXTURE_2D, from_imgui_texture(part.of->command->GetTexID()));
    gl_->DrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(part.count), kIndexType,
                                offset(part.first * sizeof(ImDrawIdx)),
                                static_cast<GLint>(part.of->command->VtxOffset));
  }
  gl_->Enable(GL_BLEND);
}

void ImGuiRenderer::add_parts(const ImDrawList& list, const DrawnCommand& command, const PixelRect& scissor) {
  if (scissor.empty()) return;
  bool open = false;  // the last part goes on
  for (std::size_t i = command.first_shape; i < command.first_shape + command.shapes; ++i) {
    const DrawnShape& shape = changes_.shapes()[i];
    const PixelRect seen = shape.box.cut_to(scissor);
    if (seen.empty()) continue;
    const Drawing drawing = seen.area() < kLarge ? Drawing::kBlended : shape.drawing;
    if (drawing == Drawing::kFill) {
      parts_.push_back({drawing, &command, seen, 0, 0, shape.colour});
      open = false;
      continue;
    }
    if (!open || parts_.back().drawing != drawing)
      parts_.push_back({drawing, &command, scissor, chosen_.size(), 0, 0});
    open = true;
    const ImDrawIdx* indices = list.IdxBuffer.Data + shape.first_index;
    chosen_.insert(chosen_.end(), indices, indices + shape.indices);
    parts_.back().count += shape.indices;
  }
}

bool ImGuiRenderer::draw(const ImDrawData& data, const Framebuffer& target, const ImVec4& background) {
  const int height = target.height();
  if (std::exchange(drawn_into_, target.texture().id()) != target.texture().id() ||
      !same_colour(background_, background))
    changes_.forget();
  background_ = background;
  const std::vector<PixelRect>& regions = changes_.update(data, target.width(), height);
  if (regions.empty()) return false;
  target.bind();
  gl_->Enable(GL_SCISSOR_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->ClearColor(background.x, background.y, background.z, 1.0F);
  for (const PixelRect& r : regions) {
    gl_->Scissor(r.x0, height - r.y1, r.x1 - r.x0, r.y1 - r.y0);
    gl_->Clear(GL_COLOR_BUFFER_BIT);
  }
  set_state(data);
  for (int n = 0; n < data.CmdListsCount; ++n)
    draw_list(*data.CmdLists[n], changes_.commands(n), regions, height);
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Disable(GL_BLEND);
  gl_->BindVertexArray(0);
  return true;
}

}  // namespace stillpoint
