// Odometry through frames without corners.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/odometry/odometry.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/unit/defocused_source.hpp"

namespace stillpoint {
namespace {

class DirectTracking : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { source_ = std::make_unique<DefocusedSource>("room"); }
  static void TearDownTestSuite() { source_.reset(); }

  static Config config_of(const std::string& method) {
    Config config;
    config.run.method = method;
    return config;
  }
  static int lost(const RunResult& run) {
    return static_cast<int>(
        std::count_if(run.records.begin(), run.records.end(), [](const auto& r) { return !r.estimated; }));
  }
  static int directly(const RunResult& run) {
    return static_cast<int>(std::count_if(run.records.begin(), run.records.end(),
                                          [](const auto& r) { return r.direct.believed; }));
  }
  /// m, the worst of single frames' motions.
  static double worst_step_m(const RunResult& run) {
    double worst = 0.0;
    for (std::size_t i = 1; i < run.records.size(); ++i) {
      const int index = static_cast<int>(i);
      const Pose truth =
          source_->truth(index - 1).world_from_camera->inverse() * *source_->truth(index).world_from_camera;
      const Pose step = run.records[i - 1].world_from_camera.inverse() * run.records[i].world_from_camera;
      worst = std::max(worst, (truth.inverse() * step).translation().norm());
    }
    return worst;
  }

  static std::unique_ptr<DefocusedSource> source_;
};

std::unique_ptr<DefocusedSource> DirectTracking::source_;

TEST_F(DirectTracking, KeepsFramesThatAreLostWithoutIt) {
  for (const char* method : {"stillpoint", "oracle"}) {
    Config without = config_of(method);
    without.direct.below_inliers = 0;
    const RunResult before = run_sequence(*source_, without), now = run_sequence(*source_, config_of(method));
    EXPECT_GE(lost(before), 3) << method;
    EXPECT_EQ(directly(before), 0) << method;
    EXPECT_EQ(lost(now), 0) << method;
    EXPECT_GE(directly(now), lost(before)) << method;
    EXPECT_LT(worst_step_m(now), 0.03) << method;
    int starved = 0;
    for (const FrameRecord& record : now.records) {
      if (record.inliers >= 20 || record.status == FrameStatus::initialised) continue;
      ++starved;
      EXPECT_EQ(record.pose_start, PoseStart::direct) << record.index;
      EXPECT_FALSE(record.keyframe) << record.index;
      EXPECT_EQ(record.new_points, 0) << record.index;
      EXPECT_GT(record.direct.share, 0.5) << record.index;
      ASSERT_NE(record.direct.seen, nullptr);
      EXPECT_EQ(static_cast<int>(record.direct.seen->size()), record.direct.patches);
    }
    EXPECT_GE(starved, 3) << method;
  }
}

TEST_F(DirectTracking, IsNoPartOfThePapersOdometry) {
  for (const char* method : {"paper", "none"}) {
    const RunResult run = run_sequence(*source_, config_of(method));
    EXPECT_EQ(directly(run), 0) << method;
    ASSERT_EQ(run.records.size(), static_cast<std::size_t>(source_->size())) << method;
    for (const FrameRecord& record : run.records) EXPECT_EQ(record.direct.reference_frame, kNone);
  }
}

TEST_F(DirectTracking, ThreadsChangeNothing) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    Config config = config_of("stillpoint");
    config.run.threads = threads;
    hashes.push_back(run_hash(run_sequence(*source_, config).records));
  }
  EXPECT_THAT(hashes, ::testing::Each(hashes.front()));
}

TEST_F(DirectTracking, FramesWithCornersEnoughAreAsWithoutIt) {
  Config without = config_of("stillpoint");
  without.direct.below_inliers = 0;
  const RunResult before = run_sequence(*source_, without),
                  now = run_sequence(*source_, config_of("stillpoint"));
  for (int i = 0; i < DefocusedSource::kFirst; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_TRUE(computed_alike(before.records[index], now.records[index])) << i;
    EXPECT_EQ(now.records[index].direct.reference_frame, kNone) << i;
    EXPECT_EQ(now.records[index].ms.direct, 0.0) << i;
  }
}

TEST_F(DirectTracking, GoesOnFromACopyWhoseImagesWerePutBy) {
  const Config config = config_of("stillpoint");
  Odometry odometry(source_->camera(), config);
  const auto read = [](int i) { return source_->read(i); };
  int compared = 0;
  for (int i = 0; i < source_->size(); ++i) {
    Odometry copy = odometry;
    copy.drop_images();
    copy.restore_images(i, read);
    const FrameRecord record = odometry.process(read(i)).record, again = copy.process(read(i)).record;
    EXPECT_TRUE(computed_alike(record, again)) << i;
    EXPECT_EQ(record.direct.rms_after, again.direct.rms_after) << i;
    EXPECT_EQ(record.direct.patches, again.direct.patches) << i;
    compared += record.direct.believed ? 1 : 0;
  }
  EXPECT_GE(compared, 3);
}

}  // namespace
}  // namespace stillpoint
