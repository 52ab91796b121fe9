#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

constexpr int kStages = 4;
constexpr std::array<const char*, kStages> kNames{"Unexplained shifts", "Points", "Evidence", "Mask"};

/// Method `stillpoint`'s stages for a frame without depth: what the camera's motion leaves unexplained of the
/// followed points, the evidence each has gathered, and what becomes of it over the image.
class ColourMotionPanel final : public FramePanel {
 public:
  explicit ColourMotionPanel(Shared shared)
      : FramePanel("colour_motion", "Colour motion", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions&) override {
    const std::string missing = missing_stages(session);
    if (!missing.empty()) {
      draw_absent(frame, missing);
      return;
    }
    const EpipolarTrace& trace = session.current->colour_motion;
    Controls controls(frame);
    controls.choice("stage", {"All", "Shifts", "Points", "Evidence", "Mask"}, shown_);
    if (const int references = static_cast<int>(trace.references.size()); references > 1) {
      std::vector<std::string> names;
      for (const ColourReference& reference : trace.references)
        names.push_back(fmt::format("{} back", reference.gap));
      if (reference_ < 0) reference_ = references - 1;
      reference_ = std::min(reference_, references - 1);
      controls.choice("reference", names, reference_);
    }
    const Footer footer = footer_of(frame, session, trace);
    const ImVec2 start = ImGui::GetCursorScreenPos();
    const ImVec2 room = room_above(frame, footer);
    if (shown_ == 0) {
      const Tiling tiling = tile(frame, room, kStages, session.current->frame.gray.size());
      for (int i = 0; i < kStages; ++i) {
        ImGui::SetCursorScreenPos(tiling.corner(start, i));
        draw_stage(frame, session, static_cast<Stage>(i), tiling.size);
      }
    } else {
      draw_stage(frame, session, static_cast<Stage>(shown_ - 1), room);
    }
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
    footer.draw(frame);
  }

 private:
  enum Stage { kShifts, kPoints, kEvidence, kMask };

  [[nodiscard]] static std::string missing_stages(const SessionView& session) {
    const FrameView& view = *session.current;
    if (!view.frame.readable()) return missing_motion(session);
    if (!view.colour_motion.points.empty()) return {};
    if (view.frame.has_depth()) return "This frame has depth, and motion is judged by that.";
    if (session.config.run.method != "stillpoint")
      return fmt::format("Method {} does not judge motion by followed points; method stillpoint does.",
                         session.config.run.method);
    if (view.record == nullptr) return fmt::format("Frame {} has not been processed yet.", view.index);
    if (!view.colour_motion.note.empty())
      return fmt::format("There is nothing to show: {}", view.colour_motion.note);
    return fmt::format("No point could be found in frame {} to follow.", view.index);
  }

  void draw_stage(const UiFrame& frame, const SessionView& session, Stage stage, ImVec2 size) {
    const FrameView& view = *session.current;
    const auto slot = static_cast<std::size_t>(stage);
    ImageContent content;
    content.texture = &ground_[slot].get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.frame.gray;
    const Texture& over =
        over_[slot].get(frame, session.current, 0, [&] { return overlay(frame, view, stage); });
    content.overlays.push_back({&over, stage == kMask ? 0.45F : stage == kEvidence ? 0.85F : 0.45F});
    const ImageResponse response =
        draw_frame_image(frame, kNames[slot], content, *shared_, size, kNames[slot]);
    push_clip(response);
    if (stage == kShifts) draw_shifts(frame, response, view.colour_motion);
    if (stage == kPoints) draw_points(frame, session, response, view.colour_motion);
    if (stage == kMask) draw_outlines(frame, response, outlines_, mask_colour(frame));
    pop_clip();
  }

  [[nodiscard]] static Rgb mask_colour(const UiFrame& frame) {
    return role_colour(Role::kUnion, frame.theme.name);
  }

