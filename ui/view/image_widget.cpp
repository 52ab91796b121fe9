#include "ui/view/image_widget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/gl/texture.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/theme.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

constexpr double kNumbersFromScale = 28.0;  // panel px an image px, design px
constexpr double kWheelFactor = 1.2;        // times the size, a notch of the wheel
constexpr float kClickSlack = 4.0F;         // px the mouse may move in a click

Eigen::Vector2d to_vector(ImVec2 v) { return {static_cast<double>(v.x), static_cast<double>(v.y)}; }

ImVec2 to_imvec(const Eigen::Vector2d& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y())}; }

std::string number_text(double value, int depth) {
  if (depth == CV_32F || depth == CV_64F) {
    // Five characters at most: what fits a pixel as soon as numbers are drawn.
    if (std::isnan(value)) return "–";
    const double size = std::abs(value);
    return fmt::format("{:.{}f}", value, size < 9.995 ? 2 : size < 99.95 ? 1 : 0);
  }
  return fmt::format("{:.0f}", value);
}

double channel_value(const cv::Mat& image, int x, int y, int channel) {
  const auto value = [&](auto type) {
    using T = decltype(type);
    return static_cast<double>(image.ptr<T>(y)[x * image.channels() + channel]);
  };
  switch (image.depth()) {
    case CV_8U:
      return value(std::uint8_t{});
    case CV_8S:
      return value(std::int8_t{});
    case CV_16U:
      return value(std::uint16_t{});
    case CV_16S:
      return value(std::int16_t{});
    case CV_32S:
      return value(std::int32_t{});
    case CV_32F:
      return value(float{});
    case CV_64F:
      return value(double{});
    default:
      return std::nan("");
  }
}

/// Whether a pixel is so bright that dark letters read better on it; unknown where numbers are no grey
/// levels.
std::optional<bool> is_bright(const cv::Mat& image, int x, int y) {
  if (image.depth() != CV_8U) return std::nullopt;
  if (image.channels() < 3) return channel_value(image, x, y, 0) > 140.0;
  return 0.114 * channel_value(image, x, y, 0) + 0.587 * channel_value(image, x, y, 1) +
             0.299 * channel_value(image, x, y, 2) >
         140.0;
}

/// Hairlines between the pixels x0..x1, y0..y1.
void draw_pixel_grid(const ImageResponse& response, int x0, int y0, int x1, int y1) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 ink = IM_COL32(128, 128, 128, 70);
  const auto place = [&response](int x, int y) { return response.to_screen(RasterPoint(x, y)); };
  for (int x = x0; x <= x1 + 1; ++x) list.AddLine(place(x, y0), place(x, y1 + 1), ink);
  for (int y = y0; y <= y1 + 1; ++y) list.AddLine(place(x0, y), place(x1 + 1, y), ink);
}

/// Writes each visible pixel's numbers onto it, light or dark as its ground asks.
void draw_numbers(const UiFrame& frame, const ImageResponse& response, const cv::Mat& values) {
  const Eigen::Vector2d size = to_vector(response.panel_max) - to_vector(response.panel_min);
  const Eigen::Vector2i first = pixel_covering(response.map.to_image({0.0, 0.0})),
                        last = pixel_covering(response.map.to_image(size));
  const int x0 = std::max(0, first.x()), x1 = std::min(values.cols - 1, last.x());
  const int y0 = std::max(0, first.y()), y1 = std::min(values.rows - 1, last.y());
  draw_pixel_grid(response, x0, y0, x1, y1);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  ImFont* font = frame.fonts.mono;
  const float lines = values.channels() >= 3 ? 3.0F : 1.0F;
  const float room = static_cast<float>(response.map.scale());
  // Three digits must fit the width, all lines the height.
  const float font_size = std::floor(std::min({font->FontSize, room / (lines + 0.6F), room / 2.2F}));
  constexpr ImU32 kLight = IM_COL32(255, 255, 255, 235), kDark = IM_COL32(0, 0, 0, 225);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const std::string text = pixel_text(values, x, y);
      const ImVec2 extent = font->CalcTextSizeA(font_size, 1e6F, 0.0F, text.c_str());
      const ImVec2 centre = response.to_screen(to_raster(Eigen::Vector2d(x, y)));
      const ImVec2 corner{std::round(centre.x - 0.5F * extent.x), std::round(centre.y - 0.5F * extent.y)};
      const std::optional<bool> bright = is_bright(values, x, y);
      if (!bright) list.AddText(font, font_size, {corner.x + 1.0F, corner.y + 1.0F}, kDark, text.c_str());
      list.AddText(font, font_size, corner, bright.value_or(false) ? kDark : kLight, text.c_str());
    }
  }
}

