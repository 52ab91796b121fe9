#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "core/check/check_sequence.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

auto says(const char* about, const char* part) {
  return testing::AllOf(Field(&Finding::about, about), Field(&Finding::sentence, HasSubstr(part)));
}

/// A camera that goes and turns unevenly, 30 poses a second from `start` s on.
Trajectory path(double start, double rate = 30.0, int poses = 90) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    const double t = start + i / rate;
    Pose pose = Pose::Identity();
    pose.linear() =
        so3_exp({0.3 * std::sin(3.3 * t), 0.4 * std::sin(2.9 * t + 1), 0.3 * std::sin(4.1 * t + 2)});
    pose.translation() = Eigen::Vector3d(0.3 * std::cos(2.7 * t), 0.3 * std::sin(2.7 * t), 0.3 * std::sin(t));
    trajectory.push_back({t, pose});
  }
  return trajectory;
}

TEST(Check, FindsNothingInAGeneratedSequence) {
  OpenOptions options;
  options.frames = 12;
  const auto source = open_sequence("generated:room", options);
  EXPECT_THAT(check_frames(*source), IsEmpty());
  EXPECT_THAT(check_odometry(*source, 12), IsEmpty());
}

TEST(Check, FindsTheShiftOfATruthsClock) {
  const Trajectory estimate = path(1.0);
  EXPECT_FALSE(find_time_shift(path(0.0, 100, 500), estimate));
  for (const double late : {-0.2, 0.06}) {
    Trajectory truth = path(0.0, 100, 500);
    for (StampedPose& pose : truth) pose.timestamp += late;
    const auto shift = find_time_shift(truth, estimate);
    ASSERT_TRUE(shift);
    EXPECT_NEAR(shift->seconds, -late, 0.006);
    EXPECT_LT(shift->mended_m, 0.2 * shift->as_is_m);
    EXPECT_THAT(check_truth(truth, estimate, false),
                Contains(says("truth", late < 0 ? "s later" : "s earlier")));
  }
}

TEST(Check, AnOdometryThatSlipsOverAShortStretchIsNoShiftOfAClock) {
  const auto truth_at = [](int poses) {
    Trajectory truth;
    for (const StampedPose& pose : path(0.9, 100, poses))
      truth.push_back({pose.timestamp, pose.world_from_camera});
    return truth;
  };
  // For the first half second the odometry holds to somebody who walks along: it sees half of the motion.
  Trajectory estimate = path(1.0, 30, 30);
  const Trajectory sound = estimate;
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    Pose step = sound[i - 1].world_from_camera.inverse() * sound[i].world_from_camera;
    if (i < 15) step.translation() *= 0.4;
    estimate[i].world_from_camera = estimate[i - 1].world_from_camera * step;
  }
  EXPECT_FALSE(find_time_shift(truth_at(120), estimate));
  // A clock that is off is found over as short a stretch.
  Trajectory late = truth_at(120);
  for (StampedPose& pose : late) pose.timestamp += 0.1;
  const auto shift = find_time_shift(late, sound);
  ASSERT_TRUE(shift);
  EXPECT_NEAR(shift->seconds, -0.1, 0.006);
}

TEST(Check, PeopleInAShortSequenceAreNoFaultOfTheTruth) {
  for (const auto& [kind, frames] :
       {std::pair("generated:walking_xyz", 30),     // a shift of its clock
        std::pair("generated:walking_rpy", 20)}) {  // a body that carries the camera
    OpenOptions options;
    options.frames = frames;
    EXPECT_THAT(check_odometry(*open_sequence(kind, options), frames),
                testing::Not(Contains(Field(&Finding::about, "truth"))))
        << kind;
  }
}

