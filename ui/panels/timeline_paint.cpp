#include "ui/panels/timeline_paint.hpp"

#include <algorithm>
#include <cmath>

#include "ui/panels/run_look.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr float kNameWidth = 104.0F, kValueWidth = 78.0F;  // design px
constexpr float kMostNames = 0.3F;                         // of the panel's width, for names and for values

}  // namespace

LegendEntry look_of(FrameStatus status, ThemeName theme) {
  switch (status) {
    case FrameStatus::tracked:
      return {"tracked", role_colour(Role::kInlier, theme), Sign::kSquare};
    case FrameStatus::initialised:
      return {"initialised", okabe_ito::kBlue, Sign::kSquare};
    case FrameStatus::relocalised:
      return {"relocalised", okabe_ito::kSkyBlue, Sign::kSquare};
    case FrameStatus::lost:
      return {"lost", role_colour(Role::kOutlier, theme), Sign::kSquare};
    case FrameStatus::unreadable:
      break;
  }
  return {"unreadable", okabe_ito::kPurple, Sign::kSquare};
}

TimelinePaint::TimelinePaint(const UiFrame& frame, ImVec2 low, ImVec2 high, AxisRange range)
    : frame_(frame), list_(*ImGui::GetWindowDrawList()), low_(low), high_(high) {
  const float most = kMostNames * (high.x - low.x);
  left = std::round(low.x + std::min(kNameWidth * frame.scale, most));
  right = std::round(std::max(high.x - std::min(kValueWidth * frame.scale, most), left + 20.0F));
  map_ = {range, AxisScale::kLinear, static_cast<double>(left), static_cast<double>(right)};
}

float TimelinePaint::text_width(const std::string& words) const {
  return frame_.fonts.small->CalcTextSizeA(frame_.fonts.small->FontSize, 1e6F, 0.0F, words.c_str()).x;
}

void TimelinePaint::text(ImVec2 at, const std::string& words, Rgb colour) const {
  list_.AddText(frame_.fonts.small, frame_.fonts.small->FontSize, {std::round(at.x), std::round(at.y)},
                to_u32(colour), words.c_str());
}

void TimelinePaint::name(float top, const std::string& words, Rgb colour, float indent) const {
  list_.PushClipRect({low_.x, low_.y}, {left - 2.0F, high_.y}, true);
  text({low_.x + indent, top}, words, colour);
  list_.PopClipRect();
}

void TimelinePaint::name_sign(float top, float bottom, Sign sign, Rgb colour) const {
  draw_sign(frame_, list_, {low_.x + 4.0F * frame_.scale, 0.5F * (top + bottom)}, 3.5F * frame_.scale, sign,
            to_u32(colour));
}

void TimelinePaint::value(float top, const std::string& words, Rgb colour) const {
  text({right + 6.0F * frame_.scale, top}, words, colour);
}

void TimelinePaint::ruler(float top, float bottom) const {
  list_.AddRectFilled({left, top}, {right, bottom}, to_u32(frame_.theme.raised), 2.0F * frame_.scale);
  const int most = std::max(2, static_cast<int>((right - left) / (70.0F * frame_.scale)));
  for (const AxisTick& tick : linear_ticks(map_.range, most, 1.0)) {
    const float x = std::round(x_of(tick.value));
    list_.AddLine({x, bottom - 4.0F * frame_.scale}, {x, bottom}, to_u32(frame_.theme.text_dim));
    const float wide = text_width(tick.label);
    text({std::clamp(x - 0.5F * wide, left + 1.0F, std::max(right - wide - 1.0F, left + 1.0F)), top},
         tick.label, frame_.theme.text_dim);
  }
}

void TimelinePaint::ground(float top, float bottom, int done) const {
  list_.AddRectFilled({left, top}, {right, bottom}, to_u32(frame_.theme.panel));
  const float processed = std::clamp(x_of(done + 0.5), left, right);
  list_.AddRectFilled({left, top}, {processed, bottom}, to_u32(frame_.theme.plot));
  list_.AddRect({left, top}, {right, bottom}, to_u32(frame_.theme.border));
}

