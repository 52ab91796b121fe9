#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/plot_axis.hpp"

namespace stillpoint {
namespace {

constexpr float kNameWidth = 86.0F, kValueWidth = 74.0F;  // design px
constexpr double kWheelFactor = 1.2;

/// What a lane tells of each frame.
struct Lane {
  std::string name, unit;
  Rgb colour;
  std::vector<double> values;  ///< one a record; NaN = none
  double highest = 1.0;
};

/// The whole run at a glance, frame by frame: one lane a figure, the frame shown as a cursor through all.
class TimelinePanel final : public NamedPanel {
 public:
  explicit TimelinePanel(Shared shared) : NamedPanel("timeline", "Timeline", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.frame_count <= 0 || session.run->records.empty()) {
      draw_absent(frame, "No frame has been processed yet.");
      return;
    }
    collect(frame, session);
    const Footer footer = footer_of(frame, session);
    const ImVec2 room = room_above(frame, footer);
    low_ = ImGui::GetCursorScreenPos();
    high_ = {low_.x + room.x, low_.y + room.y};
    left_ = low_.x + kNameWidth * frame.scale;
    right_ = std::max(high_.x - kValueWidth * frame.scale, left_ + 20.0F);
    ImGui::SetCursorScreenPos({left_, low_.y});
    ImGui::InvisibleButton("lanes", {right_ - left_, room.y},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    handle_mouse(session, actions);
    paint(frame, session);
    ImGui::SetCursorScreenPos(low_);
    ImGui::Dummy(room);
    footer.draw(frame);
  }

 private:
  void collect(const UiFrame& frame, const SessionView& session) {
    const auto& records = session.run->records;
    if (run_ == session.run.get() && revision_ == session.revision && theme_ == frame.theme.name &&
        records.size() == seen_)
      return;
    run_ = session.run.get();
    revision_ = session.revision;
    theme_ = frame.theme.name;
    seen_ = records.size();
    lanes_ = {};
    lanes_.push_back({"Mask", "%", role_colour(Role::kUnion, theme_), {}, 0.0});
    lanes_.push_back({"Inliers", "", role_colour(Role::kInlier, theme_), {}, 0.0});
    if (!session.run->evaluation.matched.empty())
      lanes_.push_back({"Error", "mm", role_colour(Role::kEstimate, theme_), {}, 0.0});
    const auto& errors = session.run->evaluation.ate.errors;
    std::size_t next = 0;
    for (const FrameRecord& record : records) {
      lanes_[0].values.push_back(100.0 * record.mask_share);
      lanes_[1].values.push_back(is_lost(record) ? std::nan("") : record.inliers);
      if (lanes_.size() < 3) continue;
      while (next < errors.size() && errors[next].timestamp < record.timestamp - 1e-6) ++next;
      const bool known = next < errors.size() && std::abs(errors[next].timestamp - record.timestamp) < 1e-6;
      lanes_[2].values.push_back(known ? 1000.0 * errors[next].translation_m : std::nan(""));
    }
    for (Lane& lane : lanes_) {
      for (const double value : lane.values)
        if (std::isfinite(value)) lane.highest = std::max(lane.highest, value);
      lane.highest = lane.highest > 0.0 ? 1.05 * lane.highest : 1.05;
    }
  }

  [[nodiscard]] AxisRange everything(const SessionView& session) const {
    return {-0.5, static_cast<double>(session.frame_count) - 0.5};
  }

  [[nodiscard]] AxisMap map_of(const SessionView& session) const {
    return {range_.value_or(everything(session)), AxisScale::kLinear, static_cast<double>(left_),
            static_cast<double>(right_)};
  }

