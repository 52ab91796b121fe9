#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/sequence/list_file.hpp"
#include "core/sequence/source.hpp"
#include "tests/support/places.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const cv::Mat kColour(48, 64, CV_8UC3, cv::Scalar(10, 20, 30));
const cv::Mat kDepth(48, 64, CV_16UC1, cv::Scalar(10000));

/// Frames 0.1 s apart from 100.0 s on, depth 4 ms later, ground truth at the depth's stamps moving 1 m a
/// frame.
void write_sequence(const TemporaryFolder& folder, int frames) {
  std::string rgb, depth, truth;
  for (int i = 0; i < frames; ++i) {
    folder.write(fmt::format("rgb/{}.png", i), kColour);
    folder.write(fmt::format("depth/{}.png", i), kDepth);
    rgb += fmt::format("{:.3f} rgb/{}.png\n", 100.0 + 0.1 * i, i);
    depth += fmt::format("{:.3f} depth/{}.png\n", 100.004 + 0.1 * i, i);
    truth += fmt::format("{:.3f} {} 0 0 0 0 0 1\n", 100.004 + 0.1 * i, i);
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth);
  folder.write("groundtruth.txt", truth);
}

TEST(TumFolder, GivesEachColourImageItsDepthAndTruth) {
  const TemporaryFolder folder("rgbd_dataset_freiburg3_test");
  write_sequence(folder, 3);
  const auto source = open_sequence(folder.path() + "/");
  EXPECT_EQ(source->name(), "rgbd_dataset_freiburg3_test");
  ASSERT_EQ(source->size(), 3);
  EXPECT_TRUE(source->has_depth());
  EXPECT_FALSE(source->has_masks());
  EXPECT_EQ(source->camera().name, "freiburg3");
  EXPECT_EQ(source->camera().width, 64);
  EXPECT_NEAR(source->camera().fx, 53.54, 1e-9);
  EXPECT_THAT(source->warnings(), ElementsAre(HasSubstr("images are 64x48 px")));
  const Frame frame = source->read(1);
  EXPECT_EQ(frame.index, 1);
  EXPECT_DOUBLE_EQ(frame.timestamp, 100.1);
  EXPECT_EQ(frame.problem, "");
  EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(frame.gray.type(), CV_8UC1);
  EXPECT_EQ(frame.depth.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 5), 2.0F);
  // Neighbours 0.1 s apart are too far to interpolate between; the nearest pose is 4 ms away.
  EXPECT_EQ(source->truth(1).world_from_camera->translation().x(), 1.0);
  EXPECT_EQ(source->ground_truth().size(), 3U);
}

TEST(TumFolder, InterpolatesTruthBetweenCloseNeighbours) {
  const TemporaryFolder folder;
  write_sequence(folder, 1);
  folder.write("groundtruth.txt", "99.99 1 0 0 0 0 0 1\n100.01 2 0 0 0 0 0 1\n");
  const FrameTruth truth = open_sequence(folder.path())->truth(0);
  ASSERT_TRUE(truth.world_from_camera);
  EXPECT_NEAR(truth.world_from_camera->translation().x(), 1.5, 1e-6);
}

TEST(TumFolder, OpensWithColourAlone) {
  const TemporaryFolder folder;
  write_sequence(folder, 2);
  for (const char* file : {"depth.txt", "groundtruth.txt"}) std::filesystem::remove(folder.path(file));
  const auto source = open_sequence(folder.path());
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(source->ground_truth(), IsEmpty());
  const Frame frame = source->read(0);
  EXPECT_TRUE(frame.readable());
  EXPECT_FALSE(frame.has_depth());
  EXPECT_EQ(frame.problem, "");
  EXPECT_FALSE(source->truth(0).world_from_camera);
  EXPECT_EQ(source->camera().name, "ros_default");
}

TEST(TumFolder, KeepsFramesWithoutDepthAndSaysSo) {
  const TemporaryFolder folder;
  write_sequence(folder, 3);
  folder.write("depth.txt", "100.004 depth/0.png\n100.204 depth/2.png\n");
  const auto source = open_sequence(folder.path());
  ASSERT_EQ(source->size(), 3);
  EXPECT_TRUE(source->read(1).readable());
  EXPECT_FALSE(source->read(1).has_depth());
  EXPECT_EQ(source->read(1).problem, "no depth image within 0.02 s");
  EXPECT_TRUE(source->read(2).has_depth());
}

