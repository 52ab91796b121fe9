#include "ui/view/picture_strips.hpp"

#include <algorithm>
#include <cmath>

#include "ui/shell/canvas.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/text.hpp"

namespace stillpoint {
namespace {

// About a divider, where it is taken hold of; and its width.
constexpr float kReach = 5.0F, kDivider = 2.0F;  // design px
constexpr float kLeastShare = 0.02F;             // of the width, between dividers

/// The wider of two names has room beside the divider, or is cut by its strip.
void draw_name(const UiFrame& frame, const PictureStrip& strip, ImVec2 at) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImFont* font = frame.fonts.small;
  const float pad = 4.0F * frame.scale;
  const ImVec2 extent = font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, strip.name.c_str());
  at = {std::round(at.x), std::round(at.y)};
  list.AddRectFilled(at, {at.x + extent.x + 2.0F * pad, at.y + extent.y + 0.5F * pad},
                     to_u32(frame.theme.background, 0.85F), 3.0F * frame.scale);
  list.AddRectFilled(at, {at.x + 0.6F * pad, at.y + extent.y + 0.5F * pad}, to_u32(strip.colour));
  list.AddText(font, font->FontSize, {at.x + 1.3F * pad, at.y + 0.25F * pad}, to_u32(strip.colour),
               strip.name.c_str());
}

/// Nothing where there is no room for it: it reads as soon as the strip is drawn wider.
/// @returns whether it is there
bool draw_sentence(const UiFrame& frame, const std::string& text, ImVec2 low, ImVec2 high) {
  const ImFont* font = frame.fonts.small;
  const float wrap = 0.86F * (high.x - low.x);
  if (widest_word(*font, text) > wrap) return false;
  const std::string lines = in_lines(*font, text, wrap);
  const ImVec2 extent = font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, lines.c_str());
  if (extent.y > high.y - low.y) return false;
  ImGui::GetWindowDrawList()->AddText(
      font, font->FontSize,
      {std::round(0.5F * (low.x + high.x - extent.x)), std::round(0.5F * (low.y + high.y - extent.y))},
      to_u32(frame.theme.text_dim), lines.c_str());
  return true;
}

}  // namespace

PictureStrips::PictureStrips(std::vector<PictureStrip> strips, std::vector<float>& dividers)
    : strips_(std::move(strips)), dividers_(dividers) {}

void PictureStrips::begin(std::size_t strip, bool takes_clicks) {
  strip_ = strip;
  takes_clicks_ = takes_clicks;
  makes_places_ = places_.empty();
  ++passes_;
}

PictureStrips::Place* PictureStrips::find(const char* id) {
  const auto found =
      std::find_if(places_.begin(), places_.end(), [&](const Place& place) { return place.id == id; });
  return found == places_.end() ? nullptr : &*found;
}

void PictureStrips::say_absent(const std::string& sentence) {
  strips_[strip_].absent = sentence;
  absent_from_ = std::max(absent_from_, ImGui::GetCursorScreenPos().y);
}

PictureStrips::Place& PictureStrips::add(const char* id, ImVec2 low, ImVec2 high) {
  Place place{.id = id,
              .low = low,
              .high = high,
              .from = low.x,
              .to = high.x,
              .top = low.y,
              .bottom = high.y,
              .drawn = {}};
  place.drawn.resize(strips_.size());
  places_.push_back(std::move(place));
  return places_.back();
}

PictureStrips::Edges PictureStrips::edges(const Place& place, std::size_t strip) const {
  const auto at = [&](std::size_t divider) {
    return std::round(place.from + dividers_[divider] * (place.to - place.from));
  };
  return {strip == 0 ? place.low.x : at(strip - 1), strip + 1 == strips_.size() ? place.high.x : at(strip)};
}

bool PictureStrips::drag(const UiFrame& frame, Place& place) {
  if (strips_.size() < 2 || place.to <= place.from) return false;
  // Which divider is held is kept by ImGui's storage of the window, under the picture's own id.
  ImGuiStorage& storage = *ImGui::GetStateStorage();
  const ImGuiID key = ImGui::GetID((place.id + " divider").c_str());
  const float mouse = ImGui::GetIO().MousePos.x;
  int held = ImGui::IsItemActive() && !ImGui::IsItemActivated() ? storage.GetInt(key, -1) : -1;
  int near = -1;
  for (std::size_t i = 0; i < dividers_.size() && place.hovered; ++i)
    if (std::abs(edges(place, i).to - mouse) <= kReach * frame.scale) near = static_cast<int>(i);
  if (ImGui::IsItemActivated()) held = ImGui::IsMouseClicked(ImGuiMouseButton_Left) ? near : -1;
  storage.SetInt(key, held);
  if (held >= 0 && held < static_cast<int>(dividers_.size())) {
    const auto i = static_cast<std::size_t>(held);
    const float least = i == 0 ? kLeastShare : dividers_[i - 1] + kLeastShare;
    const float most = i + 1 == dividers_.size() ? 1.0F - kLeastShare : dividers_[i + 1] - kLeastShare;
    const float share = (mouse - place.from) / (place.to - place.from);
    if (!ImGui::IsItemActivated() && least <= most) dividers_[i] = std::clamp(share, least, most);
  }
  const bool is_dividers = held >= 0 || (near >= 0 && !ImGui::IsItemActive());
  if (is_dividers) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  return is_dividers;
}

void PictureStrips::draw_strip(const UiFrame& frame, const Place& place, std::size_t strip) const {
  const auto [from, to] = edges(place, strip);
  if (to <= from) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect({from, place.low.y}, {to, place.high.y}, true);
  if (!place.drawn[strip]) {
    list.AddRectFilled({from, place.low.y}, {to, place.high.y}, to_u32(frame.theme.background));
    const std::string& absent = strips_[strip].absent;
    for (const std::string& sentence :
         {absent, strips_[strip].name + " has no such picture.", std::string("–")})
      if (!sentence.empty() && draw_sentence(frame, sentence, {from, place.low.y}, {to, place.high.y})) break;
  }
  const float gap = 5.0F * frame.scale;
  const float left = strip == 0 ? std::max(from, place.from) : from;
  draw_name(frame, strips_[strip], {left + gap, place.bottom - frame.fonts.small->FontSize - 2.0F * gap});
  list.PopClipRect();
}

void PictureStrips::finish(const UiFrame& frame, ImVec2 low, ImVec2 high) {
  // Controls that stand above a sentence stay free.
  if (places_.empty()) add("", {low.x, std::max(low.y, absent_from_)}, high);
  for (const Place& place : places_) {
    for (std::size_t strip = 0; strip < strips_.size(); ++strip) draw_strip(frame, place, strip);
    for (std::size_t i = 0; i + 1 < strips_.size(); ++i) {
      const float x = edges(place, i).to, half = 0.5F * kDivider * frame.scale;
      ImDrawList& list = *ImGui::GetWindowDrawList();
      list.PushClipRect({place.from, place.top}, {place.to, place.bottom}, true);
      list.AddRectFilled({x - half - 1.0F, place.low.y}, {x + half + 1.0F, place.high.y},
                         IM_COL32(0, 0, 0, 150));
      list.AddRectFilled({x - half, place.low.y}, {x + half, place.high.y}, IM_COL32(255, 255, 255, 220));
      list.PopClipRect();
    }
  }
}

}  // namespace stillpoint
