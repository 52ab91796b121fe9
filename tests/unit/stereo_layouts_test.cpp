// Stereo recordings as they are published: miniatures with exact truth, and each way they can be wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/stereo/stereo_matcher.hpp"
#include "core/sequence/stereo/stereo_rectification.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kFrames = 5;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// One miniature for all tests of a layout: they copy what they change.
const fs::path& miniature(SequenceLayout layout) {
  static std::map<SequenceLayout, std::unique_ptr<TemporaryFolder>> made;
  static std::map<SequenceLayout, fs::path> paths;
  if (!made.contains(layout)) {
    made[layout] = std::make_unique<TemporaryFolder>("miniature");
    paths[layout] = made[layout]->path();
    write_sequence(*make_generated_sequence("walking_xyz:stereo", kFrames, 1), paths[layout],
                   {.force = true, .layout = layout});
  }
  return paths[layout];
}

/// A copy of a miniature that a test may spoil.
struct Spoilt {
  explicit Spoilt(SequenceLayout layout) {
    fs::copy(miniature(layout), folder.path(), fs::copy_options::recursive);
  }
  [[nodiscard]] std::string error() const {
    return input_error_of([this] { (void)open_sequence(folder.path()); });
  }
  [[nodiscard]] std::unique_ptr<FrameSource> open(const OpenOptions& options = {}) const {
    return open_sequence(folder.path(), options);
  }
  void remove(const std::string& name) const { fs::remove_all(folder.path(name)); }
  void rename(const std::string& from, const std::string& to) const {
    fs::rename(folder.path(from), folder.path(to));
  }
  void replace(const std::string& file, const std::string& what, const std::string& by) const {
    std::string text = folder.read(file);
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << file << " has no " << what;
    folder.write(file, text.replace(at, what.size(), by));
  }
  TemporaryFolder folder{"spoilt"};
};

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
  const auto memory = make_generated_sequence("walking_xyz:stereo", kFrames, 1);
  const auto read = open_sequence(miniature(GetParam()).string());
  ASSERT_EQ(read->size(), kFrames);
  EXPECT_TRUE(read->camera().is_stereo());
  EXPECT_NEAR(read->camera().baseline_m, memory->camera().baseline_m, 1e-12);
  EXPECT_NEAR(read->camera().fx, memory->camera().fx, 1e-9);
  EXPECT_TRUE(read->has_depth() && read->has_masks());
  EXPECT_THAT(all_of(read->warnings()), Not(HasSubstr("rectified")));
  for (int i = 0; i < kFrames; ++i) {
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
  const RunResult memory = run_none(*make_generated_sequence("walking_xyz:stereo", kFrames, 1)),
                  read = run_none(*open_sequence(miniature(GetParam()).string()));
  ASSERT_EQ(read.trajectory.size(), memory.trajectory.size());
  ASSERT_EQ(read.trajectory.size(), static_cast<std::size_t>(kFrames));
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
            run_hash(run_none(*make_generated_sequence("walking_xyz:stereo", kFrames, 1)).records));
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
  ASSERT_EQ(part->size(), kFrames - 2);
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
            static_cast<std::size_t>(kFrames));
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
    for (int i = 0; i < kFrames; ++i) {
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
  ASSERT_EQ(source->size(), kFrames);
  for (int i = 0; i < kFrames; ++i) {
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
  for (int i = 0; i < kFrames; ++i)
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

// ---- rectification

/// What a camera that is turned and has a lens sees where an ideal one sees `ideal`.
cv::Mat seen_by(const Camera& camera, const Eigen::Matrix3d& ideal_from_camera, const cv::Mat& ideal,
                const Camera& ideal_camera) {
  cv::Mat from(camera.height, camera.width, CV_32FC2), image;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = ideal_from_camera * camera.back_project(camera.undistorted({x, y}), 1.0);
      const Eigen::Vector2d at = ideal_camera.project(ray);
      from.at<cv::Vec2f>(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    }
  cv::remap(ideal, image, from, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return image;
}

std::string yaml_of(const Camera& c, const Pose& body_from_camera) {
  std::string rows;
  for (int i = 0; i < 16; ++i)
    rows += fmt::format("{}{:.15g}", i == 0 ? "" : ", ", body_from_camera.matrix()(i / 4, i % 4));
  return fmt::format(
      "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\nresolution: [{}, {}]\ncamera_model: "
      "pinhole\nintrinsics: [{}, {}, {}, {}]\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [{}, {}, {}, {}]\n",
      rows, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2);
}

/// A pair with lenses, turned against each other, whose truth is the body's.
TEST(StereoRectification, APairAsItCameIsRectifiedOnOpening) {
  TemporaryFolder folder("raw");
  const auto ideal = make_generated_sequence("room:stereo", 4, 1);
  Camera left = ideal->camera(), right = left;
  left.k1 = -0.12, left.k2 = 0.03, left.p1 = 2e-4, right.k1 = -0.10, right.k2 = 0.02, right.p2 = -3e-4;
  right.fx = 530, right.cy = 240;
  const Eigen::Matrix3d turn_left = so3_exp({0.01, -0.012, 0.008}),
                        turn_right = so3_exp({-0.006, 0.01, -0.01});
  Pose body_from_ideal = Pose::Identity();
  body_from_ideal.linear() = so3_exp({0.3, -0.2, 1.2});
  body_from_ideal.translation() << 0.05, -0.02, 0.1;
  Pose left_pose = body_from_ideal, right_pose = body_from_ideal;
  left_pose.linear() = left_pose.linear() * turn_left;
  right_pose.translate(Eigen::Vector3d(0.12, 0, 0));
  right_pose.linear() = right_pose.linear() * turn_right;
  folder.write("mav0/cam0/sensor.yaml", yaml_of(left, left_pose));
  folder.write("mav0/cam1/sensor.yaml", yaml_of(right, right_pose));
  std::string truth = "#timestamp, p_RS_R_x [m], p_y, p_z, q_RS_w [], q_x, q_y, q_z\n";
  for (int i = 0; i < ideal->size(); ++i) {
    const Frame frame = ideal->read(i);
    const long long stamp = std::llround(ideal->timestamp(i) * 1e6) * 1000;
    folder.write(fmt::format("mav0/cam0/data/{}.png", stamp),
                 seen_by(left, turn_left, frame.gray, ideal->camera()));
    folder.write(fmt::format("mav0/cam1/data/{}.png", stamp),
                 seen_by(right, turn_right, to_gray(frame.stereo->right), ideal->camera()));
    const Pose body = *ideal->truth(i).world_from_camera * body_from_ideal.inverse();
    const Eigen::Quaterniond q(body.linear());
    truth +=
        fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", stamp, body.translation().x(),
                    body.translation().y(), body.translation().z(), q.w(), q.x(), q.y(), q.z());
  }
  folder.write("mav0/state_groundtruth_estimate0/data.csv", truth);

  const auto read = open_sequence(folder.path());
  EXPECT_NEAR(read->camera().baseline_m, 0.12, 1e-9);
  EXPECT_FALSE(read->camera().has_distortion());
  EXPECT_THAT(all_of(read->warnings()), Not(HasSubstr("not rectified")));
  const Frame frame = read->read(2);
  ASSERT_TRUE(frame.has_depth());
  // Both say where the same points lie: through the poses, in the world.
  const Pose ideal_from_read =
      ideal->truth(2).world_from_camera->inverse() * *read->truth(2).world_from_camera;
  EXPECT_LT(ideal_from_read.translation().norm(), 1e-5);  // m: rectifying turns the camera where it stands
  const cv::Mat exact = ideal->truth(2).depth;
  std::vector<double> errors;  // px, of disparity
  for (int y = 10; y < frame.depth.rows - 10; y += 4)
    for (int x = 10; x < frame.depth.cols - 10; x += 4) {
      const double z = frame.depth.at<float>(y, x);
      if (z <= 0) continue;
      const Eigen::Vector3d p = ideal_from_read * read->camera().back_project({x, y}, z);
      const Eigen::Vector2d at = ideal->camera().project(p);
      const cv::Point pixel(cvRound(at.x()), cvRound(at.y()));
      if (!cv::Rect(0, 0, exact.cols, exact.rows).contains(pixel)) continue;
      errors.push_back(std::abs(1.0 / p.z() - 1.0 / exact.at<float>(pixel)) * read->camera().fx * 0.12);
    }
  ASSERT_GT(errors.size(), 5000U);
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.5);
}

TEST(StereoRectification, ARectifiedPairIsLeftAsItIs) {
  Camera camera = camera_by_name("generated");
  Pose right_from_left = Pose::Identity();
  right_from_left.translation().x() = -0.2;
  const StereoRectification plain(camera, camera, right_from_left, "here");
  EXPECT_FALSE(plain.resamples());
  EXPECT_EQ(plain.camera().baseline_m, 0.2);
  EXPECT_EQ(plain.camera().fx, camera.fx);
  const cv::Mat image(480, 640, CV_8UC1, cv::Scalar(3));
  EXPECT_EQ(plain.rectified(image, StereoRectification::kLeft).data, image.data);
  right_from_left.linear() = so3_exp({0, 0, 0.01});
  EXPECT_TRUE(StereoRectification(camera, camera, right_from_left, "here").resamples());
}

}  // namespace
}  // namespace stillpoint
