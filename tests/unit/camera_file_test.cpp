#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "core/geometry/camera.hpp"
#include "core/sequence/folder_camera.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CameraFiles : public testing::Test {
 protected:
  Camera read(const std::string& text) const {
    folder_.write("c.yaml", text);
    return camera_from_argument(folder_.path("c.yaml"));
  }
  std::string complaint(const std::string& text) const {
    return input_error_of([&] { (void)read(text); });
  }
  TemporaryFolder folder_;
};

void expect_camera(const Camera& c, int width, int height, std::array<double, 4> intrinsics,
                   std::array<double, 5> distortion, double depth_scale) {
  EXPECT_EQ(std::tie(c.width, c.height), std::tie(width, height));
  EXPECT_THAT((std::array{c.fx, c.fy, c.cx, c.cy}), testing::ElementsAreArray(intrinsics));
  EXPECT_THAT((std::array{c.k1, c.k2, c.p1, c.p2, c.k3}), testing::ElementsAreArray(distortion));
  EXPECT_EQ(c.depth_scale, depth_scale);
}

TEST_F(CameraFiles, OfOrbSlamAreRead) {
  expect_camera(
      read("%YAML:1.0\n\n#----\n# Camera calibration\nCamera.fx: 517.3\nCamera.fy: 516.5\nCamera.cx: 318.6\n"
           "Camera.cy: 255.3\nCamera.k1: 0.26\nCamera.k2: -0.95\nCamera.p1: -0.005\nCamera.p2: "
           "0.002\nCamera.k3: "
           "1.16\nCamera.width: 640\nCamera.height: 480\nCamera.fps: 30.0\nDepthMapFactor: 5000.0\n"
           "ORBextractor.nFeatures: 1000\n"),
      640, 480, {517.3, 516.5, 318.6, 255.3}, {0.26, -0.95, -0.005, 0.002, 1.16}, 5000);
  expect_camera(
      read("%YAML:1.0\n---\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 617.2\nCamera1.fy: "
           "617.3\nCamera1.cx: 324.6\nCamera1.cy: 242.8\nCamera1.k1: 0.1\nCamera.width: 640\nCamera.height: "
           "480\nRGBD.DepthMapFactor: 1000.0\nStereo.T_c1_c2: !!opencv-matrix\n  rows: 1\n  cols: 2\n  dt: "
           "f\n  data: "
           "[1, 0]\n"),
      640, 480, {617.2, 617.3, 324.6, 242.8}, {0.1, 0, 0, 0, 0}, 1000);
}

TEST_F(CameraFiles, OfKalibrEurocAndRosAreRead) {
  expect_camera(
      read("cam0:\n  camera_model: pinhole\n  intrinsics: [461.629, 460.152, 362.68, 246.049]\n"
           "  distortion_model: radtan\n  distortion_coeffs: [-0.27, 0.06, 0.001, 0.0005]\n"
           "  resolution: [752, 480]\n  rostopic: /cam0/image_raw\ncam1:\n  intrinsics: [1, 1, 1, 1]\n"),
      752, 480, {461.629, 460.152, 362.68, 246.049}, {-0.27, 0.06, 0.001, 0.0005, 0}, 5000);
  expect_camera(
      read("# General sensor definitions.\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, "
           "0.0, 0.0, "
           "0.0,\n         0.0, 1.0, 0.0, 0.0,\n         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\n"
           "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.654, 457.296, "
           "367.215, "
           "248.375] #fu, fv, cu, cv\ndistortion_model: radial-tangential\ndistortion_coefficients: [-0.283, "
           "0.0739, "
           "0.00019, 1.76e-05]\n"),
      752, 480, {458.654, 457.296, 367.215, 248.375}, {-0.283, 0.0739, 0.00019, 1.76e-05, 0}, 5000);
  expect_camera(read("image_width: 1280\nimage_height: 720\ncamera_name: narrow\ncamera_matrix:\n  rows: 3\n "
                     " cols: 3\n  data: "
                     "[900, 0, 640, 0, 901, 360, 0, 0, 1]\ndistortion_model: "
                     "plumb_bob\ndistortion_coefficients:\n  rows: "
                     "1\n  cols: 5\n  data: [0.1, -0.2, 0, 0, 0.05]\n"),
                1280, 720, {900, 901, 640, 360}, {0.1, -0.2, 0, 0, 0.05}, 5000);
}