TEST(TumFolder, ReadsMasks) {
  const TemporaryFolder folder;
  write_sequence(folder, 2);
  cv::Mat mask = cv::Mat::zeros(48, 64, CV_8UC1);
  mask(cv::Rect(0, 0, 8, 4)) = 255;
  folder.write("mask/0.png", mask);
  folder.write("mask.txt", "100.000 mask/0.png\n");
  const auto source = open_sequence(folder.path());
  EXPECT_TRUE(source->has_masks());
  EXPECT_EQ(cv::countNonZero(source->truth(0).moving), 32);
  EXPECT_TRUE(source->truth(1).moving.empty());
  folder.write("mask.txt", "100.000 mask/0.png\n100.100 mask/1.png\n");
  EXPECT_THAT(
      open_sequence(folder.path())->warnings(),
      testing::Contains(HasSubstr("mask.txt: 1 of 2 masks are missing or empty, and their frames have no "
                                  "true mask: mask/1.png is missing")));
}

TEST(TumFolder, OpensIclNuimFolders) {
  const TemporaryFolder folder("living_room_traj2_frei_png");
  write_sequence(folder, 3);
  for (const char* file : {"rgb.txt", "depth.txt", "groundtruth.txt"})
    std::filesystem::remove(folder.path(file));
  folder.write("associations.txt",
               "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n2 depth/2.png 2 rgb/2.png\n");
  folder.write("livingRoom2.gt.freiburg", "1 1.5 0 0 0 0 0 1\n2 2.5 0 0 0 0 0 1\n");
  const auto source = open_sequence(folder.path());
  EXPECT_EQ(source->camera().name, "icl_nuim");
  EXPECT_NEAR(source->timestamp(2), 2.0 / 30.0, 1e-12);
  EXPECT_TRUE(source->read(2).has_depth());
  EXPECT_FALSE(source->truth(0).world_from_camera);
  EXPECT_EQ(source->truth(2).world_from_camera->translation().x(), 2.5);
  EXPECT_THAT(source->warnings(), testing::Contains(HasSubstr("frame numbers")));
}

TEST(TumFolder, CameraComesFromOptionsThenFileThenParent) {
  const TemporaryFolder folder("freiburg2/clip");
  write_sequence(folder, 1);
  EXPECT_EQ(open_sequence(folder.path())->camera().name, "freiburg2");
  folder.write("camera.toml",
               "name = \"mine\"\nwidth = 64\nheight = 48\nfx = 50\nfy = 50\ncx = 32\ncy = 24\n");
  EXPECT_EQ(open_sequence(folder.path())->camera().name, "mine");
  EXPECT_THAT(open_sequence(folder.path())->warnings(), IsEmpty());
  OpenOptions options;
  options.camera = camera_by_name("bonn");
  EXPECT_EQ(open_sequence(folder.path(), options)->camera().name, "bonn");
}

TEST(TumFolder, GivesItsFirstFramesAlone) {
  const TemporaryFolder folder;
  write_sequence(folder, 5);
  OpenOptions options;
  options.frames = 3;
  const auto all = open_sequence(folder.path()), some = open_sequence(folder.path(), options);
  EXPECT_EQ(some->size(), 3);
  EXPECT_EQ(some->name(), all->name());
  EXPECT_EQ(some->timestamp(2), all->timestamp(2));
  EXPECT_EQ(cv::norm(some->read(2).gray, all->read(2).gray, cv::NORM_INF), 0.0);
  EXPECT_EQ(some->ground_truth().size(), all->ground_truth().size());
  options.frames = 9;
  EXPECT_EQ(open_sequence(folder.path(), options)->size(), 5);
  options.frames = -1;
  EXPECT_THROW((void)open_sequence(folder.path(), options), InputError);
}

