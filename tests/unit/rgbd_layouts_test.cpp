// RGB-D recordings as other data sets publish them: each layout gives the frames, the truth and the run of
// the sequence that it was written of.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/media/image_codec.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/run/sequence_origin.hpp"
#include "core/sequence/fingerprint.hpp"
#include "tests/support/archive_writer.hpp"
#include "tests/unit/rgbd_miniature.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kFrames = kMiniatureFrames;

bool is_jpeg(const RgbdLayout& layout) { return layout.files.names(0, 0.0).colour.ends_with(".jpg"); }

/// A frame's colour as it comes back.
cv::Mat colour_in(const RgbdLayout& layout, const cv::Mat& colour) {
  return is_jpeg(layout) ? decode_pixels(encode_jpeg(colour, 95)) : colour;
}

/// Registered depth against the depth that the scene has, where both are: errors in the median, and what
/// share of it is there.
void expect_registered(const cv::Mat& depth, const cv::Mat& exact) {
  std::vector<double> errors;
  for (int y = 40; y < depth.rows - 40; ++y)
    for (int x = 60; x < depth.cols - 60; ++x)
      if (depth.at<float>(y, x) > 0)
        errors.push_back(std::abs(depth.at<float>(y, x) / exact.at<float>(y, x) - 1.0));
  ASSERT_GT(static_cast<double>(errors.size()), 0.75 * (depth.rows - 80) * (depth.cols - 120));
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.004);
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.02);
}

class EveryRgbdLayout : public ::testing::TestWithParam<const RgbdLayout*> {};

TEST_P(EveryRgbdLayout, ReadsBackTheSame) {
  const RgbdLayout& layout = *GetParam();
  const auto read = open(layout);
  ASSERT_EQ(read->size(), kFrames);
  const Camera &camera = read->camera(), &expected = made().camera();
  EXPECT_NEAR(camera.fx, expected.fx, 1e-9);
  EXPECT_NEAR(camera.fy, expected.fy, 1e-9);
  EXPECT_NEAR(camera.cx, expected.cx, 1e-9);
  EXPECT_NEAR(camera.cy, expected.cy, 1e-9);
  EXPECT_EQ(cv::Size(camera.width, camera.height), cv::Size(640, 480));
  EXPECT_DOUBLE_EQ(camera.depth_scale, layout.files.units);
  EXPECT_TRUE(read->has_depth() && read->has_masks());
  for (int i = 0; i < kFrames; ++i) {
    const Frame found = read->read(i);
    EXPECT_EQ(found.problem, "") << i;
    EXPECT_EQ(cv::norm(found.colour, colour_in(layout, original(i).colour), cv::NORM_INF), 0) << i;
    EXPECT_LT(cv::norm(found.colour, original(i).colour, cv::NORM_L1) / (3.0 * 640 * 480), 4.0) << i;
    if (layout.files.own_depth_camera) {
      expect_registered(found.depth, true_of(i).depth);
    } else {
      EXPECT_LT(cv::norm(found.depth, original(i).depth, cv::NORM_INF), 0.5 / layout.files.units + 1e-6) << i;
      EXPECT_EQ(cv::countNonZero(found.depth > 0), cv::countNonZero(original(i).depth > 0)) << i;
    }
    EXPECT_EQ(cv::norm(read->truth(i).moving, true_of(i).moving, cv::NORM_INF), 0) << i;
    EXPECT_NEAR(found.timestamp - read->timestamp(0), made().timestamp(i) - made().timestamp(0), 2e-5) << i;
  }
}

TEST_P(EveryRgbdLayout, HasTheTruthOfTheSequence) {
  const auto read = open(*GetParam());
  if (GetParam() == &kOpen3dLayout) {
    EXPECT_TRUE(read->ground_truth().empty());  // a recording, which nobody reconstructed yet
    return;
  }
  EvaluationOptions alone;
  alone.align = AlignBy::nothing;
  Trajectory stamped, expected;
  for (int i = 0; i < kFrames; ++i) {
    const auto pose = read->truth(i).world_from_camera;
    ASSERT_TRUE(pose) << i;
    const Pose off = true_of(i).world_from_camera->inverse() * *pose;
    EXPECT_LT(off.translation().norm(), 1e-4) << i;      // m
    EXPECT_LT(rotation_angle(off.linear()), 1e-4) << i;  // rad
    stamped.push_back({made().timestamp(i), *pose});
    expected.push_back({made().timestamp(i), *true_of(i).world_from_camera});
  }
  const TrajectoryEvaluation evaluation = evaluate_trajectory(expected, stamped, alone);
  EXPECT_LT(evaluation.ate.translation_m.rmse, 1e-4);
}

