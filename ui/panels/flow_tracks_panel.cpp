#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/geometry/pixel_conventions.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/sequence/frame.hpp"
#include "ui/gl/texture.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

/// The corners followed between the two frames, and which of them the homography was taken from.
class FlowTracksPanel final : public FramePanel {
 public:
  explicit FlowTracksPanel(Shared shared) : FramePanel("flow_tracks", "Flow tracks", std::move(shared)) {}

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<FlowTracksPanel>(shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const StageLog* log = stages_or_absent(frame, session, actions, name(), "flow_tracks");
    if (log == nullptr) return;
    const FrameView& view = *session.current;
    Controls controls(frame);
    controls.choice("direction", {"Forward", "Backward"}, direction_);
    controls.round(log->rounds(), round_);
    controls.slider("##length", length_, 1.0F, 8.0F, "length x%.0f");
    const char* id = direction_ == 0 ? "flow_tracks" : "flow_tracks_backward";
    const int round = round_shown(*log, round_);
    const Layer& trace = *log->layer(id, round);
    const Frame& target = direction_ == 0 ? view.frame : view.reference;

    const Footer footer = footer_of(frame, session, *log, trace, target);
    ImageContent content;
    content.texture = &ground_.get(frame, session.current, direction_, [&] { return target.gray; });
    content.values = &target.gray;
    // The picture steps back behind the tracks.
    const Texture& veil = veil_.get(frame, session.current, 0, [&] {
      const Rgb shade = frame.theme.background;
      return cv::Mat(2, 2, CV_8UC4, cv::Scalar(shade.b, shade.g, shade.r, 255));
    });
    content.overlays.push_back({&veil, 0.3F});
    const ImageResponse response =
        draw_frame_image(frame, "tracks", content, *shared_, room_above(frame, footer),
                         {session, actions, direction_ == 0 ? FrameSpace::kTarget : FrameSpace::kReference});
    push_clip(response);
    for (const Mark& track : trace.marks) draw_track(frame, response, track);
    pop_clip();
    footer.draw(frame);
  }

 private:
  enum Kind { kInlier, kOutlier, kRemoved };

  [[nodiscard]] static Kind kind_of(const Mark& track) {
    return track.kind == MarkKind::kRemoved ? kRemoved : track.kind == MarkKind::kInlier ? kInlier : kOutlier;
  }
  [[nodiscard]] static LegendEntry look_of(Kind kind, ThemeName theme) {
    if (kind == kInlier) return {"inlier", role_colour(Role::kInlier, theme), Sign::kCircle};
    if (kind == kOutlier) return {"outlier", role_colour(Role::kOutlier, theme), Sign::kCross};
    return {"left out: in the last round's mask", role_colour(Role::kUnion, theme), Sign::kHollowSquare};
  }

  void draw_track(const UiFrame& frame, const ImageResponse& response, const Mark& track) const {
    const LegendEntry look = look_of(kind_of(track), frame.theme.name);
    const ImU32 colour = to_u32(look.colour);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 to = response.to_screen(to_raster(track.at));
    const ImVec2 from =
        response.to_screen(to_raster(track.at + length_ * (track.from.value_or(track.at) - track.at)));
    list.AddLine(from, to, to_u32(look.colour, 0.8F), 1.3F * frame.scale);
    draw_sign(frame, list, to, (look.sign == Sign::kCircle ? 2.2F : 3.2F) * frame.scale, look.sign, colour);
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session, const StageLog& log,
                                 const Layer& trace, const Frame& target) const {
    std::array<int, 3> counts{};
    for (const Mark& track : trace.marks) ++counts[static_cast<std::size_t>(kind_of(track))];
    Footer footer;
    for (const Kind kind : {kInlier, kOutlier, kRemoved}) {
      LegendEntry entry = look_of(kind, frame.theme.name);
      entry.name = fmt::format("{} {}", counts[static_cast<std::size_t>(kind)], entry.name);
      footer.legend.push_back(std::move(entry));
    }
    footer.caption =
        fmt::format("{}: {} tracks, drawn where they end, {:.0f} times their length.",
                    frame_text(session, target), trace.marks.size(), static_cast<double>(length_));
    const Stage* stage = log.stage_of_layer(trace.id, round_shown(log, round_));
    const std::string rms = direction_ == 0 ? "Forward: RMS refined" : "Backward: RMS refined";
    for (const StageFigure& figure : stage->figures)
      if (figure.name == rms) footer.caption += fmt::format(" Homography: {} RMS.", figure_text(figure));
    footer.caption += whose_stages(session, log);
    return footer;
  }

  int direction_ = 0, round_ = -1;
  float length_ = 2.0F;
  FrameTexture ground_, veil_{Sampling::kLinear};
};

}  // namespace

std::unique_ptr<Panel> make_flow_tracks_panel(Shared shared) {
  return std::make_unique<FlowTracksPanel>(std::move(shared));
}

}  // namespace stillpoint
