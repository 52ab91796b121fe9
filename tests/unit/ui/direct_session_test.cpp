// Frames without corners, in a session: there and back again, and what the stages show of them.
#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "core/inspect/frame_stages.hpp"
#include "core/inspect/stage_change.hpp"
#include "core/run/run_report.hpp"
#include "tests/unit/defocused_source.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

class DirectSession : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { source_ = std::make_shared<const DefocusedSource>("walking_xyz"); }
  static void TearDownTestSuite() { source_.reset(); }
  static std::shared_ptr<const FrameSource> source_;
  static constexpr int kBlurred = DefocusedSource::kFirst + 1;
  Config config_;
};

std::shared_ptr<const FrameSource> DirectSession::source_;

TEST_F(DirectSession, EqualsABatchRunWhicheverWayOneGoes) {
  Session session(source_, config_);
  std::mt19937 random(3);
  for (int step = 0; step < 12; ++step) {
    const int wanted = static_cast<int>(random() % static_cast<unsigned>(source_->size()));
    session.go_to(wanted);
    ASSERT_NE(session.view()->current->record, nullptr);
    EXPECT_TRUE(computed_alike(*session.view()->current->record, session.record(wanted)));
  }
  session.go_to(source_->size() - 1);
  std::vector<FrameRecord> records;
  for (int i = 0; i < source_->size(); ++i) records.push_back(session.record(i));
  EXPECT_TRUE(records[kBlurred].direct.believed);
  EXPECT_EQ(run_hash(records), run_hash(run_sequence(*source_, config_).records));
}

TEST_F(DirectSession, AFrameGoneBackToIsAlignedAsItWas) {
  for (const char* method : {"stillpoint", "oracle"}) {
    config_.run.method = method;
    ReplayableRun track(*source_, config_, {.checkpoint_every = 4});
    const ReplayableRun::ReadFrame read = [](int index) { return source_->read(index); };
    for (int i = 0; i < source_->size(); ++i) (void)track.process_next(read);
    int directly = 0;
    for (int i = source_->size() - 1; i >= 0; --i) {
      const FrameRecord first = track.record(i), again = track.replay(i, read).record;
      EXPECT_TRUE(computed_alike(first, again)) << method << ' ' << i;
      EXPECT_EQ(first.direct.rms_after, again.direct.rms_after) << method << ' ' << i;
      ASSERT_EQ(first.direct.seen == nullptr, again.direct.seen == nullptr);
      if (!first.direct.believed) continue;
      ++directly;
      ASSERT_FALSE(first.direct.seen->empty()) << method << ' ' << i;
      ASSERT_EQ(first.direct.seen->size(), again.direct.seen->size());
      for (std::size_t k = 0; k < first.direct.seen->size(); ++k) {
        EXPECT_EQ((*first.direct.seen)[k].pixel, (*again.direct.seen)[k].pixel);
        EXPECT_EQ((*first.direct.seen)[k].residual, (*again.direct.seen)[k].residual);
      }
    }
    EXPECT_GE(directly, 3) << method;
  }
}

TEST_F(DirectSession, StagesShowItWhereItWasCalledFor) {
  Session session(source_, config_);
  const auto direct_stage = [&](int frame) {
    session.go_to(frame);
    const auto view = session.view();
    for (const Stage& stage : stages_of(*view->current))
      if (stage.id == "direct_refinement") return std::optional(stage);
    return std::optional<Stage>();
  };
  EXPECT_FALSE(direct_stage(kBlurred - 4).has_value());
  const auto stage = direct_stage(kBlurred);
  ASSERT_TRUE(stage.has_value());
  EXPECT_EQ(stage->name, "Direct refinement");
  const auto view = session.view();
  const DirectRecord& direct = view->current->record->direct;
  const cv::Mat& image = stage->sides.at(0).output.image;
  EXPECT_EQ(image.size(), view->current->frame.gray.size());
  // Each patch is a square of its residual; of two that overlap the later one lies on top.
  const DirectPatch& last = direct.seen->back();
  EXPECT_EQ(image.at<float>(cv::Point(cvRound(last.pixel.x), cvRound(last.pixel.y))), last.residual);
  const cv::Mat known = image == image;
  EXPECT_GT(cv::countNonZero(known), 40 * direct.patches);
  EXPECT_LT(cv::countNonZero(known), 82 * direct.patches);
}

}  // namespace
}  // namespace stillpoint
