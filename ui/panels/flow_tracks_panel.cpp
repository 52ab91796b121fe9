#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

/// The corners followed between the two frames, and which of them the homography was taken from.
class FlowTracksPanel final : public FramePanel {
 public:
  explicit FlowTracksPanel(Shared shared) : FramePanel("flow_tracks", "Flow tracks", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (draw_missing_motion(frame, session)) return;
    const FrameView& view = *session.current;
    Controls controls(frame);
    controls.choice("direction", {"Forward", "Backward"}, direction_);
    controls.round(static_cast<int>(view.motion.rounds.size()), round_);
    controls.slider("##length", length_, 1.0F, 8.0F, "length x%.0f");
    const MotionRound& round = view.motion.rounds[static_cast<std::size_t>(round_shown(view, round_))];
    const DirectionTrace& trace = direction_ == 0 ? round.forward : round.backward;
    const Frame& target = direction_ == 0 ? view.frame : view.reference;

    const Footer footer = footer_of(frame, session, trace, target);
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
    for (const Track& track : trace.tracks) draw_track(frame, response, track);
    pop_clip();
    footer.draw(frame);
  }

 private:
  enum Kind { kInlier, kOutlier, kRemoved };

  [[nodiscard]] static Kind kind_of(const Track& track) {
    return track.removed ? kRemoved : track.inlier ? kInlier : kOutlier;
  }
  [[nodiscard]] static LegendEntry look_of(Kind kind, ThemeName theme) {
    if (kind == kInlier) return {"inlier", role_colour(Role::kInlier, theme), Sign::kCircle};
    if (kind == kOutlier) return {"outlier", role_colour(Role::kOutlier, theme), Sign::kCross};
    return {"left out: in the last round's mask", role_colour(Role::kUnion, theme), Sign::kHollowSquare};
  }

  void draw_track(const UiFrame& frame, const ImageResponse& response, const Track& track) const {
    const LegendEntry look = look_of(kind_of(track), frame.theme.name);
    const ImU32 colour = to_u32(look.colour);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 to = response.keypoint_to_screen(track.to);
    const ImVec2 from = response.keypoint_to_screen(track.to + length_ * (track.from - track.to));
    list.AddLine(from, to, to_u32(look.colour, 0.8F), 1.3F * frame.scale);
    draw_sign(frame, list, to, (look.sign == Sign::kCircle ? 2.2F : 3.2F) * frame.scale, look.sign, colour);
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session,
                                 const DirectionTrace& trace, const Frame& target) const {
    std::array<int, 3> counts{};
    for (const Track& track : trace.tracks) ++counts[static_cast<std::size_t>(kind_of(track))];
    Footer footer;
    for (const Kind kind : {kInlier, kOutlier, kRemoved}) {
      LegendEntry entry = look_of(kind, frame.theme.name);
      entry.name = fmt::format("{} {}", counts[static_cast<std::size_t>(kind)], entry.name);
      footer.legend.push_back(std::move(entry));
    }
    footer.caption =
        fmt::format("{}: {} tracks, drawn where they end, {:.0f} times their length.",
                    frame_text(session, target), trace.tracks.size(), static_cast<double>(length_));
    if (trace.homography.valid) {
      footer.caption += fmt::format(" Homography: {:.2f} px RMS after {} refining steps.",
                                    trace.homography.refined_error_px, trace.homography.refine_iterations);
    }
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
