#include "ui/panels/frame_marks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/feature_selection.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/pins.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/session/debug_view.hpp"
#include "ui/session/session_view.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/palette.hpp"
#include "ui/theme/theme.hpp"
#include "ui/view/image_view.hpp"
#include "ui/view/image_widget.hpp"

namespace stillpoint {
namespace {

constexpr double kFeatureReach = 12.0;  // px of the frame, for the menu's feature

void cross(ImDrawList& list, ImVec2 at, float from, float to, ImU32 ink, float thick) {
  list.AddLine({at.x - to, at.y}, {at.x - from, at.y}, ink, thick);
  list.AddLine({at.x + from, at.y}, {at.x + to, at.y}, ink, thick);
  list.AddLine({at.x, at.y - to}, {at.x, at.y - from}, ink, thick);
  list.AddLine({at.x, at.y + from}, {at.x, at.y + to}, ink, thick);
}

/// A cross that reads on any picture; a frame about the pixel where pixels are large.
void draw_crosshair(const UiFrame& frame, const ImageResponse& response, const Eigen::Vector2d& pixel) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 at = response.to_screen(to_raster(pixel));
  const auto scale = static_cast<float>(response.map.scale());
  const float gap = std::max(4.0F * frame.scale, 0.5F * scale + 2.0F), arm = gap + 13.0F * frame.scale;
  const Rgb colour = role_colour(Role::kCursor, ThemeName::kDark);
  cross(list, at, gap - 1.0F, arm + 1.0F, IM_COL32(0, 0, 0, 170), 3.5F * frame.scale);
  cross(list, at, gap, arm, to_u32(colour), 1.5F * frame.scale);
  if (scale < 6.0F) return;
  const Eigen::Vector2d corner = pixel.array().round().matrix();  // of the nearest pixel, in the raster
  const ImVec2 low = response.to_screen(RasterPoint(corner)),
               high = response.to_screen(RasterPoint((corner.array() + 1.0).matrix()));
  list.AddRect(low, high, to_u32(colour), 0.0F, ImDrawFlags_None, 1.5F * frame.scale);
}

void draw_pins(const UiFrame& frame, const ImageResponse& response, const PairGeometry& pair,
               const FramePlace& place) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (const Pin& pin : place.session.debug.pins) {
    const auto there = scene_point_in(pair, place.space, {pin.x, pin.y});
    if (!there) continue;
    const ImVec2 at = response.to_screen(to_raster(there->pixel));
    const float r = 4.5F * frame.scale;
    list.AddCircleFilled(at, r + 1.5F * frame.scale, IM_COL32(0, 0, 0, 170));
    list.AddCircle(at, r, IM_COL32(255, 255, 255, 255), 0, 1.8F * frame.scale);
    list.AddCircleFilled(at, 1.5F * frame.scale, IM_COL32(255, 255, 255, 255));
    draw_label(frame, {at.x + r + 3.0F * frame.scale, at.y - 1.6F * frame.fonts.small->FontSize}, pin.name,
               frame.theme.text);
  }
}

void draw_chosen_feature(const UiFrame& frame, const ImageResponse& response, PanelsShared& shared,
                         const PairGeometry& pair, const FramePlace& place) {
  const auto index = chosen_feature(place.session, shared);
  if (!index) return;
  const cv::Point2f& pixel = place.session.current->record->features[static_cast<std::size_t>(*index)].pixel;
  const auto there =
      scene_point_in(pair, place.space, {static_cast<double>(pixel.x), static_cast<double>(pixel.y)});
  if (!there) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 at = response.to_screen(to_raster(there->pixel));
  const float r = 8.0F * frame.scale;
  const ImVec2 corners[] = {{at.x - r, at.y}, {at.x, at.y - r}, {at.x + r, at.y}, {at.x, at.y + r}};
  list.AddPolyline(corners, 4, IM_COL32(0, 0, 0, 170), ImDrawFlags_Closed, 4.0F * frame.scale);
  list.AddPolyline(corners, 4, IM_COL32(255, 255, 255, 255), ImDrawFlags_Closed, 1.8F * frame.scale);
}