void draw_absent(const UiFrame& frame, const ImageResponse& response, const std::string& text) {
  const ImVec2 low = response.clip_min, high = response.clip_max;
  const float wrap = std::max(0.8F * (high.x - low.x), 1.0F);
  const ImVec2 extent = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const ImVec2 corner{0.5F * (low.x + high.x - extent.x), 0.5F * (low.y + high.y - extent.y)};
  ImGui::GetWindowDrawList()->AddText(frame.fonts.text, frame.fonts.text->FontSize, corner,
                                      to_u32(frame.theme.text_dim), text.c_str(), nullptr, wrap);
}

void draw_ground(const UiFrame& frame, ImVec2 low, ImVec2 high) {
  if (low.x < high.x && low.y < high.y)
    ImGui::GetWindowDrawList()->AddRectFilled(low, high, to_u32(frame.theme.background));
}

/// The panel about the picture: under it nothing is seen.
void draw_ground_beside(const UiFrame& frame, const ImageResponse& response,
                        const Eigen::Vector2d& image_size) {
  const ImVec2 low = response.panel_min, high = response.panel_max;
  const auto inside = [&](ImVec2 at, float towards) {
    // A pixel the picture covers in part is grounded as well.
    at = {std::round(at.x) + towards, std::round(at.y) + towards};
    return ImVec2{std::clamp(at.x, low.x, high.x), std::clamp(at.y, low.y, high.y)};
  };
  const ImVec2 from = inside(response.to_screen(RasterPoint(0.0, 0.0)), 1.0F);
  const ImVec2 to = inside(response.to_screen(RasterPoint(image_size)), -1.0F);
  if (from.x >= to.x || from.y >= to.y) return draw_ground(frame, low, high);
  draw_ground(frame, low, {high.x, from.y});
  draw_ground(frame, {low.x, to.y}, high);
  draw_ground(frame, {low.x, from.y}, {from.x, to.y});
  draw_ground(frame, {to.x, from.y}, {high.x, to.y});
}

void draw_pictures(const ImageContent& content, const ImageResponse& response,
                   const Eigen::Vector2d& image_size) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  // An image pixel's edge that falls on the centre of a display pixel would go either way, by rounding that
  // differs from driver to driver; a hundredth of a pixel decides.
  constexpr float kDecide = 0.01F;
  ImVec2 low = response.to_screen(RasterPoint(0.0, 0.0)), high = response.to_screen(RasterPoint(image_size));
  for (float* coordinate : {&low.x, &low.y, &high.x, &high.y}) *coordinate += kDecide;
  if (content.wiped_to != nullptr) {
    list.AddImage(content.wiped_to->imgui_id(), low, high);
    const float edge = low.x + (high.x - low.x) * content.wipe;
    list.AddImage(content.texture->imgui_id(), low, {edge, high.y}, {0, 0}, {content.wipe, 1});
    list.AddLine({edge, low.y}, {edge, high.y}, IM_COL32(255, 255, 255, 200), 2.0F);
  } else {
    list.AddImage(content.texture->imgui_id(), low, high);
  }
  for (const ImageOverlay& overlay : content.overlays) {
    if (overlay.texture == nullptr || overlay.texture->empty()) continue;
    const cv::Rect part =
        overlay.part.value_or(cv::Rect(0, 0, overlay.texture->width(), overlay.texture->height()));
    if (part.empty()) continue;
    const ImU32 tint = IM_COL32(overlay.colour.r, overlay.colour.g, overlay.colour.b,
                                static_cast<int>(255.0F * overlay.opacity));
    const auto share_of = [&overlay](int x, int y) {
      return ImVec2{static_cast<float>(x) / static_cast<float>(overlay.texture->width()),
                    static_cast<float>(y) / static_cast<float>(overlay.texture->height())};
    };
    const ImVec2 from = share_of(part.x, part.y), to = share_of(part.br().x, part.br().y);
    const auto at = [&](ImVec2 share) {
      return ImVec2{low.x + share.x * (high.x - low.x), low.y + share.y * (high.y - low.y)};
    };
    list.AddImage(overlay.texture->imgui_id(), at(from), at(to), from, to, tint);
  }
}