TEST(TumFolder, ReadsGreySixteenBitAlphaAndJpegImages) {
  const TemporaryFolder folder;
  write_sequence(folder, 4);
  folder.write("rgb/0.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(77)));
  folder.write("rgb/1.png", cv::Mat(48, 64, CV_16UC3, cv::Scalar(257 * 10, 257 * 20, 257 * 30)));
  folder.write("rgb/2.png", cv::Mat(48, 64, CV_8UC4, cv::Scalar(10, 20, 30, 128)));
  folder.write("rgb/3.jpg", kColour);
  folder.write("rgb.txt",
               folder.read("rgb.txt").replace(folder.read("rgb.txt").find("rgb/3.png"), 9, "rgb/3.jpg"));
  const auto source = open_sequence(folder.path());
  EXPECT_EQ(source->read(0).gray.at<uchar>(3, 3), 77);
  EXPECT_TRUE(source->read(0).colour.empty());
  EXPECT_EQ(source->read(1).colour.at<cv::Vec3b>(3, 3), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(source->read(2).colour.at<cv::Vec3b>(3, 3), cv::Vec3b(10, 20, 30));
  EXPECT_NEAR(source->read(3).gray.at<uchar>(3, 3), 22, 2);
}

TEST(TumFolder, DamageMarksTheFrameAndPrintsNothing) {
  const TemporaryFolder folder;
  write_sequence(folder, 9);
  cv::Mat noise(48, 64, CV_8UC3);
  cv::randu(noise, 0, 256);
  folder.write("rgb/1.png", noise);
  folder.truncate("rgb/1.png", 0.6);
  folder.write("rgb/2.png", std::string());
  std::filesystem::remove(folder.path("rgb/3.png"));
  folder.write("rgb/4.png", std::string("this is no picture"));
  folder.write("rgb/5.png", cv::Mat(24, 32, CV_8UC3, cv::Scalar(1, 2, 3)));
  folder.write("rgb/6.png", noise);
  std::string bytes = folder.read("rgb/6.png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  folder.write("rgb/6.png", bytes);
  folder.write("rgb/7.jpg", noise);
  folder.truncate("rgb/7.jpg", 0.5);
  folder.write("rgb.txt",
               folder.read("rgb.txt").replace(folder.read("rgb.txt").find("rgb/7.png"), 9, "rgb/7.jpg"));
  const auto source = open_sequence(folder.path());
  ASSERT_EQ(source->size(), 9);
  const char* problems[] = {"",
                            "1.png is truncated",
                            "2.png is empty (0 bytes)",
                            "3.png is missing",
                            "4.png is no image",
                            "5.png is 32x24 px, but",
                            "6.png is damaged",
                            "7.jpg is truncated",
                            ""};
  testing::internal::CaptureStderr();
  for (int i = 0; i < 9; ++i) {
    const Frame frame = source->read(i);
    const bool well = problems[i][0] == '\0';
    EXPECT_EQ(frame.readable(), well) << i;
    EXPECT_THAT(frame.problem, HasSubstr(problems[i]));
    EXPECT_EQ(frame.problem.empty(), well) << i;
    EXPECT_EQ(frame.timestamp, source->timestamp(i));
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(TumFolder, BadDepthIsRejectedForItsFrameAlone) {
  const TemporaryFolder folder;
  write_sequence(folder, 5);
  folder.write("depth/0.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  folder.write("depth/1.png", cv::Mat::zeros(48, 64, CV_16UC1));
  folder.write("depth/2.png", cv::Mat(24, 32, CV_16UC1, cv::Scalar(9)));
  folder.truncate("depth/3.png", 0.5);
  const auto source = open_sequence(folder.path());
  const char* problems[] = {"1 channel of 8 bits", "zero everywhere",
                            "is 32x24 px, but its colour image is 64x48", "3.png is truncated", ""};
  for (int i = 0; i < 5; ++i) {
    const Frame frame = source->read(i);
    EXPECT_TRUE(frame.readable());
    EXPECT_EQ(frame.has_depth(), i == 4);
    EXPECT_THAT(frame.problem, HasSubstr(problems[i]));
  }
}

TEST(TumFolder, UnusableFoldersAreToldInOneSentence) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& where) {
    return input_error_of([&] { (void)open_sequence(where); });
  };
  EXPECT_THAT(complaint(folder.path("none")), HasSubstr("there is no such folder"));
  EXPECT_THAT(complaint(folder.path()), HasSubstr("neither rgb.txt nor associations.txt"));
  folder.write("rgb.txt", "# empty\n");
  EXPECT_THAT(complaint(folder.path()), HasSubstr("rgb.txt: names no images"));
  EXPECT_THAT(complaint(folder.path("rgb.txt")), HasSubstr("is a file, expected a folder"));
  folder.write("rgb.txt", "1.5 rgb/gone.png\n2.5 rgb/gone.png\n");
  EXPECT_THAT(complaint(folder.path()), HasSubstr("none of its 2 images can be read; line 1:"));
  write_sequence(folder, 1);
  EXPECT_EQ(open_sequence(folder.path())->size(), 1);
}

TEST(TumFolder, TruthOfNoUseIsSaidToBeThere) {
  const TemporaryFolder folder;
  write_sequence(folder, 3);
  const auto why = [&](const char* truth) {
    folder.write("groundtruth.txt", truth);
    const auto source = open_sequence(folder.path());
    EXPECT_THAT(source->ground_truth(), IsEmpty());
    EXPECT_FALSE(source->truth(1).world_from_camera);
    EXPECT_THAT(source->warnings(), testing::Contains(source->why_not(FramePart::truth)));
    return source->why_not(FramePart::truth);
  };
  EXPECT_THAT(why("100 0 0 0 0 0 0 0\n"), HasSubstr("groundtruth.txt:1: found a quaternion of length 0"));
  EXPECT_THAT(why("# timestamp tx ty tz qx qy qz qw\n"), HasSubstr("groundtruth.txt: holds no poses"));
  EXPECT_THAT(why("86500 0 0 0 0 0 0 1\n86500.1 0 0 0 0 0 0 1\n"),
              HasSubstr("begins 86399.800 s after the last frame"));
  EXPECT_THAT(why("1.5 0 0 0 0 0 0 1\n1.6 0 0 0 0 0 0 1\n"),
              HasSubstr("ends 98.400 s before the first frame"));
  std::filesystem::remove(folder.path("groundtruth.txt"));
  EXPECT_EQ(open_sequence(folder.path())->why_not(FramePart::truth), "");
}

TEST(TumFolder, OneBadRowOfTruthCostsThatRow) {
  const TemporaryFolder folder;
  write_sequence(folder, 4);
  folder.write("groundtruth.txt",
               folder.read("groundtruth.txt") + "100.5 nan nan nan nan nan nan nan\n100.6 1 2 3\n");
  const auto source = open_sequence(folder.path());
  EXPECT_EQ(source->ground_truth().size(), 4U);
  EXPECT_EQ(source->why_not(FramePart::truth), "");
  EXPECT_THAT(source->warnings(),
              testing::IsSupersetOf({HasSubstr("groundtruth.txt:5: a row of NaN"),
                                     HasSubstr("groundtruth.txt:6: a row holds no pose")}));
}

TEST(TumFolder, FoldersWithoutRightsAreTold) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TemporaryFolder folder;
  write_sequence(folder, 1);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::none);
  const std::string sentence = input_error_of([&] { (void)open_sequence(folder.path()); });
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_THAT(sentence, HasSubstr("cannot be opened: Permission denied"));
}

TEST(TumFolder, CameraFilesHoldTheBuiltInCameras) {
  int compared = 0;
  for (const Camera& built_in : known_cameras()) {
    if (built_in.name == "generated") continue;
    ++compared;
    const Camera read = read_camera(places::source() + "/assets/cameras/" + built_in.name + ".toml");
    EXPECT_EQ(read.name, built_in.name);
    EXPECT_EQ(std::tie(read.width, read.height, read.fx, read.fy, read.cx, read.cy, read.depth_scale,
                       read.readout_s),
              std::tie(built_in.width, built_in.height, built_in.fx, built_in.fy, built_in.cx, built_in.cy,
                       built_in.depth_scale, built_in.readout_s));
    EXPECT_EQ(std::tie(read.k1, read.k2, read.p1, read.p2, read.k3),
              std::tie(built_in.k1, built_in.k2, built_in.p1, built_in.p2, built_in.k3));
  }
  EXPECT_GE(compared, 5) << "freiburg1, 2 and 3, bonn, icl at the least";
}

TEST(TumFolder, RealClipGivesAllItsFrames) {
  const std::string data = places::source() + "/../shared/data/";
  if (!std::filesystem::exists(data + "fr1_xyz_clip")) GTEST_SKIP() << "the real clip is not here";
  const auto source = open_sequence(data + "fr1_xyz_clip");
  ASSERT_EQ(source->size(), 200);
  EXPECT_EQ(source->camera().name, "freiburg1");
  EXPECT_THAT(source->warnings(), IsEmpty());
  int with_depth = 0, with_truth = 0;
  for (int i = 0; i < 200; ++i) {
    with_truth += source->truth(i).world_from_camera.has_value() ? 1 : 0;
    const Frame frame = source->read(i);
    EXPECT_TRUE(frame.readable());
    with_depth += frame.has_depth() ? 1 : 0;
  }
  EXPECT_EQ(with_truth, 200);
  EXPECT_GT(with_depth, 150);
  RecordProperty("frames_with_depth", with_depth);
  EXPECT_FALSE(open_sequence(data + "fr3_walking_rpy_16")->has_depth());
}

}  // namespace
}  // namespace stillpoint