TEST(Check, NamesConventionsAndScales) {
  Trajectory truth = path(1.0);
  const Trajectory estimate = path(1.0);
  EXPECT_THAT(check_truth(truth, estimate, true), IsEmpty());
  for (StampedPose& pose : truth) pose.world_from_camera = pose.world_from_camera.inverse();
  EXPECT_THAT(check_truth(truth, estimate, false), Contains(says("truth", "`--truth inverse`")));
  Trajectory small = estimate;
  for (StampedPose& pose : small) pose.world_from_camera.translation() *= 0.2;
  EXPECT_THAT(check_truth(estimate, small, false), Contains(says("depth", "multiplied by 5.000")));
  EXPECT_THAT(check_truth(estimate, small, false, 0.024),
              Contains(says("depth", "is the pair's baseline right? It is 0.024 m, and 0.12 m would fit")));
  EXPECT_THAT(check_truth(estimate, small, true),
              Contains(says("estimate", "`stillpoint evaluate --align sim3`")));
  Trajectory held = estimate;
  for (StampedPose& pose : held) pose.world_from_camera = Pose::Identity();
  EXPECT_THAT(check_truth(estimate, held, true), Contains(says("estimate", "the same number for number")));
  EXPECT_THAT(check_truth(estimate, held, false),
              ::testing::Not(Contains(says("estimate", "number for number"))));
}

TEST(Check, FindsGapsRepeatsAndWhatWasMended) {
  const TemporaryFolder folder;
  std::string list;
  for (int i = 0; i < 12; ++i) {
    folder.write(fmt::format("rgb/{}.png", i), cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(10.0 * (i / 2))));
    list += fmt::format("{:.3f} rgb/{}.png\n", 100 + i / 30.0 + (i > 7 ? 2.5 : 0.0), i);
  }
  folder.write("rgb.txt", list);
  const auto findings = check_frames(*open_sequence(folder.path()));
  EXPECT_THAT(findings, Contains(says("stamps", "s, follows frame 7: the odometry may be lost there")));
  EXPECT_THAT(findings, Contains(says("images", "6 of 11 sampled colour images are the same")));
  EXPECT_THAT(findings, Contains(says("camera", "ros_default is assumed")));
}

/// A sequence whose depth images are others.
class ChangedDepth : public FrameSource {
 public:
  using Change = std::function<cv::Mat(const cv::Mat& depth, const Camera& camera)>;

  ChangedDepth(std::shared_ptr<const FrameSource> source, Change change)
      : source_(std::move(source)), change_(std::move(change)) {}
  [[nodiscard]] const std::string& name() const override { return source_->name(); }
  [[nodiscard]] const Camera& camera() const override { return source_->camera(); }
  [[nodiscard]] int size() const override { return source_->size(); }
  [[nodiscard]] double timestamp(int index) const override { return source_->timestamp(index); }
  [[nodiscard]] Frame read(int index) const override {
    Frame frame = source_->read(index);
    frame.depth = change_(frame.depth, camera());
    return frame;
  }
  [[nodiscard]] FrameTruth truth(int index) const override { return source_->truth(index); }
  [[nodiscard]] const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 private:
  std::shared_ptr<const FrameSource> source_;
  Change change_;
};

ChangedDepth::Change shifted(const cv::Point& shift) {
  return [shift](const cv::Mat& depth, const Camera&) {
    cv::Mat moved = cv::Mat::zeros(depth.size(), CV_32FC1);
    const cv::Rect image({}, depth.size());
    const cv::Rect to = (image + shift) & image;
    depth(to - shift).copyTo(moved(to));
    return moved;
  };
}

TEST(Registration, DepthThatLiesBesideColourIsToldByHowFar) {
  const auto source = rendered("walking_xyz", 12);
  EXPECT_THAT(check_registration(*source), IsEmpty());
  EXPECT_THAT(check_registration(ChangedDepth(source, shifted({2, -2}))), IsEmpty());  // a sensor's own
  const auto findings = check_registration(ChangedDepth(source, shifted({14, -8})));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0], says("depth", "best 14 px to the left and 8 px down"));
  EXPECT_FALSE(remedy_of(findings[0]));
}

