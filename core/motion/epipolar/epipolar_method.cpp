// Method `epipolar`: what is dynamic, from colour alone. Points are followed; what lies off the epipolar
// lines of the camera's own motion, or behind infinity, is dynamic.
#include "core/motion/epipolar/epipolar_stages.hpp"
#include "core/motion/methods.hpp"

namespace stillpoint {
namespace {

class EpipolarMethod final : public MotionMethod {
 public:
  EpipolarMethod(const Camera& camera, const EpipolarConfig& config)
      : config_(config), detector_(std::make_shared<const ColourMotionDetector>(camera, config)) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<EpipolarMethod>(*this);
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const Frame& frame = input.frame;
    auto after = std::make_shared<ColourMotionDetector>(*detector_);
    auto trace = std::make_shared<EpipolarMotionTrace>();
    trace->judged = after->next(frame.colour.empty() ? frame.gray : frame.colour, frame.timestamp);
    trace->after = std::move(after);
    MotionResult result;
    result.mask = trace->judged.mask;
    result.mask_share = trace->judged.mask_share;
    result.note = trace->judged.note;
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput&, const MotionResult& result, const MotionOutcome&) override {
    if (result.trace) detector_ = static_cast<const EpipolarMotionTrace&>(*result.trace).after;
  }

  [[nodiscard]] int frames_back() const override { return config_.far_reference; }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<EpipolarConfig>() == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    if (result.trace)
      return describe_epipolar(frame, static_cast<const EpipolarMotionTrace&>(*result.trace).judged, config_);
    StageLog log;
    log.note = result.note;
    return log;
  }

 private:
  EpipolarConfig config_;
  std::shared_ptr<const ColourMotionDetector> detector_;
};

}  // namespace

MethodInfo epipolar_method() {
  MethodInfo info;
  info.name = "epipolar";
  info.title = "Epipolar, colour alone";
  info.summary =
      "Points followed over several frames: dynamic is what the camera's own motion does not explain.";
  info.needs.keeps_state = true;
  info.parameters = AnySection(EpipolarConfig());
  info.old_section = "colour_motion";
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<EpipolarMethod>(camera, config.of<EpipolarConfig>());
  };
  return info;
}

}  // namespace stillpoint
