#include "ui/scene/scene_widget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/gl/framebuffer.hpp"
#include "ui/scene/scene_renderer.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/colormap.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

constexpr double kPickRadius = 9.0;    // design px about the mouse: what one points at
constexpr double kWheelFactor = 0.87;  // times the distance, a notch of the wheel
constexpr float kClickSlack = 4.0F;    // px: a hand moves a little in a click
// Lines, points and pictures' outlines are smooth by their shaders; samples would cost a software renderer
// most of a frame and change little.
constexpr int kSamples = 0;

/// Writes and paints over a drawn scene; lengths in design px times scale.
class Overlay {
 public:
  Overlay(const UiFrame& frame, ImVec2 low, ImVec2 high)
      : frame_(frame), list_(*ImGui::GetWindowDrawList()), low_(low), high_(high), scale_(frame.scale) {}

  /// As many lines as there is room for. @returns its lower right corner
  ImVec2 legend(const SceneData& scene) const {
    std::vector<SceneLegendEntry> entries = scene_legend(scene, frame_.theme.name);
    const float font = frame_.fonts.small->FontSize, line = font + 4.0F * scale_;
    const ImVec2 corner{low_.x + 8.0F * scale_, low_.y + 8.0F * scale_};
    const float room = std::max(high_.y - corner.y - 12.0F * scale_, 0.0F);
    const auto most = static_cast<std::size_t>(room / line);
    if (entries.size() > most)
      std::erase_if(entries, [](const SceneLegendEntry& entry) { return entry.elsewhere; });
    entries.resize(std::min(entries.size(), most));
    if (entries.empty()) return corner;
    float widest = 0.0F;
    for (const SceneLegendEntry& entry : entries) widest = std::max(widest, extent_of(entry.name).x);
    const ImVec2 end{corner.x + widest + 46.0F * scale_,
                     corner.y + line * static_cast<float>(entries.size()) + 8.0F * scale_};
    backdrop(corner, end);
    const float left = corner.x + 8.0F * scale_;
    float top = corner.y + 5.0F * scale_;
    for (const SceneLegendEntry& entry : entries) {
      const float middle = std::round(top + 0.5F * font);
      const ImU32 colour = to_u32(entry.colour);
      if (entry.width_px > 0.0F && entry.broken)
        for (const float from : {0.0F, 7.0F, 14.0F})
          list_.AddLine({left + from * scale_, middle}, {left + (from + 4.0F) * scale_, middle}, colour,
                        entry.width_px * scale_);
      else if (entry.width_px > 0.0F)
        list_.AddLine({left, middle}, {left + 18.0F * scale_, middle}, colour, entry.width_px * scale_);
      else
        list_.AddCircleFilled({left + 9.0F * scale_, middle}, 3.0F * scale_, colour);
      text({left + 26.0F * scale_, top}, entry.name, frame_.theme.text);
      top += line;
    }
    return end;
  }

  void error_scale(float most_m) const {
    if (high_.y - low_.y < kErrorScaleRoom * scale_) return;
    // The axes' directions stand below it.
    const float room = high_.y - low_.y - 130.0F * scale_;
    const float height = std::clamp(room, 24.0F * scale_, 110.0F * scale_), width = 10.0F * scale_;
    const ImVec2 corner{high_.x - 64.0F * scale_, low_.y + 34.0F * scale_};
    const float half = 0.5F * frame_.fonts.small->FontSize;
    backdrop({corner.x - 8.0F * scale_, low_.y + 8.0F * scale_},
             {high_.x - 8.0F * scale_, corner.y + height + half + 5.0F * scale_});
    constexpr int kSteps = 32;  // bands of the scale: it looks even
    for (int i = 0; i < kSteps; ++i) {
      const float value = 1.0F - (static_cast<float>(i) + 0.5F) / kSteps;
      const float from = corner.y + height * static_cast<float>(i) / kSteps;
      list_.AddRectFilled({corner.x, from}, {corner.x + width, from + height / kSteps + 1.0F},
                          to_u32(map_colour(Colormap::kInferno, 0.25F + 0.75F * value)));
    }
    text({corner.x - 2.0F * scale_, corner.y - 2.0F * half - 6.0F * scale_}, "error", frame_.theme.text_dim);
    text({corner.x + width + 5.0F * scale_, corner.y - half}, length_text(static_cast<double>(most_m)),
         frame_.theme.text);
    text({corner.x + width + 5.0F * scale_, corner.y + height - half}, "0", frame_.theme.text);
  }

