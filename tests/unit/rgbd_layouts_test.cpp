// RGB-D recordings as other data sets publish them: miniatures with exact truth, and each way they can be
// wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/media/image_codec.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/run/sequence_origin.hpp"
#include "core/sequence/fingerprint.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/support/archive_writer.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kFrames = 5;
constexpr const char* kKind = "walking_xyz";

/// The sequence that all miniatures are of, its frames rendered once.
const FrameSource& made() {
  static const auto sequence = make_generated_sequence(kKind, kFrames, 1);
  return *sequence;
}
const Frame& original(int i) {
  static const std::vector<Frame> frames = [] {
    std::vector<Frame> all;
    for (int k = 0; k < kFrames; ++k) all.push_back(made().read(k));
    return all;
  }();
  return frames[static_cast<std::size_t>(i)];
}
const FrameTruth& true_of(int i) {
  static const std::vector<FrameTruth> truths = [] {
    std::vector<FrameTruth> all;
    for (int k = 0; k < kFrames; ++k) all.push_back(made().truth(k));
    return all;
  }();
  return truths[static_cast<std::size_t>(i)];
}

/// One miniature for all tests of a layout: they copy what they change. Null: the TUM layout.
const fs::path& miniature(const RgbdLayout* layout) {
  static std::map<const RgbdLayout*, std::unique_ptr<TemporaryFolder>> folders;
  static std::map<const RgbdLayout*, fs::path> paths;
  if (!folders.contains(layout)) {
    folders[layout] = std::make_unique<TemporaryFolder>("miniature");
    paths[layout] = folders[layout]->path();
    write_sequence(made(), paths[layout], {.force = true, .rgbd = layout});
  }
  return paths[layout];
}

/// How a layout's truth is to be read: as it stands, but for those that the program tells the switch of.
OpenOptions options_of(const RgbdLayout& layout) {
  OpenOptions options;
  if (&layout == &kBonnLayout) options.truth = PoseConvention::bonn;
  if (&layout == &kIclLayout) options.truth = PoseConvention::mirrored_y;
  return options;
}

std::unique_ptr<FrameSource> open(const RgbdLayout& layout) {
  return open_sequence(miniature(&layout).string(), options_of(layout));
}

/// A copy of a miniature that a test may spoil.
struct Spoilt {
  explicit Spoilt(const RgbdLayout& layout) {
    fs::copy(miniature(&layout), folder.path(), fs::copy_options::recursive);
  }
  [[nodiscard]] std::string error() const {
    return input_error_of([this] { (void)open(); });
  }
  [[nodiscard]] std::unique_ptr<FrameSource> open(const OpenOptions& options = {}) const {
    return open_sequence(folder.path(), options);
  }
  void remove(const std::string& name) const { ASSERT_GT(fs::remove_all(folder.path(name)), 0U) << name; }
  void replace(const std::string& file, const std::string& what, const std::string& by) const {
    std::string text = folder.read(file);
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << file << " has no " << what;
    folder.write(file, text.replace(at, what.size(), by));
  }
  TemporaryFolder folder{"spoilt"};
};

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

// ---- what a layout says otherwise than TUM's

TEST(RgbdLayouts, SevenScenesHasItsOwnCameraAndInvalidDepth) {
  const Spoilt spoilt(kSevenScenesLayout);
  spoilt.remove("camera.toml");
  const cv::Mat stored = cv::imread(spoilt.folder.path("frame-000001.depth.png"), cv::IMREAD_UNCHANGED);
  ASSERT_GT(cv::countNonZero(stored == 65535), 1000);
  const auto source = spoilt.open();
  EXPECT_EQ(source->camera().fx, 585.0);
  EXPECT_EQ(source->camera().cy, 240.0);
  EXPECT_EQ(source->camera().depth_scale, 1000.0);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("7-Scenes has no calibration")));
  const Frame frame = source->read(1);
  EXPECT_EQ(cv::countNonZero(frame.depth > 0), cv::countNonZero(stored != 65535));
  double deepest = 0;
  cv::minMaxLoc(frame.depth, nullptr, &deepest);
  EXPECT_LT(deepest, 12.0);
}

