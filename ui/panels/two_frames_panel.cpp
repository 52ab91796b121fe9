#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/frame_pair.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/sequence/frame.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/plot/plot.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

/// The frame shown and another of the run: the map points that both found, how far each is from where it
/// would be had it stood still, and where a point of one may be in the other.
class TwoFramesPanel final : public NamedPanel {
 public:
  explicit TwoFramesPanel(Shared shared) : NamedPanel("two_frames", "Two frames", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {420.0F, 240.0F}; }

  [[nodiscard]] bool shows_image_alone() const override { return false; }
  [[nodiscard]] bool keeps_up() const override { return true; }
  [[nodiscard]] bool shows_a_run() const override { return true; }
  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<TwoFramesPanel>(shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    choose_frame(frame, session, actions);
    const auto& other = session.debug.other;
    if (session.current->record == nullptr || other == nullptr) {
      draw_absent(frame, why_none(session));
      return;
    }
    if (!session.current->record->measured.features) {
      draw_absent(frame, fmt::format("{} left no features of frame {} to pair.", session.run->name,
                                     session.current->index));
      return;
    }
    Controls controls(frame);
    controls.toggle(
        "Lines", lines_,
        "Joins where both frames have a map point; not where runs are wiped against each other, as a "
        "line would cross what is another run's");
    controls.toggle("Arrows", arrows_, "From where the point would be had it stood still to where it is");
    controls.slider("##from", from_px_, 0.0F, kMostPx, "from %.1f px");
    collect(session);
    const Footer footer = footer_of(frame, session);
    ImVec2 room = room_above(frame, footer);
    const bool has_histogram = !pair_.errors.empty() && room.y > kRoomForHistogram * frame.scale;
    if (has_histogram) room.y -= kHistogram * frame.scale + ImGui::GetStyle().ItemSpacing.y;
    draw_pair(frame, session, actions, room);
    if (has_histogram) draw_histogram(frame);
    footer.draw(frame);
  }

  [[nodiscard]] std::vector<PanelCommand> commands() override {
    PanelCommand keep{
        .name = "keep_frame",
        .title = "Keep this frame to stand beside others",
        .group = "Debug",
        .icon = "",
        .shows = true,
        .run = [](const SessionView& session, PanelActions& actions) {
          actions.requests.emplace_back(request::StandBeside{OtherFrame::kept, session.current->index});
        }};
    return {keep};
  }

 private:
  void choose_frame(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    Controls controls(frame);
    if (!session.debug.other_is) actions.requests.emplace_back(request::StandBeside{});
    int which = static_cast<int>(session.debug.other_is.value_or(OtherFrame::before));
    if (controls.choice("beside", {"Frame before", "Keyframe", "Kept frame"}, which,
                        "The frame on the left: the one before, the keyframe this one shares most points "
                        "with, or one that is kept"))
      actions.requests.emplace_back(request::StandBeside{static_cast<OtherFrame>(which)});
    if (controls.button(fmt::format("Keep {}", session.current->index).c_str(),
                        "Keeps the frame shown on the left while others are gone to"))
      actions.requests.emplace_back(request::StandBeside{OtherFrame::kept, session.current->index});
  }

  [[nodiscard]] static std::string why_none(const SessionView& session) {
    const int index = session.current->index;
    if (session.current->record == nullptr) return fmt::format("Frame {} has not been processed yet.", index);
    switch (session.debug.other_is.value_or(OtherFrame::before)) {
      case OtherFrame::before:
        return index == 0 ? "There is no frame before the first."
                          : fmt::format("Frame {} has not been processed.", index - 1);
      case OtherFrame::keyframe:
        return fmt::format("Frame {} is its own keyframe, or has none.", index);
      case OtherFrame::kept:
        if (!session.debug.kept_frame)
          return "No frame is kept yet: Keep takes the one shown, for others to be held against.";
        return *session.debug.kept_frame == index
                   ? fmt::format("Frame {} is kept: go to another to see both.", index)
                   : fmt::format("Frame {}, which is kept, has not been processed.",
                                 *session.debug.kept_frame);
    }
    return {};
  }

  void collect(const SessionView& session) {
    if (same(here_, session.current) && same(other_, session.debug.other)) return;
    here_ = session.current, other_ = session.debug.other;
    pair_ = pair_frames(*session.current, *session.debug.other, session.camera);
    bars_x_.clear(), bars_y_.clear();
    if (pair_.errors.empty()) return;
    // Those beyond the axis stand in the last bar.
    const double width = static_cast<double>(kMostPx) / kBars;
    bars_y_.assign(kBars, 0.0);
    for (int i = 0; i < kBars; ++i) bars_x_.push_back(i * width);
    for (const double error : pair_.errors)
      bars_y_[static_cast<std::size_t>(std::min(kBars - 1, static_cast<int>(error / width)))] += 1.0;
  }

  static bool same(const std::weak_ptr<const FrameView>& kept, const std::shared_ptr<const FrameView>& view) {
    return !kept.owner_before(view) && !view.owner_before(kept);
  }

