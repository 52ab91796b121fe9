#include "core/evaluation/suspicion.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/evaluation/doubts.hpp"

namespace stillpoint {
namespace {

using testing::HasSubstr;

/// A camera that goes and turns about all axes, 30 poses a second, with an estimate that errs by some
/// millimetres.
std::vector<MatchedPose> sound(int poses = 90) {
  std::vector<MatchedPose> matched;
  for (int i = 0; i < poses; ++i) {
    const double t = i / 30.0;
    MatchedPose pose;
    pose.timestamp = pose.truth_timestamp = t;
    pose.truth.linear() =
        so3_exp({0.3 * std::sin(1.3 * t), 0.4 * std::sin(0.9 * t + 1), 0.3 * std::sin(1.1 * t + 2)});
    pose.truth.translation() = Eigen::Vector3d(0.8 * std::cos(0.7 * t), 0.8 * std::sin(0.7 * t), 0.3 * t);
    pose.estimate = pose.truth;
    pose.estimate.translation().x() += 0.003 * std::sin(5.0 * t);
    matched.push_back(pose);
  }
  const Pose start = matched[0].estimate.inverse();
  for (MatchedPose& pose : matched) pose.estimate = start * pose.estimate;
  return matched;
}

TEST(Conventions, AreTheirOwnInversesWhereTheyShouldBe) {
  const Pose pose = sound()[40].truth;
  for (const PoseConvention c :
       {PoseConvention::inverse, PoseConvention::mirrored_x, PoseConvention::mirrored_y,
        PoseConvention::mirrored_z, PoseConvention::opengl}) {
    const Pose twice = camera_pose(camera_pose(pose, c), c);
    EXPECT_LT((twice.matrix() - pose.matrix()).norm(), 1e-12) << to_string(c);
    EXPECT_GT((camera_pose(pose, c).matrix() - pose.matrix()).norm(), 0.01) << to_string(c);
    EXPECT_NEAR(camera_pose(pose, c).linear().determinant(), 1.0, 1e-12);
  }
  for (const PoseConvention c : other_conventions()) EXPECT_EQ(convention_by_name(to_string(c)), c);
  EXPECT_FALSE(convention_by_name("upside-down"));
}

TEST(Conventions, BonnsMarkerIsTurnedByAHundredAndSeventyThreeDegrees) {
  const Pose camera = camera_pose(Pose::Identity(), PoseConvention::bonn);
  // The body turns by T_ROS T_m; here, T_m alone is left of the camera's pose.
  Eigen::Matrix3d ros;
  ros << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  EXPECT_NEAR(camera.linear().determinant(), 1.0, 1e-12);
  EXPECT_NEAR(rotation_angle(ros * camera.linear()) * 180 / std::numbers::pi, 172.7, 0.2);
}

TEST(Suspicion, NothingIsSaidOfSoundPoses) {
  EXPECT_FALSE(suspect_convention(sound(), true));
  auto noisy = sound();
  for (std::size_t i = 0; i < noisy.size(); ++i)
    noisy[i].estimate.translation().z() += 0.05 * std::sin(0.37 * static_cast<double>(i));
  EXPECT_FALSE(suspect_convention(noisy, true));
  EXPECT_FALSE(suspect_convention({}, true));
  EXPECT_FALSE(suspect_convention(sound(3), true));
}

class Misread : public testing::TestWithParam<PoseConvention> {};

/// What a reader of TUM's format makes of a pose that was written in the convention.
Pose misread(const Pose& pose, PoseConvention convention) {
  if (convention != PoseConvention::w_first) return camera_pose(pose, convention);
  const Eigen::Quaterniond q(pose.linear());
  Pose read = pose;
  read.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
  return read;
}

TEST_P(Misread, TruthIsNamedWithItsSwitch) {
  auto matched = sound();
  for (MatchedPose& pose : matched) pose.truth = misread(pose.truth, GetParam());
  const auto suspicion = suspect_convention(matched, false);
  ASSERT_TRUE(suspicion);
  EXPECT_EQ(suspicion->convention, GetParam());
  EXPECT_LT(suspicion->mended.translation_m, 0.02);
  EXPECT_LT(suspicion->mended.rotation_deg, 0.01);
  EXPECT_THAT(suspicion->sentence(), HasSubstr(fmt::format("`--truth {}`", to_string(GetParam()))));
}

TEST_P(Misread, EstimateIsNamedWithItsSwitch) {
  auto matched = sound();
  for (MatchedPose& pose : matched) pose.estimate = misread(pose.estimate, GetParam());
  const auto suspicion = suspect_convention(matched, true);
  ASSERT_TRUE(suspicion);
  EXPECT_EQ(suspicion->convention, GetParam());
  EXPECT_LT(suspicion->mended.combined_m(), 0.02);
  EXPECT_THAT(suspicion->sentence(), HasSubstr(fmt::format("`--estimate {}` reads", to_string(GetParam()))));
}

TEST_P(Misread, EstimateIsNamedWhateverItsScale) {
  for (const double scale : {30.0, 0.03}) {
    auto matched = sound();
    for (MatchedPose& pose : matched) {
      pose.estimate = misread(pose.estimate, GetParam());
      pose.estimate.translation() *= scale;
    }
    const auto suspicion = suspect_convention(matched, true);
    ASSERT_TRUE(suspicion) << scale;
    EXPECT_EQ(suspicion->convention, GetParam());
    EXPECT_NEAR(suspicion->mended.scale * scale, 1.0, 0.01);
    EXPECT_THAT(suspicion->sentence(),
                HasSubstr(fmt::format("lengths are multiplied by {:.3g}", suspicion->mended.scale)));
    EXPECT_FALSE(suspect_convention(matched, false)) << "our own lengths are depth's";
  }
}

INSTANTIATE_TEST_SUITE_P(Suspicion, Misread,
                         testing::Values(PoseConvention::inverse, PoseConvention::w_first,
                                         PoseConvention::mirrored_x, PoseConvention::mirrored_y,
                                         PoseConvention::mirrored_z, PoseConvention::opengl),
                         [](const auto& tested) {
                           std::string name(to_string(tested.param));
                           std::erase(name, '-');
                           return name;
                         });

TEST(Suspicion, ABodyThatCarriesTheCameraIsFoundWithItsTurn) {
  auto matched = sound();
  Pose camera_from_body = Pose::Identity();
  camera_from_body.linear() =
      so3_exp(Eigen::Vector3d(0.2, 2.9, -0.4).normalized() * (173.0 / 180 * std::numbers::pi));
  camera_from_body.translation() = Eigen::Vector3d(0.1, -0.05, 0.2);
  for (MatchedPose& pose : matched) pose.truth = pose.truth * camera_from_body;
  const auto suspicion = suspect_convention(matched, false);
  ASSERT_TRUE(suspicion);
  ASSERT_TRUE(suspicion->body_from_camera);
  EXPECT_NEAR(rotation_angle(suspicion->body_from_camera->linear()) * 180 / std::numbers::pi, 173.0, 0.2);
  EXPECT_NEAR(suspicion->body_from_camera->translation().norm(), camera_from_body.translation().norm(), 0.02);
  EXPECT_THAT(suspicion->sentence(), HasSubstr("173.0 deg"));
}

/// sound(), whose estimate is of a body that carries the camera.
std::vector<MatchedPose> carried_poses(double turned_deg) {
  auto matched = sound();
  Pose camera_from_body = Pose::Identity();
  camera_from_body.linear() =
      so3_exp(Eigen::Vector3d(0.2, 2.9, -0.4).normalized() * (turned_deg / 180 * std::numbers::pi));
  camera_from_body.translation() = Eigen::Vector3d(0.1, -0.05, 0.2);
  for (MatchedPose& pose : matched) pose.estimate = pose.estimate * camera_from_body;
  return matched;
}

TEST(Suspicion, ABodyMayBeTheEstimatesWhateverItsScale) {
  for (const double scale : {1.0, 10.0}) {
    auto matched = carried_poses(120);
    for (MatchedPose& pose : matched) pose.estimate.translation() *= scale;
    const auto suspicion = suspect_convention(matched, true);
    ASSERT_TRUE(suspicion) << scale;
    EXPECT_EQ(suspicion->of, Suspicion::Of::either);
    EXPECT_NEAR(suspicion->mended.scale * scale, 1.0, 0.01);
    EXPECT_THAT(suspicion->sentence(), HasSubstr("ground truth and estimate seem to follow two bodies"));
    EXPECT_THAT(suspicion->sentence(), HasSubstr("turned 120.0 deg"));
  }
}

std::vector<std::string> doubts_of(const std::vector<MatchedPose>& matched, AlignBy align = AlignBy::rigid) {
  Trajectory truth, estimate;
  for (const MatchedPose& pose : matched) {
    truth.push_back({pose.timestamp, pose.truth});
    estimate.push_back({pose.timestamp, pose.estimate});
  }
  EvaluationOptions options;
  options.align = align;
  std::vector<std::string> sentences;
  for (const Doubt& doubt :
       doubts_about(truth, estimate, evaluate_trajectory(truth, estimate, options), align, "evaluate "))
    sentences.push_back(doubt.sentence);
  return sentences;
}

TEST(Doubts, AreNoneOfSoundPosesAndElseWhatIsWrong) {
  using testing::ElementsAre;
  using testing::IsEmpty;
  EXPECT_THAT(doubts_of(sound()), IsEmpty());
  EXPECT_THAT(doubts_of(sound(), AlignBy::origin), IsEmpty());
  auto small = sound();
  for (MatchedPose& pose : small) pose.estimate.translation() *= 0.2;
  EXPECT_THAT(doubts_of(small), ElementsAre(HasSubstr("multiplied by 5.0")));
  EXPECT_THAT(doubts_of(small), ElementsAre(HasSubstr("(`evaluate --align sim3` does so)")));
  EXPECT_THAT(doubts_of(small, AlignBy::similarity), IsEmpty());
  // Over two thirds of a second no body can be found, and what is turned is seen all the same.
  auto turned = carried_poses(120);
  turned.resize(40);
  EXPECT_THAT(doubts_of(turned), testing::Contains(HasSubstr("all orientations are off by 119.0 deg")));
  auto at_random = sound();
  for (std::size_t i = 0; i < at_random.size(); ++i) {
    const auto t = static_cast<double>(i);
    at_random[i].estimate = Pose::Identity();
    at_random[i].estimate.translation() = Eigen::Vector3d(std::sin(t), std::cos(1.7 * t), std::sin(2.3 * t));
  }
  EXPECT_THAT(doubts_of(at_random), ElementsAre(HasSubstr("it tells next to nothing of the path")));
}

TEST(Doubts, AScaleThatChangesOnTheWayIsTold) {
  auto matched = sound(180);
  EXPECT_EQ(scale_drift_sentence(matched), "");
  for (MatchedPose& pose : matched) pose.estimate.translation() *= 0.5;
  EXPECT_EQ(scale_drift_sentence(matched), "") << "one scale for all of it";
  Eigen::Vector3d at = Eigen::Vector3d::Zero(), last = at;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const Eigen::Vector3d step = matched[i].estimate.translation() - last;
    last = matched[i].estimate.translation();
    at += step * (1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(matched.size()));
    matched[i].estimate.translation() = at;
  }
  EXPECT_THAT(doubts_of(matched), testing::Contains(HasSubstr("scale changes on the way")));
}

/// A camera that goes straight on, a few millimetres beside a line, by an estimate that misses by `missing_m`
/// and whose world is turned about that line.
std::vector<MatchedPose> along_a_line(double missing_m, double turned_deg) {
  std::vector<MatchedPose> matched;
  for (int i = 0; i < 60; ++i) {
    const double t = i / 30.0;
    MatchedPose pose;
    pose.timestamp = pose.truth_timestamp = t;
    pose.truth.translation() = Eigen::Vector3d(t, 0.014 * std::sin(3 * t), 0.0);
    pose.estimate = pose.truth;
    pose.estimate.translation().z() += missing_m * std::sqrt(2.0) * std::sin(3 * t);
    pose.estimate.linear() = so3_exp({turned_deg / 180 * std::numbers::pi, 0, 0});
    matched.push_back(pose);
  }
  return matched;
}

TEST(OpenRotation, IsToldWhereTheMissExplainsTheAngle) {
  const auto told = [](const std::vector<MatchedPose>& matched, double scale = 1.0) {
    Trajectory truth, estimate;
    for (const MatchedPose& pose : matched) {
      truth.push_back({pose.timestamp, pose.truth});
      estimate.push_back({pose.timestamp, pose.estimate});
      estimate.back().world_from_camera.translation() *= scale;
    }
    return open_rotation_sentence(evaluate_trajectory(truth, estimate));
  };
  EXPECT_THAT(told(along_a_line(0.03, 0)), HasSubstr("they do not tell the rotation about it"));
  EXPECT_EQ(told(along_a_line(0.0, 0)), "");
  EXPECT_EQ(told(along_a_line(0.0, 178)), "") << "the axes are wrong, and the positions say so";
  EXPECT_EQ(told(along_a_line(0.0, 178), 30.0), "") << "… whatever the scale";
}

/// A camera that is waved to and fro with a period of 2.6 s while it is carried on, 30 poses a second.
Pose waved(double t) {
  const double phase = 2 * std::numbers::pi * t / 2.6;
  Pose pose;
  pose.linear() = so3_exp({0.05 * std::sin(phase), 0.08 * std::sin(0.9 * t), 0.03 * std::sin(1.7 * t)});
  pose.translation() = Eigen::Vector3d(0.2 * std::sin(phase), 0.05 * std::sin(1.9 * t), 0.02 * t);
  return pose;
}

/// Waved about for so many seconds, by an estimate whose clock is late.
std::pair<Trajectory, Trajectory> waved_about(double seconds, double late_s) {
  Trajectory truth, estimate;
  for (int i = 0; i < static_cast<int>(30 * seconds); ++i) {
    truth.push_back({i / 30.0, waved(i / 30.0)});
    estimate.push_back({i / 30.0 + late_s, waved(i / 30.0)});
  }
  return {truth, estimate};
}

TEST(Suspicion, NoConventionIsBlamedForAClockHalfAPeriodOff) {
  const auto [truth, estimate] = waved_about(9, 1.3);
  const auto matched = match_trajectories(truth, estimate);
  ASSERT_GT(matched.size(), 200U);
  // Read the wrong way round the motions do fit better, and still not at all.
  auto reversed = matched;
  for (MatchedPose& pose : reversed) pose.estimate = pose.estimate.inverse();
  ASSERT_LT(motion_fit(reversed).combined_m(), 0.4 * motion_fit(matched).combined_m());
  EXPECT_FALSE(suspect_convention(matched, true)) << suspect_convention(matched, true)->sentence();
}

TEST(Clock, IsToldWhereItExplainsTheError) {
  const auto told = [](double late_s, double noise_m = 0.0) {
    auto [truth, estimate] = waved_about(9, late_s);
    for (std::size_t i = 0; i < estimate.size(); ++i)
      estimate[i].world_from_camera.translation().z() += noise_m * std::sin(0.37 * static_cast<double>(i));
    return clock_sentence(truth, estimate, evaluate_trajectory(truth, estimate, {}));
  };
  EXPECT_THAT(told(0.05), HasSubstr("when -0.050 s are added to its stamps"));
  EXPECT_THAT(told(-0.2), HasSubstr("when +0.200 s are added to its stamps"));
  EXPECT_EQ(told(0.0), "");
  EXPECT_EQ(told(0.003), "");
  EXPECT_EQ(told(0.0, 0.05), "");
  EXPECT_EQ(told(0.02, 0.05), "") << "most of the error is not the clock's";
  EXPECT_EQ(clock_sentence({}, {}, {}), "");
}

TEST(HeldPoses, AreToldWhereTheTruthGoesOn) {
  auto matched = sound();
  EXPECT_EQ(held_pose_sentence(matched), "");
  for (std::size_t i = 40; i < 52; ++i) matched[i].estimate = Pose::Identity();
  // Eleven repeat the one before; pose 40 was the first to be none.
  EXPECT_THAT(held_pose_sentence(matched), HasSubstr("11 of its poses"));
  EXPECT_THAT(held_pose_sentence(matched), HasSubstr("(1.367 s to 1.700 s)"));
  for (std::size_t i = 40; i < 52; ++i) matched[i].truth = matched[40].truth;
  EXPECT_EQ(held_pose_sentence(matched), "") << "a camera that stands still may repeat its pose";
}

TEST(Scale, IsToldWhereItExplainsTheError) {
  Trajectory truth, estimate;
  for (const MatchedPose& pose : sound()) {
    truth.push_back({pose.timestamp, pose.truth});
    estimate.push_back({pose.timestamp, pose.estimate});
    estimate.back().world_from_camera.translation() *= 0.4;
  }
  auto evaluation = evaluate_trajectory(truth, estimate);
  ASSERT_TRUE(evaluation.ate.similarity);
  EXPECT_NEAR(evaluation.ate.similarity->scale, 2.5, 0.01);
  EXPECT_LT(evaluation.ate.similarity->rmse_m, 0.004);
  EXPECT_GT(evaluation.ate.translation_m.rmse, 0.1);
  EXPECT_THAT(scale_sentence(evaluation), HasSubstr("multiplied by 2.5"));
  EXPECT_EQ(scale_question(evaluation, 0.0), "is the depth scale right?");
  EXPECT_EQ(scale_question(evaluation, 0.048),
            "is the pair's baseline right? It is 0.048 m, and 0.12 m would fit");
  EvaluationOptions options;
  options.align = AlignBy::similarity;
  evaluation = evaluate_trajectory(truth, estimate, options);
  EXPECT_NEAR(evaluation.applied_scale, 2.5, 0.01);
  EXPECT_LT(evaluation.ate.translation_m.rmse, 0.004);
  EXPECT_THAT(to_text(evaluation, options), HasSubstr("multiplied by 2.5"));
  EXPECT_EQ(scale_sentence(evaluate_trajectory(truth, truth)), "");
}

TEST(Scale, IsNotSaidOfPosesThatHaveNothingToDoWithTheTruth) {
  Trajectory truth, estimate;
  for (const MatchedPose& pose : sound()) {
    truth.push_back({pose.timestamp, pose.truth});
    estimate.push_back({pose.timestamp, Pose::Identity()});
    estimate.back().world_from_camera.translation() =
        Eigen::Vector3d(5 * std::sin(9 * pose.timestamp), 4 * std::cos(11 * pose.timestamp),
                        3 * std::sin(7 * pose.timestamp));
  }
  const auto evaluation = evaluate_trajectory(truth, estimate);
  ASSERT_TRUE(evaluation.ate.similarity);
  EXPECT_LT(evaluation.ate.similarity->rmse_m, 0.5 * evaluation.ate.translation_m.rmse)
      << "shrinking helps …";
  EXPECT_EQ(scale_sentence(evaluation), "") << "… and means nothing";
}

TEST(TrajectoryMetrics, NothingToMeasureIsADashAndAReason) {
  Trajectory truth;
  for (const MatchedPose& pose : sound()) truth.push_back({pose.timestamp, pose.truth});
  const Trajectory one(truth.begin(), truth.begin() + 1), short_one(truth.begin(), truth.begin() + 16);
  const auto alone = evaluate_trajectory(truth, one);
  EXPECT_FALSE(alone.has_figures());
  EXPECT_EQ(alone.ate.translation_m.count, 0);
  EXPECT_THAT(alone.ate.why_none, HasSubstr("1 matched pose"));
  EXPECT_EQ(to_text(alone).find("0.00000"), std::string::npos) << to_text(alone);
  const auto half = evaluate_trajectory(truth, short_one);
  EXPECT_TRUE(half.has_figures());
  EXPECT_EQ(half.rpe_time.why_none, "no two matched poses are 1 s apart");
  EXPECT_THAT(to_text(half), HasSubstr("span 0.500 s of the truth's 2.967 s (16.9 %)"));
}

TEST(TrajectoryMetrics, FewerPosesThanAreToBeAlignedByAreTold) {
  Trajectory truth;
  for (const MatchedPose& pose : sound()) truth.push_back({pose.timestamp, pose.truth});
  EvaluationOptions options;
  options.align = AlignBy::first;
  options.align_first = 90;
  EXPECT_THAT(to_text(evaluate_trajectory(truth, truth, options), options),
              HasSubstr("by the first 90 matched poses\n"));
  options.align_first = 91;
  EXPECT_THAT(to_text(evaluate_trajectory(truth, truth, options), options),
              HasSubstr("by all 90 matched poses, fewer than the first 91 asked for"));
}

}  // namespace
}  // namespace stillpoint
