// Method `yi2013`: a background of two Gaussians a block, warped by a homography of grid points.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/motion/methods.hpp"
#include "core/motion/yi2013/yi2013_stages.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

class Yi2013Method final : public MotionMethod {
 public:
  explicit Yi2013Method(const Yi2013Config& config) : config_(config) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Yi2013Method>(*this);
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    const cv::Mat& seen = input.frame.gray;
    if (std::min(seen.cols, seen.rows) < config_.block_px) {
      result.note = "the image is smaller than a block of the background model";
      return result;
    }
    auto trace = std::make_shared<Yi2013Trace>();
    auto after = std::make_shared<Yi2013State>();
    Stopwatch watch;
    cv::Mat gray;
    cv::medianBlur(seen, gray, 2 * config_.median_radius_px + 1);
    after->pyramid = yi2013_pyramid(gray, config_);
    if (state_ && state_->pyramid.front().size() == gray.size()) {
      trace->last = state_;
      trace->motion = yi2013_motion(after->pyramid, state_->pyramid, config_);
    }
    trace->ms_motion = watch.lap();
    const Yi2013Blocks blocks = yi2013_blocks(gray, config_.block_px);
    trace->chosen = yi2013_warped(trace->last ? trace->last->model : Yi2013Model(),
                                  trace->motion.last_from_here, blocks, config_);
    trace->matches = yi2013_choose(trace->chosen, blocks, config_);
    trace->ms_warp = watch.lap();
    after->model = yi2013_updated(trace->chosen, trace->matches, blocks, config_);
    trace->ms_update = watch.lap();
    trace->mask = yi2013_moving(gray, trace->chosen, after->model, config_);
    trace->ms_mask = watch.lap();
    after->index = input.frame.index;
    after->frames = trace->last ? trace->last->frames + 1 : 1;

    result.mask = trace->mask;
    result.mask_share = percent_set(trace->mask) / 100.0;
    if (trace->last)
      result.figures = {static_cast<double>(trace->motion.tracks.size()),
                        static_cast<double>(trace->motion.inliers),
                        yi2013_share(trace->matches, kMatchApparent)};
    result.note = trace->last ? trace->motion.note : "the background model begins with this frame";
    trace->after = std::move(after);
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput&, const MotionResult& result, const MotionOutcome&) override {
    if (result.trace) state_ = static_cast<const Yi2013Trace&>(*result.trace).after;
  }

  /// Gaussians forget what lies farther back than their oldest age, but for a small share.
  [[nodiscard]] int frames_back() const override { return static_cast<int>(std::ceil(config_.max_age)); }

  [[nodiscard]] bool settled() const override {
    return state_ && static_cast<double>(state_->frames) > config_.settled_age;
  }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<Yi2013Config>() == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    if (result.trace) log = describe_yi2013(frame, static_cast<const Yi2013Trace&>(*result.trace), config_);
    log.note = result.note;
    return log;
  }

 private:
  Yi2013Config config_;
  std::shared_ptr<const Yi2013State> state_;  // null before the first frame
};

}  // namespace

MethodInfo yi2013_method() {
  MethodInfo info;
  info.name = "yi2013";
  info.title = "Yi et al. 2013";
  info.summary = "A background of two Gaussians a block, warped by a homography of grid points.";
  info.citation =
      "Yi K. M., Yun K., Kim S. W., Chang H. J., Choi J. Y.: Detection of moving objects with non-stationary "
      "cameras in 5.8 ms, CVPRW 2013";
  info.needs.keeps_state = true;
  info.parameters = AnySection(Yi2013Config());
  info.figures = {
      {"yi2013_tracks", FigureUnit::plain, "grid points followed to the last frame", 0},
      {"yi2013_inliers", FigureUnit::plain, "of those, the ones that agree with the homography", 0},
      {"yi2013_apparent", FigureUnit::share, "blocks that belong to the apparent background", 4}};
  info.make = [](const Camera&, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Yi2013Method>(config.of<Yi2013Config>());
  };
  return info;
}

}  // namespace stillpoint
