// A motion method of one's own on the installed library: run, measured, and drawn into a picture.
#include <fmt/format.h>

#include "core/media/image_codec.hpp"
#include "core/motion/methods.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

using namespace stillpoint;

/// What differs from the frame before by more than 40 grey levels.
struct Difference final : MotionMethod {
  cv::Mat last;
  std::unique_ptr<MotionMethod> clone() const override { return std::make_unique<Difference>(*this); }
  MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    if (last.empty()) return result;
    cv::absdiff(input.frame.gray, last, result.mask);
    result.mask = result.mask > 40;
    result.mask_share = percent_set(result.mask) / 100.0;
    return result;
  }
  void commit(const MotionInput& now, const MotionResult&, const MotionOutcome&) override {
    last = now.frame.gray;
  }
  StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    const Layer seen = photo_layer("Frame", frame.gray);
    log.add("own", "Mine", "Grey difference", "What differs from the frame before.")
        .add_side({seen}, mask_layer("Mask", result.mask, seen, "mask"));
    return log;
  }
};

std::unique_ptr<MotionMethod> make(const Camera&, const Config&) { return std::make_unique<Difference>(); }

int main(int, char** arguments) {
  register_method({.name = "difference", .needs = {.keeps_state = true}, .make = make});
  Config config = load_config("fast");
  config.run.method = "difference";
  Session session(open_sequence("generated:walking_static", {.frames = 34}), config, {.baseline = false});
  session.go_to(33);
  const auto view = session.view();
  MaskScore mask;
  for (const FrameScores& frame : view->run->scores) mask += frame.mask;
  fmt::print("RPE 1 s {:.4f} m, IoU {:.3f}, stage '{}'\n", view->run->evaluation.rpe_time.translation_m.rmse,
             mask.iou().value(), view->current->motion->stages.at(0).name);
  Offscreen offscreen;
  const auto panels = make_panels();
  const auto stages = std::ranges::find(panels, "stages", &Panel::name);
  const auto draw = [&](UiFrame& frame) { Workbench::draw_alone(frame, *view, **stages); };
  return save_image(arguments[1], offscreen.render(draw)) ? 0 : 1;
}
