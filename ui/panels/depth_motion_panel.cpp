#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

constexpr int kStages = 7;
constexpr std::array<const char*, kStages> kNames{
    "Depth residual", "Brightness residual", "Patch shifts", "Memory", "All evidence", "Segments", "Mask"};

/// Method `stillpoint`'s stages: what depth and brightness say against an earlier frame, what is remembered,
/// and what becomes of it on surfaces.
class DepthMotionPanel final : public FramePanel {
 public:
  explicit DepthMotionPanel(Shared shared)
      : FramePanel("depth_motion", "Depth motion", shared), colour_(make_colour_motion_panel(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    // What is judged in colour instead stands where one looks for it.
    if (!session.current->colour_motion.points.empty()) {
      colour_->draw(frame, session, actions);
      return;
    }
    const std::string missing = missing_stages(session);
    if (!missing.empty()) {
      draw_absent(frame, missing);
      return;
    }
    const StillpointTrace& trace = session.current->depth_motion;
    Controls controls(frame);
    controls.choice(
        "stage", {"All", "Depth", "Brightness", "Shifts", "Memory", "Log-odds", "Segments", "Mask"}, shown_);
    const int references = static_cast<int>(trace.references.size());
    reference_ = std::clamp(reference_, 0, references - 1);
    if (references > 1) {
      controls.choice("reference", {"Near reference", "Far reference"}, reference_);
    }

    const Footer footer = footer_of(frame, session, trace);
    const ImVec2 start = ImGui::GetCursorScreenPos();
    ImVec2 room = room_above(frame, footer);
    const float bar = colour_scale_width(frame) + ImGui::GetStyle().ItemSpacing.x;
    const bool all = shown_ == 0;
    const bool has_scale = all || shown_ - 1 != kMask;
    if (has_scale) room.x -= bar;
    if (all) {
      const Tiling tiling = tile(frame, room, kStages, session.current->frame.gray.size());
      for (int i = 0; i < kStages; ++i) {
        ImGui::SetCursorScreenPos(tiling.corner(start, i));
        draw_stage(frame, {session, actions, FrameSpace::kSmall}, static_cast<Stage>(i), tiling.size);
      }
    } else {
      draw_stage(frame, {session, actions, FrameSpace::kSmall}, static_cast<Stage>(shown_ - 1), room);
    }
    if (has_scale) {
      ImGui::SetCursorScreenPos({start.x + room.x + ImGui::GetStyle().ItemSpacing.x, start.y});
      draw_colour_scale(frame, bar_scale(frame, session, all), room.y);
    }
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
    footer.draw(frame);
  }

 private:
  enum Stage { kDepth, kBrightness, kShifts, kMemory, kLogOdds, kSegments, kMask };

  [[nodiscard]] static std::string missing_stages(const SessionView& session) {
    const FrameView& view = *session.current;
    if (!view.frame.readable()) return missing_motion(session);
    if (view.frame.depth.empty()) return "This frame has no depth, from which these stages judge what moves.";
    if (!view.depth_motion.references.empty()) return {};
    if (session.config.run.method != "stillpoint")
      return fmt::format("Method {} does not judge motion by depth; method stillpoint does.",
                         session.config.run.method);
    if (view.record == nullptr) return fmt::format("Frame {} has not been processed yet.", view.index);
    if (!view.depth_motion.note.empty())
      return fmt::format("There is nothing to compare with: {}", view.depth_motion.note);
    return fmt::format("Frame {} has no earlier frame with depth and a pose to be compared with.",
                       view.index);
  }

  /// What the ends of a stage's scale stand for.
  [[nodiscard]] static double range_of_stage(const SessionView& session, Stage stage) {
    const StillpointConfig& config = session.config.depth_motion;
    if (stage == kDepth) return 2.0 * config.depth_sigmas;
    if (stage == kBrightness) return 60.0;
    return config.max_log_odds;
  }

  [[nodiscard]] static std::string unit_of(Stage stage) {
    return stage == kDepth ? "σ" : stage == kBrightness ? "grey levels" : "log-odds";
  }

  [[nodiscard]] ColourScale scale_of(const UiFrame& frame, const SessionView& session, Stage stage) const {
    ColourScale scale;
    scale.high = range_of_stage(session, stage);
    scale.low = -scale.high;
    scale.unit = unit_of(stage);
    const double end = scale.high;
    scale.colour = [&theme = frame.theme, end](double value) { return diverging_colour(theme, value / end); };
    scale.none = "none";
    scale.none_colour = no_value_colour(frame.theme);
    return scale;
  }

  /// The bar beside: one stage's own, or one that stands for all, whose ranges their headings name.
  [[nodiscard]] ColourScale bar_scale(const UiFrame& frame, const SessionView& session, bool all) const {
    if (!all) return scale_of(frame, session, static_cast<Stage>(shown_ - 1));
    ColourScale scale = scale_of(frame, session, kLogOdds);
    scale.low = -1.0;
    scale.high = 1.0;
    scale.unit = "of range";
    scale.colour = [&theme = frame.theme](double value) { return diverging_colour(theme, value); };
    return scale;
  }

  [[nodiscard]] const cv::Mat& values_of(const StillpointTrace& trace, Stage stage) const {
    const ReferenceEvidence& reference = trace.references[static_cast<std::size_t>(reference_)];
    switch (stage) {
      case kDepth:
        return reference.depth_residual;
      case kBrightness:
        return reference.intensity_residual;
      case kShifts:
        return trace.slow;
      case kMemory:
        return trace.prior;
      case kLogOdds:
        return trace.log_odds;
      case kSegments:
        return segment_values_;
      case kMask:
        return trace.mask;
    }
    return trace.mask;
  }

  [[nodiscard]] std::string heading_of(const SessionView& session, Stage stage) const {
    const std::string name = kNames[static_cast<std::size_t>(stage)];
    if (shown_ != 0 || stage == kMask) return name;
    return fmt::format("{}, ±{:g} {}", name, range_of_stage(session, stage), unit_of(stage));
  }

  void draw_stage(const UiFrame& frame, const FramePlace& place, Stage stage, ImVec2 size) {
    const SessionView& session = place.session;
    const FrameView& view = *session.current;
    const StillpointTrace& trace = view.depth_motion;
    const auto slot = static_cast<std::size_t>(stage);
    ImageContent content;
    if (stage == kMask) {
      draw_mask(frame, {session, place.actions, FrameSpace::kTarget}, size);
      return;
    }
    if (stage == kSegments)
      segments_.get(frame, session.current, 0, [&] { return make_segments(frame, session); });
    const cv::Mat& values = values_of(trace, stage);
    content.texture = stage == kSegments ? &segments_.get(frame, session.current, 0, [] { return cv::Mat(); })
                                         : &textures_[slot].get(frame, session.current, reference_, [&] {
                                             return coloured(values, scale_of(frame, session, stage));
                                           });
    content.values = &values;
    content.absent = stage == kMemory ? "Nothing is remembered yet." : "Nothing to show.";
    const ImageResponse response =
        draw_frame_image(frame, heading_of(session, stage).c_str(), content, *shared_, size, place);
    draw_heading(frame, response, heading_of(session, stage));
  }

  void draw_mask(const UiFrame& frame, const FramePlace& place, ImVec2 size) {
    const SessionView& session = place.session;
    const FrameView& view = *session.current;
    const Rgb colour = role_colour(Role::kUnion, frame.theme.name);
    ImageContent content;
    content.texture = &ground_.get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.frame.gray;
    const Texture& tint = textures_[kMask].get(frame, session.current, 0, [&] {
      outlines_ = outlines_of(view.depth_motion.mask);
      return tinted_mask(view.depth_motion.mask, colour);
    });
    content.overlays.push_back({&tint, 0.45F});
    const ImageResponse response = draw_frame_image(frame, "mask", content, *shared_, size, place);
    push_clip(response);
    draw_outlines(frame, response, outlines_, colour);
    pop_clip();
    draw_heading(frame, response, heading_of(session, kMask));
  }

  /// Each patch in the colour of its log-odds, patches parted by lines.
  cv::Mat make_segments(const UiFrame& frame, const SessionView& session) {
    const StillpointTrace& trace = session.current->depth_motion;
    segment_values_ = cv::Mat(trace.labels.size(), CV_32FC1, cv::Scalar(std::nanf("")));
    for (int y = 0; y < trace.labels.rows; ++y) {
      for (int x = 0; x < trace.labels.cols; ++x) {
        const int segment = trace.labels.at<int>(y, x);
        if (segment >= 0)
          segment_values_.at<float>(y, x) = trace.segments[static_cast<std::size_t>(segment)].log_odds;
      }
    }
    cv::Mat picture = coloured(segment_values_, scale_of(frame, session, kSegments));
    const Rgb line = frame.theme.text_dim;
    for (int y = 0; y + 1 < picture.rows; ++y) {
      for (int x = 0; x + 1 < picture.cols; ++x) {
        const int here = trace.labels.at<int>(y, x);
        if (here == trace.labels.at<int>(y, x + 1) && here == trace.labels.at<int>(y + 1, x)) continue;
        auto& pixel = picture.at<cv::Vec3b>(y, x);
        const Rgb mixed = mix({pixel[2], pixel[1], pixel[0]}, line, 0.45F);
        pixel = {mixed.b, mixed.g, mixed.r};
      }
    }
    return picture;
  }

  [[nodiscard]] Footer footer_of(const UiFrame& frame, const SessionView& session,
                                 const StillpointTrace& trace) const {
    Footer footer;
    footer.legend.push_back({"speaks for moving", diverging_colour(frame.theme, 1.0), Sign::kSquare});
    footer.legend.push_back(
        {"speaks for still; in depth: hidden then", diverging_colour(frame.theme, -1.0), Sign::kSquare});
    const auto moving = std::count_if(trace.segments.begin(), trace.segments.end(),
                                      [](const Segment& segment) { return segment.moving; });
    const ReferenceEvidence& reference = trace.references[static_cast<std::size_t>(reference_)];
    footer.caption = fmt::format(
        "{}, against {} frames back: brightness noise {:.1f} grey levels; {} of {} patches move, "
        "{:.1f} % of the pixels.",
        frame_text(session, session.current->frame), reference.reference.frames_back,
        reference.intensity_sigma, moving, trace.segments.size(), 100.0 * trace.mask_share);
    if (!trace.note.empty()) footer.caption += " " + trace.note;
    return footer;
  }

  std::unique_ptr<Panel> colour_;  // of frames without depth
  int shown_ = 0, reference_ = 0;
  std::array<FrameTexture, kStages> textures_;
  FrameTexture segments_, ground_;
  cv::Mat segment_values_;
  Outlines outlines_;
};

}  // namespace

std::unique_ptr<Panel> make_depth_motion_panel(Shared shared) {
  return std::make_unique<DepthMotionPanel>(std::move(shared));
}

}  // namespace stillpoint
