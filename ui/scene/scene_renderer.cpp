#include "ui/scene/scene_renderer.hpp"

#include <cstddef>

namespace stillpoint {
namespace {

constexpr float kGridWidth = 1.0F, kAxesWidth = 2.0F, kErrorWidth = 1.6F, kKeyframeWidth = 1.1F,
                kCurrentWidth = 2.0F;
constexpr float kPointSize = 2.5F, kRemovedPointSize = 4.0F;
constexpr float kImageOpacity = 0.92F;

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

struct QuadVertex {
  Eigen::Vector3f position;
  Eigen::Vector2f uv;
};

}  // namespace

SceneRenderer::SceneRenderer(const Gl& gl)
    : gl_(&gl),
      line_program_(Program::embedded(gl, "line")),
      point_program_(Program::embedded(gl, "point")),
      image_program_(Program::embedded(gl, "image")),
      grid_(make_batch(Layout::kSegments)),
      axes_(make_batch(Layout::kSegments)),
      errors_(make_batch(Layout::kSegments)),
      keyframes_(make_batch(Layout::kSegments)),
      current_(make_batch(Layout::kSegments)),
      kept_points_(make_batch(Layout::kPoints)),
      removed_points_(make_batch(Layout::kPoints)),
      image_(gl, Sampling::kLinear),
      quad_array_(make_vertex_array(gl)),
      quad_buffer_(make_buffer(gl)) {
  gl.BindVertexArray(quad_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, quad_buffer_.id());
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(QuadVertex),
                         offset(offsetof(QuadVertex, position)));
  gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(QuadVertex), offset(offsetof(QuadVertex, uv)));
  gl.BindVertexArray(0);
}

SceneRenderer::Batch SceneRenderer::make_batch(Layout layout) const {
  Batch batch{make_vertex_array(*gl_), make_buffer(*gl_)};
  gl_->BindVertexArray(batch.vertex_array.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, batch.buffer.id());
  // A segment is one instance of two vertices; the shader makes four corners of it.
  const GLuint ends = layout == Layout::kSegments ? 2 : 1;
  const auto stride = static_cast<GLsizei>(ends * sizeof(SceneVertex));
  for (GLuint end = 0; end < ends; ++end) {
    const std::size_t begin = end * sizeof(SceneVertex);
    const GLuint position = 2 * end, colour = 2 * end + 1;
    gl_->VertexAttribPointer(position, 3, GL_FLOAT, GL_FALSE, stride,
                             offset(begin + offsetof(SceneVertex, position)));
    gl_->VertexAttribPointer(colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                             offset(begin + offsetof(SceneVertex, rgba)));
    for (const GLuint attribute : {position, colour}) {
      gl_->EnableVertexAttribArray(attribute);
      if (layout == Layout::kSegments) gl_->VertexAttribDivisor(attribute, 1);
    }
  }
  gl_->BindVertexArray(0);
  return batch;
}

void SceneRenderer::fill(Batch& batch, Layout layout, const std::vector<SceneVertex>& vertices) const {
  gl_->BindBuffer(GL_ARRAY_BUFFER, batch.buffer.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(SceneVertex)),
                  vertices.data(), GL_STATIC_DRAW);
  batch.count = static_cast<GLsizei>(layout == Layout::kSegments ? vertices.size() / 2 : vertices.size());
}

void SceneRenderer::upload_scene(const SceneData& scene, ThemeName theme) {
  if (uploaded_revision_ == scene.revision && uploaded_theme_ == theme) return;
  uploaded_revision_ = scene.revision;
  uploaded_theme_ = theme;
  paths_.clear();
  for (const ScenePath& path : scene.paths) {
    paths_.push_back({make_batch(Layout::kSegments), path.width_px});
    fill(paths_.back().batch, Layout::kSegments, path_segments(path, theme));
  }
  fill(errors_, Layout::kSegments, error_segments(scene.errors, scene.error_scale_m));
  Segments frusta;
  const Rgb frustum_colour =
      mix(role_colour(Role::kEstimate, theme), role_colour(Role::kMapPoint, theme), 0.35F);
  for (const Pose& keyframe : scene.keyframes) {
    append_frustum(frusta, keyframe, scene.frustum, scene.frustum.keyframe_depth_m, frustum_colour, 0.75F);
  }
  fill(keyframes_, Layout::kSegments, frusta);
  std::vector<SceneVertex> kept, removed;
  kept.reserve(scene.points.size());
  for (const ScenePoint& point : scene.points) {
    if (point.removed)
      removed.push_back(make_vertex(point.position, role_colour(Role::kRemoved, theme)));
    else
      kept.push_back(make_vertex(point.position, role_colour(Role::kMapPoint, theme), 0.85F));
  }
  fill(kept_points_, Layout::kPoints, kept);
  fill(removed_points_, Layout::kPoints, removed);
}