void handle_mouse(ImageView& view, bool drawn_on, const Eigen::Vector2d& image_size,
                  const Eigen::Vector2d& panel_size, ImVec2 panel_min, ImageResponse& response) {
  const ImGuiIO& io = ImGui::GetIO();
  const Eigen::Vector2d cursor = to_vector(io.MousePos) - to_vector(panel_min);
  if (ImGui::IsItemHovered()) {
    if (io.MouseWheel != 0.0F) {
      zoom_about(view, image_size, panel_size, cursor, std::pow(kWheelFactor, io.MouseWheel));
    }
    if (!drawn_on && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) view = ImageView{};
    const auto released_in_place = [](ImGuiMouseButton button) {
      const ImVec2 moved = ImGui::GetMouseDragDelta(button, 0.0F);
      return ImGui::IsMouseReleased(button) && std::hypot(moved.x, moved.y) < kClickSlack;
    };
    response.clicked = released_in_place(ImGuiMouseButton_Left);
    response.right_clicked = released_in_place(ImGuiMouseButton_Right);
  }
  if (!ImGui::IsItemActive()) return;
  for (const int button : {ImGuiMouseButton_Left, ImGuiMouseButton_Right, ImGuiMouseButton_Middle}) {
    if (drawn_on && button == ImGuiMouseButton_Left) continue;
    if (!ImGui::IsMouseDragging(button, kClickSlack)) continue;
    pan_by(view, image_size, panel_size, to_vector(io.MouseDelta));
    return;
  }
}

}  // namespace

ImVec2 ImageResponse::to_screen(const RasterPoint& image) const {
  return to_imvec(to_vector(panel_min) + map.to_panel(image));
}

