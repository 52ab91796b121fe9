// Methods of the literature in whole runs: frames that lack depth or cannot be read, and going back to a
// checkpoint.
#include <gtest/gtest.h>

#include "core/config.hpp"
#include "core/error.hpp"
#include "core/inspect/replayable_run.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/wall_and_board.hpp"

namespace stillpoint {
namespace {

/// A generated sequence of which one frame has no depth and another cannot be read.
class PatchySource final : public FrameSource {
 public:
  static constexpr int kFrames = 10, kNoDepth = 4, kUnreadable = 6;

  [[nodiscard]] const std::string& name() const override { return source_->name(); }
  [[nodiscard]] const Camera& camera() const override { return source_->camera(); }
  [[nodiscard]] int size() const override { return source_->size(); }
  [[nodiscard]] double timestamp(int index) const override { return source_->timestamp(index); }
  [[nodiscard]] Frame read(int index) const override {
    Frame frame = source_->read(index);
    if (index == kNoDepth || index == kUnreadable) frame.depth.release();
    if (index == kUnreadable) frame.colour.release(), frame.gray.release(), frame.problem = "broken";
    return frame;
  }
  [[nodiscard]] FrameTruth truth(int index) const override { return source_->truth(index); }
  [[nodiscard]] const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return true; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 private:
  std::shared_ptr<const FrameSource> source_ = rendered("walking_xyz", kFrames);
};

class Literature : public testing::TestWithParam<const char*> {};

TEST_P(Literature, GoesOnPastBrokenFramesAndBackToAnyFrame) {
  const PatchySource source;
  Config config;
  config.run.method = GetParam();
  ReplayableRunOptions options;
  options.checkpoint_every = 3;
  options.keep_times = false;
  ReplayableRun run(source, config, options);
  const auto read = [&](int index) { return source.read(index); };
  std::vector<FrameResult> results;
  for (int i = 0; i < PatchySource::kFrames; ++i) results.push_back(run.process_next(read));
  EXPECT_EQ(results[PatchySource::kUnreadable].record.status, FrameStatus::unreadable);
  int judged = 0;
  for (int i = 0; i < PatchySource::kFrames; ++i) {
    const FrameResult again = run.replay(i, read);
    EXPECT_TRUE(computed_alike(again.record, run.record(i))) << "frame " << i;
    const MotionResult &a = results[static_cast<std::size_t>(i)].motion, &b = again.motion;
    EXPECT_EQ(a.weight_of_feature, b.weight_of_feature) << "frame " << i;
    EXPECT_EQ(a.mask.empty(), b.mask.empty()) << "frame " << i;
    EXPECT_TRUE(a.mask.empty() || motion_test::same_bytes(a.mask, b.mask)) << "frame " << i;
    EXPECT_EQ(a.note, b.note) << "frame " << i;
    if (a.trace != nullptr && i != PatchySource::kNoDepth) ++judged;
  }
  EXPECT_GE(judged, 4);
}

/// Frames of a pair, read once, under any camera.
class SomeFrames final : public FrameSource {
 public:
  SomeFrames(const FrameSource& source, const Camera& camera) : camera_(camera), name_(source.name()) {
    for (int i = 0; i < source.size(); ++i) frames_.push_back(source.read(i));
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override { return read(index).timestamp; }
  [[nodiscard]] Frame read(int index) const override { return frames_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return none_; }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return told_; }

 private:
  Camera camera_;
  std::string name_;
  std::vector<Frame> frames_;
  Trajectory none_;
  std::vector<std::string> told_;
};

/// Of every method whose constants name the noise of a depth sensor.
TEST(LiteratureOfPairs, AStereoPairsNoiseGoesBeforeASensors) {
  const auto pairs = make_generated_sequence("walking_xyz:stereo", 9, 1);
  const SomeFrames stereo(*pairs, pairs->camera());
  Camera sensor = pairs->camera();
  sensor.baseline_m = 0.0;
  const SomeFrames depth(stereo, sensor);
  int asked = 0;
  for (const MethodInfo& info : methods()) {
    Config usual;
    usual.run.method = info.name;
    const auto hash = [&usual](const FrameSource& source, const std::string& noise) {
      Config config = usual;
      if (!noise.empty()) set_parameter(config, noise);
      return run_hash(run_sequence(source, config).records);
    };
    Config noisy = usual;
    const std::string noise = info.name + ".depth_sigma_per_m2=0.09";
    try {
      set_parameter(noisy, noise);
    } catch (const InputError&) {
      continue;
    }
    ++asked;
    if (info.name == "dai2020") set_parameter(usual, "dai2020.settle_frames=3");
    EXPECT_EQ(hash(stereo, noise), hash(stereo, "")) << info.name;
    EXPECT_NE(hash(depth, noise), hash(depth, "")) << info.name << " takes no heed of it at all";
  }
  EXPECT_GE(asked, 5);
}

INSTANTIATE_TEST_SUITE_P(Methods, Literature,
                         testing::Values("alcantarilla2012", "gao2019", "lin2017", "dai2020", "peng2017",
                                         "wang2014"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace stillpoint