TEST(RgbdLayouts, ACameraInTheFolderOrGivenGoesBeforeTheLayouts) {
  const Spoilt spoilt(kEth3dLayout);
  OpenOptions options;
  options.camera = camera_by_name("freiburg1");
  EXPECT_EQ(spoilt.open(options)->camera().name, "freiburg1");
  spoilt.folder.write("camera.toml", std::string("name = \"own\"\nfx = 500\nfy = 500\ncx = 320\ncy = 240\n"));
  EXPECT_EQ(spoilt.open()->camera().name, "own");
  spoilt.remove("camera.toml");
  EXPECT_EQ(spoilt.open()->camera().name, "eth3d");
}

TEST(RgbdLayouts, AMissingPoseCostsThatPose) {
  const auto expect_lost = [](const FrameSource& source, int lost, const char* told) {
    EXPECT_EQ(source.ground_truth().size(), static_cast<std::size_t>(kFrames - 1));
    for (int i = 0; i < kFrames; ++i)
      EXPECT_EQ(source.truth(i).world_from_camera.has_value(), i != lost) << i;
    EXPECT_THAT(source.warnings(), Contains(HasSubstr(told)));
  };
  const Spoilt seven(kSevenScenesLayout), scannet(kScanNetLayout), redwood(kRedwoodLayout),
      replica(kReplicaLayout);
  seven.remove("frame-000002.pose.txt");
  expect_lost(*seven.open(), 2, "1 of 5 images have no pose");
  const std::string lost = "-inf -inf -inf -inf\n";
  scannet.folder.write("pose/3.txt", lost + lost + lost + lost);
  expect_lost(*scannet.open(), 3, "1 of 5 poses are not finite");
  scannet.folder.write("pose/3.txt", std::string("1 0 0 0\n0 1 0 zero\n"));
  expect_lost(*scannet.open(), 3, "pose/3.txt: is no 4x4 matrix of numbers");
  scannet.folder.write("pose/3.txt", std::string("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"));
  expect_lost(*scannet.open(), 3, "pose/3.txt: is no rigid motion");
  std::string log = redwood.folder.read("trajectory.log");
  const auto from = log.find("2 2 3\n"), to = log.find("3 3 4\n");
  redwood.folder.write("trajectory.log",
                       log.substr(0, from) + "2 2 3\n" + lost + lost + lost + lost + log.substr(to));
  expect_lost(*redwood.open(), 2, "is no rigid motion, and costs its pose");
  std::string rows = replica.folder.read("traj.txt");
  const auto second = rows.find('\n') + 1, third = rows.find('\n', second);
  rows.replace(second, third - second, "nan nan nan nan nan nan nan nan nan nan nan nan 0 0 0 1");
  replica.folder.write("traj.txt", rows);
  expect_lost(*replica.open(), 1, "NaN");
}

TEST(RgbdLayouts, AMissingDepthImageCostsThatDepth) {
  for (const auto& [layout, name] :
       {std::pair(&kSevenScenesLayout, "frame-000002.depth.png"),
        std::pair(&kReplicaLayout, "results/depth000002.png"), std::pair(&kScanNetLayout, "depth/2.png")}) {
    const Spoilt spoilt(*layout);
    spoilt.remove(name);
    const auto source = spoilt.open();
    EXPECT_TRUE(source->read(1).has_depth());
    EXPECT_FALSE(source->read(2).has_depth());
    EXPECT_THAT(source->read(2).problem, HasSubstr("no depth image")) << name;
  }
}

/// Every twentieth frame of a scan, as people export it: numbers are frames whatever their step.
TEST(RgbdLayouts, APartOfAScanKeepsItsFrameNumbers) {
  const Spoilt spoilt(kScanNetLayout);
  for (int i = kFrames - 1; i > 0; --i)
    for (const auto& [folder, end] : {std::pair("color", "jpg"), {"depth", "png"}, {"pose", "txt"}})
      fs::rename(spoilt.folder.path(fmt::format("{}/{}.{}", folder, i, end)),
                 spoilt.folder.path(fmt::format("{}/{}.{}", folder, 20 * i, end)));
  fs::remove(spoilt.folder.path("mask.txt"));
  const auto part = spoilt.open(), whole = open(kScanNetLayout);
  ASSERT_EQ(part->size(), kFrames);
  EXPECT_NEAR(part->timestamp(3), 2.0, 1e-9);
  ASSERT_TRUE(part->truth(3).world_from_camera);
  EXPECT_TRUE(part->truth(3).world_from_camera->isApprox(*whole->truth(3).world_from_camera, 1e-9));
  EXPECT_TRUE(part->read(3).has_depth());
}

