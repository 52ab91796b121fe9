// Method `peng2017`: distances of neighbouring features between consecutive frames; features most of whose
// distances change are dropped.
#include <algorithm>

#include "core/motion/dai2020/graph_layers.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/peng2017/peng2017_stages.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  std::shared_ptr<const GraphFrame> frame;
  std::shared_ptr<const GraphFrame> last;  // the frame right before, where it can be compared with

  [[nodiscard]] std::shared_ptr<const MotionPreparation> for_later() const override {
    auto kept = std::make_shared<Preparation>();
    kept->frame = frame;
    return kept;
  }
};

class Peng2017Method final : public MotionMethod {
 public:
  Peng2017Method(const Camera& camera, const Peng2017Config& config)
      : camera_(camera),
        config_(config.for_camera(camera)),
        rays_(camera, {camera.width, camera.height}, 1) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Peng2017Method>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>> past,
      int) const override {
    auto preparation = std::make_shared<Preparation>();
    const bool usual = frame.gray.cols == camera_.width && frame.gray.rows == camera_.height;
    preparation->frame = std::make_shared<GraphFrame>(
        make_graph_frame(frame, usual ? rays_ : PixelRays(camera_, frame.gray.size(), 1), config_.follow()));
    if (!past.empty() && past.back()) {
      const auto& before = static_cast<const Preparation&>(*past.back()).frame;
      // Only neighbours, and with depth: a run that begins from a checkpoint finds the same one.
      if (before->index == frame.index - 1 && !before->depth.empty() &&
          before->pyramid.front().size() == frame.gray.size())
        preparation->last = before;
    }
    return preparation;
  }
  [[nodiscard]] int frames_prepared_back() const override { return 1; }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const auto& ready = static_cast<const Preparation&>(*input.prepared);
    MotionResult result;
    if (!ready.last) {
      result.note = "there is no frame right before, with depth, to compare with";
      return result;
    }
    const GraphFrame &here = *ready.frame, &last = *ready.last;
    auto trace = std::make_shared<Peng2017Trace>();
    trace->last_index = last.index;
    trace->last_gray = last.pyramid.front();
    trace->features.assign(input.features.begin(), input.features.end());
    Stopwatch watch;
    measure(here, last, *trace);
    trace->ms_follow = watch.lap();
    trace->edges = delaunay_edges(trace->here, input.frame.gray.size(), config_.edges());
    trace->strains =
        edge_strains(trace->edges, trace->here, trace->last,
                     {config_.pixel_sigma_px / here.rays.fx(), config_.pixel_sigma_px / here.rays.fy(),
                      config_.depth_sigma_per_m2, config_.depth_floor_m});
    trace->shares = held_shares(trace->here.size(), trace->edges, trace->strains, config_.cut_sigmas);
    trace->of_point = verdicts_by_shares(trace->shares, config_.held_share);
    trace->nearest =
        nearest_points(trace->features, trace->here, trace->of_point, config_.reach_px, config_.most_step_m);
    trace->verdicts = verdicts_of(trace->nearest, trace->of_point);
    trace->ms_edges = watch.lap();
    for (const PointVerdict verdict : trace->verdicts)
      result.weight_of_feature.push_back(is_out(verdict) ? 0.0F : 1.0F);
    if (trace->edges.empty()) result.note = "no two features could be followed with depth: nothing is judged";
    result.figures = {static_cast<double>(trace->here.size()), static_cast<double>(trace->edges.size()),
                      static_cast<double>(trace->cut_edges(config_.cut_sigmas)),
                      static_cast<double>(std::count(trace->verdicts.begin(), trace->verdicts.end(),
                                                     PointVerdict::kDynamic))};
    result.trace = std::move(trace);
    return result;
  }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    auto method = std::make_unique<Peng2017Method>(*this);
    method->config_ = config.of<Peng2017Config>().for_camera(camera_);
    return method;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    if (result.trace)
      log = describe_peng2017(frame, static_cast<const Peng2017Trace&>(*result.trace), config_);
    log.note = result.note;
    return log;
  }

 private:
  /// The graph's points: features that are followed, with depth at both ends, and off each other.
  void measure(const GraphFrame& here, const GraphFrame& last, Peng2017Trace& trace) const {
    std::vector<cv::Point2f> from;
    for (const int f : spaced_features(trace.features, {}, config_.spacing_px))
      from.push_back(trace.features[static_cast<std::size_t>(f)].pixel);
    const std::vector<FollowedPoint> followed = follow_points(from, here, last, config_.follow());
    for (std::size_t i = 0; i < from.size(); ++i) {
      const GraphPoint now = point_at(from[i], here);
      const GraphPoint before = followed[i].followed ? point_at(followed[i].pixel, last) : GraphPoint{};
      if (now.measured() && before.measured())
        trace.here.push_back(now), trace.last.push_back(before);
      else
        trace.unmeasured.push_back(from[i]);
    }
  }

  Camera camera_;
  Peng2017Config config_;
  PixelRays rays_;
};

}  // namespace

MethodInfo peng2017_method() {
  MethodInfo info;
  info.name = "peng2017";
  info.title = "Peng 2017";
  info.summary =
      "Distances of neighbouring features between two frames; features most of whose distances change are "
      "dropped.";
  info.citation =
      "Peng, 2017: the idea alone, as Niu W., Li W.: Visual odometry algorithm based on dynamic object "
      "feature "
      "point removal (2019) cite it; its text and title were not to be had";
  info.needs.depth = info.needs.first_pose = info.needs.matches = true;
  info.judges_features = true;
  info.without_depth = "epipolar";
  info.parameters = AnySection(Peng2017Config());
  info.figures = {{"peng2017_points", FigureUnit::plain,
                   "features followed to the last frame with depth at both ends", 0},
                  {"peng2017_edges", FigureUnit::plain, "edges between them", 0},
                  {"peng2017_cut", FigureUnit::plain, "of these, the ones whose length changed", 0},
                  {"peng2017_dynamic", FigureUnit::plain, "features most of whose edges are cut", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Peng2017Method>(camera, config.of<Peng2017Config>());
  };
  return info;
}

}  // namespace stillpoint