void TimelinePaint::status(const std::vector<int>& frames, const std::vector<double>& badness, float top,
                           float bottom) const {
  for (const ColumnRun& run : runs_of(aggregate(frames, badness, map_.range, columns()))) {
    const FrameStatus status = status_of_badness(run.values.greatest);
    const bool low = status == FrameStatus::lost || status == FrameStatus::unreadable;
    list_.AddRectFilled({left + static_cast<float>(run.first), low ? 0.5F * (top + bottom) : top + 1.0F},
                        {left + static_cast<float>(run.last + 1), bottom - 1.0F},
                        to_u32(look_of(status, frame_.theme.name).colour));
  }
}

void TimelinePaint::signs(const std::vector<int>& frames, Sign sign, Rgb colour, float middle,
                          float radius) const {
  list_.PushClipRect({left, low_.y}, {right, high_.y}, true);
  for (const int column : columns_of(frames, map_.range, columns()))
    draw_sign(frame_, list_, {left + static_cast<float>(column) + 0.5F, middle}, radius, sign,
              to_u32(colour));
  list_.PopClipRect();
}

void TimelinePaint::lane(const std::vector<int>& frames, const std::vector<double>& values, double highest,
                         Rgb colour, float top, float bottom) const {
  const auto y_of = [&](double value) {
    return bottom - static_cast<float>(std::clamp(value / highest, 0.0, 1.0)) * (bottom - top);
  };
  const float edge = 1.5F * frame_.scale;
  for (const ColumnRun& run : runs_of(aggregate(frames, values, map_.range, columns()))) {
    const float from = left + static_cast<float>(run.first), to = left + static_cast<float>(run.last + 1);
    const float high = y_of(run.values.greatest), low = std::max(y_of(run.values.least), high + edge);
    list_.AddRectFilled({from, high}, {to, bottom}, to_u32(colour, 0.35F));
    list_.AddRectFilled({from, high}, {to, std::min(low, bottom)}, to_u32(colour));
  }
}

void TimelinePaint::ghost_lane(const std::vector<int>& frames, const std::vector<double>& values,
                               double highest, const RunLook& look, float top, float bottom) const {
  const float thick = 2.0F * frame_.scale;
  int last = -2;
  float last_y = 0.0F;
  for (const ColumnRun& run : runs_of(aggregate(frames, values, map_.range, columns()))) {
    const float from = left + static_cast<float>(run.first), to = left + static_cast<float>(run.last + 1);
    const float y =
        bottom - static_cast<float>(std::clamp(run.values.greatest / highest, 0.0, 1.0)) * (bottom - top);
    list_.AddLine({from, y}, {to, y}, to_u32(look.colour), thick);
    if (last == run.first - 1) list_.AddLine({from, last_y}, {from, y}, to_u32(look.colour), frame_.scale);
    last = run.last;
    last_y = y;
  }
}

void TimelinePaint::ring(int frame, double value, double highest, Rgb colour, float top, float bottom) const {
  const float radius = 3.5F * frame_.scale;
  const float y = bottom - static_cast<float>(std::clamp(value / highest, 0.0, 1.0)) * (bottom - top);
  const float x = x_of(frame);
  if (x < left || x > right) return;
  list_.AddCircle({x, std::clamp(y, top + radius, bottom - radius)}, radius, to_u32(colour), 0,
                  1.5F * frame_.scale);
}

void TimelinePaint::upright(double frame, Rgb colour, float alpha, float thickness, float top,
                            float bottom) const {
  const float x = x_of(frame);
  if (x < left || x > right) return;
  list_.AddLine({x, top}, {x, bottom}, to_u32(colour, alpha), thickness * frame_.scale);
}

void TimelinePaint::span(const FrameSpan& span, float top, float ruler_bottom, float bottom) const {
  const float from = std::max(x_of(span.first - 0.5), left), to = std::min(x_of(span.last + 0.5), right);
  if (to < from) return;
  const Rgb ink = frame_.theme.accent;
  const float wide = std::max(to, from + 1.0F);
  list_.AddRectFilled({from, top}, {wide, ruler_bottom}, to_u32(ink, 0.45F));
  list_.AddRectFilled({from, ruler_bottom}, {wide, bottom}, to_u32(ink, 0.12F));
  for (const float x : {from, wide}) {
    list_.AddLine({x, top}, {x, bottom}, to_u32(ink), frame_.scale);
    const float grip = 2.0F * frame_.scale;
    list_.AddRectFilled({x - grip, top}, {x + grip, ruler_bottom}, to_u32(ink), frame_.scale);
  }
}

}  // namespace stillpoint