TEST(RgbdLayouts, ColourOfScanNetThatWasMadeSmallerKeepsItsField) {
  const Spoilt spoilt(kScanNetLayout);
  spoilt.folder.write("intrinsic/intrinsic_color.txt",
                      std::string("1170 0 648 0\n0 1170 484 0\n0 0 1 0\n0 0 0 1\n"));
  const auto source = spoilt.open();
  EXPECT_NEAR(source->camera().fx, 1170.0 * 640 / 1296, 1e-9);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("were scaled to them")));
}

TEST(RgbdLayouts, ReplicasCameraLiesAboveItsSequences) {
  const TemporaryFolder data("Replica");
  fs::copy(miniature(&kReplicaLayout), data.path("room0"), fs::copy_options::recursive);
  fs::rename(data.path("room0/cam_params.json"), data.path("cam_params.json"));
  EXPECT_DOUBLE_EQ(open_sequence(data.path("room0"))->camera().depth_scale, 6553.5);
  fs::remove(data.path("cam_params.json"));
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(data.path("room0")); }),
              HasSubstr("has no cam_params.json, neither here nor in the folder above"));
}

TEST(RgbdLayouts, IntrinsicsRowByRowAreReadAndTold) {
  const Spoilt spoilt(kOpen3dLayout);
  spoilt.folder.write("intrinsic.json",
                      std::string("{\"width\": 640, \"height\": 480, \"depth_scale\": 4000.0, "
                                  "\"intrinsic_matrix\": [500, 0, 321, 0, 501, 241, 0, 0, 1]}"));
  const auto source = spoilt.open();
  EXPECT_EQ(source->camera().cx, 321);
  EXPECT_EQ(source->camera().cy, 241);
  EXPECT_EQ(source->camera().depth_scale, 4000);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("is written row by row")));
}

TEST(RgbdLayouts, RedwoodWithoutIntrinsicsIsPrimeSenses) {
  const Spoilt spoilt(kRedwoodLayout);
  spoilt.remove("camera_primesense.json");
  const auto source = spoilt.open();
  EXPECT_EQ(source->camera().fx, 525.0);
  EXPECT_EQ(source->camera().depth_scale, 1000.0);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("PrimeSense's default is taken")));
  EXPECT_EQ(source->ground_truth().size(), static_cast<std::size_t>(kFrames));
}

TEST(RgbdLayouts, RedwoodsNamesAreFrameNumbersOrMicroseconds) {
  const auto renamed = [](const std::function<std::string(int)>& name_of) {
    auto spoilt = std::make_unique<Spoilt>(kRedwoodLayout);
    for (int i = kFrames; i > 0; --i)
      for (const char* folder : {"image", "depth"})
        fs::rename(spoilt->folder.path(fmt::format("{}/{:06}.png", folder, i)),
                   spoilt->folder.path(fmt::format("{}/{}.png", folder, name_of(i))));
    spoilt->remove("mask.txt");
    return spoilt;
  };
  const auto fiftieth = renamed([](int i) { return fmt::format("{:06}", 50 * i); });
  EXPECT_NEAR(fiftieth->open()->timestamp(1) - fiftieth->open()->timestamp(0), 50 / 30.0, 1e-9);
  const auto scan = renamed([](int i) { return fmt::format("{:07}-{:012}", i, 33333 * i); });
  const auto source = scan->open();
  EXPECT_NEAR(source->timestamp(1) - source->timestamp(0), 0.033333, 1e-9);
  EXPECT_TRUE(source->read(4).has_depth());
  ASSERT_TRUE(source->truth(4).world_from_camera);
  EXPECT_TRUE(
      source->truth(4).world_from_camera->isApprox(*open(kRedwoodLayout)->truth(4).world_from_camera, 1e-9));
}

TEST(RgbdLayouts, OpenLorisTruthIsOfTheRobotUnlessItSaysWhereTheCameraSits) {
  const Spoilt spoilt(kOpenLorisLayout);
  spoilt.remove("trans_matrix.yaml");
  const auto source = spoilt.open();
  EXPECT_TRUE(source->ground_truth().empty());
  EXPECT_THAT(source->why_not(FramePart::truth),
              HasSubstr("trans_matrix.yaml: is missing; groundtruth.txt is of base_link"));
}