  void handle_mouse(const SessionView& session, PanelActions& actions) {
    const ImGuiIO& io = ImGui::GetIO();
    const AxisMap map = map_of(session);
    hovered_.reset();
    const auto mouse = static_cast<double>(io.MousePos.x);
    if (ImGui::IsItemHovered()) {
      hovered_ = frame_under(session, map.to_value(mouse));
      if (io.MouseWheel != 0.0F) {
        const AxisRange all = everything(session);
        AxisRange range = zoomed(map, mouse, std::pow(kWheelFactor, -io.MouseWheel));
        range = {std::max(range.low, all.low), std::min(range.high, all.high)};
        if (range.span() >= 4.0) range_ = range;
      }
      if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) range_.reset();
    }
    if (!ImGui::IsItemActive()) return;
    for (const int button : {ImGuiMouseButton_Right, ImGuiMouseButton_Middle})
      if (ImGui::IsMouseDragging(button) && range_)
        range_ = panned(map, static_cast<double>(io.MouseDelta.x));
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left))
      actions.go_to_frame = frame_under(session, map.to_value(mouse));
  }

  [[nodiscard]] static int frame_under(const SessionView& session, double value) {
    return static_cast<int>(
        std::lround(std::clamp(value, 0.0, static_cast<double>(session.frame_count - 1))));
  }

  void paint(const UiFrame& frame, const SessionView& session) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float line = frame.fonts.small->FontSize, gap = 4.0F * frame.scale;
    const float axis = line + gap, thin = line + 2.0F * frame.scale;
    const float bottom = high_.y - axis;
    float y = low_.y;
    paint_status(frame, session, y, y + thin);
    y += thin + gap;
    paint_keyframes(frame, session, y, y + thin);
    y += thin + gap;
    // In a low panel the last lanes give way.
    const int fitting = std::max(0, static_cast<int>((bottom - y) / (thin + gap)));
    const std::size_t shown = std::min(lanes_.size(), static_cast<std::size_t>(fitting));
    const float height = shown == 0 ? 0.0F : (bottom - y) / static_cast<float>(shown) - gap;
    for (std::size_t i = 0; i < shown; ++i) {
      paint_lane(frame, session, lanes_[i], y, y + height);
      y += height + gap;
    }
    const AxisMap map = map_of(session);
    list.PushClipRect({left_, low_.y}, {right_, high_.y}, true);
    if (hovered_) cursor(list, map, *hovered_, to_u32(frame.theme.text_dim, 0.7F), frame.scale, y);
    cursor(list, map, session.current->index, to_u32(role_colour(Role::kCursor, theme_)), 1.5F * frame.scale,
           y);
    list.PopClipRect();
    const int most = std::max(2, static_cast<int>((right_ - left_) / (70.0F * frame.scale)));
    for (const AxisTick& tick : linear_ticks(map.range, most)) {
      if (!tick.major || tick.value != std::round(tick.value)) continue;
      const auto x = static_cast<float>(map.to_pixel(tick.value));
      write(frame, {x - 0.5F * width(frame, tick.label), bottom + gap}, tick.label, frame.theme.text_dim);
    }
    write(frame, {low_.x, bottom + gap}, "Frame", frame.theme.text_dim);
    if (hovered_) tell(session, *hovered_);
  }

  static void cursor(ImDrawList& list, const AxisMap& map, int index, ImU32 colour, float thickness,
                     float bottom) {
    const auto x = static_cast<float>(map.to_pixel(index));
    const float top = ImGui::GetItemRectMin().y;
    list.AddLine({x, top}, {x, bottom}, colour, thickness);
  }

  /// Left and right edge of a record's column, px.
  [[nodiscard]] std::pair<float, float> column(const AxisMap& map, int index) const {
    const auto from = static_cast<float>(map.to_pixel(index - 0.5)),
               to = static_cast<float>(map.to_pixel(index + 0.5));
    return {from, std::max(to, from + 1.0F)};
  }

  void ground(const UiFrame& frame, const SessionView& session, float top, float bottom) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({left_, top}, {right_, bottom}, to_u32(frame.theme.plot));
    // What has not been processed stays the panel's ground.
    const AxisMap map = map_of(session);
    const float done = column(map, session.run->records.back().index).second;
    if (done < right_)
      list.AddRectFilled({std::max(done, left_), top}, {right_, bottom}, to_u32(frame.theme.panel));
    list.AddRect({left_, top}, {right_, bottom}, to_u32(frame.theme.border));
  }

  [[nodiscard]] static LegendEntry look_of(FrameStatus status, ThemeName theme) {
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

  void paint_status(const UiFrame& frame, const SessionView& session, float top, float bottom) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ground(frame, session, top, bottom);
    write(frame, {low_.x, top}, "Status", frame.theme.text);
    const AxisMap map = map_of(session);
    list.PushClipRect({left_, top}, {right_, bottom}, true);
    for (const FrameRecord& record : session.run->records) {
      const auto [from, to] = column(map, record.index);
      if (to < left_ || from > right_) continue;
      // Lost frames also stand lower, so that colour is not all that tells them.
      const float high = is_lost(record) ? 0.5F * (top + bottom) : top + 1.0F;
      list.AddRectFilled({from, high}, {to, bottom - 1.0F}, to_u32(look_of(record.status, theme_).colour));
    }
    list.PopClipRect();
    const FrameRecord* record = session.current->record;
    if (record != nullptr)
      write(frame, {right_ + 6.0F * frame.scale, top}, std::string(to_string(record->status)),
            frame.theme.text);
  }

  void paint_keyframes(const UiFrame& frame, const SessionView& session, float top, float bottom) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ground(frame, session, top, bottom);
    write(frame, {low_.x, top}, "Keyframes", frame.theme.text);
    const AxisMap map = map_of(session);
    int count = 0;
    list.PushClipRect({left_, top}, {right_, bottom}, true);
    for (const FrameRecord& record : session.run->records) {
      if (!record.keyframe) continue;
      ++count;
      const auto x = static_cast<float>(map.to_pixel(record.index));
      const float side = 3.5F * frame.scale, middle = 0.5F * (top + bottom);
      list.AddQuadFilled({x - side, middle}, {x, middle - side}, {x + side, middle}, {x, middle + side},
                         to_u32(role_colour(Role::kEstimate, theme_)));
    }
    list.PopClipRect();
    write(frame, {right_ + 6.0F * frame.scale, top}, fmt::format("{}", count), frame.theme.text);
  }

  void paint_lane(const UiFrame& frame, const SessionView& session, const Lane& lane, float top,
                  float bottom) const {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ground(frame, session, top, bottom);
    write(frame, {low_.x, top}, lane.name, frame.theme.text);
    if (bottom - top > 2.0F * frame.fonts.small->FontSize)
      write(frame, {low_.x, top + frame.fonts.small->FontSize + 1.0F},
            fmt::format("0–{:.3g}{}{}", lane.highest / 1.05, lane.unit.empty() ? "" : " ", lane.unit),
            frame.theme.text_dim);
    const AxisMap map = map_of(session);
    const auto& records = session.run->records;
    list.PushClipRect({left_, top}, {right_, bottom}, true);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const double value = lane.values[i];
      if (!std::isfinite(value)) continue;
      const auto [from, to] = column(map, records[i].index);
      if (to < left_ || from > right_) continue;
      const float high = bottom - static_cast<float>(value / lane.highest) * (bottom - top);
      list.AddRectFilled({from, high}, {to, bottom}, to_u32(lane.colour, 0.35F));
      list.AddRectFilled({from, high}, {to, high + 1.5F * frame.scale}, to_u32(lane.colour));
    }
    list.PopClipRect();
    const auto here = record_of(session, session.current->index);
    if (!here) return;
    const double value = lane.values[*here];
    write(frame, {right_ + 6.0F * frame.scale, top},
          std::isfinite(value) ? format_value(std::round(value * 10.0) / 10.0, lane.unit) : "–",
          frame.theme.text);
  }

  void tell(const SessionView& session, int index) const {
    const auto at = record_of(session, index);
    if (!at) {
      ImGui::SetTooltip("frame %d\nnot processed yet", index);
      return;
    }
    const FrameRecord& record = session.run->records[*at];
    std::string text = fmt::format("frame {}, {:.3f} s\n{}", index, record.timestamp - series_start(session),
                                   to_string(record.status));
    if (record.keyframe) text += ", keyframe";
    for (const Lane& lane : lanes_)
      if (std::isfinite(lane.values[*at]))
        text += fmt::format("\n{} {:.1f} {}", lane.name, lane.values[*at], lane.unit);
    if (!record.note.empty()) text += "\n" + record.note;
    ImGui::SetTooltip("%s", text.c_str());
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session) const {
    Footer footer;
    std::array<int, 5> counts{};
    for (const FrameRecord& record : session.run->records) ++counts[static_cast<std::size_t>(record.status)];
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] == 0) continue;
      LegendEntry entry = look_of(static_cast<FrameStatus>(i), frame.theme.name);
      entry.name = fmt::format("{} {}", counts[i], entry.name);
      footer.legend.push_back(std::move(entry));
    }
    footer.legend.push_back({"keyframe", role_colour(Role::kEstimate, frame.theme.name), Sign::kDiamond});
    footer.caption =
        fmt::format("Frame {} of {}; {} processed. Error: distance to the truth after alignment.",
                    session.current->index, session.frame_count, session.processed);
    return footer;
  }

  static float width(const UiFrame& frame, const std::string& text) {
    return frame.fonts.small->CalcTextSizeA(frame.fonts.small->FontSize, 1e6F, 0.0F, text.c_str()).x;
  }
  static void write(const UiFrame& frame, ImVec2 at, const std::string& text, Rgb colour) {
    ImGui::GetWindowDrawList()->AddText(frame.fonts.small, frame.fonts.small->FontSize,
                                        {std::round(at.x), std::round(at.y)}, to_u32(colour), text.c_str());
  }

  std::vector<Lane> lanes_;
  std::optional<AxisRange> range_;  // frames; none shows all
  std::optional<int> hovered_;
  ImVec2 low_, high_;
  float left_ = 0.0F, right_ = 0.0F;
  const void* run_ = nullptr;
  std::uint64_t revision_ = 0;
  std::size_t seen_ = 0;
  ThemeName theme_ = ThemeName::kDark;
};

}  // namespace

std::unique_ptr<Panel> make_timeline_panel(Shared shared) {
  return std::make_unique<TimelinePanel>(std::move(shared));
}

}  // namespace stillpoint
