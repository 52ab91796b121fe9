#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/layer_values.hpp"
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

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<DifferencePanel>(shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const StageLog* log = stages_or_absent(frame, session, actions, name(), "difference");
    if (log == nullptr) return;
    Controls controls(frame);
    controls.choice("direction", {"Forward", "Backward"}, direction_);
    controls.toggle("Outline what is above", outline_, "Outlines the pixels above the threshold");
    const Layer* layer = log->layer(direction_ == 0 ? "difference" : "difference_backward");
    raw_ = log->layer(direction_ == 0 ? "raw_forward_mask" : "raw_backward_mask");
    whose_ = whose_stages(session, *log);
    if (layer == nullptr || layer->image.empty()) {
      draw_absent(frame, "This direction has no homography, so there is no difference.");
      return;
    }
    const Layer& trace = *layer;
    const FramePlace place{session, actions, layer->space};
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
  void draw_picture(const UiFrame& frame, const FramePlace& place, const Layer& trace, ImVec2 size) {
    ColourScale scale;
    scale.unit = trace.unit;
    scale.high = trace.range;
    scale.colour = [&scale](double v) {
      return map_colour(Colormap::kInferno, static_cast<float>(v / scale.high));
    };
    const Texture& texture = texture_.get(frame, place.session.current, direction_, [&] {
      above_ = outlines_of(raw_ != nullptr ? raw_->image : cv::Mat());
      collect_histogram(trace);
      return coloured(trace.image, scale);
    });
    ImageContent content;
    content.texture = &texture;
    content.values = &trace.image;
    const ImageResponse response =
        draw_scaled_image(frame, "difference", content, *shared_, size, place, scale);
    if (outline_) {
      push_clip(response);
      draw_outlines(frame, response, above_, okabe_ito::kSkyBlue);
      pop_clip();
    }
  }

  void collect_histogram(const Layer& trace) {
    const LevelHistogram counts = level_histogram(trace);
    for (std::size_t level = 0; level < counts.pixels.size(); ++level) {
      levels_[level] = static_cast<double>(level);
      // A logarithmic axis has no place for zero.
      histogram_[level] = std::max(0.5, counts.pixels[level]);
    }
    highest_ = std::max(16.0, counts.highest);
    above_share_ = counts.above_share;
  }

  void draw_histogram(const UiFrame& frame, const SessionView& session, const Layer& trace, ImVec2 size) {
    const ImVec2 start = ImGui::GetCursorScreenPos();
    Footer footer;
    footer.caption = fmt::format(
        "{}: {:.1f} % of the pixels with data are above Otsu's threshold.",
        frame_text(session, direction_ == 0 ? session.current->frame : session.current->reference),
        100.0 * above_share_);
    footer.caption += whose_;
    ImGui::BeginGroup();
    ImGui::PushItemWidth(size.x);
    const ThemeName theme = frame.theme.name;
    Plot plot{.x_label = "difference", .x_unit = "grey levels", .y_label = "pixels"};
    plot.series.push_back({"", levels_, histogram_, frame.theme.accent, SeriesStyle::kBars});
    plot.marks.push_back({*trace.limit + 1.0, fmt::format("threshold {:.0f}", *trace.limit),
                          role_colour(Role::kWarning, theme)});
    plot.bands.push_back({{*trace.limit + 1.0, highest_},
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
  const Layer* raw_ = nullptr;  // of what is being drawn
  std::string whose_;
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