TEST(RgbdLayouts, IclAndBonnTellTheSwitchThatReadsTheirTruth) {
  EXPECT_THAT(open_sequence(miniature(&kIclLayout).string())->warnings(),
              Contains(AllOf(HasSubstr("mirrored in y"), HasSubstr("--truth mirrored-y"))));
  EXPECT_THAT(open_sequence(miniature(&kBonnLayout).string())->warnings(),
              Contains(HasSubstr("--truth bonn")));
  const Spoilt spoilt(kIclLayout);
  spoilt.remove("camera.toml");
  EXPECT_EQ(spoilt.open()->camera().name, "icl_nuim");
}

TEST(RgbdLayouts, ACalibrationOfAnotherKindIsNotEth3ds) {
  const TemporaryFolder folder("rgbd_dataset_freiburg1_own");
  fs::copy(miniature(&kEth3dLayout), folder.path(), fs::copy_options::recursive);
  folder.write("calibration.txt", std::string("made on Monday\nwith a chessboard\n"));
  EXPECT_EQ(open_sequence(folder.path())->camera().name, "freiburg1");
}

TEST(RgbdLayouts, AnArchiveThatIsCutOffIsNamedWhereACalibrationIsMissing) {
  const TemporaryFolder places("archives");
  const std::string path = places.path("scene.tar");
  const Spoilt spoilt(kReplicaLayout);
  spoilt.remove("cam_params.json");
  write_archive(path, spoilt.folder.path(), "tar", "scene");
  fs::resize_file(path, fs::file_size(path) * 2 / 3);
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(path); }),
              AllOf(HasSubstr("has no cam_params.json"), HasSubstr("is cut off")));
}

// ---- what is missing or wrong

TEST(RgbdLayouts, CalibrationThatIsMissingOrWrongIsSaidInOneSentence) {
  const Spoilt scannet(kScanNetLayout), loris(kOpenLorisLayout), eth(kEth3dLayout), azure(kOpen3dLayout),
      replica(kReplicaLayout);
  scannet.remove("intrinsic/intrinsic_depth.txt");
  EXPECT_THAT(scannet.error(),
              HasSubstr("intrinsic_depth.txt: is missing; it says how ScanNet's camera sees"));
  scannet.folder.write("intrinsic/intrinsic_depth.txt", std::string("0 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"));
  EXPECT_THAT(scannet.error(), HasSubstr("intrinsic_depth.txt: is no camera: fx 0"));
  scannet.folder.write("intrinsic/extrinsic_color.txt", std::string("7 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"));
  scannet.folder.write("intrinsic/intrinsic_depth.txt",
                       std::string("280 0 160 0\n0 280 120 0\n0 0 1 0\n0 0 0 1\n"));
  EXPECT_THAT(scannet.error(), HasSubstr("extrinsic_color.txt: is no rigid motion"));
  loris.replace("sensors.yaml", "d400_color_optical_frame:", "t265_fisheye1_optical_frame:");
  EXPECT_THAT(loris.error(), HasSubstr("sensors.yaml: d400_color_optical_frame has no width"));
  loris.folder.write("sensors.yaml", std::string("%YAML:1.0\n---\na: [1, 2\n"));
  EXPECT_THAT(loris.error(), HasSubstr("is no YAML"));
  loris.folder.write(
      "sensors.yaml",
      std::string("d400_color_optical_frame:\n  width: wide\n  height: 480\n  intrinsics:\n    data: "
                  "[1, 2, 3, 4]\n"));
  EXPECT_THAT(loris.error(), HasSubstr("sensors.yaml:2: bad conversion"));
  eth.folder.write("calibration.txt", std::string("535 539\n"));
  EXPECT_THAT(eth.error(), HasSubstr("calibration.txt: expected one line of fx fy cx cy"));
  eth.folder.write("calibration.txt", std::string("535 -539 320 240\n"));
  EXPECT_THAT(eth.error(), HasSubstr("calibration.txt: is no camera: fx 535, fy -539"));
  azure.folder.write("intrinsic.json", std::string("{\"intrinsic_matrix\": [1, 2, 3]}"));
  EXPECT_THAT(azure.error(), HasSubstr("intrinsic_matrix has 3 numbers, expected 9"));
  azure.folder.write("intrinsic.json", std::string("{\"intrinsic_matrix\": [500,0,0,0,500,0,320,240,1]}"));
  EXPECT_THAT(azure.error(), HasSubstr("is no intrinsic of Open3D"));
  replica.folder.write("cam_params.json", std::string("{\"camera\": {\"w\": \"wide\"}}"));
  EXPECT_THAT(replica.error(), HasSubstr("cam_params.json: is no camera of Replica"));
  replica.folder.write("cam_params.json", std::string("{"));
  EXPECT_THAT(replica.error(), HasSubstr("cam_params.json: is no camera of Replica"));
}