  /// @param legend the legend's lower right corner, beside which it goes where it cannot go below
  void scale_bar(double metres_per_pixel, ImVec2 legend) const {
    const double metres = scale_bar_length(metres_per_pixel, 120.0 * static_cast<double>(scale_));
    const auto length = static_cast<float>(metres / metres_per_pixel);
    const float y = std::round(high_.y - 14.0F * scale_), tick = 4.0F * scale_;
    const ImU32 ink = to_u32(frame_.theme.text_dim);
    const float font = frame_.fonts.small->FontSize;
    const bool below = y - font - 6.0F * scale_ > legend.y;
    const float x = (below ? low_.x : legend.x) + 12.0F * scale_;
    if (x + length > high_.x - (below ? 0.0F : kAxesRoom * scale_)) return;
    backdrop({x - 4.0F * scale_, y - font - 6.0F * scale_}, {x + length + 4.0F * scale_, y + 6.0F * scale_});
    list_.AddLine({x, y}, {x + length, y}, ink, scale_);
    list_.AddLine({x, y - tick}, {x, y + tick}, ink, scale_);
    list_.AddLine({x + length, y - tick}, {x + length, y + tick}, ink, scale_);
    text({x + 6.0F * scale_, y - frame_.fonts.small->FontSize - 3.0F * scale_}, length_text(metres),
         frame_.theme.text_dim);
  }

  void axes(const SceneView& view, bool with_errors) const {
    const float height = high_.y - low_.y;
    if (height < kAxesRoom * scale_) return;
    // Where they cannot stand below the errors' scale they stand beside it.
    const bool beside = with_errors && height < (kErrorScaleRoom + kAxesRoom) * scale_;
    const ImVec2 middle{high_.x - (beside ? 72.0F + 38.0F : 38.0F) * scale_, high_.y - 38.0F * scale_};
    const Eigen::Matrix3d view_from_world = view.world_from_view.toRotationMatrix().transpose();
    std::array<int, 3> order{0, 1, 2};
    // The axis that points away is drawn first, so that the nearer ones cross over it.
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return view_from_world(2, a) < view_from_world(2, b); });
    constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
    for (const int axis : order) {
      const auto index = static_cast<std::size_t>(axis);
      const Eigen::Vector2f tip = view_from_world.col(axis).head<2>().cast<float>() * 24.0F * scale_;
      const ImVec2 end{middle.x + tip.x(), middle.y - tip.y()};
      list_.AddLine(middle, end, to_u32(axis_colours()[index]), 2.0F * scale_);
      const ImVec2 at{middle.x + 1.35F * tip.x(), middle.y - 1.35F * tip.y()};
      const ImVec2 extent = extent_of(kNames[index]);
      text({at.x - 0.5F * extent.x, at.y - 0.5F * extent.y}, kNames[index], axis_colours()[index]);
    }
  }

  void ring(ImVec2 at, Rgb colour) const {
    list_.AddCircleFilled(at, 6.0F * scale_, to_u32(frame_.theme.plot, 0.9F));
    list_.AddCircle(at, 6.0F * scale_, to_u32(colour), 0, 2.5F * scale_);
  }

 private:
  /// A ground that keeps writing readable over points and lines.
  void backdrop(ImVec2 low, ImVec2 high) const {
    list_.AddRectFilled(low, high, to_u32(frame_.theme.plot, 0.8F), 4.0F * scale_);
  }

  [[nodiscard]] ImVec2 extent_of(const std::string& words) const {
    return frame_.fonts.small->CalcTextSizeA(frame_.fonts.small->FontSize, 1e6F, 0.0F, words.c_str());
  }

  void text(ImVec2 at, const std::string& words, Rgb colour) const {
    list_.AddText(frame_.fonts.small, frame_.fonts.small->FontSize, {std::round(at.x), std::round(at.y)},
                  to_u32(colour), words.c_str());
  }

  static constexpr float kErrorScaleRoom = 76.0F, kAxesRoom = 80.0F;  // design px, from top to bottom

  const UiFrame& frame_;
  ImDrawList& list_;
  ImVec2 low_, high_;
  float scale_;
};

/// @returns whether it was a click in place.
bool handle_mouse(const SceneData& scene, SceneView& view, const Viewport& viewport, ImVec2 low) {
  const ImGuiIO& io = ImGui::GetIO();
  const Eigen::Vector2d cursor{static_cast<double>(io.MousePos.x - low.x),
                               static_cast<double>(io.MousePos.y - low.y)};
  const Eigen::Vector2d moved{static_cast<double>(io.MouseDelta.x), static_cast<double>(io.MouseDelta.y)};
  bool clicked = false;
  if (ImGui::IsItemHovered()) {
    if (io.MouseWheel != 0.0F) zoom(view, viewport, cursor, std::pow(kWheelFactor, io.MouseWheel));
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) fit(view, viewport, bounds(scene));
    const ImVec2 dragged = ImGui::GetMouseDragDelta(ImGuiMouseButton_Left, 0.0F);
    clicked = ImGui::IsMouseReleased(ImGuiMouseButton_Left) && std::hypot(dragged.x, dragged.y) < kClickSlack;
  }
  if (!ImGui::IsItemActive()) return clicked;
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, kClickSlack)) {
    if (io.KeyShift)
      pan(view, viewport, moved);
    else
      orbit(view, viewport, moved, scene.up);
  } else if (ImGui::IsMouseDragging(ImGuiMouseButton_Right) ||
             ImGui::IsMouseDragging(ImGuiMouseButton_Middle)) {
    pan(view, viewport, moved);
  }
  return clicked;
}

