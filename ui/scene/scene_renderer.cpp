#include "ui/scene/scene_renderer.hpp"

#include <algorithm>
#include <cstddef>

namespace stillpoint {
namespace {

constexpr float kGridWidth = 1.0F, kAxesWidth = 2.0F, kErrorWidth = 1.6F, kKeyframeWidth = 1.1F,
                kCurrentWidth = 2.0F;  // design px of lines, and of points: the more they matter, the wider
constexpr float kPointSize = 2.5F, kRemovedPointSize = 4.0F;  // design px: points removed stand out
// Above so many, points lie so close that their round edges are not seen, but are paid for.
constexpr GLsizei kManyPoints = 20000;
constexpr float kPlainPointSize = 2.0F;  // design px
constexpr float kImageOpacity = 0.92F;   // so that what lies behind a frame's picture is still made out

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
      segment_indices_(make_buffer(gl)),
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
  if (layout == Layout::kSegments) gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, segment_indices_.id());
  const GLuint ends = layout == Layout::kSegments ? 2 : 1;
  const auto stride = static_cast<GLsizei>(ends * sizeof(SceneVertex));
  for (GLuint end = 0; end < ends; ++end) {
    const std::size_t begin = end * sizeof(SceneVertex);
    const GLuint position = 2 * end, colour = 2 * end + 1;
    gl_->VertexAttribPointer(position, 3, GL_FLOAT, GL_FALSE, stride,
                             offset(begin + offsetof(SceneVertex, position)));
    gl_->VertexAttribPointer(colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                             offset(begin + offsetof(SceneVertex, rgba)));
    gl_->EnableVertexAttribArray(position);
    gl_->EnableVertexAttribArray(colour);
  }
  gl_->BindVertexArray(0);
  return batch;
}

void SceneRenderer::fill(Batch& batch, Layout layout, const std::vector<SceneVertex>& vertices) {
  std::vector<SceneVertex> corners;
  if (layout == Layout::kSegments) {
    // Each of a segment's four corners knows both ends. One instance a segment would need less memory, but
    // software renderers take instances one by one.
    corners.reserve(4 * vertices.size());
    for (std::size_t i = 0; i + 1 < vertices.size(); i += 2) {
      for (int corner = 0; corner < 4; ++corner)
        corners.insert(corners.end(), {vertices[i], vertices[i + 1]});
    }
    reserve_segment_indices(vertices.size() / 2);
  }
  const std::vector<SceneVertex>& data = layout == Layout::kSegments ? corners : vertices;
  gl_->BindBuffer(GL_ARRAY_BUFFER, batch.buffer.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(SceneVertex)), data.data(),
                  GL_STATIC_DRAW);
  batch.count = static_cast<GLsizei>(layout == Layout::kSegments ? vertices.size() / 2 : vertices.size());
}

void SceneRenderer::reserve_segment_indices(std::size_t segments) {
  if (segments <= indexed_segments_) return;
  indexed_segments_ = std::max(segments, 2 * indexed_segments_);
  std::vector<GLuint> indices;
  indices.reserve(6 * indexed_segments_);
  for (GLuint first = 0; first < 4 * indexed_segments_; first += 4) {
    indices.insert(indices.end(), {first, first + 1, first + 2, first + 2, first + 1, first + 3});
  }
  // No vertex array may be bound: it would take this buffer for its own.
  gl_->BindVertexArray(0);
  gl_->BindBuffer(GL_ARRAY_BUFFER, segment_indices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(GLuint)), indices.data(),
                  GL_STATIC_DRAW);
}

void SceneRenderer::upload_scene(const SceneData& scene, ThemeName theme) {
  if (uploaded_revision_ == scene.revision && uploaded_theme_ == theme) return;
  uploaded_revision_ = scene.revision;
  uploaded_theme_ = theme;
  paths_.clear();
  for (const ScenePath& path : scene.paths) {
    SceneData alone;
    alone.paths.push_back(path);
    paths_.push_back({make_batch(Layout::kSegments), bounds(alone)});
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

void SceneRenderer::upload_paths(const SceneData& scene, const SceneView& view, const Viewport& viewport,
                                 ThemeName theme) {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const double tolerance = unseen_detail(view, viewport, paths_[i].box);
    if (tolerance == paths_[i].tolerance_m) continue;
    paths_[i].tolerance_m = tolerance;
    ScenePath path{.name = "",
                   .role = scene.paths[i].role,
                   .positions = simplified(scene.paths[i].positions, tolerance),
                   .colour = scene.paths[i].colour,
                   .dash_m = scene.paths[i].dash_m};
    fill(paths_[i].batch, Layout::kSegments, path_segments(path, theme));
  }
}

void SceneRenderer::draw_segments(const Batch& batch, float width_px) const {
  if (batch.count == 0) return;
  line_program_.set("width_px", width_px);
  gl_->BindVertexArray(batch.vertex_array.id());
  gl_->DrawElementsBaseVertex(GL_TRIANGLES, 6 * batch.count, GL_UNSIGNED_INT, nullptr, 0);
}

void SceneRenderer::draw_points(const Batch& batch) const {
  if (batch.count == 0) return;
  gl_->BindVertexArray(batch.vertex_array.id());
  gl_->DrawArrays(GL_POINTS, 0, batch.count);
}

void SceneRenderer::draw_kept_points(const SceneView& view, const Eigen::Matrix4f& clip_from_world,
                                     const Theme& theme, float scale) {
  const bool plain = kept_points_.count > kManyPoints;
  if (plain && !plain_point_program_) plain_point_program_.emplace(Program::embedded(*gl_, "plain_point"));
  const Program& program = plain ? *plain_point_program_ : point_program_;
  program.use();
  program.set("clip_from_world", clip_from_world);
  program.set("reference_depth", static_cast<float>(view.distance));
  program.set("size_px", scale * (plain ? kPlainPointSize : kPointSize));
  if (plain) {
    const ImVec4 ground = to_vec4(theme.plot);
    program.set("ground", Eigen::Vector4f(ground.x, ground.y, ground.z, 1.0F));
    gl_->Disable(GL_BLEND);
  }
  draw_points(kept_points_);
  gl_->Enable(GL_BLEND);
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
  upload_paths(scene, view, viewport, theme.name);
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

  draw_kept_points(view, clip_from_world, theme, scale);
  point_program_.use();
  point_program_.set("clip_from_world", clip_from_world);
  point_program_.set("reference_depth", static_cast<float>(view.distance));
  point_program_.set("size_px", kRemovedPointSize * scale);
  draw_points(removed_points_);

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
  for (std::size_t i = 0; i < paths_.size(); ++i)
    draw_segments(paths_[i].batch, scene.paths[i].width_px * scale);
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
