// Stereo recordings as they are published: miniatures with exact truth, and each way they can be wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/stereo/stereo_matcher.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/unit/stereo_miniature.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

std::string all_of(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += sentence + "\n";
  return text;
}

RunResult run_none(const FrameSource& source) {
  Config config;
  config.run.method = "none";
  config.run.threads = 2;
  return run_sequence(source, config);
}

class EveryStereoLayout : public ::testing::TestWithParam<SequenceLayout> {};

TEST_P(EveryStereoLayout, ReadsBackTheSame) {
  const auto memory = make_generated_sequence("walking_xyz:stereo", kStereoFrames, 1);
  const auto read = open_sequence(miniature(GetParam()).string());
  ASSERT_EQ(read->size(), kStereoFrames);
  EXPECT_TRUE(read->camera().is_stereo());
  EXPECT_NEAR(read->camera().baseline_m, memory->camera().baseline_m, 1e-12);
  EXPECT_NEAR(read->camera().fx, memory->camera().fx, 1e-9);
  EXPECT_TRUE(read->has_depth() && read->has_masks());
  EXPECT_THAT(all_of(read->warnings()), Not(HasSubstr("rectified")));
  for (int i = 0; i < kStereoFrames; ++i) {
    const Frame made = memory->read(i), found = read->read(i);
    EXPECT_TRUE(same(made.gray, found.gray)) << i;
    EXPECT_LT(cv::norm(made.depth, found.depth, cv::NORM_INF), 1e-5) << i;
    ASSERT_NE(found.stereo, nullptr) << i;
    EXPECT_TRUE(same(made.stereo->holes, found.stereo->holes)) << i;
    EXPECT_NEAR(found.timestamp, made.timestamp, 1e-9) << i;
    EXPECT_TRUE(same(memory->truth(i).moving, read->truth(i).moving)) << i;
    ASSERT_TRUE(read->truth(i).world_from_camera) << i;
    const Pose off = memory->truth(i).world_from_camera->inverse() * *read->truth(i).world_from_camera;
    EXPECT_LT(off.translation().norm(), 1e-4) << i;      // m
    EXPECT_LT(rotation_angle(off.linear()), 1e-4) << i;  // rad
  }
}

TEST_P(EveryStereoLayout, GivesTheSameTrajectory) {
  const RunResult memory = run_none(*make_generated_sequence("walking_xyz:stereo", kStereoFrames, 1)),
                  read = run_none(*open_sequence(miniature(GetParam()).string()));
  ASSERT_EQ(read.trajectory.size(), memory.trajectory.size());
  ASSERT_EQ(read.trajectory.size(), static_cast<std::size_t>(kStereoFrames));
  for (std::size_t i = 0; i < memory.trajectory.size(); ++i) {
    const Pose off = memory.trajectory[i].world_from_camera.inverse() * read.trajectory[i].world_from_camera;
    EXPECT_LT(off.translation().norm(), 1e-7) << i;  // m: what a focal length in decimals leaves
  }
}

INSTANTIATE_TEST_SUITE_P(Stereo, EveryStereoLayout,
                         ::testing::Values(SequenceLayout::left_right, SequenceLayout::kitti,
                                           SequenceLayout::euroc));

TEST(StereoLayouts, LeftAndRightGiveTheSameRunToTheLastBit) {
  EXPECT_EQ(run_hash(run_none(*open_sequence(miniature(SequenceLayout::left_right).string())).records),
            run_hash(run_none(*make_generated_sequence("walking_xyz:stereo", kStereoFrames, 1)).records));
}

TEST(StereoLayouts, HalfSizeIsAnOption) {
  OpenOptions options;
  options.stereo.half = true;
  const auto full = open_sequence(miniature(SequenceLayout::left_right).string()),
             half = open_sequence(miniature(SequenceLayout::left_right).string(), options);
  EXPECT_FALSE(same(full->read(0).depth, half->read(0).depth));
  EXPECT_GT(half->camera().depth_sigma_per_m2, full->camera().depth_sigma_per_m2);
}

