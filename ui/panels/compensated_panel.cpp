#include <fmt/format.h>

#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/layer_values.hpp"
#include "core/sequence/frame.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/shell/input.hpp"

namespace stillpoint {
namespace {

constexpr Key kFlipKey = Key::kT;
constexpr double kSignedRange = 80.0;  // grey levels at the ends of the signed scale

/// A frame carried into the other's camera, to be held against what the camera saw there.
class CompensatedPanel final : public FramePanel {
 public:
  explicit CompensatedPanel(Shared shared)
      : FramePanel("compensated", "Compensated frame", std::move(shared)) {}

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<CompensatedPanel>(shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const StageLog* log = stages_or_absent(frame, session, actions, name(), "compensated");
    if (log == nullptr) return;
    bool held = false;
    Controls controls(frame);
    controls.choice("direction", {"Forward", "Backward"}, direction_);
    controls.choice("look", {"Image", "Wipe", "Signed difference"}, look_);
    if (look_ == kWipe) controls.slider("##wipe", wipe_, 0.0F, 1.0F, "target %.2f");
    if (look_ == kImage)
      controls.button("Hold for target (T)", "Hold the button, or T over this panel", &held);
    held = held || (is_key_down(kFlipKey) && ImGui::IsWindowHovered());

    const Layer* layer = log->layer(direction_ == 0 ? "compensated" : "compensated_backward");
    if (layer == nullptr || layer->image.empty()) {
      draw_absent(frame, "This direction has no homography, so nothing was compensated.");
      return;
    }
    const Layer& trace = *layer;
    const FrameView& view = *session.current;
    const Frame& target = direction_ == 0 ? view.frame : view.reference;
    const FrameSpace seen = direction_ == 0 ? FrameSpace::kTarget : FrameSpace::kReference;
    const FrameSpace carried = layer->space;
    caption_ = caption(session, *log);
    if (look_ == kSigned)
      draw_signed(frame, {session, actions, seen}, trace, target);
    else
      draw_images(frame, {session, actions, look_ == kImage && !held ? carried : seen}, trace, target, held);
  }

 private:
  enum LookAt { kImage, kWipe, kSigned };

  void draw_images(const UiFrame& frame, const FramePlace& place, const Layer& trace, const Frame& target,
                   bool held) {
    const SessionView& session = place.session;
    const Texture& compensated =
        compensated_.get(frame, session.current, direction_, [&] { return trace.image; });
    const Texture& seen = target_.get(frame, session.current, direction_, [&] { return target.gray; });
    Footer footer;
    footer.caption = caption_;
    ImageContent content;
    content.texture = held && look_ == kImage ? &seen : &compensated;
    content.values = held && look_ == kImage ? &target.gray : &trace.image;
    if (look_ == kWipe) {
      content.texture = &seen;
      content.values = &target.gray;
      content.wipe = wipe_;
      content.wiped_to = &compensated;
    }
    const char* heading = look_ == kWipe ? "Left target, right compensated" : held ? "Target" : "Compensated";
    draw_frame_image(frame, "image", content, *shared_, room_above(frame, footer), place, heading);
    footer.draw(frame);
  }

  void draw_signed(const UiFrame& frame, const FramePlace& place, const Layer& trace, const Frame& target) {
    const SessionView& session = place.session;
    ColourScale scale;
    scale.low = -kSignedRange;
    scale.high = kSignedRange;
    scale.unit = "grey levels";
    scale.colour = [&frame](double value) { return diverging_colour(frame.theme, value / kSignedRange); };
    scale.none = "no data";
    scale.none_colour = no_value_colour(frame.theme);
    const Texture& texture = signed_.get(frame, session.current, direction_, [&] {
      difference_ = signed_difference(trace, target.gray);
      return coloured(difference_, scale);
    });
    Footer footer;
    footer.caption = "Target less compensated: above zero it became brighter. " + caption_;
    ImageContent content;
    content.texture = &texture;
    content.values = &difference_;
    draw_scaled_image(frame, "signed", content, *shared_, room_above(frame, footer), place, scale);
    footer.draw(frame);
  }

  [[nodiscard]] std::string caption(const SessionView& session, const StageLog& log) const {
    const FrameView& view = *session.current;
    const bool forward = direction_ == 0;
    const int from = forward ? view.reference.index : view.frame.index;
    const int to = forward ? view.frame.index : view.reference.index;
    std::string text = fmt::format("Frame {} warped into frame {}'s camera", from, to);
    const std::string begin = forward ? "Forward: " : "Backward: ";
    std::string figures;
    if (const Stage* stage = log.stage_of_layer(forward ? "flow_tracks" : "flow_tracks_backward"))
      for (const StageFigure& figure : stage->figures)
        if (figure.name.starts_with(begin))
          figures += fmt::format("{}{} {}", figures.empty() ? ": " : ", ", figure.name.substr(begin.size()),
                                 figure_text(figure));
    if (figures.empty()) figures = " by the homography fallen back on";
    return text + figures + "." + whose_stages(session, log);
  }

  int direction_ = 0, look_ = kImage;
  float wipe_ = 0.5F;
  FrameTexture compensated_, target_, signed_;
  cv::Mat difference_;
  std::string caption_;  // of what is being drawn
};

}  // namespace

std::unique_ptr<Panel> make_compensated_panel(Shared shared) {
  return std::make_unique<CompensatedPanel>(std::move(shared));
}

}  // namespace stillpoint