  /// What is laid over the picture: a veil that lets points stand out, the evidence, or the mask.
  cv::Mat overlay(const UiFrame& frame, const FrameView& view, Stage stage) {
    if (stage == kMask) {
      outlines_ = outlines_of(view.colour_motion.mask);
      return view.colour_motion.mask.empty() ? cv::Mat(2, 2, CV_8UC4, cv::Scalar::all(0))
                                             : tinted_mask(view.colour_motion.mask, mask_colour(frame));
    }
    if (stage == kEvidence && !view.colour_motion.evidence.empty()) {
      ColourScale scale;
      scale.low = -1.0;
      scale.high = 1.0;
      scale.colour = [&theme = frame.theme](double value) { return diverging_colour(theme, value); };
      return coloured(view.colour_motion.evidence, scale);
    }
    const Rgb shade = frame.theme.background;
    return cv::Mat(2, 2, CV_8UC4, cv::Scalar(shade.b, shade.g, shade.r, 255));
  }

  [[nodiscard]] const ColourReference* reference_of(const EpipolarTrace& trace) const {
    if (trace.references.empty()) return nullptr;
    const auto last = trace.references.size() - 1;
    return &trace.references[reference_ < 0 ? last : std::min(last, static_cast<std::size_t>(reference_))];
  }

  /// Each point's way that no still room explains, several times its length.
  void draw_shifts(const UiFrame& frame, const ImageResponse& response, const EpipolarTrace& trace) const {
    constexpr float kLength = 8.0F;  // times; residuals are of the half-size image
    const ColourReference* reference = reference_of(trace);
    if (reference == nullptr) return;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (std::size_t k = 0; k < reference->points.size(); ++k) {
      const cv::Point2f at = trace.points[static_cast<std::size_t>(reference->points[k])].at;
      const Rgb colour =
          role_colour(reference->sigmas[k] > 3.0F ? Role::kOutlier : Role::kInlier, frame.theme.name);
      list.AddLine(response.keypoint_to_screen(at),
                   response.keypoint_to_screen(at - 2.0F * kLength * reference->residuals[k]),
                   to_u32(colour, 0.9F), 1.3F * frame.scale);
      list.AddCircleFilled(response.keypoint_to_screen(at), 1.6F * frame.scale, to_u32(colour));
    }
  }

  static void draw_points(const UiFrame& frame, const SessionView& session, const ImageResponse& response,
                          const EpipolarTrace& trace) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto limit = static_cast<float>(session.config.colour_motion.moving_evidence);
    for (const ColourPoint& point : trace.points) {
      if (point.age < session.config.colour_motion.min_age) continue;
      const bool moves = point.shared > limit;
      const Rgb colour = role_colour(moves ? Role::kUnion : Role::kInlier, frame.theme.name);
      draw_sign(frame, list, response.keypoint_to_screen(point.at), (moves ? 3.2F : 2.0F) * frame.scale,
                moves ? Sign::kHollowSquare : Sign::kCircle, to_u32(colour));
    }
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session,
                                 const EpipolarTrace& trace) const {
    Footer footer;
    footer.legend.push_back({"moves", mask_colour(frame), Sign::kHollowSquare});
    footer.legend.push_back({"stands still", role_colour(Role::kInlier, frame.theme.name), Sign::kCircle});
    footer.legend.push_back({"unexplained", role_colour(Role::kOutlier, frame.theme.name), Sign::kLine});
    footer.caption = fmt::format("{}: {} points, {:.1f} % of the pixels move.",
                                 frame_text(session, session.current->frame), trace.points.size(),
                                 100.0 * trace.mask_share);
    if (const ColourReference* reference = reference_of(trace))
      footer.caption += fmt::format(" Against {} frames back the camera {}; noise {:.2f} px.", reference->gap,
                                    reference->motion.turns_only ? "only turned" : "went elsewhere too",
                                    2.0 * reference->sigma);
    if (!trace.note.empty()) footer.caption += " " + trace.note;
    return footer;
  }

  int shown_ = 0, reference_ = -1;
  std::array<FrameTexture, kStages> ground_;
  std::array<FrameTexture, kStages> over_{FrameTexture{Sampling::kLinear}, FrameTexture{Sampling::kLinear},
                                          FrameTexture{Sampling::kLinear}, FrameTexture{}};
  Outlines outlines_;
};

}  // namespace

std::unique_ptr<Panel> make_colour_motion_panel(Shared shared) {
  return std::make_unique<ColourMotionPanel>(std::move(shared));
}

}  // namespace stillpoint