TEST(StereoLayouts, AnRgbdFolderWithABaselineIsNotStereo) {
  TemporaryFolder folder;
  write_sequence(*make_generated_sequence("room", 2, 1), folder.path(), {.force = true});
  std::ofstream(folder.path("camera.toml"), std::ios::app) << "baseline_m = 0.08\n";
  const auto source = open_sequence(folder.path());
  EXPECT_FALSE(source->camera().is_stereo());
  EXPECT_EQ(source->read(0).stereo, nullptr);
}

TEST(StereoLayouts, ASourceIsWrittenInALayoutOfItsKind) {
  TemporaryFolder folder;
  const auto rgbd = make_generated_sequence("room", 1, 1),
             stereo = make_generated_sequence("room:stereo", 1, 1);
  EXPECT_THAT(
      input_error_of([&] { write_sequence(*rgbd, folder.path("a"), {.layout = SequenceLayout::kitti}); }),
      HasSubstr("is RGB-D, and cannot be written in a layout of stereo pairs"));
  EXPECT_THAT(
      input_error_of([&] { write_sequence(*stereo, folder.path("b"), {.layout = SequenceLayout::tum}); }),
      HasSubstr("is stereo"));
}

// ---- what is missing

TEST(StereoLayouts, AMissingRightFolderIsSaid) {
  const std::map<SequenceLayout, std::array<std::string, 2>> right = {
      {SequenceLayout::left_right, {"right", "right: is missing; depth comes of two images a frame"}},
      {SequenceLayout::kitti, {"image_3", "image_3: is missing; depth comes of two images a frame"}},
      {SequenceLayout::euroc, {"mav0/cam1", "cam1: is missing; depth comes of two images a frame"}}};
  for (const auto& [layout, names] : right) {
    const Spoilt spoilt(layout);
    spoilt.remove(names[0]);
    EXPECT_THAT(spoilt.error(), HasSubstr(names[1]));
  }
}

TEST(StereoLayouts, AMissingCalibrationIsSaid) {
  const Spoilt kitti(SequenceLayout::kitti), euroc(SequenceLayout::euroc), plain(SequenceLayout::left_right);
  kitti.remove("calib.txt");
  EXPECT_THAT(kitti.error(), HasSubstr("calib.txt: is missing; it holds P0 to P3"));
  euroc.remove("mav0/cam1/sensor.yaml");
  EXPECT_THAT(euroc.error(), HasSubstr("cam1/sensor.yaml: is missing; it says how the camera sees"));
  plain.remove("camera.toml");
  EXPECT_THAT(plain.error(), HasSubstr("left/ and right/ need a camera.toml"));
}

TEST(StereoLayouts, ACameraWithoutBaselineHasNoScale) {
  const Spoilt spoilt(SequenceLayout::left_right);
  spoilt.replace("camera.toml", "baseline_m = 0.12", "");
  EXPECT_THAT(spoilt.error(), HasSubstr("has no baseline_m"));
  OpenOptions options;
  options.camera = camera_by_name("freiburg1");
  EXPECT_THAT(
      input_error_of([&] { (void)open_sequence(miniature(SequenceLayout::kitti).string(), options); }),
      HasSubstr("camera freiburg1 has no baseline_m"));
}

TEST(StereoLayouts, ACalibrationThatCannotBeIsSaid) {
  const auto kitti_error = [](const std::string& calibration) {
    const Spoilt spoilt(SequenceLayout::kitti);
    spoilt.folder.write("calib.txt", calibration);
    return spoilt.error();
  };
  const std::string left = "P2: 500 0 320 0 0 500 240 0 0 0 1 0\n";
  EXPECT_THAT(kitti_error(left), HasSubstr("calib.txt: has no P3"));
  EXPECT_THAT(kitti_error(left + "P3: 500 0 320\n"), HasSubstr("calib.txt:2: found"));
  EXPECT_THAT(kitti_error(left + "P3: 500 0 320 50 0 500 240 0 0 0 1 0\n"),
              HasSubstr("by P2 and P3 the right camera lies to the left"));
  EXPECT_THAT(kitti_error(left + "P3: 510 0 320 -50 0 510 240 0 0 0 1 0\n"),
              HasSubstr("different focal lengths or centres"));
  EXPECT_THAT(kitti_error("P2: 0 0 320 0 0 500 240 0 0 0 1 0\nP3: 0 0 320 -50 0 500 240 0 0 0 1 0\n"),
              HasSubstr("focal length of 0 or less"));
}