  [[nodiscard]] bool shows(const PairedFeature& feature) const {
    const auto error = feature.error();
    return from_px_ <= 0.0F || (error && *error >= static_cast<double>(from_px_));
  }

  void draw_pair(const UiFrame& frame, const SessionView& session, PanelActions& actions, ImVec2 room) {
    const FrameView &here = *session.current, &other = *session.debug.other;
    const ImVec2 start = ImGui::GetCursorScreenPos();
    const Tiling tiling = tile(frame, room, 2, {session.camera.width, session.camera.height});
    ImGui::SetCursorScreenPos(tiling.corner(start, 0));
    const ImageResponse left =
        draw_image(frame, "other", content_of(frame, other_texture_, session.debug.other),
                   shared_->views.at("frame"), tiling.size);
    draw_heading(frame, left, heading(session, other));
    ImGui::SetCursorScreenPos(tiling.corner(start, 1));
    const ImageResponse right =
        draw_frame_image(frame, "here", content_of(frame, here_texture_, session.current), *shared_,
                         tiling.size, {session, actions}, heading(session, here));
    std::optional<std::size_t> pointed = pointed_at(frame, left, right);
    draw_features(frame, left, right, pointed);
    if (pointed) {
      const PairedFeature& feature = pair_.features[*pointed];
      if (right.clicked || left.clicked) choose_feature(session, *shared_, feature.here);
      tell(frame, feature);
    }
    draw_cursor(frame, session, left, right);
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
  }

  [[nodiscard]] static ImageContent content_of(const UiFrame& frame, FrameTexture& texture,
                                               const std::shared_ptr<const FrameView>& view) {
    ImageContent content;
    if (view->frame.readable()) {
      content.texture = &texture.get(frame, view, 0, [&view] { return view->frame.gray; });
      content.values = &view->frame.gray;
    }
    content.absent = "Its image is missing";
    return content;
  }

  static std::string heading(const SessionView& session, const FrameView& view) {
    return frame_text(session, view.frame);
  }

