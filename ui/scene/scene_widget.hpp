#pragma once

#include <imgui.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/scene/scene_view.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {

class Framebuffer;
class Gl;
class SceneRenderer;
struct UiFrame;

/// A pose of a path under the mouse.
struct ScenePose {
  std::size_t path = 0;   ///< index into SceneData::paths
  std::size_t index = 0;  ///< … and into its positions
};

struct SceneResponse {
  bool hovered = false;
  std::optional<ScenePose> pose;  ///< under the mouse, of the paths that are pickable
  bool clicked = false;           ///< left, in place
  Viewport viewport;              ///< px
  ImVec2 panel_min;               ///< px of the display: where the viewport's corner lies

  /// Viewport pixels to the display's.
  [[nodiscard]] ImVec2 to_screen(const Eigen::Vector2d& pixel) const {
    return {panel_min.x + static_cast<float>(pixel.x()), panel_min.y + static_cast<float>(pixel.y())};
  }
};

/// What tells one kind of thing in a scene from another.
struct SceneLegendEntry {
  std::string name;
  Rgb colour;
  float width_px = 0.0F;  ///< of its line; 0 for a dot
  bool broken = false;
  bool elsewhere = false;  ///< the first to go where there is no room for all
};
[[nodiscard]] std::vector<SceneLegendEntry> scene_legend(const SceneData& scene, ThemeName theme);

/// The trajectory view as a widget: left drag orbits, right or middle drag (or Shift and left) pans, the
/// wheel zooms about the cursor, double click fits everything. With legend, error scale, scale bar and the
/// axes' directions on it.
class SceneWidget {
 public:
  explicit SceneWidget(const Gl& gl);
  ~SceneWidget();
  SceneWidget(const SceneWidget&) = delete;
  SceneWidget& operator=(const SceneWidget&) = delete;

  /// Draws into the given size (0 takes what is left) at ImGui's cursor.
  SceneResponse draw(const UiFrame& frame, const char* id, const SceneData& scene, SceneView& view,
                     ImVec2 size = {0, 0});

 private:
  const Gl* gl_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::unique_ptr<Framebuffer> framebuffer_;

  /// What a picture of the scene depends on: the one drawn last serves until something of it changes.
  struct Drawn {
    std::uint64_t revision = 0, image_revision = 0;
    Eigen::Matrix4d view_from_world;
    double fov_y = 0.0, ground_m = 0.0;
    std::optional<Eigen::Matrix4d> current;
    Eigen::Vector3d up;
    bool show_grid = false, show_axes = false;
    ThemeName theme = ThemeName::kDark;
    float scale = 1.0F;
    bool operator==(const Drawn&) const = default;
  };
  std::optional<Drawn> drawn_;
};

/// A round length for a scale bar of at most `longest_px`: its metres, 1, 2 or 5 times a power of ten.
[[nodiscard]] double scale_bar_length(double metres_per_pixel, double longest_px);

/// A length as people say it: "20 cm", "1 m", "5 mm", "2 km".
[[nodiscard]] std::string length_text(double metres);

}  // namespace stillpoint
