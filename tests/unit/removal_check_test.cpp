#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/run/removal_errors.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

Config config_of(const std::string& method, int check) {
  Config config;
  config.run.method = method;
  config.run.check_removal = check;
  config.features.count = 400;
  return config;
}

bool same(const std::optional<Pose>& a, const Pose& b) { return a && a->matrix() == b.matrix(); }

TEST(RemovalCheck, ChangesNoResult) {
  const SmallSequence folder(8);
  const auto source = open_sequence(folder.path());
  for (const char* method : {"none", "paper", "stillpoint"})
    EXPECT_EQ(run_hash(run_sequence(*source, config_of(method, 0)).records),
              run_hash(run_sequence(*source, config_of(method, 1)).records))
        << method;
}

TEST(RemovalCheck, WithoutRemovalItIsWhatMethodNoneFinds) {
  const SmallSequence folder(8);
  const auto run = run_sequence(*open_sequence(folder.path()), config_of("none", 1));
  EXPECT_FALSE(run.records[0].removal_check.nothing_removed.has_value());  // no map yet
  EXPECT_TRUE(run.records[0].pose_covariance.isZero(0.0));
  for (std::size_t i = 1; i < run.records.size(); ++i) {
    EXPECT_TRUE(same(run.records[i].removal_check.nothing_removed, run.records[i].world_from_camera)) << i;
    EXPECT_FALSE(run.records[i].removal_check.truth_removed.has_value()) << i;
  }
}

TEST(RemovalCheck, WithTheTrueMaskItIsWhatTheOracleFinds) {
  const auto source = rendered("walking_static", 12);
  const auto run = run_sequence(*source, config_of("oracle", 1));
  bool differs = false;
  for (std::size_t i = 1; i < run.records.size(); ++i) {
    const FrameRecord& record = run.records[i];
    EXPECT_TRUE(same(record.removal_check.truth_removed, record.world_from_camera)) << i;
    differs = differs || !same(record.removal_check.nothing_removed, record.world_from_camera);
  }
  EXPECT_TRUE(differs);
}

/// A camera that truly goes 10 mm a frame along x. Poses of run and truth are given in mm.
class RemovalErrors : public ::testing::Test {
 protected:
  static Pose at(double x_mm) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 1e-3 * x_mm;
    return pose;
  }
  void add(double estimate_mm, std::optional<double> without_mm, std::optional<double> told_mm = {}) {
    const auto i = static_cast<int>(records_.size());
    FrameRecord record;
    record.index = i;
    record.timestamp = 0.1 * i;
    record.estimated = true;
    record.world_from_camera = at(estimate_mm);
    if (without_mm) record.removal_check.nothing_removed = at(*without_mm);
    if (told_mm) record.removal_check.truth_removed = at(*told_mm);
    records_.push_back(record);
    evaluation_.matched.push_back({.timestamp = record.timestamp, .truth = at(100.0 + 10.0 * i)});
  }
  std::vector<FrameRecord> records_;
  TrajectoryEvaluation evaluation_;
};

TEST_F(RemovalErrors, AreOfTheStepFromThePoseBefore) {
  add(0, std::nullopt);
  add(13, 11, 9.5);  // 3, 1 and 0.5 mm too far or too short
  add(23, 31);       // from 13 mm on: right with removal, 8 mm off without
  const auto errors = removal_errors(records_, evaluation_);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].frame, 1);
  EXPECT_NEAR(errors[0].with_removal_m, 0.003, 1e-12);
  EXPECT_NEAR(errors[0].without_removal_m, 0.001, 1e-12);
  EXPECT_NEAR(errors[0].oracle_m, 0.0005, 1e-12);
  EXPECT_NEAR(errors[1].with_removal_m, 0.0, 1e-12);
  EXPECT_NEAR(errors[1].without_removal_m, 0.008, 1e-12);
  EXPECT_TRUE(std::isnan(errors[1].oracle_m));
}

TEST_F(RemovalErrors, RemovalHurtsOnlyBeyondTheNoiseOfTheRun) {
  add(0, std::nullopt);
  // Removal makes steps 0.1 mm better or worse, by turns.
  for (int i = 1; i <= 20; ++i) add(10.0 * i, 10.0 * i + (i % 2 == 0 ? 0.1 : 0.0));
  add(10.0 * 21 + 5.0, 10.0 * 21);         // 5 mm worse
  add(10.0 * 22 + 5.8, 10.0 * 22 + 5.0);   // 0.8 mm worse: not to be noticed
  add(10.0 * 23 + 5.8, 10.0 * 23 + 10.8);  // right, where 5 mm would be amiss without it
  const auto errors = removal_errors(records_, evaluation_);
  ASSERT_EQ(errors.size(), 23U);
  for (const RemovalError& error : errors) {
    EXPECT_EQ(error.hurt, error.frame == 21) << error.frame;
    EXPECT_EQ(error.helped, error.frame == 23) << error.frame;
  }
}

TEST_F(RemovalErrors, AreNotKnownWithoutTruthOrCheck) {
  add(0, std::nullopt);
  add(10, std::nullopt);
  add(20, 20);
  records_[1].estimated = false;
  EXPECT_TRUE(removal_errors(records_, evaluation_).empty());
  records_[1].estimated = true;
  EXPECT_EQ(removal_errors(records_, evaluation_).size(), 1U);
  evaluation_.matched.pop_back();
  EXPECT_TRUE(removal_errors(records_, evaluation_).empty());
}

}  // namespace
}  // namespace stillpoint
