// Alignments, time offsets and other people's protocols against figures computed another way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/core.hpp>

#include "core/evaluation/evaluation_json.hpp"
#include "core/evaluation/time_offset.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/run/estimate_file.hpp"
#include "tests/support/archive_writer.hpp"
#include "tests/support/places.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A hand-held path of 10 s, 30 poses a second.
Pose hand_at(double t) {
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp({0.3 * std::sin(1.1 * t), 0.2 * std::cos(0.7 * t), 0.1 * t});
  pose.translation() =
      Eigen::Vector3d(std::sin(1.3 * t), 0.5 * std::sin(2.1 * t + 1), 0.3 * std::cos(0.9 * t));
  return pose;
}
Trajectory hand(double rate = 30.0, double origin_s = 0.0) {
  Trajectory trajectory;
  for (int i = 0; i < static_cast<int>(10 * rate); ++i)
    trajectory.push_back({i / rate + origin_s, hand_at(i / rate)});
  return trajectory;
}

/// The same path as somebody estimated it: scaled, in another world, with errors that repeat.
Trajectory estimated(double scale = 0.8) {
  Pose world = Pose::Identity();
  world.linear() = so3_exp({0.4, -1.0, 0.2});
  world.translation() = Eigen::Vector3d(3, -2, 1);
  Trajectory trajectory = hand();
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    Pose& pose = trajectory[i].world_from_camera;
    const auto phase = static_cast<double>(i);
    pose.translation() +=
        0.02 * Eigen::Vector3d(std::sin(7.0 * phase), std::cos(3.0 * phase), std::sin(phase));
    pose.linear() = pose.linear() * so3_exp({0.01 * std::sin(phase), 0.0, 0.01 * std::cos(2.0 * phase)});
    pose = world * pose;
    pose.translation() *= scale;
  }
  return trajectory;
}

/// RMSE after Horn's quaternion alignment (1987), which shares nothing with Umeyama's decomposition. With
/// scale, his asymmetric one: what minimises the error in the truth's world.
double horn_rmse(const std::vector<MatchedPose>& matched, std::size_t first, bool with_scale) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  for (std::size_t i = 0; i < first; ++i)
    from += matched[i].estimate.translation(), to += matched[i].truth.translation();
  from /= static_cast<double>(first), to /= static_cast<double>(first);
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < first; ++i) {
    const Eigen::Vector3d a = matched[i].estimate.translation() - from,
                          b = matched[i].truth.translation() - to;
    m += a * b.transpose();
    spread += a.squaredNorm();
  }
  // By OpenCV's decomposition: Eigen's takes many seconds to compile.
  const cv::Matx44d n(
      m.trace(), m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0),                    //
      m(1, 2) - m(2, 1), m(0, 0) - m(1, 1) - m(2, 2), m(0, 1) + m(1, 0), m(2, 0) + m(0, 2),  //
      m(2, 0) - m(0, 2), m(0, 1) + m(1, 0), m(1, 1) - m(0, 0) - m(2, 2), m(1, 2) + m(2, 1),  //
      m(0, 1) - m(1, 0), m(2, 0) + m(0, 2), m(1, 2) + m(2, 1), m(2, 2) - m(0, 0) - m(1, 1));
  cv::Matx41d values;
  cv::Matx44d vectors;  // in rows, the largest value's first
  cv::eigen(n, values, vectors);
  const cv::Matx14d q = vectors.row(0);
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).toRotationMatrix();
  const double scale = with_scale ? (rotation * m).trace() / spread : 1.0;
  double squares = 0;
  for (const MatchedPose& pose : matched)
    squares += (scale * (rotation * (pose.estimate.translation() - from)) + to - pose.truth.translation())
                   .squaredNorm();
  return std::sqrt(squares / static_cast<double>(matched.size()));
}

double ate(const Trajectory& truth, const Trajectory& estimate, AlignBy align, int first = 0) {
  EvaluationOptions options;
  options.align = align;
  options.align_first = first;
  return evaluate_trajectory(truth, estimate, options).ate.translation_m.rmse;
}