void draw_menu(PanelsShared& shared, const FramePlace& place) {
  if (!ImGui::BeginPopup("pixel menu")) return;
  const auto& target = shared.cursor ? shared.cursor->target : std::nullopt;
  const auto& pins = place.session.debug.pins;
  const auto pin = target ? pin_near(pins, target->x(), target->y(), 0.7) : std::nullopt;
  const std::string label =
      pin ? fmt::format("Take out pin {}", pins[*pin].name) : std::string("Pin this pixel");
  if (ImGui::MenuItem(label.c_str(), "P", false, target.has_value()))
    toggle_pin_at_cursor(place.session, shared, place.actions);
  if (ImGui::MenuItem("Take out all pins", nullptr, false, !pins.empty()))
    place.actions.requests.emplace_back(request::Pins{});
  ImGui::Separator();
  const FrameRecord* record = place.session.current->record;
  const auto feature =
      record != nullptr && target ? feature_near(*record, *target, kFeatureReach) : std::nullopt;
  if (ImGui::MenuItem("Explain the feature here", nullptr, false, feature.has_value()))
    choose_feature(place.session, shared, *feature);
  if (ImGui::MenuItem("Let go of the chosen feature", nullptr, false, shared.feature.has_value()))
    shared.feature.reset();
  ImGui::Separator();
  if (ImGui::MenuItem("Show the whole image", "double click")) shared.views.at("frame") = ImageView{};
  ImGui::EndPopup();
}

}  // namespace

void take_mouse(const char* id, const ImageResponse& response, PanelsShared& shared,
                const FramePlace& place) {
  ImGui::PushID(id);
  if (response.image_point) {
    ImageCursor cursor;
    cursor.space = place.space;
    cursor.pixel = to_pixel(*response.image_point);
    if (place.space == FrameSpace::kTarget) cursor.pixel = response.pixel->cast<double>();
    if (const auto target = target_point(shared.geometry(place.session), place.space, cursor.pixel))
      cursor.target = target->pixel;
    shared.cursor = cursor;
    shared.pixel.reset();
    if (cursor.target) shared.pixel = cursor.target->array().round().cast<int>().matrix();
    if (response.right_clicked) ImGui::OpenPopup("pixel menu");
  }
  draw_menu(shared, place);
  ImGui::PopID();
}

void draw_marks(const UiFrame& frame, const ImageResponse& response, PanelsShared& shared,
                const FramePlace& place) {
  const PairGeometry& pair = shared.geometry(place.session);
  push_clip(response);
  draw_chosen_feature(frame, response, shared, pair, place);
  draw_pins(frame, response, pair, place);
  if (shared.cursor) {
    // Under the mouse itself the mouse's own place is the surest.
    const ImageCursor& cursor = *shared.cursor;
    std::optional<Eigen::Vector2d> pixel;
    if (cursor.space == place.space) {
      pixel = cursor.pixel;
    } else if (cursor.target) {
      if (const auto there = scene_point_in(pair, place.space, *cursor.target)) pixel = there->pixel;
    }
    if (pixel) draw_crosshair(frame, response, *pixel);
  }
  pop_clip();
}

void toggle_pin_at_cursor(const SessionView& session, const PanelsShared& shared, PanelActions& actions) {
  if (!shared.pixel) return;
  actions.requests.emplace_back(request::Pins{
      with_pin_toggled(session.debug.pins, session.current->index, shared.pixel->x(), shared.pixel->y())});
}

std::optional<int> chosen_feature(const SessionView& session, PanelsShared& shared) {
  if (!shared.feature || session.current->record == nullptr) return std::nullopt;
  const auto index = find_selected(*session.current, *shared.feature);
  if (index && shared.feature->frame != session.current->index) choose_feature(session, shared, *index);
  return index;
}

void choose_feature(const SessionView& session, PanelsShared& shared, int index) {
  const FrameView& view = *session.current;
  shared.feature =
      FeatureSelection{view.index, index, view.record->features[static_cast<std::size_t>(index)]};
}

}  // namespace stillpoint