TEST(StereoLayouts, AnAslPairThatIsNoneIsSaid) {
  const auto error = [](const std::string& what, const std::string& by) {
    const Spoilt spoilt(SequenceLayout::euroc);
    spoilt.replace("mav0/cam1/sensor.yaml", what, by);
    return spoilt.error();
  };
  EXPECT_THAT(error("T_BS", "T_XX"), HasSubstr("cam1/sensor.yaml: has no T_BS"));
  EXPECT_THAT(error("data: [0", "data: [7"), HasSubstr("T_BS is no rigid motion"));
  EXPECT_THAT(error("resolution: [640, 480]", "resolution: [320, 240]"),
              HasSubstr("the left camera is of 640x480 px and the right one of 320x240 px"));
  EXPECT_THAT(error("radial-tangential", "equidistant"), HasSubstr("distortion_model is equidistant"));
  const Spoilt exchanged(SequenceLayout::euroc);
  exchanged.rename("mav0/cam0/sensor.yaml", "mav0/cam0/other");
  exchanged.rename("mav0/cam1/sensor.yaml", "mav0/cam0/sensor.yaml");
  exchanged.rename("mav0/cam0/other", "mav0/cam1/sensor.yaml");
  EXPECT_THAT(exchanged.error(), HasSubstr("the second camera is said to lie to the left of the first one"));
}

TEST(StereoLayouts, UnequalCountsAreSaidAndCostTheirFrames) {
  const Spoilt spoilt(SequenceLayout::kitti);
  spoilt.remove("image_3/000003.png");
  const auto source = spoilt.open();
  EXPECT_THAT(all_of(source->warnings()), HasSubstr("has 4 images where"));
  EXPECT_THAT(all_of(source->warnings()), HasSubstr("4 pairs were found"));
  EXPECT_FALSE(source->read(3).has_depth());
  EXPECT_EQ(source->read(3).problem, "has no right image");
  EXPECT_TRUE(source->read(2).has_depth());
}

TEST(StereoLayouts, TimesOfFewerFramesAreSaid) {
  const Spoilt spoilt(SequenceLayout::kitti);
  spoilt.folder.write("times.txt", "0.0\n0.1\n0.2\n");
  EXPECT_THAT(spoilt.error(), HasSubstr("has 3 times for 5 left images, whose last one is number 4"));
  spoilt.folder.write("times.txt", "0.0\n0.1\nlate\n0.3\n0.4\n");
  EXPECT_THAT(spoilt.error(), HasSubstr("times.txt:3: 'late' is no time"));
  spoilt.folder.write("times.txt", "0.0\n0.1\n0.1\n0.3\n0.4\n");
  EXPECT_THAT(spoilt.error(), HasSubstr("times.txt:3: 0.1 is no later than the line before"));
}

/// A part of a KITTI sequence keeps its images' numbers, beside the whole sequence's times and poses.
TEST(StereoLayouts, APartOfAKittiSequenceIsStampedByItsNumbers) {
  const Spoilt spoilt(SequenceLayout::kitti);
  for (const char* gone : {"000000", "000001"})
    for (const char* side : {"image_2/", "image_3/"}) spoilt.remove(std::string(side) + gone + ".png");
  const auto whole = open_sequence(miniature(SequenceLayout::kitti).string()), part = spoilt.open();
  ASSERT_EQ(part->size(), kStereoFrames - 2);
  for (int i = 0; i < part->size(); ++i) {
    EXPECT_EQ(part->timestamp(i), whole->timestamp(i + 2));
    EXPECT_TRUE(same(part->read(i).gray, whole->read(i + 2).gray));
    ASSERT_TRUE(part->truth(i).world_from_camera);
    EXPECT_TRUE(part->truth(i).world_from_camera->isApprox(*whole->truth(i + 2).world_from_camera, 1e-9));
  }
}