TEST(Parallax, TellsWhatDepthImagesHoldInsteadOfDepth) {
  const auto source = rendered("sitting_xyz", 60);
  EXPECT_THAT(check_parallax(*source), IsEmpty());
  const auto scaled = [](const cv::Mat& depth, const Camera&) { return cv::Mat(depth * 1.7); };
  EXPECT_THAT(check_parallax(ChangedDepth(source, scaled)), IsEmpty());  // a scale cancels

  const auto by_ray = [](const cv::Mat& depth, const Camera& camera) {
    cv::Mat range = depth.clone();
    range.forEach<float>([&](float& z, const int* at) {
      z *= static_cast<float>(
          std::hypot(1.0, (at[1] - camera.cx) / camera.fx, (at[0] - camera.cy) / camera.fy));
    });
    return range;
  };
  auto findings = check_parallax(ChangedDepth(source, by_ray));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0],
              says("depth", "the distance from the camera's centre, not the depth along its axis"));

  const auto inverted = [](const cv::Mat& depth, const Camera&) {
    cv::Mat inverse = depth.clone();
    inverse.forEach<float>([](float& z, const int*) { z = z > 0 ? 2.0F / z : 0.0F; });
    return inverse;
  };
  findings = check_parallax(ChangedDepth(source, inverted));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0], says("depth", "disparity or the inverse of depth"));

  const auto upside_down = [](const cv::Mat& depth, const Camera&) {
    cv::Mat other;
    cv::flip(depth, other, 0);
    return other;
  };
  findings = check_parallax(ChangedDepth(source, upside_down));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0], says("depth", "depth does not go with the images"));
}

/// Depth whose clock is in doubt.
class LateDepth final : public ChangedDepth {
 public:
  using ChangedDepth::ChangedDepth;
  [[nodiscard]] std::optional<double> depth_late_s() const override { return 0.5; }
};

TEST(Check, DepthOfAnotherTimeIsNotBlamedOnCameraOrScale) {
  const auto source = rendered("walking_xyz", 12);
  const auto beside = says("depth", "does not lie on colour");
  EXPECT_THAT(check_sequence(ChangedDepth(source, shifted({14, -8}))).findings, Contains(beside));
  EXPECT_THAT(check_sequence(LateDepth(source, shifted({14, -8}))).findings,
              ::testing::Not(Contains(beside)));
}

TEST(Remedies, AreTheSwitchesThatMendForCertain) {
  EXPECT_EQ(remedy_of({"depth", "it would be 1 to 2 m: `--depth-scale 1000` reads it so"}),
            (Remedy{"depth-scale", "1000"}));
  EXPECT_EQ(remedy_of({"time", "20 ms (`--calibrate-time` goes by what was measured)"}),
            (Remedy{"calibrate-time", ""}));
  EXPECT_EQ((Remedy{"camera", "freiburg1"}).text(), "--camera freiburg1");
  // A person's to decide, without a value, or no switch at all.
  EXPECT_FALSE(remedy_of({"masks", "if white is what is static, `--invert-masks` reads them so"}));
  EXPECT_FALSE(remedy_of({"depth", "(if its clock is, `--depth-offset 0.5` mends that)"}));
  EXPECT_FALSE(remedy_of({"depth", "`--depth-scale` sets the depth's"}));
  EXPECT_FALSE(remedy_of({"camera", "the name tells no camera"}));
  EXPECT_FALSE(remedy_of({"camera", "`--camera freiburg1 without an end"}));
}

TEST(Remedies, WhatLetsTheTruthLookWrongComesFirstAndWhatWasGivenStands) {
  const std::vector<Finding> findings = {{"truth", "(`--truth inverse` reads it so)"},
                                         {"camera", "(`--camera icl_nuim` uses it)"},
                                         {"depth", "`--depth-scale 5000` reads it so"}};
  const auto first = first_remedy(findings, {});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->first.name, "depth-scale");
  EXPECT_EQ(first->second.about, "depth");
  EXPECT_EQ(first_remedy(findings, {"depth-scale"})->first.name, "camera");
  EXPECT_FALSE(first_remedy(findings, {"depth-scale", "camera", "truth"}));
}

TEST(Remedies, EveryFindingOfAConventionNamesOne) {
  const Trajectory estimate = path(10.0);
  Trajectory inverse = estimate;
  for (StampedPose& pose : inverse) pose.world_from_camera = pose.world_from_camera.inverse();
  const auto findings = check_truth(inverse, estimate, false);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(remedy_of(findings[0]), (Remedy{"truth", "inverse"}));
}

}  // namespace
}  // namespace stillpoint
