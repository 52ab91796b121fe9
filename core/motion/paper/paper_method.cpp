// Niu & Li (2019), METHOD.md §1, as a motion method: each frame against the one reference_gap frames before.
#include <algorithm>

#include "core/motion/methods.hpp"
#include "core/motion/paper/detect_motion.hpp"
#include "core/motion/paper/paper_config.hpp"
#include "core/motion/paper/paper_stages.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  int index = 0;
  std::shared_ptr<const MotionFrame> frame;
  std::shared_ptr<const PaperMotionTrace> trace;  // null where there was no frame to compare with

  /// The trace's images are not kept for a frame longer than they are looked at.
  [[nodiscard]] std::shared_ptr<const MotionPreparation> for_later() const override {
    if (!trace) return nullptr;
    auto kept = std::make_shared<Preparation>();
    kept->index = index;
    kept->frame = frame;
    return kept;
  }
};

class PaperMethod final : public MotionMethod {
 public:
  explicit PaperMethod(const PaperConfig& config) : config_(config) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<PaperMethod>(*this);
  }

  [[nodiscard]] int frames_prepared_back() const override { return config_.reference_gap; }

  /// All of the method needs no pose, so all of it runs ahead.
  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>> past,
      int threads) const override {
    auto prepared = std::make_shared<Preparation>();
    prepared->index = frame.index;
    prepared->frame = std::make_shared<const MotionFrame>(prepare_motion_frame(frame.gray, config_));
    if (past.empty()) return prepared;
    const auto& reference = static_cast<const Preparation&>(*past.front());
    auto trace = std::make_shared<PaperMotionTrace>();
    trace->reference = reference.index;
    trace->reference_gray = reference.frame->gray;
    trace->pair = detect_motion(*reference.frame, *prepared->frame, config_, threads);
    prepared->trace = std::move(trace);
    return prepared;
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    const auto& prepared = static_cast<const Preparation&>(*input.prepared);
    result.trace = prepared.trace;
    if (!prepared.trace) {
      result.note = "there is no earlier frame to compare with";
      return result;
    }
    const PaperTrace& trace = prepared.trace->pair;
    result.note = trace.note;
    if (trace.rounds.empty()) return result;
    const MotionRound& round = trace.rounds.back();
    const auto& tracks = round.forward.tracks;
    result.mask = trace.mask();
    result.mask_share = round.mask_share;
    result.partial_mask = round.forward.mask;
    result.rounds = static_cast<int>(trace.rounds.size());
    result.figures = {static_cast<double>(std::count_if(tracks.begin(), tracks.end(),
                                                        [](const Track& track) { return track.inlier; })),
                      round.forward.homography.refined_error_px};
    return result;
  }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<PaperConfig>() == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log = describe_paper(frame, static_cast<const PaperMotionTrace*>(result.trace.get()));
    if (log.stages.empty()) log.note = result.note;
    return log;
  }

 private:
  PaperConfig config_;
};

}  // namespace

MethodInfo paper_method() {
  MethodInfo info;
  info.name = "paper";
  info.title = "Niu & Li 2019";
  info.summary = "Homography, motion compensation, frame difference both ways, iterated.";
  info.citation =
      "Niu Wenyu, Li Wenfeng: Visual Odometry Algorithm Based on Dynamic Object Feature Point Removal, 2019";
  info.usual = true;
  info.parameters = AnySection(PaperConfig());
  info.old_section = "motion";
  info.partial_mask = "forward_mask";
  info.figures = {
      {"static_tracks", FigureUnit::plain, "flow tracks that agree with the forward homography", 0},
      {"homography_rms", FigureUnit::pixels, "error of the homography over those tracks", 4}};
  info.panels = {"forward_mask", "backward_mask", "union_mask", "flow_tracks", "compensated", "difference"};
  info.make = [](const Camera&, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<PaperMethod>(config.of<PaperConfig>());
  };
  return info;
}

}  // namespace stillpoint