TEST(StereoLayouts, PosesLieWhereTheBenchmarkHasThem) {
  TemporaryFolder folder("dataset");
  fs::create_directories(folder.path("sequences"));
  fs::copy(miniature(SequenceLayout::kitti), folder.path("sequences/07"), fs::copy_options::recursive);
  fs::create_directories(folder.path("poses"));
  fs::rename(folder.path("sequences/07/poses.txt"), folder.path("poses/07.txt"));
  EXPECT_EQ(open_sequence(folder.path("sequences/07"))->ground_truth().size(),
            static_cast<std::size_t>(kStereoFrames));
  fs::remove(folder.path("poses/07.txt"));
  EXPECT_TRUE(open_sequence(folder.path("sequences/07"))->ground_truth().empty());
}

/// Poses of KITTI are camera 0's, and camera 2 sits beside it.
TEST(StereoLayouts, KittiPosesAreCarriedToTheColourCamera) {
  const Spoilt spoilt(SequenceLayout::kitti);
  spoilt.folder.write("calib.txt",
                      "P2: 535.4 0 320.1 32.124 0 539.2 247.6 0 0 0 1 0\n"
                      "P3: 535.4 0 320.1 -32.124 0 539.2 247.6 0 0 0 1 0\n");
  const auto moved = spoilt.open(), plain = open_sequence(miniature(SequenceLayout::kitti).string());
  EXPECT_NEAR(moved->camera().baseline_m, 0.12, 1e-9);
  const Pose off = plain->truth(1).world_from_camera->inverse() * *moved->truth(1).world_from_camera;
  EXPECT_TRUE(off.translation().isApprox(Eigen::Vector3d(-32.124 / 535.4, 0, 0), 1e-6)) << off.translation();
}

TEST(StereoLayouts, LeftAndRightGoByOtherNamesToo) {
  const auto usual = open_sequence(miniature(SequenceLayout::left_right).string());
  for (const auto& [left, right] : {std::pair("Left", "Right"), std::pair("image_left", "image_right")}) {
    const Spoilt renamed(SequenceLayout::left_right);
    renamed.rename("left", left);
    renamed.rename("right", right);
    const auto source = renamed.open();
    EXPECT_TRUE(same(source->read(2).depth, usual->read(2).depth)) << left;
    renamed.remove(right);
    EXPECT_THAT(renamed.error(), HasSubstr(fmt::format("{}: is missing", right)));
  }
}

/// The miniature of left and right as TartanAir has its sequences.
struct TartanAir : Spoilt {
  TartanAir() : Spoilt(SequenceLayout::left_right) {
    const auto source = open_sequence(miniature(SequenceLayout::left_right).string());
    std::string poses;
    for (int i = 0; i < kStereoFrames; ++i) {
      for (const std::string side : {"left", "right"}) {
        fs::create_directories(folder.path("image_" + side));
        fs::rename(folder.path(fmt::format("{}/{:.6f}.png", side, source->timestamp(i))),
                   folder.path(fmt::format("image_{0}/{1:06}_{0}.png", side, i)));
      }
      // Forward of its body is a camera's z, right its x, down its y.
      Pose camera_from_body = Pose::Identity();
      camera_from_body.linear() << 0, 1, 0, 0, 0, 1, 1, 0, 0;
      const Pose body = *source->truth(i).world_from_camera * camera_from_body;
      const Eigen::Vector3d p = body.translation();
      const Eigen::Quaterniond q(body.linear());
      poses += fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.x(), p.y(), p.z(), q.x(),
                           q.y(), q.z(), q.w());
    }
    folder.write("pose_left.txt", poses);
    for (const char* gone : {"left", "right", "groundtruth.txt"}) remove(gone);
  }
};

TEST(StereoLayouts, TartanAirIsReadWithItsPoses) {
  const TartanAir sequence;
  const auto usual = open_sequence(miniature(SequenceLayout::left_right).string()), source = sequence.open();
  ASSERT_EQ(source->size(), kStereoFrames);
  for (int i = 0; i < kStereoFrames; ++i) {
    EXPECT_TRUE(same(source->read(i).depth, usual->read(i).depth)) << i;
    EXPECT_NEAR(source->timestamp(i), i / 30.0, 1e-9);
    ASSERT_TRUE(source->truth(i).world_from_camera) << i;
    const Pose off = usual->truth(i).world_from_camera->inverse() * *source->truth(i).world_from_camera;
    EXPECT_LT(off.translation().norm(), 1e-6) << i;      // m
    EXPECT_LT(rotation_angle(off.linear()), 1e-6) << i;  // rad
  }
  // A part of it keeps its numbers.
  sequence.remove("image_left/000000_left.png");
  sequence.remove("image_right/000000_right.png");
  const auto part = sequence.open();
  ASSERT_TRUE(part->truth(0).world_from_camera);
  EXPECT_TRUE(part->truth(0).world_from_camera->isApprox(*source->truth(1).world_from_camera, 1e-9));
  // As it is downloaded no camera lies beside it.
  sequence.remove("camera.toml");
  const Camera camera = sequence.open()->camera();
  EXPECT_EQ(camera.name, "tartanair");
  EXPECT_EQ(camera.fx, 320.0);
  EXPECT_EQ(camera.baseline_m, 0.25);
}

