#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/motion/paper/difference.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/plot/plot.hpp"
#include "ui/theme/colormap.hpp"

namespace stillpoint {
namespace {

/// Eq. (1) as an image, and the histogram that Otsu's threshold splits.
class DifferencePanel final : public FramePanel {
 public:
  explicit DifferencePanel(Shared shared) : FramePanel("difference", "Difference", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (draw_missing_motion(frame, session)) return;
    Controls controls(frame);
    controls.choice("direction", {"Forward", "Backward"}, direction_);
    controls.toggle("Outline what is above", outline_, "Outlines the pixels above the threshold");
    const MotionRound& round = session.current->motion.rounds.back();
    const DirectionTrace& trace = direction_ == 0 ? round.forward : round.backward;
    if (trace.difference.empty()) {
      draw_absent(frame, "This direction has no homography, so there is no difference.");
      return;
    }
    const FramePlace place{session, actions, direction_ == 0 ? FrameSpace::kTarget : FrameSpace::kReference};
    const ImVec2 room = ImGui::GetContentRegionAvail(), start = ImGui::GetCursorScreenPos();
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    if (room.x > 1.75F * room.y) {
      const float left = std::floor(0.56F * room.x);
      draw_picture(frame, place, trace, {left, room.y});
      ImGui::SetCursorScreenPos({start.x + left + gap, start.y});
      draw_histogram(frame, session, trace, {room.x - left - gap, room.y});
    } else {
      const float above = std::floor(0.62F * room.y);
      draw_picture(frame, place, trace, {room.x, above});
      ImGui::SetCursorScreenPos({start.x, start.y + above + gap});
      draw_histogram(frame, session, trace, {room.x, room.y - above - gap});
    }
  }

 private:
  void draw_picture(const UiFrame& frame, const FramePlace& place, const DirectionTrace& trace, ImVec2 size) {
    ColourScale scale;
    scale.unit = "grey levels";
    // Three times the threshold tells most apart; what is above is as bright as can be.
    scale.high = std::clamp(3.0 * trace.threshold, 30.0, 255.0);
    scale.colour = [&scale](double v) {
      return map_colour(Colormap::kInferno, static_cast<float>(v / scale.high));
    };
    const Texture& texture = texture_.get(frame, place.session.current, direction_, [&] {
      above_ = outlines_of(trace.raw_mask);
      collect_histogram(trace);
      return coloured(trace.difference, scale);
    });
    ImageContent content;
    content.texture = &texture;
    content.values = &trace.difference;
    const ImageResponse response =
        draw_scaled_image(frame, "difference", content, *shared_, size, place, scale);
    if (outline_) {
      push_clip(response);
      draw_outlines(frame, response, above_, okabe_ito::kSkyBlue);
      pop_clip();
    }
  }

  void collect_histogram(const DirectionTrace& trace) {
    const Histogram counts = histogram(trace.difference, trace.valid);
    histogram_ = {};
    for (std::size_t level = 0; level < counts.size(); ++level) {
      levels_[level] = static_cast<double>(level);
      // A logarithmic axis has no place for zero.
      histogram_[level] = counts[level] > 0 ? counts[level] : 0.5;
    }
    const auto used = std::find_if(counts.rbegin(), counts.rend(), [](int count) { return count > 0; });
    highest_ = std::max(16.0, static_cast<double>(counts.rend() - used));
    above_share_ = static_cast<double>(cv::countNonZero(trace.raw_mask)) /
                   std::max(1.0, static_cast<double>(cv::countNonZero(trace.valid)));
  }

  void draw_histogram(const UiFrame& frame, const SessionView& session, const DirectionTrace& trace,
                      ImVec2 size) {
    const ImVec2 start = ImGui::GetCursorScreenPos();
    Footer footer;
    footer.caption = fmt::format(
        "{}: {:.1f} % of the pixels with data are above Otsu's threshold.",
        frame_text(session, direction_ == 0 ? session.current->frame : session.current->reference),
        100.0 * above_share_);
    footer.caption += whose_motion(session);
    ImGui::BeginGroup();
    ImGui::PushItemWidth(size.x);
    const ThemeName theme = frame.theme.name;
    Plot plot{.x_label = "difference", .x_unit = "grey levels", .y_label = "pixels"};
    plot.series.push_back({"", levels_, histogram_, frame.theme.accent, SeriesStyle::kBars});
    plot.marks.push_back({trace.threshold + 1.0, fmt::format("threshold {:.0f}", trace.threshold),
                          role_colour(Role::kWarning, theme)});
    plot.bands.push_back({{trace.threshold + 1.0, highest_},
                          role_colour(direction_ == 0 ? Role::kForward : Role::kBackward, theme)});
    plot.x_limits = AxisRange{0.0, highest_};
    plot.legend = false;
    const float below = footer.height(frame) + ImGui::GetStyle().ItemSpacing.y;
    draw_plot(frame, "histogram", plot, plot_view_, {size.x, size.y - below});
    ImGui::SetCursorScreenPos({start.x, start.y + size.y - below + ImGui::GetStyle().ItemSpacing.y});
    footer.draw(frame);
    ImGui::PopItemWidth();
    ImGui::EndGroup();
  }

  int direction_ = 0;
  bool outline_ = false;
  FrameTexture texture_;
  Outlines above_;
  std::array<double, 256> levels_{}, histogram_{};
  double highest_ = 255.0, above_share_ = 0.0;
  PlotView plot_view_{.log_y = true};
};

}  // namespace

std::unique_ptr<Panel> make_difference_panel(Shared shared) {
  return std::make_unique<DifferencePanel>(std::move(shared));
}

}  // namespace stillpoint