TEST(Alignments, AgreeWithHorn) {
  const Trajectory truth = hand(), estimate = estimated();
  const auto matched = match_trajectories(truth, estimate);
  ASSERT_EQ(matched.size(), 300U);
  EXPECT_NEAR(ate(truth, estimate, AlignBy::rigid), horn_rmse(matched, 300, false), 1e-9);
  EXPECT_NEAR(ate(truth, estimate, AlignBy::similarity), horn_rmse(matched, 300, true), 1e-9);
  EXPECT_NEAR(ate(truth, estimate, AlignBy::first, 50), horn_rmse(matched, 50, false), 1e-9);
  EXPECT_LT(ate(truth, estimate, AlignBy::similarity), 0.05);
  EXPECT_GT(ate(truth, estimate, AlignBy::rigid), 0.1);
}

TEST(Alignments, ByTheOriginAndNotAtAll) {
  const Trajectory truth = hand(), estimate = estimated();
  double by_origin = 0, not_at_all = 0;
  const Pose onto = truth[0].world_from_camera * estimate[0].world_from_camera.inverse();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d there = truth[i].world_from_camera.translation();
    by_origin += (onto * estimate[i].world_from_camera.translation() - there).squaredNorm();
    not_at_all += (estimate[i].world_from_camera.translation() - there).squaredNorm();
  }
  EXPECT_NEAR(ate(truth, estimate, AlignBy::origin), std::sqrt(by_origin / 300), 1e-9);
  EXPECT_NEAR(ate(truth, estimate, AlignBy::nothing), std::sqrt(not_at_all / 300), 1e-9);
  // One pose is enough for these.
  EXPECT_NEAR(ate(truth, {estimate[3]}, AlignBy::origin), 0.0, 1e-12);
}

TEST(Alignments, ScaleIsTold) {
  EvaluationOptions options;
  options.align = AlignBy::similarity;
  const auto e = evaluate_trajectory(hand(), estimated(0.8), options);
  EXPECT_NEAR(e.applied_scale, 1.25, 0.003);  // the errors have a share in it
  EXPECT_THAT(to_text(e, options), HasSubstr("lengths were multiplied by 1.2"));
  // Not applied, it is told all the same.
  EXPECT_THAT(to_text(evaluate_trajectory(hand(), estimated(0.8))), HasSubstr("would fit best"));
}

TEST(TimeOffsets, AreFound) {
  const Trajectory truth = hand(100.0);
  for (const double offset : {0.0, 0.0137, -0.25, 0.4999}) {
    const auto found = estimate_time_offset(truth, hand(30.0, -offset));
    ASSERT_TRUE(found) << offset;
    // Linear interpolation between 10 ms steps is what is left of an error.
    EXPECT_NEAR(found->offset_s, offset, 1e-4) << offset;
    EXPECT_LT(found->rmse_after_m, 1e-4);
  }
}

TEST(TimeOffsets, OfTheTruthsOwnPosesToAMicrosecond) {
  // Halfway between its stamps the interpolated path itself is the estimate: nothing is left over.
  const Trajectory truth = hand(30.0);
  Trajectory estimate;
  for (double t = 1.0; t < 8.0; t += 0.05) estimate.push_back({t + 0.0437, *interpolate(truth, t, 0.1)});
  const auto found = estimate_time_offset(truth, estimate);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset_s, -0.0437, 1e-6);
}

TEST(TimeOffsets, OfAShortPathWithErrorsAreNotGuessed) {
  // A second of it, of which the estimate misses the first half by centimetres: laid half a second away it
  // would be measured by its good half alone.
  Trajectory truth, estimate;
  for (const StampedPose& pose : hand(100.0))
    if (pose.timestamp <= 1.0) truth.push_back(pose);
  for (const StampedPose& pose : hand(30.0))
    if (pose.timestamp <= 1.0) estimate.push_back(pose);
  for (std::size_t i = 0; i < estimate.size() / 2; ++i)
    estimate[i].world_from_camera.translation().x() += i % 2 == 0 ? 0.05 : -0.05;
  EXPECT_FALSE(estimate_time_offset(truth, estimate));
}

TEST(TimeOffsets, OfAStillCameraAreNotGuessed) {
  Trajectory still = hand();
  for (StampedPose& pose : still) pose.world_from_camera = Pose::Identity();
  EXPECT_FALSE(estimate_time_offset(still, still));
  EXPECT_FALSE(estimate_time_offset(hand(), hand(30.0, 100.0)));
}

