// Speed of the odometry's stages, each on what the stage before made of a generated frame.
#include <benchmark/benchmark.h>

#include <opencv2/features2d.hpp>

#include "core/motion/stillpoint/superpixels.hpp"
#include "core/odometry/bundle_adjustment.hpp"
#include "core/odometry/consensus.hpp"
#include "core/odometry/odometry.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

/// Two people walk about; ten frames bring a map of a few keyframes.
struct Scene {
  static constexpr int kFrames = 10;

  Scene() {
    OpenOptions options;
    options.frames = kFrames + 1;
    source = open_sequence("generated:walking_xyz", options);
    for (int i = 0; i <= kFrames; ++i) frames.push_back(source->read(i));
    config.run.method = "none";
    config.map.keyframe_min_ratio =
        1.0;  // a keyframe as often as may be, so that there is something to adjust
    odometry.emplace(source->camera(), config);
    for (int i = 0; i < kFrames; ++i) (void)odometry->process(frames[static_cast<std::size_t>(i)]);
    odometry->finish();
  }

  static const Scene& get() {
    static const Scene scene;
    return scene;
  }

  [[nodiscard]] const Frame& last() const { return frames.back(); }

  std::unique_ptr<FrameSource> source;
  std::vector<Frame> frames;
  Config config;
  std::optional<Odometry> odometry;
};

void OrbUnit(benchmark::State& state) {
  const Scene& scene = Scene::get();
  const auto orb = cv::ORB::create(1000, 1.2F, 8);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  for (auto _ : state) orb->detectAndCompute(scene.last().gray, cv::noArray(), keypoints, descriptors);
}
BENCHMARK(OrbUnit)->Unit(benchmark::kMillisecond);

void ExtractFeatures(benchmark::State& state) {
  FeatureConfig config;
  config.count = static_cast<int>(state.range(0));
  OrbExtractor extractor(config);
  const cv::Mat gray = Scene::get().last().gray;  // made before the clock runs
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(gray));
}
BENCHMARK(ExtractFeatures)->Arg(500)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

/// A pose from matches 30 % of which are wrong.
std::vector<PoseObservation> observations(const Camera& camera, int count) {
  cv::RNG random(4);
  std::vector<PoseObservation> result;
  for (int i = 0; i < count; ++i) {
    PoseObservation o;
    o.pixel = {random.uniform(0.0, 640.0), random.uniform(0.0, 480.0)};
    o.depth = random.uniform(0.8, 4.0);
    o.point_in_world = camera.back_project(o.pixel, o.depth);
    o.pixel += Eigen::Vector2d(random.gaussian(0.7), random.gaussian(0.7));
    if (i % 10 < 3) o.pixel.x() += random.uniform(5.0, 40.0);
    result.push_back(o);
  }
  return result;
}

void RefinePose(benchmark::State& state) {
  const Camera& camera = Scene::get().source->camera();
  const auto matches = observations(camera, 400);
  Pose start = Pose::Identity();
  start.translation().x() = 0.02;
  for (auto _ : state) benchmark::DoNotOptimize(refine_pose(camera, matches, start, {}));
}
BENCHMARK(RefinePose)->Unit(benchmark::kMillisecond);

void InitialPoseByEpnp(benchmark::State& state) {
  const Camera& camera = Scene::get().source->camera();
  const auto matches = observations(camera, 400);
  for (auto _ : state) benchmark::DoNotOptimize(initial_pose(camera, matches, {}));
}
BENCHMARK(InitialPoseByEpnp)->Unit(benchmark::kMillisecond);

void ConsensusPose(benchmark::State& state) {
  const Camera& camera = Scene::get().source->camera();
  const auto matches = observations(camera, 400);
  for (auto _ : state) benchmark::DoNotOptimize(consensus_pose(camera, matches, {Pose::Identity()}, 200, 1));
}
BENCHMARK(ConsensusPose)->Unit(benchmark::kMillisecond);

void LocalBundleAdjustment(benchmark::State& state) {
  const Scene& scene = Scene::get();
  const LocalMap& map = scene.odometry->map();
  const BundleProblem problem = make_bundle_problem(map, map.keyframes().rbegin()->first, scene.config);
  for (auto _ : state)
    benchmark::DoNotOptimize(solve_bundle(problem, scene.source->camera(), scene.config.bundle, 1.0));
  state.counters["keyframes"] = static_cast<double>(problem.views.size());
  state.counters["edges"] = static_cast<double>(problem.edges.size());
}
BENCHMARK(LocalBundleAdjustment)->Unit(benchmark::kMillisecond);

void DepthMotion(benchmark::State& state) {
  const Scene& scene = Scene::get();
  const StillpointConfig config;
  const auto view = [&](std::size_t i) {
    return std::make_shared<const RgbdView>(
        make_rgbd_view(scene.frames[i].gray, scene.frames[i].depth, scene.source->camera(), config.factor));
  };
  const auto current = view(Scene::kFrames);
  const Pose world_from_current = *scene.source->truth(Scene::kFrames).world_from_camera;
  std::vector<ReferenceView> references;
  for (const int i : {8, 0})
    references.push_back({view(static_cast<std::size_t>(i)),
                          scene.source->truth(i).world_from_camera->inverse() * world_from_current, i == 0});
  for (auto _ : state)
    benchmark::DoNotOptimize(detect_depth_motion(*current, make_superpixels(*current, config),
                                                 scene.last().depth, references, nullptr, Pose::Identity(),
                                                 config));
}
BENCHMARK(DepthMotion)->Unit(benchmark::kMillisecond);

/// A whole frame, by method; the state is copied anew for each, which is not timed.
void ProcessFrame(benchmark::State& state, const char* method) {
  const Scene& scene = Scene::get();
  Config config = scene.config;
  config.run.method = method;
  Odometry before(scene.source->camera(), config);
  for (int i = 0; i < Scene::kFrames; ++i) (void)before.process(scene.frames[static_cast<std::size_t>(i)]);
  before.finish();
  for (auto _ : state) {
    state.PauseTiming();
    Odometry odometry = before;
    state.ResumeTiming();
    benchmark::DoNotOptimize(odometry.process(scene.last()));
  }
}
BENCHMARK_CAPTURE(ProcessFrame, none, "none")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(ProcessFrame, paper, "paper")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(ProcessFrame, stillpoint, "stillpoint")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace stillpoint
