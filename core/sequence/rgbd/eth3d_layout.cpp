// ETH3D SLAM: the TUM layout with calibration.txt, one line of fx fy cx cy; images are undistorted, depth is
// 5000 a metre and registered.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr const char* kCalibration = "calibration.txt";

/// The four numbers of the file; empty where it holds something else.
std::vector<double> calibration_of(const FileStore& folder) {
  std::vector<double> numbers;
  const auto lines = text_lines(folder.read_text(kCalibration));
  if (lines.size() == 1)
    for (const std::string_view column : split_columns(lines.front().text))
      numbers.push_back(parse_number(column).value_or(std::nan("")));
  return numbers.size() == 4 ? numbers : std::vector<double>();
}

Camera eth3d_camera(const FileStore& folder, const OpenOptions& options) {
  const std::string path = folder.path_of(kCalibration);
  const auto numbers = calibration_of(folder);
  if (numbers.empty()) {
    // Another data set's folder, whose name says which, may have a file of that name.
    for (const std::string& name : folder.own_names())
      if (const auto known = camera_from_folder_name(name)) return *known;
    throw InputError(
        fmt::format("{}: expected one line of fx fy cx cy, as ETH3D has it (or --camera FILE)", path));
  }
  Camera camera;
  camera.name = "eth3d";
  camera.fx = numbers[0], camera.fy = numbers[1], camera.cx = numbers[2], camera.cy = numbers[3];
  const cv::Size size = first_size(folder, read_folder_lists(folder, options.frame_rate).colours);
  camera.width = size.width, camera.height = size.height;
  check_camera(path, camera);
  return camera;
}

std::optional<RgbdRecording> read_eth3d(const FileStore& folder, const OpenOptions& options) {
  if (!folder.is_file(kCalibration) || !has_image_lists(folder)) return std::nullopt;
  RgbdRecording recording;
  recording.camera = given_camera_or(folder, options, [&] { return eth3d_camera(folder, options); });
  return recording;
}

RgbdNames eth3d_names(int, double seconds) {
  return {fmt::format("rgb/{:.6f}.png", seconds), fmt::format("depth/{:.6f}.png", seconds), seconds};
}

void write_eth3d(const WrittenRgbd& written) {
  const Camera& c = written.source.camera();
  write_text_file(written.folder / kCalibration, fmt::format("{} {} {} {}\n", c.fx, c.fy, c.cx, c.cy));
  write_tum_texts(written, eth3d_names, "rgb.txt", "depth.txt");
  std::string pairs;
  for (int i = 0; i < written.frames; ++i) {
    const RgbdNames image = eth3d_names(i, written.source.timestamp(i));
    pairs += fmt::format("{0:.6f} {1} {0:.6f} {2}\n", image.stamp, image.colour, image.depth);
  }
  write_text_file(written.folder / "associated.txt", pairs);
  if (!written.source.ground_truth().empty())
    write_tum_trajectory((written.folder / "groundtruth.txt").string(), written.source.ground_truth());
}

}  // namespace

const RgbdLayout kEth3dLayout = {"eth3d",
                                 read_eth3d,
                                 {eth3d_names, 5000.0, 0, false, write_eth3d,
                                  "rgb/*.png depth/*.png rgb.txt depth.txt associated.txt calibration.txt"}};

}  // namespace stillpoint
