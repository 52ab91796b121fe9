#include "ui/panels/outline_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/geometry/pixel_conventions.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/theme.hpp"
#include "ui/view/image_widget.hpp"

namespace stillpoint {

ImVec2 corner_on(const ImageResponse& response, const Corner& corner) {
  return response.to_screen(to_raster(Eigen::Vector2d(corner.x, corner.y)));
}

float distance_between(ImVec2 a, ImVec2 b) { return std::hypot(a.x - b.x, a.y - b.y); }

float distance_to_edge(ImVec2 p, ImVec2 a, ImVec2 b) {
  const ImVec2 along{b.x - a.x, b.y - a.y};
  const float length = along.x * along.x + along.y * along.y;
  const float share =
      length > 0.0F ? std::clamp(((p.x - a.x) * along.x + (p.y - a.y) * along.y) / length, 0.0F, 1.0F) : 0.0F;
  return distance_between(p, {a.x + share * along.x, a.y + share * along.y});
}

bool encloses(const Outline& outline, const Corner& at) {
  std::vector<cv::Point2f> corners;
  for (const Corner& corner : outline)
    corners.emplace_back(static_cast<float>(corner.x), static_cast<float>(corner.y));
  return cv::pointPolygonTest(corners, {static_cast<float>(at.x), static_cast<float>(at.y)}, false) >= 0;
}

void draw_outline(const UiFrame& frame, const std::vector<ImVec2>& points, bool closed, Rgb ink) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto flags = closed ? ImDrawFlags_Closed : ImDrawFlags_None;
  const int count = static_cast<int>(points.size());
  list.AddPolyline(points.data(), count, IM_COL32(0, 0, 0, 170), flags, 4.0F * frame.scale);
  list.AddPolyline(points.data(), count, to_u32(ink), flags, 1.8F * frame.scale);
}

void draw_corners(const UiFrame& frame, const std::vector<ImVec2>& points, Rgb ink) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (const ImVec2& p : points) {
    const float r = 3.0F * frame.scale;
    list.AddRectFilled({p.x - r - 1, p.y - r - 1}, {p.x + r + 1, p.y + r + 1}, IM_COL32(0, 0, 0, 200));
    list.AddRectFilled({p.x - r, p.y - r}, {p.x + r, p.y + r}, to_u32(ink));
  }
}

}  // namespace stillpoint
