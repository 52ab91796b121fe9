// The reference: the ground-truth mask, for what removal could gain at best.
#include "core/motion/methods.hpp"

namespace stillpoint {
namespace {

class Oracle final : public MotionMethod {
 public:
  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Oracle>(*this);
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    if (input.true_mask.size() != input.frame.gray.size()) {
      result.mask_problem = "there is no ground-truth mask for this frame";
      result.note = result.mask_problem;
      return result;
    }
    result.mask = input.true_mask;
    result.mask_share =
        static_cast<double>(cv::countNonZero(result.mask)) / static_cast<double>(result.mask.total());
    return result;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    log.note = result.note;
    const Layer target = photo_layer("Frame", frame.gray);
    Stage& stage = log.add("ground_truth", "Motion", "Ground-truth mask",
                           "Takes the ground-truth mask: a reference, not a method.");
    stage.timed = false;
    stage.note = result.note;
    stage.figure("Mask", 100.0 * result.mask_share, "%", 2);
    stage.add_side({target}, mask_layer("Ground-truth mask", result.mask, target, "mask"));
    stage.overview = true;
    return log;
  }
};

}  // namespace

MethodInfo oracle_method() {
  MethodInfo info;
  info.name = "oracle";
  info.title = "Ground-truth masks";
  info.summary =
      "The reference: the odometry is given the ground-truth mask, to show what removal could gain.";
  info.needs.true_mask = true;
  info.reference = true;
  info.extends_odometry = true;
  info.make = [](const Camera&, const Config&) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Oracle>();
  };
  return info;
}

}  // namespace stillpoint