  /// The pair whose feature is nearest to the mouse, in either picture.
  [[nodiscard]] std::optional<std::size_t> pointed_at(const UiFrame& frame, const ImageResponse& left,
                                                      const ImageResponse& right) const {
    const ImageResponse& under = right.image_point ? right : left;
    if (!under.image_point) return std::nullopt;
    const Eigen::Vector2d mouse = to_pixel(*under.image_point);
    double nearest = kReach * static_cast<double>(frame.scale) / under.map.scale();
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < pair_.features.size(); ++i) {
      const PairedFeature& feature = pair_.features[i];
      const double away = ((right.image_point ? feature.pixel_here : feature.pixel_other) - mouse).norm();
      if (away >= nearest || !shows(feature)) continue;
      nearest = away, found = i;
    }
    return found;
  }

  static ImVec2 on_screen(const ImageResponse& response, const Eigen::Vector2d& pixel) {
    return response.to_screen(to_raster(pixel));
  }

  static bool in_view(const ImageResponse& response, ImVec2 at) {
    return at.x >= response.panel_min.x && at.x <= response.panel_max.x && at.y >= response.panel_min.y &&
           at.y <= response.panel_max.y;
  }

  [[nodiscard]] static Rgb colour_of(const PairedFeature& feature, ThemeName theme) {
    return role_colour(feature.inlier ? Role::kInlier : Role::kOutlier, theme);
  }

  void draw_features(const UiFrame& frame, const ImageResponse& left, const ImageResponse& right,
                     std::optional<std::size_t> pointed) const {
    const ThemeName theme = frame.theme.name;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const bool joins = frame.strips == nullptr || !frame.strips->several();
    for (std::size_t i = 0; i < pair_.features.size(); ++i) {
      const PairedFeature& feature = pair_.features[i];
      if (!shows(feature)) continue;
      const bool chosen = pointed == i;
      const Rgb colour = colour_of(feature, theme);
      const Sign sign = feature.inlier ? Sign::kCircle : Sign::kTriangle;
      const ImVec2 from = on_screen(left, feature.pixel_other), to = on_screen(right, feature.pixel_here);
      // A line is drawn where both its ends can be seen.
      if (joins && (lines_ || chosen) && in_view(left, from) && in_view(right, to))
        list.AddLine(from, to, to_u32(colour, chosen ? 1.0F : 0.22F), (chosen ? 2.0F : 1.0F) * frame.scale);
      const float radius = (chosen ? 4.0F : 2.4F) * frame.scale;
      push_clip(left);
      draw_sign(frame, list, from, radius, sign, to_u32(colour));
      pop_clip();
      push_clip(right);
      if (arrows_ && feature.expected) {
        const ImVec2 expected = on_screen(right, *feature.expected);
        list.AddLine(expected, to, to_u32(role_colour(Role::kWarning, theme)), 1.6F * frame.scale);
        draw_sign(frame, list, expected, 2.0F * frame.scale, Sign::kRing,
                  to_u32(role_colour(Role::kWarning, theme)));
      }
      draw_sign(frame, list, to, radius, sign, to_u32(colour));
      pop_clip();
    }
  }

  /// Where the point under the mouse in one picture may be in the other, and where its depth puts it.
  void draw_cursor(const UiFrame& frame, const SessionView& session, const ImageResponse& left,
                   const ImageResponse& right) const {
    if (!pair_.here_from_other) return;
    const bool here = right.image_point.has_value();
    const ImageResponse &under = here ? right : left, &across = here ? left : right;
    if (!under.image_point) return;
    const Eigen::Vector2d pixel = to_pixel(*under.image_point);
    const Pose motion = here ? pair_.here_from_other->inverse() : *pair_.here_from_other;
    const Frame& measured = here ? session.current->frame : session.debug.other->frame;
    std::vector<ImVec2> points;
    for (const Eigen::Vector2d& place : epipolar_curve(session.camera, motion, pixel))
      points.push_back(on_screen(across, place));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 colour = to_u32(role_colour(Role::kCursor, frame.theme.name));
    push_clip(across);
    if (points.size() > 1)
      list.AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, 1.5F * frame.scale);
    if (const auto depth = depth_at_pixel(measured.depth, pixel))
      if (const auto place = pixel_at_depth(session.camera, motion, pixel, *depth))
        draw_sign(frame, list, on_screen(across, *place), 5.0F * frame.scale, Sign::kRing, colour);
    pop_clip();
  }

  static void tell(const UiFrame& frame, const PairedFeature& feature) {
    std::string text = fmt::format("Map point {}, {}", feature.map_point,
                                   feature.inlier ? "an inlier in both" : "an outlier in one of them");
    if (const auto error = feature.error())
      text += fmt::format("\n{:.2f} px from where it would be had it stood still", *error);
    else
      text += "\nno depth in the other frame, or no pose: where it would be is not known";
    (void)frame;
    ImGui::SetTooltip("%s", text.c_str());
  }

  void draw_histogram(const UiFrame& frame) {
    Plot plot{.x_label = "error", .x_unit = "px", .y_label = "features"};
    plot.series.push_back(
        {"error", bars_x_, bars_y_, role_colour(Role::kWarning, frame.theme.name), SeriesStyle::kBars});
    plot.x_limits = AxisRange{0.0, static_cast<double>(kMostPx)};
    plot.legend = false;
    if (const auto median = pair_.median_error())
      plot.marks.push_back({*median, fmt::format("median {:.2f} px", *median), frame.theme.text_dim});
    const PlotResponse response = draw_plot(frame, "errors", plot, plot_view_, {0, kHistogram * frame.scale});
    // A click takes what lies above it.
    if (response.clicked_x) from_px_ = std::clamp(static_cast<float>(*response.clicked_x), 0.0F, kMostPx);
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session) const {
    const ThemeName theme = frame.theme.name;
    const auto inliers = std::count_if(pair_.features.begin(), pair_.features.end(),
                                       [](const PairedFeature& feature) { return feature.inlier; });
    const auto outliers = static_cast<std::ptrdiff_t>(pair_.features.size()) - inliers;
    Footer footer;
    footer.legend = {
        {fmt::format("{} inliers in both", inliers), role_colour(Role::kInlier, theme), Sign::kCircle},
        {fmt::format("{} outliers", outliers), role_colour(Role::kOutlier, theme), Sign::kTriangle},
        {"had it stood still", role_colour(Role::kWarning, theme), Sign::kRing}};
    footer.caption = fmt::format("Frames {} and {}: {} map points found in both, {} in {} alone.",
                                 session.debug.other->index, session.current->index, pair_.features.size(),
                                 pair_.only_here, session.current->index);
    if (pair_.baseline_m)
      footer.caption += fmt::format(" The camera went {:.0f} mm and turned {:.2f}°.",
                                    1000.0 * *pair_.baseline_m, *pair_.rotation_deg);
    else
      footer.caption += " One of them has no pose, so that nothing can be expected.";
    if (const auto median = pair_.median_error())
      footer.caption += fmt::format(" Median error {:.2f} px, by depth and both poses.", *median);
    return footer;
  }

  static constexpr float kMostPx = 10.0F;             // px, of the slider and the histogram
  static constexpr int kBars = 40;                    // of a quarter px
  static constexpr double kReach = 9.0;               // design px about the mouse
  static constexpr float kHistogram = 110.0F;         // design px, high
  static constexpr float kRoomForHistogram = 330.0F;  // design px, of pictures and histogram

  bool lines_ = true, arrows_ = true;
  float from_px_ = 0.0F;
  FramePair pair_;
  std::weak_ptr<const FrameView> here_, other_;
  std::vector<double> bars_x_, bars_y_;
  PlotView plot_view_;
  FrameTexture here_texture_, other_texture_;
};

}  // namespace

std::unique_ptr<Panel> make_two_frames_panel(Shared shared) {
  return std::make_unique<TwoFramesPanel>(std::move(shared));
}

}  // namespace stillpoint
