// The baseline: the odometry as it is, with nothing removed.
#include "core/motion/methods.hpp"

namespace stillpoint {
namespace {

class NoRemoval final : public MotionMethod {
 public:
  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<NoRemoval>(*this);
  }
  [[nodiscard]] MotionResult detect(const MotionInput&) const override { return {}; }
  [[nodiscard]] StageLog describe(const Frame&, const MotionResult&) const override {
    StageLog log;
    log.note = "nothing is classified as dynamic: the baseline removes nothing";
    return log;
  }
};

}  // namespace

MethodInfo none_method() {
  MethodInfo info;
  info.name = "none";
  info.title = "No removal";
  info.summary = "The baseline: the same odometry with nothing removed.";
  info.baseline = true;
  info.panels = {"mask"};
  info.make = [](const Camera&, const Config&) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<NoRemoval>();
  };
  return info;
}

}  // namespace stillpoint
