// RGB-D recordings as other data sets publish them: what a layout says otherwise than TUM's, and each way it
// can be wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/archive_writer.hpp"
#include "tests/unit/rgbd_miniature.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

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
    EXPECT_EQ(source.ground_truth().size(), static_cast<std::size_t>(kMiniatureFrames - 1));
    for (int i = 0; i < kMiniatureFrames; ++i)
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
  for (int i = kMiniatureFrames - 1; i > 0; --i)
    for (const auto& [folder, end] : {std::pair("color", "jpg"), {"depth", "png"}, {"pose", "txt"}})
      fs::rename(spoilt.folder.path(fmt::format("{}/{}.{}", folder, i, end)),
                 spoilt.folder.path(fmt::format("{}/{}.{}", folder, 20 * i, end)));
  fs::remove(spoilt.folder.path("mask.txt"));
  const auto part = spoilt.open(), whole = open(kScanNetLayout);
  ASSERT_EQ(part->size(), kMiniatureFrames);
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
  EXPECT_EQ(source->ground_truth().size(), static_cast<std::size_t>(kMiniatureFrames));
}

TEST(RgbdLayouts, RedwoodsNamesAreFrameNumbersOrMicroseconds) {
  const auto renamed = [](const std::function<std::string(int)>& name_of) {
    auto spoilt = std::make_unique<Spoilt>(kRedwoodLayout);
    for (int i = kMiniatureFrames; i > 0; --i)
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
  for (int i = 0; i < kMiniatureFrames; ++i) {
    scannet.remove(fmt::format("depth/{}.png", i));
    seven.remove(fmt::format("frame-{:06}.depth.png", i));
    replica.remove(fmt::format("results/depth{:06}.png", i));
  }
  for (const Spoilt* spoilt : {&seven, &replica, &scannet}) {
    const auto source = spoilt->open();
    EXPECT_FALSE(source->has_depth());
    EXPECT_EQ(source->size(), kMiniatureFrames);
    EXPECT_THAT(source->warnings(), Contains(HasSubstr("has no depth images")));
  }
}

TEST(RgbdLayouts, SizesThatDifferAreSaid) {
  const Spoilt azure(kOpen3dLayout);
  for (int i = 0; i < kMiniatureFrames; ++i)
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
  EXPECT_EQ(cut.open()->ground_truth().size(), static_cast<std::size_t>(kMiniatureFrames - 1));
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
  EXPECT_EQ(open_sequence(folder.path("b"))->size(), kMiniatureFrames);
}

}  // namespace
}  // namespace stillpoint
