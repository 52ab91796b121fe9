#pragma once

#include <optional>

#include "ui/gl/framebuffer.hpp"
#include "ui/gl/program.hpp"
#include "ui/scene/scene_mesh.hpp"

namespace stillpoint {

/// Draws a SceneData with GL. What only changes with the data stays on the graphics card from frame to frame.
class SceneRenderer {
 public:
  explicit SceneRenderer(const Gl& gl);

  /// Draws into `target` and resolves it. `scale` is px a design pixel: widths and point sizes grow with it.
  void draw(const SceneData& scene, const SceneView& view, const Theme& theme, float scale,
            const Framebuffer& target);

 private:
  /// Segments or points on the card.
  struct Batch {
    GlObject vertex_array, buffer;
    GLsizei count = 0;  ///< segments, or points
  };
  struct PathBatch {
    Batch batch;
    SceneBounds box;  ///< of its positions
    double tolerance_m =
        -1.0;  ///< by which what lies on the card is simplified; negative: nothing lies there yet
  };

  enum class Layout { kSegments, kPoints };
  [[nodiscard]] Batch make_batch(Layout layout) const;
  void fill(Batch& batch, Layout layout, const std::vector<SceneVertex>& vertices);
  void reserve_segment_indices(std::size_t segments);
  void upload_scene(const SceneData& scene, ThemeName theme);
  void upload_paths(const SceneData& scene, const SceneView& view, const Viewport& viewport, ThemeName theme);
  void draw_segments(const Batch& batch, float width_px) const;
  void draw_points(const Batch& batch) const;
  void draw_kept_points(const SceneView& view, const Eigen::Matrix4f& clip_from_world, const Theme& theme,
                        float scale);
  void draw_current_image(const SceneData& scene);

  const Gl* gl_;
  Program line_program_, point_program_, image_program_;
  std::optional<Program> plain_point_program_;  ///< made when there are many points
  GlObject segment_indices_;                    ///< two triangles a segment, shared by all batches
  std::size_t indexed_segments_ = 0;
  Batch grid_, axes_, errors_, keyframes_, current_, kept_points_, removed_points_;
  std::vector<PathBatch> paths_;
  Texture image_;
  GlObject quad_array_, quad_buffer_;
  std::optional<std::uint64_t> uploaded_revision_, uploaded_image_;
  ThemeName uploaded_theme_ = ThemeName::kDark;
};

}  // namespace stillpoint
