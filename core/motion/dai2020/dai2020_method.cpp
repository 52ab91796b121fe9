// Method `dai2020`: points whose distances stay belong together; the largest group of them is static, and
// features on the others are dropped.
#include <algorithm>
#include <optional>

#include "core/motion/dai2020/dai2020_stages.hpp"
#include "core/motion/dai2020/graph_layers.hpp"
#include "core/motion/methods.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr int kMostGap = 5;  // frames: over a longer one points are not followed, and the graph begins anew

struct Preparation final : MotionPreparation {
  std::shared_ptr<const GraphFrame> frame;
};

class Dai2020Method final : public MotionMethod {
 public:
  Dai2020Method(const Camera& camera, const Dai2020Config& config)
      : camera_(camera),
        config_(config.for_camera(camera)),
        rays_(camera, {camera.width, camera.height}, 1) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Dai2020Method>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>>, int) const override {
    auto preparation = std::make_shared<Preparation>();
    const bool usual = frame.gray.cols == camera_.width && frame.gray.rows == camera_.height;
    preparation->frame = std::make_shared<GraphFrame>(
        make_graph_frame(frame, usual ? rays_ : PixelRays(camera_, frame.gray.size(), 1), config_.follow()));
    return preparation;
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const GraphFrame& here = *static_cast<const Preparation&>(*input.prepared).frame;
    MotionResult result;
    auto trace = std::make_shared<Dai2020Trace>();
    trace->features.assign(input.features.begin(), input.features.end());
    const bool goes_on = last_ && here.index - last_->index <= kMostGap &&
                         last_->pyramid.front().size() == here.pyramid.front().size();
    if (goes_on)
      judge(here, *trace);
    else
      result.note = "the graph begins with this frame: nothing is judged";
    Stopwatch watch;
    trace->next = trace->judged;
    trace->keyframe = !goes_on || ++trace->next.frames_since_keyframe >= config_.keyframe_frames;
    if (trace->keyframe) trace->added = extend_graph(trace->next, input.features, here, config_);
    trace->ms_keyframe = watch.lap();

    if (goes_on) {
      for (const PointVerdict verdict : trace->verdicts)
        result.weight_of_feature.push_back(is_out(verdict) ? 0.0F : 1.0F);
      if (trace->still < 0) result.note = "no edge has settled yet: nothing is judged";
    }
    const auto dynamic = std::count(trace->verdicts.begin(), trace->verdicts.end(), PointVerdict::kDynamic);
    const auto undecided =
        std::count(trace->verdicts.begin(), trace->verdicts.end(), PointVerdict::kUndecided);
    result.figures = {static_cast<double>(trace->judged.points.size()),
                      static_cast<double>(trace->judged.edges.size()),
                      static_cast<double>(trace->cut_edges()), static_cast<double>(dynamic),
                      static_cast<double>(undecided)};
    result.trace = std::move(trace);
    return result;
  }

  /// A frame that was not judged is passed over: points are followed across it.
  void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome&) override {
    if (!result.trace) return;
    graph_ = static_cast<const Dai2020Trace&>(*result.trace).next;
    last_ = static_cast<const Preparation&>(*input.prepared).frame;
  }

  [[nodiscard]] bool settled() const override { return last_ != nullptr; }

  [[nodiscard]] int frames_back() const override { return 1; }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<Dai2020Config>().for_camera(camera_) == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    if (result.trace) log = describe_dai2020(frame, static_cast<const Dai2020Trace&>(*result.trace), config_);
    log.note = result.note;
    return log;
  }

 private:
  void judge(const GraphFrame& here, Dai2020Trace& trace) const {
    trace.last_index = last_->index;
    trace.last_gray = last_->pyramid.front();
    Stopwatch watch;
    std::vector<cv::Point2f> from;
    for (const GraphPoint& point : graph_.seen) from.push_back(point.pixel);
    const std::vector<FollowedPoint> followed = follow_points(from, *last_, here, config_.follow());
    std::vector<std::uint8_t> kept;
    for (std::size_t i = 0; i < from.size(); ++i) {
      kept.push_back(followed[i].followed ? 1 : 0);
      (followed[i].followed ? trace.before : trace.lost).push_back(from[i]);
    }
    TrackedGraph& graph = trace.judged = without_lost(graph_, kept);
    std::size_t next = 0;
    for (const FollowedPoint& one : followed)
      if (one.followed) graph.seen[next++] = point_at(one.pixel, here);
    trace.ms_follow = watch.lap();
    measure_edges(graph,
                  {config_.pixel_sigma_px / here.rays.fx(), config_.pixel_sigma_px / here.rays.fy(),
                   config_.depth_sigma_per_m2, config_.depth_floor_m},
                  here.index, config_);
    trace.ms_edges = watch.lap();
    trace.groups = judge_points(graph, config_);
    trace.still = trace.groups.largest(config_.group_by == "hull_area");
    std::vector<PointVerdict> verdicts;
    for (const TrackedPoint& point : graph.points) verdicts.push_back(point.verdict);
    trace.nearest =
        nearest_points(trace.features, graph.seen, verdicts, config_.reach_px, config_.most_step_m);
    trace.verdicts = verdicts_of(trace.nearest, verdicts);
    trace.ms_groups = watch.lap();
  }

  Camera camera_;
  Dai2020Config config_;
  PixelRays rays_;
  TrackedGraph graph_;
  std::shared_ptr<const GraphFrame> last_;  // in which the graph's points were seen
};

}  // namespace

MethodInfo dai2020_method() {
  MethodInfo info;
  info.name = "dai2020";
  info.title = "Dai et al. 2020";
  info.summary =
      "Points joined by edges that remember their lengths; what hangs together with the largest group is "
      "static.";
  info.citation =
      "Dai W., Zhang Y., Li P., Fang Z., Scherer S.: RGB-D SLAM in dynamic environments using point "
      "correlations, IEEE TPAMI 44(1), 2022 (online 2020), arXiv 1811.03217";
  info.needs.depth = info.needs.first_pose = info.needs.matches = true;
  info.needs.keeps_state = true;
  info.judges_features = true;
  info.without_depth = "epipolar";
  info.parameters = AnySection(Dai2020Config());
  info.figures = {{"dai2020_points", FigureUnit::plain, "points of the graph that were followed", 0},
                  {"dai2020_edges", FigureUnit::plain, "edges between them", 0},
                  {"dai2020_cut", FigureUnit::plain, "of these, the ones that are cut", 0},
                  {"dai2020_dynamic", FigureUnit::plain, "features of groups that move", 0},
                  {"dai2020_undecided", FigureUnit::plain, "features of groups too small to tell", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Dai2020Method>(camera, config.of<Dai2020Config>());
  };
  return info;
}

}  // namespace stillpoint