TEST(StereoLayouts, WhatEurocSaysOfItsStampsIsNoFinding) {
  EXPECT_THAT(all_of(open_sequence(miniature(SequenceLayout::euroc).string())->warnings()),
              Not(HasSubstr("the stamps are")));
}

// ---- pairs that are none

TEST(StereoLayouts, RightImagesOfAnotherMomentAreTold) {
  const Spoilt spoilt(SequenceLayout::left_right);
  const auto usual = spoilt.open();
  EXPECT_THAT(all_of(usual->warnings()), Not(HasSubstr("were taken")));
  for (int i = 0; i < kStereoFrames; ++i)
    spoilt.rename(fmt::format("right/{:.6f}.png", usual->timestamp(i)),
                  fmt::format("right/{:.6f}.png", usual->timestamp(i) - 0.0065));
  EXPECT_THAT(all_of(spoilt.open()->warnings()),
              HasSubstr("right: its images were taken 6.5 ms earlier than those of"));
}

TEST(StereoLayouts, ExchangedFoldersAreSaid) {
  const Spoilt spoilt(SequenceLayout::left_right);
  spoilt.rename("left", "other");
  spoilt.rename("right", "left");
  spoilt.rename("other", "right");
  const auto source = spoilt.open();
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(source->why_not(FramePart::depth), HasSubstr("left and right are exchanged"));
}

TEST(StereoLayouts, RowsThatDoNotCorrespondAreSaid) {
  const Spoilt spoilt(SequenceLayout::left_right);
  for (const auto& entry : fs::directory_iterator(spoilt.folder.path("right"))) {
    const cv::Mat image = cv::imread(entry.path().string());
    cv::Mat lower;
    const cv::Mat by_four = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 4);
    cv::warpAffine(image, lower, by_four, image.size());
    cv::imwrite(entry.path().string(), lower);
  }
  const auto source = spoilt.open();
  EXPECT_THAT(all_of(source->warnings()), HasSubstr("matched corners lie 4.0 px lower than in"));
  EXPECT_THAT(all_of(source->warnings()), HasSubstr("the pair is not rectified"));
}

TEST(StereoLayouts, SizesThatDifferAreSaid) {
  const Spoilt all(SequenceLayout::left_right), one(SequenceLayout::left_right);
  const auto shrink = [](const fs::path& path) {
    cv::Mat small;
    cv::resize(cv::imread(path.string()), small, {320, 240});
    cv::imwrite(path.string(), small);
  };
  for (const auto& entry : fs::directory_iterator(all.folder.path("right"))) shrink(entry.path());
  EXPECT_THAT(all.open()->why_not(FramePart::depth),
              HasSubstr("is 320x240 px, but its left image is 640x480 px"));
  const fs::path first = one.folder.path("right/1000.000000.png");
  shrink(first);
  const auto source = one.open();
  EXPECT_THAT(source->read(0).problem, HasSubstr("is 320x240 px, but its left image is 640x480 px"));
  EXPECT_TRUE(source->read(1).has_depth());
}

TEST(StereoLayouts, ADamagedRightImageCostsItsFramesDepth) {
  const Spoilt spoilt(SequenceLayout::left_right);
  spoilt.folder.truncate("right/1000.033333.png", 0.5);
  const auto source = spoilt.open();
  const Frame frame = source->read(1);
  EXPECT_TRUE(frame.readable());
  EXPECT_FALSE(frame.has_depth());
  EXPECT_THAT(frame.problem, HasSubstr("1000.033333.png"));
}

}  // namespace
}  // namespace stillpoint
