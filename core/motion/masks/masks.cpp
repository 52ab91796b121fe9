// Masks made elsewhere, and nothing of our own: what somebody's network says is dynamic.
#include "core/config.hpp"
#include "core/motion/masks/outside_masks.hpp"
#include "core/motion/methods.hpp"

namespace stillpoint {
namespace {

class GivenMasks final : public MotionMethod {
 public:
  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<GivenMasks>(*this);
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    if (input.outside)
      result.mask = input.outside->mask;
    else
      result.note = "no masks are given: masks.sources names none";
    return result;
  }

  [[nodiscard]] StageLog describe(const Frame&, const MotionResult& result) const override {
    StageLog log;
    log.note = result.note;
    return log;
  }
};

}  // namespace

MethodInfo masks_method() {
  MethodInfo info;
  info.name = "masks";
  info.title = "Masks made elsewhere";
  info.summary = "Removes what masks of somebody else's making hold: a folder or a list of images.";
  info.needs.outside_masks = true;
  info.extends_odometry = true;
  info.parameters = AnySection(MasksConfig());
  info.make = [](const Camera&, const Config&) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<GivenMasks>();
  };
  return info;
}

}  // namespace stillpoint
