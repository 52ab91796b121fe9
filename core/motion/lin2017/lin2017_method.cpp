// Method `lin2017`: scene flow of features sorted by direction; what moves is dropped, and kept as virtual
// map points.
#include <algorithm>
#include <opencv2/video/tracking.hpp>
#include <optional>

#include "core/motion/lin2017/lin2017_stages.hpp"
#include "core/motion/methods.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  std::shared_ptr<const FlowFrame> frame;
};

class Lin2017Method final : public MotionMethod {
 public:
  Lin2017Method(const Camera& camera, const Lin2017Config& config)
      : camera_(camera),
        config_(config.for_camera(camera)),
        rays_(camera, {camera.width, camera.height}, 1) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Lin2017Method>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>>, int) const override {
    auto preparation = std::make_shared<Preparation>();
    auto ready = std::make_shared<FlowFrame>();
    ready->index = frame.index;
    ready->timestamp = frame.timestamp;
    ready->depth = frame.depth;
    cv::buildOpticalFlowPyramid(frame.gray, ready->pyramid, {config_.window_px, config_.window_px},
                                config_.levels, false);
    const bool usual = frame.gray.cols == camera_.width && frame.gray.rows == camera_.height;
    ready->rays = usual ? rays_ : PixelRays(camera_, frame.gray.size(), 1);
    preparation->frame = std::move(ready);
    return preparation;
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const auto& here = static_cast<const Preparation&>(*input.prepared).frame;
    MotionResult result;
    if (!last_ || last_->frame->pyramid.front().size() != here->pyramid.front().size()) {
      result.note = "there is no earlier frame with depth and a measured pose to compare with";
      return result;
    }
    const FlowFrame& last = *last_->frame;
    const Camera camera = camera_.scaled_to(input.frame.gray.cols, input.frame.gray.rows);
    auto trace = std::make_shared<Lin2017Trace>();
    trace->last_index = last.index;
    trace->last_gray = last.pyramid.front();
    trace->features.assign(input.features.begin(), input.features.end());
    Stopwatch watch;
    // (d) first: what matches a virtual point is out before any pose is solved.
    const std::vector<BinaryDescriptor> descriptors = upright_descriptors(input.frame.gray, input.features);
    const double seconds = here->timestamp - last.timestamp;
    trace->virtual_before = transformed(
        moved_on(virtual_, here->timestamp - virtual_s_, config_.virtual_frames), *input.camera_from_world);
    trace->virtual_pixels = projections(trace->virtual_before, camera);
    trace->virtual_matches = match_virtual_points(trace->virtual_before, trace->virtual_pixels,
                                                  input.features, descriptors, config_);
    trace->ms_virtual = watch.lap();
    const std::vector<FeatureFlow> followed = follow_features(input.features, *here, last, config_);
    trace->ms_follow = watch.lap();

    Pose pose = *input.camera_from_world;
    std::vector<std::uint8_t> left_out(input.features.size(), 0);
    for (const int feature : trace->virtual_matches)
      if (feature >= 0) left_out[static_cast<std::size_t>(feature)] = 1;
    for (int round = 0; round < config_.rounds; ++round) {
      Lin2017Round next;
      next.pose = pose_of_features(input.features, left_out, pose, camera);
      if (round > 0 && !next.pose.found) break;
      // The odometry's own first pose is the better one of the first round: it stood its RANSAC.
      if (round > 0) pose = next.pose.camera_from_world;
      next.here_from_last = pose * last_->camera_from_world.inverse();
      next.flows = followed;
      judge(input, *here, *trace, next);
      for (std::size_t i = 0; i < left_out.size(); ++i) left_out[i] = is_out(next.flows[i].kind) ? 1 : 0;
      next.ms = watch.lap();
      trace->rounds.push_back(std::move(next));
    }
    trace->virtual_after = virtual_points_after(*trace, descriptors, seconds);

    const std::vector<FeatureFlow>& flows = trace->rounds.back().flows;
    for (const FeatureFlow& flow : flows) result.weight_of_feature.push_back(is_out(flow.kind) ? 0.0F : 1.0F);
    result.rounds = static_cast<int>(trace->rounds.size());
    const auto measured =
        std::count_if(flows.begin(), flows.end(), [](const FeatureFlow& flow) { return flow.measured; });
    result.figures = {static_cast<double>(measured), static_cast<double>(trace->count(FeatureClass::kMoving)),
                      static_cast<double>(trace->count(FeatureClass::kStray)),
                      static_cast<double>(trace->count(FeatureClass::kVirtual)),
                      static_cast<double>(trace->virtual_after.size())};
    if (measured == 0) result.note = "no feature could be followed with depth: only virtual points judge";
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome& outcome) override {
    const auto& here = static_cast<const Preparation&>(*input.prepared).frame;
    if (result.trace) {
      // Of this frame's camera until now: where that is, the odometry has found out meanwhile.
      virtual_ = transformed(static_cast<const Lin2017Trace&>(*result.trace).virtual_after,
                             outcome.camera_from_world.inverse());
    } else {
      virtual_ = moved_on(virtual_, here->timestamp - virtual_s_, config_.virtual_frames);
    }
    virtual_s_ = here->timestamp;
    last_.reset();
    if (outcome.estimated) last_ = Last{here, outcome.camera_from_world};
  }

  [[nodiscard]] bool settled() const override { return last_.has_value(); }

  /// Virtual points outlive what they were made of by so many frames.
  [[nodiscard]] int frames_back() const override { return std::max(1, config_.virtual_frames); }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<Lin2017Config>().for_camera(camera_) == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    if (result.trace) log = describe_lin2017(frame, static_cast<const Lin2017Trace&>(*result.trace), config_);
    log.note = result.note;
    return log;
  }

 private:
  struct Last {
    std::shared_ptr<const FlowFrame> frame;
    Pose camera_from_world = Pose::Identity();
  };

  static bool is_out(FeatureClass kind) {
    return kind == FeatureClass::kStray || kind == FeatureClass::kMoving || kind == FeatureClass::kVirtual;
  }

  /// (a) to (c) under a round's pose.
  void judge(const MotionInput& input, const FlowFrame& here, const Lin2017Trace& trace,
             Lin2017Round& round) const {
    const SceneFlowNoise noise{config_.pixel_sigma_px / here.rays.fx(),
                               config_.pixel_sigma_px / here.rays.fy(), config_.depth_sigma_per_m2,
                               config_.depth_floor_m};
    measure_flow(round.flows, CameraMotion(round.here_from_last, round.pose.covariance), noise, config_);
    round.things = find_moving_things(input.features, round.flows, config_);
    for (const int feature : trace.virtual_matches)
      if (feature >= 0)
        if (FeatureClass& kind = round.flows[static_cast<std::size_t>(feature)].kind;
            kind != FeatureClass::kMoving)
          kind = FeatureClass::kVirtual;
  }

  /// What the next frames are to keep out: features that move, and what was kept out before and is not too
  /// old.
  [[nodiscard]] std::vector<VirtualPoint> virtual_points_after(
      const Lin2017Trace& trace, const std::vector<BinaryDescriptor>& descriptors, double seconds) const {
    std::vector<VirtualPoint> after;
    if (config_.virtual_frames == 0) return after;
    const std::vector<FeatureFlow>& flows = trace.rounds.back().flows;
    const auto seen = [&](std::size_t i, int age) {
      const FeatureFlow& flow = flows[i];
      VirtualPoint point;
      const auto z = static_cast<double>(flow.pair.z_here);
      point.position = {static_cast<double>(flow.pair.ray_here.x()) * z,
                        static_cast<double>(flow.pair.ray_here.y()) * z, z};
      if (seconds > 0.0 && flow.bin >= 0) point.velocity = flow.flow.cast<double>() / seconds;
      point.descriptor = descriptors[i];
      point.age = age;
      return point;
    };
    // A feature may match several: the youngest of them lives on.
    std::vector<int> youngest(flows.size(), -1);
    for (std::size_t k = 0; k < trace.virtual_matches.size(); ++k) {
      const VirtualPoint& point = trace.virtual_before[k];
      const int feature = trace.virtual_matches[k];
      if (feature < 0 || !flows[static_cast<std::size_t>(feature)].measured) {
        after.push_back(point);
        continue;
      }
      int& age = youngest[static_cast<std::size_t>(feature)];
      age = age < 0 ? point.age : std::min(age, point.age);
    }
    for (std::size_t i = 0; i < flows.size(); ++i)
      if (flows[i].kind == FeatureClass::kMoving)
        after.push_back(seen(i, 0));
      else if (youngest[i] >= 0)
        after.push_back(seen(i, youngest[i]));  // it pauses, or moves too little to tell
    return after;
  }

  Camera camera_;
  Lin2017Config config_;
  PixelRays rays_;
  std::optional<Last> last_;           // where its pose was measured
  std::vector<VirtualPoint> virtual_;  // in the world …
  double virtual_s_ = 0.0;             // … at this frame's stamp, s
};

}  // namespace

MethodInfo lin2017_method() {
  MethodInfo info;
  info.name = "lin2017";
  info.title = "Lin et al. 2017";
  info.summary =
      "Scene flow of features, sorted by its direction; what moves is dropped and kept as virtual map "
      "points.";
  info.citation =
      "Lin Z., Zhang G., Yao E., Xu J.: Stereo visual odometry based on motion object detection in the "
      "dynamic scene (in "
      "Chinese), Acta Optica Sinica 37(11), 2017";
  info.needs.depth = info.needs.first_pose = info.needs.matches = true;
  info.needs.keeps_state = true;
  info.judges_features = true;
  info.without_depth = "epipolar";
  info.parameters = AnySection(Lin2017Config());
  info.figures = {{"lin2017_measured", FigureUnit::plain, "features whose scene flow is measured", 0},
                  {"lin2017_moving", FigureUnit::plain, "features of things that move", 0},
                  {"lin2017_stray", FigureUnit::plain, "features that move by themselves", 0},
                  {"lin2017_virtual", FigureUnit::plain, "features that match virtual map points", 0},
                  {"lin2017_points", FigureUnit::plain, "virtual map points", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Lin2017Method>(camera, config.of<Lin2017Config>());
  };
  return info;
}

}  // namespace stillpoint