RunResult run_oracle(const FrameSource& source) {
  Config config;
  config.run.method = "oracle";
  config.run.threads = 2;
  return run_sequence(source, config);
}

TEST_P(EveryRgbdLayout, GivesTheTumFoldersRun) {
  static const RunResult plain = run_oracle(*open_sequence(miniature(nullptr).string()));
  const RgbdLayout& layout = *GetParam();
  const RunResult read = run_oracle(*open(layout));
  // The same pixels, depths and stamps give the same run to the last bit. What JPEG or millimetres took moves
  // a pose by little, frame numbers are other stamps, and a depth camera of its own has noise of its own.
  const bool has_seconds = layout.files.names(7, 0.5).stamp == 0.5;
  if (!is_jpeg(layout) && layout.files.units == 5000 && !layout.files.own_depth_camera && has_seconds) {
    EXPECT_EQ(run_hash(read.records), run_hash(plain.records));
  }
  ASSERT_EQ(read.trajectory.size(), plain.trajectory.size());
  for (std::size_t i = 0; i < plain.trajectory.size(); ++i) {
    const Pose off = plain.trajectory[i].world_from_camera.inverse() * read.trajectory[i].world_from_camera;
    EXPECT_LT(off.translation().norm(), 0.01) << i;  // m
  }
}

/// A finished run opens its sequence by what it wrote down of it.
TEST_P(EveryRgbdLayout, IsFoundAgainByItsRun) {
  const std::string where = miniature(GetParam()).string();
  const auto source = open(*GetParam());
  const auto json = to_json(origin_of(*source, where, options_of(*GetParam())), "");
  const SequenceOrigin origin = origin_from_json(nlohmann::json::parse(json.dump()));
  OpenOptions again;
  again.camera = origin.camera;
  again.truth = origin.truth;
  EXPECT_EQ(sequence_fingerprint(*open_sequence(origin.where, again)), origin.fingerprint);
}

/// What is exported of a sequence is a folder of its own, with registered depth.
TEST_P(EveryRgbdLayout, IsWrittenAsATumFolderThatReadsTheSame) {
  const TemporaryFolder folder;
  const auto source = open(*GetParam());
  write_sequence(*source, folder.path(), {.force = true});
  const auto written = open_sequence(folder.path());
  ASSERT_EQ(written->size(), kFrames);
  EXPECT_EQ(written->camera().depth_camera, nullptr);
  const Frame a = source->read(1), b = written->read(1);
  EXPECT_EQ(cv::norm(a.colour, b.colour, cv::NORM_INF), 0);
  EXPECT_LT(cv::norm(a.depth, b.depth, cv::NORM_INF), 0.5 / source->camera().depth_scale + 1e-6);
}

TEST_P(EveryRgbdLayout, OpensAsAnArchive) {
  const TemporaryFolder places("archives");
  const RgbdLayout& layout = *GetParam();
  const std::string path = places.path("layout.zip");
  write_archive(path, miniature(&layout).string(), "zip", "some_name");
  const auto packed = open_sequence(path, options_of(layout)), folder = open(layout);
  ASSERT_EQ(packed->size(), folder->size());
  EXPECT_EQ(packed->camera().fx, folder->camera().fx);
  EXPECT_EQ(packed->ground_truth().size(), folder->ground_truth().size());
  const Frame a = packed->read(2), b = folder->read(2);
  EXPECT_EQ(cv::norm(a.colour, b.colour, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.depth, b.depth, cv::NORM_INF), 0);
}

TEST_P(EveryRgbdLayout, IsReplacedByForceAlone) {
  const RgbdLayout& layout = *GetParam();
  const TemporaryFolder folder;
  const auto sequence = make_generated_sequence("room", 2, 1);
  write_sequence(*sequence, folder.path(), {.rgbd = &layout});
  folder.write("notes.txt", std::string("mine"));
  EXPECT_THAT(input_error_of([&] { write_sequence(*sequence, folder.path(), {.rgbd = &layout}); }),
              HasSubstr("holds a sequence already"));
  write_sequence(*sequence, folder.path(), {.force = true});
  EXPECT_EQ(open_sequence(folder.path())->size(), 2);
  for (const char* mixed :
       {"color", "results", "pose", "sensors.yaml", "calibration.txt", "frame-000000.color.png"})
    EXPECT_TRUE(!fs::exists(folder.path(mixed)) || fs::is_empty(folder.path(mixed))) << mixed;
  EXPECT_EQ(folder.read("notes.txt"), "mine");
}

std::string test_name(const ::testing::TestParamInfo<const RgbdLayout*>& tested) {
  std::string name = tested.param->name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Rgbd, EveryRgbdLayout,
                         ::testing::ValuesIn(rgbd_layouts().begin(), rgbd_layouts().end()), test_name);

}  // namespace
}  // namespace stillpoint
