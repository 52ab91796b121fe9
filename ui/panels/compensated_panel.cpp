#include <fmt/format.h>

#include <cmath>

#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

constexpr Key kFlipKey = Key::kT;
constexpr double kSignedRange = 80.0;  // grey levels at the ends of the signed scale

/// A frame carried into the other's camera, to be held against what the camera saw there.
class CompensatedPanel final : public FramePanel {
 public:
  explicit CompensatedPanel(Shared shared)
      : FramePanel("compensated", "Compensated frame", std::move(shared)) {}

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (draw_missing_motion(frame, session)) return;
    bool held = false;
    Controls controls(frame);
    controls.choice("direction", {"Forward", "Backward"}, direction_);
    controls.choice("look", {"Image", "Wipe", "Signed difference"}, look_);
    if (look_ == kWipe) controls.slider("##wipe", wipe_, 0.0F, 1.0F, "target %.2f");
    if (look_ == kImage)
      controls.button("Hold for target (T)", "Hold the button, or T over this panel", &held);
    held = held || (is_key_down(kFlipKey) && ImGui::IsWindowHovered());

    const FrameView& view = *session.current;
    const MotionRound& round = view.motion.rounds.back();
    const DirectionTrace& trace = direction_ == 0 ? round.forward : round.backward;
    if (trace.compensated.empty()) {
      draw_absent(frame, "This direction has no homography, so nothing was compensated.");
      return;
    }
    const Frame& target = direction_ == 0 ? view.frame : view.reference;
    const FrameSpace seen = direction_ == 0 ? FrameSpace::kTarget : FrameSpace::kReference;
    const FrameSpace carried =
        direction_ == 0 ? FrameSpace::kCompensatedForward : FrameSpace::kCompensatedBackward;
    if (look_ == kSigned)
      draw_signed(frame, {session, actions, seen}, trace, target);
    else
      draw_images(frame, {session, actions, look_ == kImage && !held ? carried : seen}, trace, target, held);
  }

 private:
  enum LookAt { kImage, kWipe, kSigned };

  void draw_images(const UiFrame& frame, const FramePlace& place, const DirectionTrace& trace,
                   const Frame& target, bool held) {
    const SessionView& session = place.session;
    const Texture& compensated =
        compensated_.get(frame, session.current, direction_, [&] { return trace.compensated; });
    const Texture& seen = target_.get(frame, session.current, direction_, [&] { return target.gray; });
    Footer footer;
    footer.caption = caption(session, trace);
    ImageContent content;
    content.texture = held && look_ == kImage ? &seen : &compensated;
    content.values = held && look_ == kImage ? &target.gray : &trace.compensated;
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

  void draw_signed(const UiFrame& frame, const FramePlace& place, const DirectionTrace& trace,
                   const Frame& target) {
    const SessionView& session = place.session;
    ColourScale scale;
    scale.low = -kSignedRange;
    scale.high = kSignedRange;
    scale.unit = "grey levels";
    scale.colour = [&frame](double value) { return diverging_colour(frame.theme, value / kSignedRange); };
    scale.none = "no data";
    scale.none_colour = no_value_colour(frame.theme);
    const Texture& texture = signed_.get(frame, session.current, direction_, [&] {
      cv::Mat seen, carried;
      target.gray.convertTo(seen, CV_32F);
      trace.compensated.convertTo(carried, CV_32F);
      difference_ = seen - carried;
      difference_.setTo(std::nanf(""), trace.valid == 0);
      return coloured(difference_, scale);
    });
    Footer footer;
    footer.caption = "Target less compensated: above zero it became brighter. " + caption(session, trace);
    ImageContent content;
    content.texture = &texture;
    content.values = &difference_;
    draw_scaled_image(frame, "signed", content, *shared_, room_above(frame, footer), place, scale);
    footer.draw(frame);
  }

  [[nodiscard]] std::string caption(const SessionView& session, const DirectionTrace& trace) const {
    const FrameView& view = *session.current;
    const int from = direction_ == 0 ? view.reference.index : view.frame.index;
    const int to = direction_ == 0 ? view.frame.index : view.reference.index;
    std::string text = fmt::format("Frame {} carried into frame {}'s camera", from, to);
    if (!trace.homography.valid) return text + " by the homography fallen back on.";
    return text + fmt::format(": {} inliers, {:.2f} px RMS after RANSAC, {:.2f} px refined.",
                              trace.homography.ransac_inliers, trace.homography.ransac_error_px,
                              trace.homography.refined_error_px);
  }

  int direction_ = 0, look_ = kImage;
  float wipe_ = 0.5F;
  FrameTexture compensated_, target_, signed_;
  cv::Mat difference_;
};

}  // namespace

std::unique_ptr<Panel> make_compensated_panel(Shared shared) {
  return std::make_unique<CompensatedPanel>(std::move(shared));
}

}  // namespace stillpoint
