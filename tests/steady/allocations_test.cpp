// What a frame asks the allocator for once the first frames have made room: next to nothing that is large.
// The frames lie in memory, so that no reading and decoding is counted.
#include "tests/support/allocations.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/odometry/odometry.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/memory_source.hpp"

namespace stillpoint {
namespace {

constexpr int kFrames = 40, kWarmUp = 26;  // until method `stillpoint` looks as far back as it ever does

const MemorySource& sequence() {
  static const auto source = [] {
    OpenOptions options;
    options.frames = kFrames;
    return open_sequence("generated:walking_xyz", options);
  }();
  static const MemorySource frames(*source, kFrames, {640, 480});
  return frames;
}

/// A frame's mean in the steady state.
struct PerFrame {
  double large_calls = 0.0, large_bytes = 0.0, calls = 0.0;
};

PerFrame steady_state(const char* method, int threads) {
  Config config;
  config.run.method = method;
  config.run.threads = threads;
  config.map.keyframe_max_gap = kFrames;  // keyframes make points, which stay: no steady state
  config.map.keyframe_min_ratio = 0.0;
  config.map.keyframe_min_near = 0;
  Allocations before, after;
  int frames = 0;
  RunOptions options;
  options.on_frame = [&](const FrameResult& frame) {
    if (frame.record.index < kWarmUp) before = allocations_so_far();
    after = allocations_so_far();
    frames = frame.record.index - kWarmUp + 1;
  };
  (void)run_sequence(sequence(), config, options);
  const Allocations spent = after - before;
  const auto a_frame = [&](long sum) { return static_cast<double>(sum) / frames; };
  return {a_frame(spent.large_calls), a_frame(spent.large_bytes), a_frame(spent.calls)};
}

struct Bounds {
  const char* method;
  double large_calls, large_bytes, calls;  ///< a frame
};

/// What the test is called by.
void PrintTo(const Bounds& bounds, std::ostream* to) { *to << bounds.method; }

class SteadyState : public testing::TestWithParam<Bounds> {
 protected:
  void SetUp() override {
    if (!counts_allocations()) GTEST_SKIP() << "a sanitizer stands where allocations are counted";
  }
};

TEST_P(SteadyState, AsksForLittle) {
  const Bounds& bounds = GetParam();
  for (const int threads : {1, 2}) {
    const PerFrame spent = steady_state(bounds.method, threads);
    const std::string with = fmt::format("with {} threads, {:.2f} of {:.0f} bytes are large, of {:.0f}",
                                         threads, spent.large_calls, spent.large_bytes, spent.calls);
    SCOPED_TRACE(with);
    RecordProperty(fmt::format("threads_{}", threads), with);
    EXPECT_LE(spent.large_calls, bounds.large_calls);
    EXPECT_LE(spent.large_bytes, bounds.large_bytes);
    EXPECT_LE(spent.calls, bounds.calls);
  }
}

// A quarter more than is asked for, and of small blocks half as much again: images and tables that come and
// go by the frame, whose pages stay with the program.
INSTANTIATE_TEST_SUITE_P(Methods, SteadyState,
                         testing::Values(Bounds{"none", 15, 2.4e6, 900}, Bounds{"paper", 65, 22.5e6, 35000},
                                         Bounds{"stillpoint", 56, 6.7e6, 1800}),
                         [](const auto& method) { return std::string(method.param.method); });

TEST(Allocations, AreCountedWhoeverAsks) {
  if (!counts_allocations()) GTEST_SKIP() << "a sanitizer stands where allocations are counted";
  const Allocations before = allocations_so_far();
  const std::vector<char> ours(kLarge);
  cv::Mat source(300, 400, CV_8UC1, cv::Scalar(1)), blurred;
  cv::blur(source, blurred, {3, 3});
  const Allocations spent = allocations_so_far() - before;
  EXPECT_GE(spent.large_calls, 1);
  EXPECT_GE(spent.large_bytes, static_cast<long>(kLarge));
  EXPECT_GE(spent.calls, 3);
}

}  // namespace
}  // namespace stillpoint
