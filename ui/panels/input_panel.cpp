#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/layer_values.hpp"
#include "core/sequence/frame.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/plot/plot.hpp"
#include "ui/theme/colormap.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

/// What the method is given: the frame, the one it is compared with, and depth.
class InputPanel final : public FramePanel {
 public:
  explicit InputPanel(Shared shared) : FramePanel("input", "Input", std::move(shared)) {}

  /// The frame and its depth are every run's; what it is compared with is for the run's method to choose.
  [[nodiscard]] bool shows_a_run() const override { return what_ == kReference; }
  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    auto other = std::make_unique<InputPanel>(shared_);
    other->what_ = kReference;
    return other;
  }

  [[nodiscard]] PanelSize least() const override { return {300.0F, 190.0F}; }

  [[nodiscard]] bool shows_image_alone() const override { return true; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const FrameView& view = *session.current;
    Controls controls(frame);
    const int gap = std::max(1, view.index - view.reference.index);
    controls.choice("what", {"Frame t", fmt::format("Frame t−{}", gap), "Depth"}, what_);
    if (what_ == kDepth) {
      controls.choice("map", {"Viridis", "Cividis", "Inferno"}, map_, "The colours of near and far");
      controls.slider("##near", near_m_, 0.0F, 9.5F, "from %.1f m");
      controls.slider("##far", to_m_, 0.0F, 20.0F, to_m_ > 0.0F ? "to %.1f m" : "to what there is");
      draw_depth(frame, {session, actions, FrameSpace::kTarget}, view);
      return;
    }
    controls.choice("channel", {"Colour", "Grey", "R", "G", "B"}, channel_, "Which channel is shown");
    controls.slider("##exposure", stops_, -4.0F, 4.0F, "%+.1f stops");
    controls.toggle("Histogram", histogram_, "How often each level occurs, before exposure");
    const bool target = what_ == kFrame;
    draw_picture(frame, {session, actions, target ? FrameSpace::kTarget : FrameSpace::kReference},
                 target ? view.frame : view.reference);
  }

 private:
  enum What { kFrame, kReference, kDepth };

  void draw_picture(const UiFrame& frame, const FramePlace& place, const Frame& shown) {
    const SessionView& session = place.session;
    if (!shown.readable()) {
      draw_absent(frame, missing(session, shown));
      return;
    }
    Footer footer;
    footer.caption = fmt::format("{}, {}x{} px, {}.{}{}", frame_text(session, shown), shown.gray.cols,
                                 shown.gray.rows, shown.colour.empty() ? "grey" : "colour",
                                 shown.problem.empty() ? "" : " ", shown.problem);
    footer.caption += what_ == kReference ? "" : same_in_all_runs(frame);
    ImageContent content;
    const cv::Mat& picture = picture_of(shown);
    const int variant = what_ + 2 * channel_ + 100 * static_cast<int>(std::lround(10.0F * stops_));
    content.texture = &picture_.get(frame, session.current, variant, [&] {
      return developed(picture, static_cast<Channel>(channel_), static_cast<double>(stops_));
    });
    content.values = &picture;
    ImVec2 room = room_above(frame, footer);
    const bool has_histogram = histogram_ && room.y > 2.5F * kHistogram * frame.scale;
    if (has_histogram) room.y -= kHistogram * frame.scale + ImGui::GetStyle().ItemSpacing.y;
    const ImageResponse response = draw_frame_image(frame, "image", content, *shared_, room, place);
    // Runs side by side may compare the frame with different ones.
    if (what_ == kReference && frame.strips != nullptr && frame.strips->several()) {
      const float gap = 5.0F * frame.scale;
      push_clip(response);
      draw_label(frame, {response.clip_min.x + gap, response.clip_min.y + gap}, frame_text(session, shown),
                 frame.theme.text);
      pop_clip();
    }
    if (has_histogram) draw_histogram(frame, session, picture);
    footer.draw(frame);
  }

  void draw_histogram(const UiFrame& frame, const SessionView& session, const cv::Mat& picture) {
    if (const auto of = std::pair(session.current.get(), what_ + 2 * channel_); counted_ != of) {
      counted_ = of;
      const LevelHistogram counts = level_histogram(developed(picture, static_cast<Channel>(channel_), 0.0));
      levels_.clear(), counts_.assign(counts.pixels.begin(), counts.pixels.end());
      for (int level = 0; level < 256; ++level) levels_.push_back(level);
    }
    Plot plot{.x_label = "level", .y_label = "pixels"};
    plot.series.push_back({"pixels", levels_, counts_, frame.theme.accent, SeriesStyle::kBars});
    plot.x_limits = AxisRange{0.0, 256.0};
    plot.legend = false;
    // What is beyond this is white as it is shown.
    if (stops_ > 0.0F)
      plot.marks.push_back(
          {256.0 * std::exp2(-static_cast<double>(stops_)), "white from here", frame.theme.text_dim});
    draw_plot(frame, "histogram", plot, plot_view_, {0, kHistogram * frame.scale});
  }

  void draw_depth(const UiFrame& frame, const FramePlace& place, const FrameView& view) {
    const SessionView& session = place.session;
    const cv::Mat& depth = view.frame.depth;
    if (depth.empty()) {
      draw_absent(frame, !view.frame.readable() ? missing(session, view.frame)
                         : view.frame.problem.empty()
                             ? "This frame has no depth image."
                             : fmt::format("This frame has no depth image: {}", view.frame.problem));
      return;
    }
    ColourScale scale;
    scale.unit = "m";
    scale.none = "not measured";
    scale.none_colour = no_value_colour(frame.theme);
    scale.colour = [this](double z) { return colour_of(z); };
    const int variant = map_ + 3 * static_cast<int>(std::lround(10.0F * near_m_)) +
                        3000 * static_cast<int>(std::lround(10.0F * to_m_));
    const auto set_range = [&] {
      shown_low_ =
          std::min(static_cast<double>(near_m_), (to_m_ > 0.0F ? static_cast<double>(to_m_) : far_m_) - 0.1);
      shown_high_ = to_m_ > 0.0F ? std::max(static_cast<double>(to_m_), shown_low_ + 0.1) : far_m_;
      scale.low = shown_low_, scale.high = shown_high_;
    };
    const Texture& texture = depth_.get(frame, session.current, variant, [&] {
      find_depth_range(depth);
      set_range();
      return coloured(depth, scale, true);
    });
    set_range();
    Footer footer;
    footer.caption = fmt::format(
        "{}. Depth on {:.0f} % of the pixels, median {:.2f} m; taken {:+.0f} ms from the colour image.",
        frame_text(session, view.frame), 100.0 * covered_, median_m_,
        1000.0 * (view.frame.depth_timestamp - view.frame.timestamp));
    footer.caption += same_in_all_runs(frame);
    ImageContent content;
    content.texture = &texture;
    content.values = &depth;
    draw_scaled_image(frame, "depth", content, *shared_, room_above(frame, footer), place, scale);
    footer.draw(frame);
  }

  [[nodiscard]] Rgb colour_of(double z) const {
    // Near is bright: what is near matters most.
    return map_colour(static_cast<Colormap>(map_),
                      static_cast<float>(1.0 - (z - shown_low_) / (shown_high_ - shown_low_)));
  }

  /// The far end of the scale in half metres, so that it stays while playing; and figures for the caption.
  void find_depth_range(const cv::Mat& depth) {
    std::vector<float> measured;
    for (int y = 0; y < depth.rows; y += 2) {
      for (int x = 0; x < depth.cols; x += 2) {
        const float z = depth.at<float>(y, x);
        if (z > 0.0F) measured.push_back(z);
      }
    }
    covered_ = static_cast<double>(cv::countNonZero(depth)) / static_cast<double>(depth.total());
    far_m_ = 1.0;
    median_m_ = 0.0;
    if (measured.empty()) return;
    const auto at = [&measured](double share) {
      const auto place =
          measured.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(measured.size() - 1));
      std::nth_element(measured.begin(), place, measured.end());
      return static_cast<double>(*place);
    };
    far_m_ = std::max(1.0, 0.5 * std::ceil(2.0 * at(0.98)));
    median_m_ = at(0.5);
  }

  [[nodiscard]] static std::string missing(const SessionView& session, const Frame& shown) {
    if (&shown == &session.current->frame || !session.current->frame.readable())
      return missing_motion(session);
    if (session.current->index == 0) return "The first frame has none before it.";
    return fmt::format("Frame {} could not be read.", session.current->reference.index);
  }

  static constexpr float kHistogram = 90.0F;  // design px, high

  int what_ = kFrame, channel_ = 0, map_ = 0;
  float stops_ = 0.0F, near_m_ = 0.0F, to_m_ = 0.0F;  // exposure; the scale of depth, 0 = as it is found
  bool histogram_ = false;
  std::pair<const FrameView*, int> counted_{nullptr, -1};  // what the histogram is of
  std::vector<double> levels_, counts_;
  PlotView plot_view_;
  double shown_low_ = 0.0, shown_high_ = 1.0;  // m, of depth's scale
  FrameTexture picture_, depth_;
  double far_m_ = 1.0, median_m_ = 0.0, covered_ = 0.0;
};

}  // namespace

std::unique_ptr<Panel> make_input_panel(Shared shared) {
  return std::make_unique<InputPanel>(std::move(shared));
}

}  // namespace stillpoint
