// Other data sets' layouts and videos from the command line: made, questioned, run.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "tests/cli/run_cli.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class LayoutsCli : public ::testing::Test {
 protected:
  /// A miniature of four frames. @return its folder
  [[nodiscard]] std::string made(const std::string& layout) const {
    const std::string out = folder.path(layout);
    EXPECT_EQ(
        run_cli({"generate", "walking_static", "--frames", "4", "--layout", layout, "--out", out}).exit_code,
        0);
    return out;
  }
  TemporaryFolder folder{"layouts"};
};

TEST_F(LayoutsCli, AreMadeQuestionedAndRun) {
  const CliResult check = run_cli({"check", made("scannet")});
  EXPECT_THAT(
      check.out,
      AllOf(HasSubstr("4 frames"), HasSubstr("camera scannet (640x480 px)"),
            HasSubstr("depth at 1000 a metre, registered from 320x240 px, masks yes, ground truth 4 poses")));
  const CliResult run =
      run_cli({"run", folder.path("scannet"), "--method", "oracle", "--out", folder.path("run")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("over 4 poses"));
  const CliResult again =
      run_cli({"generate", "room", "--layout", "scannet", "--out", folder.path("scannet")});
  expect_one_sentence(again, "holds a sequence already");
}

TEST_F(LayoutsCli, OfUnknownNameOrOfTheOtherKindAreRefused) {
  const auto refused = [this](std::vector<std::string> more) {
    std::vector<std::string> words = {"generate", "room", "--frames", "1", "--out", folder.path("none")};
    words.insert(words.end(), more.begin(), more.end());
    return run_cli(words);
  };
  expect_one_sentence(refused({"--layout", "nyu"}), "--layout nyu: expected tum, 7-scenes, replica, scannet");
  expect_one_sentence(refused({"--layout", "kitti"}), "--layout kitti: expected tum");
  expect_one_sentence(refused({"--layout", "scannet", "--stereo"}), "expected left-right, kitti or euroc");
}

TEST_F(LayoutsCli, ACalibrationThatIsMissingIsOneSentence) {
  std::filesystem::remove(made("replica") + "/cam_params.json");
  expect_one_sentence(run_cli({"run", folder.path("replica")}), "has no cam_params.json");
  const CliResult told =
      run_cli({"check", folder.path("replica"), "--camera", "freiburg3", "--depth-scale", "6553.5"});
  EXPECT_EQ(told.exit_code, 0) << told.out << "its stamps are frame numbers, as they are to be";
}

TEST_F(LayoutsCli, VideosAreForMotion) {
  const std::string tum = made("tum"), path = folder.path("walk.avi");
  std::vector<cv::String> images;
  cv::glob(tum + "/rgb/*.png", images);
  cv::VideoWriter video(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30.0, {640, 480});
  for (const cv::String& image : images) video.write(cv::imread(image));
  video.release();
  const CliResult motion = run_cli({"motion", path, "--out", folder.path("motion")});
  EXPECT_EQ(motion.exit_code, 0) << motion.err;
  EXPECT_THAT(motion.out, HasSubstr("3 frames, 0 of them without a mask"));
  EXPECT_THAT(run_cli({"check", path}).out,
              HasSubstr("4 frames, 0.100 s, camera ros_default (640x480 px), depth none"));
  expect_one_sentence(run_cli({"run", path}), "has colour frames only, and odometry needs depth");
  // What FFmpeg finds amiss is not written between the sentences.
  std::filesystem::resize_file(path, std::filesystem::file_size(path) * 2 / 3);
  const CliResult cut = run_cli({"check", path});
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_EQ(cut.err, "");
  std::filesystem::resize_file(path, 200);
  expect_one_sentence(run_cli({"check", path}), "walk.avi:");
}

}  // namespace
}  // namespace stillpoint