std::optional<ScenePose> pose_under(const SceneData& scene, const SceneView& view, const Viewport& viewport,
                                    const Eigen::Vector2d& cursor, double radius) {
  std::optional<ScenePose> best;
  double best_distance = radius;
  for (std::size_t path = 0; path < scene.paths.size(); ++path) {
    if (!scene.paths[path].pickable) continue;
    const auto picked = pick(view, viewport, scene.paths[path].positions, cursor, best_distance);
    if (!picked) continue;
    best = ScenePose{path, picked->index};
    best_distance = picked->distance_px;
  }
  return best;
}

}  // namespace

SceneWidget::SceneWidget(const Gl& gl) : gl_(&gl), renderer_(std::make_unique<SceneRenderer>(gl)) {}

SceneWidget::~SceneWidget() = default;

SceneResponse SceneWidget::draw(const UiFrame& frame, const char* id, const SceneData& scene, SceneView& view,
                                ImVec2 size) {
  const ImVec2 available = ImGui::GetContentRegionAvail();
  if (size.x <= 0.0F) size.x = available.x;
  if (size.y <= 0.0F) size.y = available.y;
  const int width = std::max(16, static_cast<int>(size.x)), height = std::max(16, static_cast<int>(size.y));
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 high{low.x + static_cast<float>(width), low.y + static_cast<float>(height)};
  SceneResponse response;
  response.viewport = {static_cast<double>(width), static_cast<double>(height)};
  response.panel_min = low;

  ImGui::InvisibleButton(id, {static_cast<float>(width), static_cast<float>(height)},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  response.hovered = ImGui::IsItemHovered();
  response.clicked = handle_mouse(scene, view, response.viewport, low);
  if (response.hovered) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    response.pose = pose_under(scene, view, response.viewport,
                               {static_cast<double>(mouse.x - low.x), static_cast<double>(mouse.y - low.y)},
                               kPickRadius * static_cast<double>(frame.scale));
  }

  if (!framebuffer_ || framebuffer_->width() != width || framebuffer_->height() != height) {
    framebuffer_ = std::make_unique<Framebuffer>(*gl_, width, height, kSamples);
    drawn_.reset();
  }
  Drawn wanted{
      scene.revision, scene.image_revision, view_from_world(view), view.fov_y,       scene.ground_m, {},
      scene.up,       scene.show_grid,      scene.show_axes,       frame.theme.name, frame.scale};
  if (scene.current) wanted.current = scene.current->matrix();
  if (drawn_ != wanted) {
    renderer_->draw(scene, view, frame.theme, frame.scale, *framebuffer_);
    drawn_ = wanted;
  }
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddImage(framebuffer_->texture().imgui_id(), low, high, {0, 1}, {1, 0});

  const Overlay overlay(frame, low, high);
  list.PushClipRect(low, high, true);
  const ImVec2 legend = scene.show_legend ? overlay.legend(scene) : low;
  if (!scene.errors.empty()) overlay.error_scale(scene.error_scale_m);
  overlay.scale_bar(2.0 * view.distance * std::tan(0.5 * view.fov_y) / response.viewport.height, legend);
  overlay.axes(view, !scene.errors.empty());
  if (response.pose) {
    const ScenePath& path = scene.paths[response.pose->path];
    const auto seen = project(view, response.viewport, path.positions[response.pose->index].cast<double>());
    if (seen) overlay.ring(response.to_screen(seen->head<2>()), path_colour(path, frame.theme.name));
  }
  list.PopClipRect();
  return response;
}

std::vector<SceneLegendEntry> scene_legend(const SceneData& scene, ThemeName theme) {
  std::vector<SceneLegendEntry> entries;
  for (const ScenePath& path : scene.paths)
    if (!path.name.empty())
      entries.push_back({path.name, path_colour(path, theme), std::max(2.0F, path.width_px),
                         path.dash_m > 0.0, path.named_elsewhere});
  const auto removed = [](const ScenePoint& point) { return point.removed; };
  if (std::any_of(scene.points.begin(), scene.points.end(), removed))
    entries.push_back({"removed points", role_colour(Role::kRemoved, theme), 0.0F});
  return entries;
}

double scale_bar_length(double metres_per_pixel, double longest_px) {
  const double longest = metres_per_pixel * longest_px;
  const double decade = std::pow(10.0, std::floor(std::log10(longest) + 1e-9));
  for (const double leading : {5.0, 2.0}) {
    if (leading * decade <= longest * (1.0 + 1e-9)) return leading * decade;
  }
  return decade;
}

std::string length_text(double metres) {
  if (metres >= 1000.0) return fmt::format("{:.4g} km", metres / 1000.0);
  if (metres >= 1.0) return fmt::format("{:.4g} m", metres);
  if (metres >= 0.01) return fmt::format("{:.4g} cm", metres * 100.0);
  return fmt::format("{:.3g} mm", metres * 1000.0);
}

}  // namespace stillpoint