namespace {

/// The part of the display that a picture is seen in.
void set_seen(PictureStrips::Place& place, const ImageResponse& response, const Eigen::Vector2d& image_size) {
  const ImVec2 low = response.to_screen(RasterPoint(0.0, 0.0)),
               high = response.to_screen(RasterPoint(image_size));
  place.from = std::clamp(low.x, place.low.x, place.high.x);
  place.to = std::clamp(high.x, place.low.x, place.high.x);
  place.top = std::clamp(low.y, place.low.y, place.high.y);
  place.bottom = std::clamp(high.y, place.low.y, place.high.y);
}

/// The button under a picture, and what the mouse does to it. @returns its place among the strips, if any
PictureStrips::Place* take_place(const UiFrame& frame, const char* id, const ImageContent& content,
                                 ImageView& view, const Eigen::Vector2d& image_size,
                                 ImageResponse& response) {
  const ImVec2 low = response.panel_min, high = response.panel_max;
  const Eigen::Vector2d panel_size = to_vector(high) - to_vector(low);
  PictureStrips* strips = frame.strips;
  // A pass that draws pictures alone has nothing else that can be clicked, and is clipped for it.
  if (strips != nullptr) ImGui::PushClipRect(low, high, !strips->pictures_alone());
  ImGui::InvisibleButton(id, {high.x - low.x, high.y - low.y},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  if (strips != nullptr) ImGui::PopClipRect();
  response.hovered = ImGui::IsItemHovered();
  const bool present = content.texture != nullptr && !content.texture->empty();
  PictureStrips::Place* place = strips == nullptr ? nullptr : &strips->add(id, low, high);
  bool is_dividers = false;
  if (place != nullptr) {
    response.map = ImageMap(view, image_size, panel_size);
    set_seen(*place, response, image_size);
    place->hovered = response.hovered;
    is_dividers = strips->drag(frame, *place);
  }
  if (present && !is_dividers) handle_mouse(view, content.drawn_on, image_size, panel_size, low, response);
  response.map = ImageMap(view, image_size, panel_size);
  if (place != nullptr) {
    set_seen(*place, response, image_size);
    place->clicked = response.clicked, place->right_clicked = response.right_clicked;
  }
  return place;
}

/// What of a picture with strips is the strip's at hand.
void confine_to_strip(PictureStrips& strips, PictureStrips::Place& place, ImageResponse& response) {
  const auto [from, to] = strips.edges(place);
  const float mouse = ImGui::GetIO().MousePos.x;
  const bool here = mouse >= from && mouse < to;
  response.clip_min.x = std::max(response.clip_min.x, from);
  response.clip_max.x = std::max(std::min(response.clip_max.x, to), response.clip_min.x);
  response.clips_anew = strips.pictures_alone();
  response.hovered = place.hovered && here;
  response.clicked = place.clicked && here && strips.takes_clicks();
  response.right_clicked = place.right_clicked && here;
}

}  // namespace

ImageResponse draw_image(const UiFrame& frame, const char* id, const ImageContent& content, ImageView& view,
                         ImVec2 size) {
  const ImVec2 available = ImGui::GetContentRegionAvail();
  if (size.x <= 0.0F) size.x = available.x;
  if (size.y <= 0.0F) size.y = available.y;
  size = {std::max(size.x, 16.0F), std::max(size.y, 16.0F)};
  const bool present = content.texture != nullptr && !content.texture->empty();
  const Eigen::Vector2d image_size =
      present ? Eigen::Vector2d(content.texture->width(), content.texture->height())
              : Eigen::Vector2d(4.0, 3.0);
  ImageResponse response;
  response.panel_min = ImGui::GetCursorScreenPos();
  response.panel_max = {response.panel_min.x + size.x, response.panel_min.y + size.y};
  PictureStrips::Place* place = frame.strips == nullptr ? nullptr : frame.strips->find(id);
  if (place != nullptr) {
    response.panel_min = place->low, response.panel_max = place->high;
    response.map = ImageMap(view, image_size, to_vector(response.panel_max) - to_vector(response.panel_min));
    ImGui::Dummy(size);
  } else if (frame.strips != nullptr && !frame.strips->makes_places()) {
    // A picture that the first strip has no like of is shown nowhere.
    response.panel_max = response.clip_min = response.clip_max = response.panel_min;
    ImGui::Dummy(size);
    return response;
  } else {
    place = take_place(frame, id, content, view, image_size, response);
  }
  response.clip_min = response.panel_min, response.clip_max = response.panel_max;
  if (place != nullptr) confine_to_strip(*frame.strips, *place, response);
  if (place != nullptr && present) frame.strips->note_drawn(*place);

  push_clip(response);
  if (present && is_opaque(content.texture->imgui_id()))
    draw_ground_beside(frame, response, image_size);
  else
    draw_ground(frame, response.panel_min, response.panel_max);
  if (present) {
    draw_pictures(content, response, image_size);
    if (content.values != nullptr && !content.values->empty() &&
        response.map.scale() >= kNumbersFromScale * static_cast<double>(frame.scale)) {
      draw_numbers(frame, response, *content.values);
    }
  } else {
    draw_absent(frame, response, content.absent);
  }
  pop_clip();
  if (present && response.hovered) {
    const Eigen::Vector2d cursor = to_vector(ImGui::GetIO().MousePos) - to_vector(response.panel_min);
    response.pixel = response.map.pixel_at(cursor);
    if (response.pixel) response.image_point = response.map.to_image(cursor);
  }
  return response;
}

void push_clip(const ImageResponse& response) {
  // A strip is cut from the window anew: passes that draw pictures alone are clipped everywhere else.
  const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  const ImVec2 from{std::max(response.clip_min.x, low.x), std::max(response.clip_min.y, low.y)};
  const ImVec2 to{std::min(response.clip_max.x, low.x + size.x),
                  std::min(response.clip_max.y, low.y + size.y)};
  ImGui::GetWindowDrawList()->PushClipRect(response.clips_anew ? from : response.clip_min,
                                           response.clips_anew ? to : response.clip_max,
                                           !response.clips_anew);
}

void pop_clip() { ImGui::GetWindowDrawList()->PopClipRect(); }

std::string pixel_text(const cv::Mat& image, int x, int y) {
  if (image.channels() < 3) return number_text(channel_value(image, x, y, 0), image.depth());
  // OpenCV stores blue first; people read red, green, blue.
  return number_text(channel_value(image, x, y, 2), image.depth()) + "\n" +
         number_text(channel_value(image, x, y, 1), image.depth()) + "\n" +
         number_text(channel_value(image, x, y, 0), image.depth());
}

}  // namespace stillpoint
