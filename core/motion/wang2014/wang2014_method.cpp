// Method `wang2014`: trajectories of dense flow, clustered by their motion in space; the cluster that moves
// as most trajectories do, and what fits its motion, is static, all others are dynamic.
#include <fmt/format.h>

#include <algorithm>

#include "core/motion/methods.hpp"
#include "core/motion/wang2014/dense_labels.hpp"
#include "core/motion/wang2014/wang2014_stages.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  std::shared_ptr<const TrajectoryFrame> frame;
  std::shared_ptr<const TrajectoryFrame> last;  // the frame before, where flow leads there
  FlowPair flow;
  double ms = 0.0;

  [[nodiscard]] std::shared_ptr<const MotionPreparation> for_later() const override {
    auto kept = std::make_shared<Preparation>();
    kept->frame = frame;
    return kept;
  }
};

class Wang2014Method final : public MotionMethod {
 public:
  Wang2014Method(const Camera& camera, const Wang2014Config& config)
      : camera_(camera),
        config_(config.for_camera(camera)),
        rays_(camera, {camera.width, camera.height}, kFlowFactor) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Wang2014Method>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>> past,
      int) const override {
    const Stopwatch watch;
    auto preparation = std::make_shared<Preparation>();
    auto ready = std::make_shared<TrajectoryFrame>();
    ready->index = frame.index;
    ready->timestamp = frame.timestamp;
    ready->view = make_rgbd_view(frame.gray, frame.depth, camera_, kFlowFactor);
    ready->view.gray.convertTo(ready->gray, CV_8U);
    const bool usual = frame.gray.cols == camera_.width && frame.gray.rows == camera_.height;
    ready->rays = usual ? rays_ : PixelRays(camera_, frame.gray.size(), kFlowFactor);
    if (!past.empty() && past.back()) {
      const auto& before = static_cast<const Preparation&>(*past.back()).frame;
      // Only neighbours: a run that begins from a checkpoint finds the same one.
      if (before->index == frame.index - 1 && before->gray.size() == ready->gray.size() &&
          std::min(ready->gray.cols, ready->gray.rows) >= kLeastFlowSide) {
        preparation->last = before;
        preparation->flow = dense_flow(ready->gray, before->gray);
      }
    }
    preparation->frame = std::move(ready);
    preparation->ms = watch.milliseconds();
    return preparation;
  }
  [[nodiscard]] int frames_prepared_back() const override { return 1; }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const auto& ready = static_cast<const Preparation&>(*input.prepared);
    MotionResult result;
    auto trace = std::make_shared<Wang2014Trace>();
    trace->here = ready.frame;
    trace->ms_flow = ready.ms;
    Stopwatch watch;
    // Only from the frame that the state is of.
    const bool goes_on = ready.last && last_index_ == ready.last->index;
    if (goes_on) trace->last = ready.last;
    trace->trajectories = std::make_shared<const TrajectorySet>(
        advanced(goes_on ? *trajectories_ : TrajectorySet(), goes_on ? &ready.flow : nullptr, *ready.frame,
                 config_));  // (a)
    trace->ms_follow = watch.lap();

    trace->since = goes_on && !labels_.empty() ? since_ + 1 : config_.segment_frames;
    if (trace->since >= config_.segment_frames) {
      auto segments = std::make_shared<const MotionSegments>(
          segment_motion(*ready.frame, *trace->trajectories, config_));  // (b) to (e)
      if (segments->k > 0) {
        trace->since = 0;
        trace->labels = segments->labels;
        trace->small_mask = segments->mask;
        trace->segments = std::move(segments);
      }
    }
    watch.lap();
    if (!trace->segments && goes_on && !labels_.empty()) {
      trace->labels = carried(labels_, ready.flow.last_from_here);
      trace->small_mask = carried(mask_, ready.flow.last_from_here);
    }
    if (trace->small_mask.empty()) {
      result.note = fmt::format("too few trajectories of {} frames with depth yet", config_.least_frames);
    } else {
      trace->mask = enlarged(trace->small_mask, kFlowFactor, input.frame.gray.size());
      result.mask = trace->mask;
      result.mask_share = static_cast<double>(cv::countNonZero(trace->mask)) /
                          static_cast<double>(std::max<std::size_t>(1, trace->mask.total()));
    }
    trace->ms_mask = watch.lap();
    result.figures = {static_cast<double>(trace->trajectories->all.size()),
                      trace->segments ? static_cast<double>(trace->segments->chosen.size()) : 0.0,
                      trace->segments ? static_cast<double>(trace->segments->k) : 0.0,
                      trace->segments ? static_cast<double>(dynamic_labels(*trace->segments)) : 0.0,
                      static_cast<double>(trace->since)};
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome&) override {
    if (!result.trace) return;
    const auto& trace = static_cast<const Wang2014Trace&>(*result.trace);
    trajectories_ = trace.trajectories;
    labels_ = trace.labels;
    mask_ = trace.small_mask;
    since_ = trace.since;
    last_index_ = input.frame.index;
  }

  [[nodiscard]] bool settled() const override { return !labels_.empty(); }

  [[nodiscard]] int frames_back() const override { return config_.window_frames + config_.segment_frames; }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<Wang2014Config>().for_camera(camera_) == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    if (result.trace)
      log = describe_wang2014(frame, static_cast<const Wang2014Trace&>(*result.trace), config_);
    log.note = result.note;
    return log;
  }

 private:
  static int dynamic_labels(const MotionSegments& segments) {
    int dynamic = 0;
    for (int label = 0; label < segments.k; ++label)
      if (std::find(segments.label.begin(), segments.label.end(), label) != segments.label.end() &&
          !segments.is_static(label))
        ++dynamic;
    return dynamic;
  }

  Camera camera_;
  Wang2014Config config_;
  PixelRays rays_;
  std::shared_ptr<const TrajectorySet> trajectories_ = std::make_shared<TrajectorySet>();
  cv::Mat labels_, mask_;  // small; shared between copies, never written to
  int since_ = 0, last_index_ = -1;
};

}  // namespace

MethodInfo wang2014_method() {
  MethodInfo info;
  info.name = "wang2014";
  info.title = "Wang & Huang 2014";
  info.summary =
      "Long trajectories of dense flow, clustered by their motion in space; static is what moves as most do.";
  info.citation =
      "Wang Y., Huang S.: Towards dense moving object segmentation based robust dense RGB-D SLAM in dynamic "
      "scenarios, ICARCV 2014, 1841-1846; segmentation after Ochs P., Malik J., Brox T., IEEE TPAMI 36(6), "
      "2014";
  info.needs.depth = true;
  info.needs.keeps_state = true;
  info.without_depth = "epipolar";
  info.parameters = AnySection(Wang2014Config());
  info.figures = {{"wang2014_trajectories", FigureUnit::plain, "trajectories that reach the frame", 0},
                  {"wang2014_clustered", FigureUnit::plain,
                   "of these, the ones clustered; 0 where the mask is carried", 0},
                  {"wang2014_clusters", FigureUnit::plain, "clusters by the eigengap", 0},
                  {"wang2014_dynamic", FigureUnit::plain, "of these, after merging, the dynamic ones", 0},
                  {"wang2014_since", FigureUnit::plain, "frames since the last segmentation", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Wang2014Method>(camera, config.of<Wang2014Config>());
  };
  return info;
}

}  // namespace stillpoint
