// Methods of the literature in whole runs: frames that lack depth or cannot be read, and going back to a
// checkpoint.
#include <gtest/gtest.h>

#include "core/inspect/replayable_run.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_hash.hpp"
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

INSTANTIATE_TEST_SUITE_P(Methods, Literature,
                         testing::Values("alcantarilla2012", "gao2019", "lin2017", "dai2020", "peng2017",
                                         "wang2014"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace stillpoint