TEST(RelativeErrors, OverFramesAndMetres) {
  // Straight on at 1 m/s, measured 10 % long.
  Trajectory truth, estimate;
  for (int i = 0; i <= 100; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.1 * i;
    truth.push_back({0.1 * i, pose});
    pose.translation().x() *= 1.1;
    estimate.push_back({0.1 * i, pose});
  }
  EvaluationOptions options;
  options.deltas = {rpe_delta_of("20f"), rpe_delta_of("5m"), rpe_delta_of("3s")};
  options.lengths_m = {1.0, 100.0};
  const auto e = evaluate_trajectory(truth, estimate, options);
  ASSERT_EQ(e.rpe_more.size(), 3U);
  EXPECT_EQ(e.rpe_more[0].delta, "20 frames");
  EXPECT_EQ(e.rpe_more[0].translation_m.count, 81);
  EXPECT_NEAR(e.rpe_more[0].translation_m.rmse, 0.2, 1e-12);
  EXPECT_NEAR(e.rpe_more[1].translation_m.median, 0.5, 0.0101);  // a step's rounding may add 0.1 m to the way
  EXPECT_EQ(e.rpe_more[2].delta, "3 s");
  EXPECT_NEAR(e.rpe_more[2].translation_m.max, 0.3, 1e-9);
  EXPECT_EQ(e.by_length[1].translation_m.count, 0);
  EXPECT_EQ(e.by_length[1].why_none, "the truth's matched path is 10 m long");
  const std::string text = to_text(e, options);
  EXPECT_THAT(text, HasSubstr("Parts of the path by length"));
  EXPECT_THAT(text, testing::ContainsRegex("1 m +9[01] +0.1"));
}

TEST(RelativeErrors, DeltasAreReadStrictly) {
  EXPECT_EQ(rpe_delta_of("2.5s").text(), "2.5 s");
  for (const char* wrong : {"", "1", "s", "0f", "1.5f", "-1m", "infm", "1 s", "3km"})
    EXPECT_THAT(input_error_of([&] { (void)rpe_delta_of(wrong); }), HasSubstr("is no distance of poses"))
        << wrong;
}