TEST(RgbdLayouts, ImagesThatAreMissingAreSaid) {
  const Spoilt seven(kSevenScenesLayout), replica(kReplicaLayout), scannet(kScanNetLayout);
  for (int i = 0; i < kFrames; ++i) {
    scannet.remove(fmt::format("depth/{}.png", i));
    seven.remove(fmt::format("frame-{:06}.depth.png", i));
    replica.remove(fmt::format("results/depth{:06}.png", i));
  }
  for (const Spoilt* spoilt : {&seven, &replica, &scannet}) {
    const auto source = spoilt->open();
    EXPECT_FALSE(source->has_depth());
    EXPECT_EQ(source->size(), kFrames);
    EXPECT_THAT(source->warnings(), Contains(HasSubstr("has no depth images")));
  }
}

TEST(RgbdLayouts, SizesThatDifferAreSaid) {
  const Spoilt azure(kOpen3dLayout);
  for (int i = 0; i < kFrames; ++i)
    azure.folder.write(fmt::format("depth/{:05}.png", i), cv::Mat(288, 320, CV_16UC1, cv::Scalar(2000)));
  const auto source = azure.open();
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(
      source->why_not(FramePart::depth),
      AllOf(HasSubstr("is 320x288 px, but its colour image is 640x480 px"), HasSubstr("[depth_camera]")));
}

TEST(RgbdLayouts, ATrajectoryThatIsNoneCostsTheTruth) {
  const Spoilt redwood(kRedwoodLayout), replica(kReplicaLayout);
  redwood.replace("trajectory.log", "1 1 2\n", "one two\n");
  EXPECT_THAT(redwood.open()->why_not(FramePart::truth),
              HasSubstr("trajectory.log:6: found 'one two', expected the three numbers that begin a pose"));
  redwood.folder.truncate("trajectory.log", 0.5);
  EXPECT_TRUE(redwood.open()->has_depth());
  replica.folder.write("traj.txt", std::string("no numbers\n"));
  EXPECT_TRUE(replica.open()->ground_truth().empty());
  EXPECT_THAT(replica.open()->why_not(FramePart::truth), HasSubstr("traj.txt"));
  const Spoilt cut(kRedwoodLayout);
  cut.folder.truncate("trajectory.log", 0.9);
  EXPECT_EQ(cut.open()->ground_truth().size(), static_cast<std::size_t>(kFrames - 1));
  EXPECT_THAT(cut.open()->warnings(), Contains(HasSubstr("the last pose was cut short and skipped")));
}

TEST(RgbdLayouts, OfUnknownNameAreRefusedWithTheNames) {
  EXPECT_THAT(input_error_of([] { (void)rgbd_layout_by_name("nyu"); }),
              AllOf(HasSubstr("--layout nyu: expected tum, 7-scenes"), HasSubstr("scannet")));
}

TEST(RgbdLayouts, ASourceThatIsNoSceneIsNotFilmedByAnotherCamera) {
  const TemporaryFolder folder;
  const auto recorded = open_sequence(miniature(nullptr).string());
  EXPECT_THAT(input_error_of([&] { write_sequence(*recorded, folder.path("a"), {.rgbd = &kScanNetLayout}); }),
              HasSubstr("only a generated sequence is filmed"));
  write_sequence(*recorded, folder.path("b"), {.rgbd = &kReplicaLayout});
  EXPECT_EQ(open_sequence(folder.path("b"))->size(), kFrames);
}

}  // namespace
}  // namespace stillpoint