void SceneRenderer::draw_segments(const Batch& batch, float width_px) const {
  if (batch.count == 0) return;
  line_program_.set("width_px", width_px);
  gl_->BindVertexArray(batch.vertex_array.id());
  gl_->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, batch.count);
}

void SceneRenderer::draw_points(const Batch& batch, float size_px) const {
  if (batch.count == 0) return;
  point_program_.set("size_px", size_px);
  gl_->BindVertexArray(batch.vertex_array.id());
  gl_->DrawArrays(GL_POINTS, 0, batch.count);
}

void SceneRenderer::draw_current_image(const SceneData& scene) {
  if (!scene.current || scene.current_image.empty()) return;
  if (uploaded_image_ != scene.image_revision) {
    image_.upload(scene.current_image);
    uploaded_image_ = scene.image_revision;
  }
  const auto corners = frustum_image_corners(*scene.current, scene.frustum, scene.frustum.current_depth_m);
  const QuadVertex quad[] = {{corners[0], {0.0F, 0.0F}},
                             {corners[1], {1.0F, 0.0F}},
                             {corners[2], {0.0F, 1.0F}},
                             {corners[3], {1.0F, 1.0F}}};
  image_program_.set("image", 0);
  image_program_.set("opacity", kImageOpacity);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, image_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, quad_buffer_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, sizeof(quad), quad, GL_STREAM_DRAW);
  gl_->BindVertexArray(quad_array_.id());
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void SceneRenderer::draw(const SceneData& scene, const SceneView& view, const Theme& theme, float scale,
                         const Framebuffer& target) {
  upload_scene(scene, theme.name);
  const Viewport viewport{static_cast<double>(target.width()), static_cast<double>(target.height())};
  const Eigen::Matrix4f clip_from_world =
      (clip_from_view(view, viewport) * view_from_world(view)).cast<float>();
  const Eigen::Vector2f size{static_cast<float>(viewport.width), static_cast<float>(viewport.height)};

  target.bind();
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Disable(GL_CULL_FACE);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->DepthMask(GL_TRUE);
  const ImVec4 background = to_vec4(theme.plot);
  gl_->ClearColor(background.x, background.y, background.z, 1.0F);
  gl_->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl_->Enable(GL_DEPTH_TEST);
  gl_->DepthFunc(GL_LEQUAL);
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_FUNC_ADD);
  gl_->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->Enable(GL_PROGRAM_POINT_SIZE);

  line_program_.use();
  line_program_.set("clip_from_world", clip_from_world);
  line_program_.set("viewport_px", size);
  if (scene.show_grid) {
    // The grid is seen through: it hides nothing that is drawn after it.
    gl_->DepthMask(GL_FALSE);
    fill(grid_, Layout::kSegments, grid_segments(view, scene.up, scene.ground_m, theme));
    draw_segments(grid_, kGridWidth * scale);
    gl_->DepthMask(GL_TRUE);
  }

  point_program_.use();
  point_program_.set("clip_from_world", clip_from_world);
  point_program_.set("reference_depth", static_cast<float>(view.distance));
  draw_points(kept_points_, kPointSize * scale);
  draw_points(removed_points_, kRemovedPointSize * scale);

  image_program_.use();
  image_program_.set("clip_from_world", clip_from_world);
  draw_current_image(scene);

  line_program_.use();
  if (scene.show_axes) {
    fill(axes_, Layout::kSegments, axes_segments(2.0 * grid_spacing(view)));
    draw_segments(axes_, kAxesWidth * scale);
  }
  draw_segments(errors_, kErrorWidth * scale);
  draw_segments(keyframes_, kKeyframeWidth * scale);
  for (const PathBatch& path : paths_) draw_segments(path.batch, path.width_px * scale);
  if (scene.current) {
    Segments frustum;
    append_frustum(frustum, *scene.current, scene.frustum, scene.frustum.current_depth_m,
                   role_colour(Role::kCursor, theme.name));
    fill(current_, Layout::kSegments, frustum);
    draw_segments(current_, kCurrentWidth * scale);
  }
  gl_->BindVertexArray(0);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->Disable(GL_BLEND);
  target.resolve();
}

}  // namespace stillpoint
