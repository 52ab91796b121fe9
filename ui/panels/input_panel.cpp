#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/theme/colormap.hpp"

namespace stillpoint {
namespace {

/// What the method is given: the frame, the one it is compared with, and depth.
class InputPanel final : public FramePanel {
 public:
  explicit InputPanel(Shared shared) : FramePanel("input", "Input", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const FrameView& view = *session.current;
    Controls controls(frame);
    const int gap = std::max(1, view.index - view.reference.index);
    controls.choice("what", {"Frame t", fmt::format("Frame t−{}", gap), "Depth"}, what_);
    if (what_ == kDepth) {
      draw_depth(frame, {session, actions, FrameSpace::kTarget}, view);
      return;
    }
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
    ImageContent content;
    const cv::Mat& picture = picture_of(shown);
    content.texture = &picture_.get(frame, session.current, what_, [&] { return picture; });
    content.values = &picture;
    draw_frame_image(frame, "image", content, *shared_, room_above(frame, footer), place);
    footer.draw(frame);
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
    const Texture& texture = depth_.get(frame, session.current, 0, [&] {
      find_depth_range(depth);
      scale.high = far_m_;
      return coloured(depth, scale, true);
    });
    scale.high = far_m_;
    Footer footer;
    footer.caption = fmt::format(
        "{}. Depth on {:.0f} % of the pixels, median {:.2f} m; taken {:+.0f} ms from the colour image.",
        frame_text(session, view.frame), 100.0 * covered_, median_m_,
        1000.0 * (view.frame.depth_timestamp - view.frame.timestamp));
    ImageContent content;
    content.texture = &texture;
    content.values = &depth;
    draw_scaled_image(frame, "depth", content, *shared_, room_above(frame, footer), place, scale);
    footer.draw(frame);
  }

  [[nodiscard]] Rgb colour_of(double z) const {
    // Near is bright: what is near matters most.
    return map_colour(Colormap::kViridis, static_cast<float>(1.0 - z / far_m_));
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

  int what_ = kFrame;
  FrameTexture picture_, depth_;
  double far_m_ = 1.0, median_m_ = 0.0, covered_ = 0.0;
};

}  // namespace

std::unique_ptr<Panel> make_input_panel(Shared shared) {
  return std::make_unique<InputPanel>(std::move(shared));
}

}  // namespace stillpoint
