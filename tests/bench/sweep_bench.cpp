// Whole frames by method, number of features and image size, with each stage's share:
// `benchmarks --benchmark_filter=Frame`. STILLPOINT_BENCH_SEQUENCE names another sequence than the generated
// one.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>

#include "core/motion/methods.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/memory_source.hpp"

namespace stillpoint {

namespace {

constexpr int kFrames = 100;  // some ten keyframes

const FrameSource& sequence() {
  static const auto source = [] {
    const char* named = std::getenv("STILLPOINT_BENCH_SEQUENCE");
    OpenOptions options;
    options.frames = kFrames;
    return open_sequence(named != nullptr ? named : "generated:walking_xyz", options);
  }();
  return *source;
}

/// Sequences of one size follow each other, so that one is held at a time.
const MemorySource& sequence(const cv::Size& size) {
  static std::unique_ptr<MemorySource> held;
  static cv::Size held_size;
  if (held_size != size) {
    held = std::make_unique<MemorySource>(sequence(), kFrames, size);
    held_size = size;
  }
  return *held;
}

/// Runs the sequence once; the time reported is a frame's median.
void run(benchmark::State& state, const char* method, int features, const cv::Size& size, int threads) {
  const MemorySource& source = sequence(size);
  Config config;
  config.run.method = method;
  config.run.threads = threads;
  config.features.count = features;
  RunOptions options;
  options.measure_orb_unit = true;
  Allocations before, after;
  options.on_frame = [&](const FrameResult& frame) {
    if (frame.record.index == kFrames / 2) before = allocations_so_far();
    after = allocations_so_far();
  };
  for (auto _ : state) {
    const RunResult result = run_sequence(source, config, options);
    const SpeedFigures speed = report_on(result, source).speed;
    state.SetIterationTime(speed.median_ms / 1000.0);
    state.counters["p99_ms"] = speed.p99_ms;
    state.counters["units"] = speed.units;
    state.counters["motion"] = speed.mean.motion;
    state.counters["features"] = speed.mean.features;
    state.counters["matching"] = speed.mean.matching;
    state.counters["pose"] = speed.mean.pose;
    state.counters["mapping"] = speed.mean.mapping;
    state.counters["bundle"] = speed.mean.bundle;
    // A frame's mean over the second half, keyframes and their adjustment included.
    const Allocations spent = after - before;
    const double frames = std::max(1, source.size() - kFrames / 2 - 1);
    state.counters["allocations"] = static_cast<double>(spent.calls) / frames;
    state.counters["allocated_kB"] = static_cast<double>(spent.bytes) / frames / 1e3;
    state.counters["large"] = static_cast<double>(spent.large_calls) / frames;
    state.counters["large_kB"] = static_cast<double>(spent.large_bytes) / frames / 1e3;
  }
}

void add(const char* sweep, const char* method, int features, const cv::Size& size, int threads = 2) {
  const std::string name = std::string("Frame/") + sweep + "/" + method + "/" + std::to_string(features) +
                           "/" + std::to_string(size.width) + "x" + std::to_string(size.height) +
                           (threads == 2 ? "" : "/threads:" + std::to_string(threads));
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) { run(state, method, features, size, threads); })
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

const bool kRegistered = [] {
  constexpr int kUsual = 1000;
  const cv::Size usual(640, 480);
  const auto methods = {"none", "paper", "stillpoint"};
  for (const char* method : methods) add("method", method, kUsual, usual);
  for (const char* method : methods) add("method", method, kUsual, usual, 1);
  for (const int features : {500, 1000, 1500, 2000})
    for (const char* method : methods) add("features", method, features, usual);
  for (const cv::Size& size : {cv::Size(320, 240), usual, cv::Size(960, 720), cv::Size(1280, 960)})
    for (const char* method : methods) add("size", method, kUsual, size);
  return true;
}();

}  // namespace
}  // namespace stillpoint