TEST(Statistics, QuartilesLieBetweenNeighbours) {
  const ErrorStatistics s = statistics_of({4.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(s.lower_quartile, 1.75);
  EXPECT_DOUBLE_EQ(s.upper_quartile, 3.25);
}

TEST(Protocols, EvoTakesTheNearestOfTheLonger) {
  // Two estimates near one truth: both are taken, as one may be used twice.
  Trajectory truth = hand(10.0);
  Trajectory estimate = {truth[5], truth[5], truth[7]};
  estimate[0].timestamp -= 0.004, estimate[1].timestamp += 0.006;
  estimate[2].timestamp += 0.02;
  EvaluationOptions evo;
  use_protocol(Protocol::evo, evo);
  EXPECT_EQ(evaluate_trajectory(truth, estimate, evo).matched.size(), 2U);
  EXPECT_EQ(evaluate_trajectory(truth, estimate).matched.size(), 1U);
  EXPECT_THAT(to_text(evaluate_trajectory(truth, estimate, evo), evo), HasSubstr("Protocol  evo's"));
}

TEST(Protocols, TheBenchmarksPairsOfFewPosesAreAll) {
  const Trajectory truth = hand(9.0), estimate = [] {
    Trajectory trajectory = hand(9.0);
    for (std::size_t i = 0; i < trajectory.size(); ++i)
      trajectory[i].world_from_camera.translation().x() += 0.01 * static_cast<double>(i % 3);
    return trajectory;
  }();
  ASSERT_EQ(truth.size(), 90U);
  double squares = 0;
  for (const StampedPose& i : estimate)
    for (const StampedPose& j : estimate) {
      const auto true_at = [](double t) { return hand_at(t); };
      const Pose e = (j.world_from_camera.inverse() * i.world_from_camera).inverse() *
                     (true_at(j.timestamp).inverse() * true_at(i.timestamp));
      squares += e.translation().squaredNorm();
    }
  const RelativePoseError found = relative_error_of_random_pairs(truth, estimate);
  EXPECT_EQ(found.translation_m.count, 8100);
  EXPECT_NEAR(found.translation_m.rmse, std::sqrt(squares / 8100), 1e-9);
}

/// Figures of a Python script that does what the others' programs do, on real trajectories.
TEST(Protocols, AgreeWithTheOthersOnRealTrajectories) {
  const std::string data = places::source() + "/../shared/data/trajectories/fr3_walking_xyz_";
  if (!std::filesystem::exists(data + "groundtruth.txt"))
    GTEST_SKIP() << "the real trajectories are not here";
  struct Golden {
    const char* name;
    int pairs;
    double tum_rmse, tum_mean, tum_median, tum_deg, ape, rpe;
  };
  const Trajectory truth = read_tum_trajectory(data + "groundtruth.txt");
  for (const Golden& g : {Golden{"a", 10000, 0.022786807662925, 0.020204950959585, 0.018426133771432,
                                 0.522183303291403, 3.342849248355505, 0.011896444458285},
                          Golden{"b", 9983, 0.046341975770973, 0.040490312475345, 0.036299725509094,
                                 0.655737904071971, 3.334766229754600, 0.012739603921232}}) {
    const Trajectory estimate = read_tum_trajectory(data + "estimate_" + g.name + ".txt");
    const RelativePoseError tum = relative_error_of_random_pairs(truth, estimate);
    EXPECT_EQ(tum.translation_m.count, g.pairs);
    EXPECT_NEAR(tum.translation_m.rmse, g.tum_rmse, 1e-6);
    EXPECT_NEAR(tum.translation_m.mean, g.tum_mean, 1e-6);
    EXPECT_NEAR(tum.translation_m.median, g.tum_median, 1e-6);
    EXPECT_NEAR(tum.rotation_deg.mean, g.tum_deg, 1e-6);
    EvaluationOptions evo;
    use_protocol(Protocol::evo, evo);
    const auto e = evaluate_trajectory(truth, estimate, evo);
    EXPECT_EQ(e.matched.size(), 826U);
    EXPECT_NEAR(e.ate.translation_m.rmse, g.ape, 1e-6);
    EXPECT_NEAR(e.rpe_frame.translation_m.rmse, g.rpe, 1e-6);
  }
}

TEST(EstimateFiles, OfReplicaAndEvo) {
  const TemporaryFolder folder;
  folder.write("replica.txt",
               std::string("1 0 0 0.5 0 1 0 0 0 0 1 0 0 0 0 1\n1 0 0 0.75 0 1 0 0 0 0 1 0 0 0 0 1\n"));
  const TrajectoryFile replica = read_estimate_file(folder.path("replica.txt"));
  ASSERT_EQ(replica.poses.size(), 2U);
  EXPECT_FALSE(replica.has_stamps);
  EXPECT_EQ(replica.poses[1].world_from_camera.translation().x(), 0.75);
  folder.write("evo/info.json", std::string(R"({"ref_name": "gt.txt", "est_name": "runs/orb.txt"})"));
  folder.write("evo/gt.txt.tum", std::string("0 9 0 0 0 0 0 1\n"));
  folder.write("evo/orb.txt.tum", std::string("0 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n"));
  write_archive(folder.path("evo.zip"), folder.path("evo"), "zip", "");
  const TrajectoryFile evo = read_estimate_file(folder.path("evo.zip"));
  ASSERT_EQ(evo.poses.size(), 2U);
  EXPECT_EQ(evo.poses[1].world_from_camera.translation().x(), 2.0);
  folder.write("evo/info.json", std::string(R"({"est_name": 7})"));
  write_archive(folder.path("seven.zip"), folder.path("evo"), "zip", "");
  EXPECT_THAT(input_error_of([&] { (void)read_estimate_file(folder.path("seven.zip")); }),
              HasSubstr("does not say which is the estimate"));
  folder.write("two/a.tum", std::string("0 9 0 0 0 0 0 1\n"));
  folder.write("two/b.tum", std::string("0 9 0 0 0 0 0 1\n"));
  write_archive(folder.path("two.zip"), folder.path("two"), "zip", "");
  EXPECT_THAT(input_error_of([&] { (void)read_estimate_file(folder.path("two.zip")); }),
              HasSubstr("holds 2 trajectories and does not say which is the estimate"));
}

}  // namespace
}  // namespace stillpoint
