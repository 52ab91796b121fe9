#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>

#include "core/motion/paper/cleanup.hpp"
#include "core/motion/paper/compensation.hpp"
#include "core/motion/paper/detect_motion.hpp"
#include "core/motion/paper/difference.hpp"
#include "core/motion/paper/homography.hpp"
#include "core/motion/regions.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

/// Everything the stages of one 640x480 pair need, made once. The program parallelises itself, hence one
/// OpenCV thread.
struct Pair {
  Pair() {
    cv::setNumThreads(1);
    scene = motion_test::plane_and_patch({640, 480}, {260, 120, 130, 240}, {20, -1}, 16);
    reference = prepare_motion_frame(scene.reference, config);
    target = prepare_motion_frame(scene.target, config);
    trace = detect_motion(reference, target, config);
  }
  PaperConfig config;
  motion_test::PlaneAndPatch scene;
  MotionFrame reference, target;
  PaperTrace trace;
};

const Pair& pair() {
  static const Pair made;
  return made;
}

void PrepareFrame(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(prepare_motion_frame(pair().scene.target, pair().config));
}
BENCHMARK(PrepareFrame)->Unit(benchmark::kMillisecond);

void FollowCorners(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(follow_corners(pair().reference, pair().target, pair().config));
  state.counters["corners"] = static_cast<double>(pair().reference.corners.size());
}
BENCHMARK(FollowCorners)->Unit(benchmark::kMillisecond);

void Ransac(benchmark::State& state) {
  const auto& tracks = pair().trace.rounds.front().forward.tracks;
  for (auto _ : state) benchmark::DoNotOptimize(ransac_homography(tracks, pair().config));
}
BENCHMARK(Ransac)->Unit(benchmark::kMillisecond);

void RefineHomography(benchmark::State& state) {
  std::vector<Track> inliers;
  for (const Track& track : pair().trace.rounds.front().forward.tracks)
    if (track.inlier) inliers.push_back(track);
  const cv::Matx33d start = *ransac_homography(inliers, pair().config);
  for (auto _ : state)
    benchmark::DoNotOptimize(refine_homography(start, inliers, pair().config.refine_iterations));
  state.counters["inliers"] = static_cast<double>(inliers.size());
}
BENCHMARK(RefineHomography)->Unit(benchmark::kMillisecond);

void Compensate(benchmark::State& state) {
  const cv::Matx33d homography = pair().trace.rounds.back().forward.homography.matrix;
  for (auto _ : state)
    benchmark::DoNotOptimize(compensate(pair().scene.reference, homography, pair().config.border_px));
}
BENCHMARK(Compensate)->Unit(benchmark::kMillisecond);

void DifferenceAndThreshold(benchmark::State& state) {
  const DirectionTrace& forward = pair().trace.rounds.back().forward;
  for (auto _ : state) {
    const cv::Mat difference = frame_difference(pair().scene.target, forward.compensated, forward.valid);
    benchmark::DoNotOptimize(binarise(difference, otsu_threshold(histogram(difference, forward.valid))));
  }
}
BENCHMARK(DifferenceAndThreshold)->Unit(benchmark::kMillisecond);

void CleanMask(benchmark::State& state) {
  const DirectionTrace& forward = pair().trace.rounds.back().forward;
  for (auto _ : state) benchmark::DoNotOptimize(clean_mask(forward.raw_mask, forward.valid, pair().config));
}
BENCHMARK(CleanMask)->Unit(benchmark::kMillisecond);

void FindRegions(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(find_regions(pair().trace.mask()));
}
BENCHMARK(FindRegions)->Unit(benchmark::kMillisecond);

/// As the odometry calls it: the reference's preparation is the frame before's.
void DetectMotionInSequence(benchmark::State& state) {
  for (auto _ : state) {
    const MotionFrame target = prepare_motion_frame(pair().scene.target, pair().config);
    benchmark::DoNotOptimize(
        detect_motion(pair().reference, target, pair().config, static_cast<int>(state.range(0))));
  }
  state.counters["rounds"] = static_cast<double>(pair().trace.rounds.size());
}
BENCHMARK(DetectMotionInSequence)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void DetectMotionOfTwoImages(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(detect_motion(pair().scene.reference, pair().scene.target, pair().config,
                                           static_cast<int>(state.range(0))));
}
BENCHMARK(DetectMotionOfTwoImages)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace stillpoint