TEST_F(CameraFiles, ThatCannotBeUsedAreToldInOneSentence) {
  EXPECT_THAT(complaint("Camera.type: \"KannalaBrandt8\"\nCamera1.fx: 190\n"),
              HasSubstr("only PinHole is read"));
  EXPECT_THAT(complaint("cam0:\n  camera_model: omni\n  intrinsics: [1, 2, 3, 4]\n"),
              HasSubstr("only pinhole"));
  EXPECT_THAT(
      complaint(
          "cam0:\n  camera_model: pinhole\n  intrinsics: [1, 2, 3, 4]\n  distortion_model: equidistant\n"),
      HasSubstr("only radial-tangential"));
  EXPECT_THAT(complaint("Camera.fx: 517\nCamera.fy: 516\nCamera.cx: 318\n"), HasSubstr("has no Camera.cy"));
  EXPECT_THAT(complaint("Camera.fx: many\nCamera.fy: 516\n"),
              HasSubstr("c.yaml:1: Camera.fx takes a number"));
  EXPECT_THAT(complaint("cam0:\n  intrinsics: [1, 2]\n"), HasSubstr("takes 4 numbers or more, found 2"));
  EXPECT_THAT(complaint("Camera.fx: 900\nCamera.fy: 900\nCamera.cx: 640\nCamera.cy: 360\n"),
              HasSubstr("width and height are missing"));
  EXPECT_THAT(complaint("cam0: [1, 2\nx: }\n"), HasSubstr("not a readable camera file"));
  EXPECT_THAT(complaint("just text"), HasSubstr("no camera file"));
  EXPECT_THAT(complaint("a: 1\n"), HasSubstr("names no camera, expected Camera.fx"));
  EXPECT_THAT(input_error_of([&] { (void)camera_from_argument(folder_.path("none.yaml")); }),
              HasSubstr("cannot be read"));
}

TEST_F(CameraFiles, ANegativeFyIsIclNuims) {
  folder_.write("icl.toml", "fx = 481.2\nfy = -480.0\ncx = 319.5\ncy = 239.5\n");
  EXPECT_THAT(input_error_of([&] { (void)camera_from_argument(folder_.path("icl.toml")); }),
              HasSubstr("`--truth mirrored-y`"));
}

TEST(FolderNames, TellACameraByWholeWordsOnly) {
  const auto name = [](const char* folder) {
    const auto camera = camera_from_folder_name(folder);
    return camera ? camera->name : std::string("none");
  };
  for (const char* none : {"vehicle_cam", "particles", "trajectories", "traj_05", "my_living_room", "bicycle",
                           "bonnet", "article_1", "afr1ca", "kitchen", "fr12_test", "traj12", ""})
    EXPECT_EQ(name(none), "none") << none;
  for (const char* icl :
       {"living_room_traj2_frei_png", "office_room_traj0_loop", "ICL-NUIM", "icl_test", "traj3_frei_png"})
    EXPECT_EQ(name(icl), "icl_nuim") << icl;
  EXPECT_EQ(name("rgbd_dataset_freiburg2_desk"), "freiburg2");
  EXPECT_EQ(name("my fr3 walking"), "freiburg3");
  EXPECT_EQ(name("rgbd_bonn_balloon"), "bonn");
}

TEST(CameraForSize, IsNeverStretched) {
  std::vector<std::string> warnings;
  const Camera freiburg1 = camera_by_name("freiburg1");
  const Camera wide = camera_for_size(freiburg1, {640, 360}, "f", warnings);
  EXPECT_THAT(std::tie(wide.width, wide.height), testing::FieldsAre(640, 360));
  EXPECT_NEAR(wide.fx, freiburg1.fx, 1e-9);
  EXPECT_NEAR(wide.fy, freiburg1.fy, 1e-9);
  EXPECT_NEAR(wide.cy, freiburg1.cy - 60, 1e-9);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("sides do not fit the 640x480 px of camera freiburg1")));
  warnings.clear();
  const Camera hd = camera_for_size(freiburg1, {1280, 720}, "f", warnings);
  EXPECT_NEAR(hd.fx, 2 * freiburg1.fx, 1e-9);
  EXPECT_NEAR(hd.fy, 2 * freiburg1.fy, 1e-9);
  warnings.clear();
  const Camera half = camera_for_size(freiburg1, {320, 240}, "f", warnings);
  EXPECT_NEAR(half.fy, 0.5 * freiburg1.fy, 1e-9);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("were scaled to them")));
  warnings.clear();
  (void)camera_for_size(freiburg1, {640, 480}, "f", warnings);
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(CameraForSize, APrincipalPointFarFromTheMiddleIsTold) {
  Camera doubled = camera_by_name("freiburg1");  // intrinsics of 1280x960 px, and the size of 640x480
  doubled.fx *= 2, doubled.fy *= 2, doubled.cx *= 2, doubled.cy *= 2;
  std::vector<std::string> warnings;
  (void)camera_for_size(doubled, {640, 480}, "f", warnings);
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr("(637, 511) of 640x480 px, far from the middle: are its intrinsics of "
                                    "images of another size?")));
  warnings.clear();
  Camera halved = camera_by_name("freiburg1");
  halved.fx /= 2, halved.fy /= 2, halved.cx /= 2, halved.cy /= 2;
  (void)camera_for_size(halved, {640, 480}, "f", warnings);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("(159, 128) of 640x480 px, far from the middle")));
  warnings.clear();
  Camera cropped = camera_by_name("freiburg1");  // the left half of a sensor's upper rows
  cropped.cx = 620;
  (void)camera_for_size(cropped, {640, 480}, "f", warnings);
  EXPECT_THAT(warnings, IsEmpty());
}

}  // namespace
}  // namespace stillpoint
