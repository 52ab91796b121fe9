// ScanNet as its SensReader exports it: color/0.jpg (1296x968), depth/0.png (640x480, mm), pose/0.txt (4x4,
// camera to world; -inf where the camera was lost), and intrinsic/ with the matrices of both cameras and
// their places (body from camera), which are the identity where the scan was aligned.
#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"

namespace stillpoint {
namespace {

const cv::Size kScanNetColour(1296, 968);  // px, as filmed

/// A camera of an intrinsic matrix. @param size of its images
Camera camera_of_matrix(const FileStore& folder, const std::string& name, cv::Size size) {
  if (!folder.is_file(name))
    throw InputError(fmt::format("{}: is missing; it says how ScanNet's camera sees (or --camera FILE does)",
                                 folder.path_of(name)));
  const Eigen::Matrix4d k = read_matrix(folder, name);
  Camera camera;
  camera.name = "scannet";
  camera.width = size.width, camera.height = size.height;
  camera.fx = k(0, 0), camera.fy = k(1, 1), camera.cx = k(0, 2), camera.cy = k(1, 2);
  camera.depth_scale = kMillimetreScale;
  check_camera(folder.path_of(name), camera);
  return camera;
}

Pose place_of(const FileStore& folder, const std::string& name) {
  if (!folder.is_file(name)) return Pose::Identity();
  const auto pose = rigid_pose(read_matrix(folder, name));
  if (!pose) throw InputError(fmt::format("{}: is no rigid motion", folder.path_of(name)));
  return *pose;
}

bool is_near_middle(const Camera& camera) {
  constexpr double kFarthest = 0.15;  // of the width
  return std::abs(camera.cx / camera.width - 0.5) < kFarthest;
}

Camera scannet_camera(const FileStore& folder, const FolderLists& lists) {
  constexpr const char *kColour = "intrinsic/intrinsic_color.txt", *kDepth = "intrinsic/intrinsic_depth.txt";
  Camera camera = camera_of_matrix(folder, kColour, first_size(folder, lists.colours));
  // Colour images that were made smaller on exporting keep the matrix of what was filmed.
  if (!is_near_middle(camera)) camera.width = kScanNetColour.width, camera.height = kScanNetColour.height;
  if (!lists.depths) return camera;
  DepthCamera depth;
  depth.camera = camera_of_matrix(folder, kDepth, first_size(folder, *lists.depths));
  depth.colour_from_depth = place_of(folder, "intrinsic/extrinsic_color.txt").inverse() *
                            place_of(folder, "intrinsic/extrinsic_depth.txt");
  camera.depth_camera = std::make_shared<const DepthCamera>(depth);
  return camera;
}

std::optional<RgbdRecording> read_scannet(const FileStore& folder, const OpenOptions& options) {
  if (has_image_lists(folder) || !(folder.is_folder("intrinsic") || folder.is_folder("pose")))
    return std::nullopt;
  ImageList colours = images_of(folder, "color");
  if (colours.entries.empty()) return std::nullopt;
  RgbdRecording recording;
  recording.unit = StampUnit::frames;
  recording.lists = numbered_images(folder, std::move(colours), images_of(folder, "depth"));
  recording.camera =
      given_camera_or(folder, options, [&] { return scannet_camera(folder, *recording.lists); });
  recording.truth = read_pose_files(folder, recording.lists->colours, "pose", [](const ListEntry& image) {
    return "pose/" + std::filesystem::path(image.file).stem().string() + ".txt";
  });
  recording.body_from_camera = place_of(folder, "intrinsic/extrinsic_color.txt");
  return recording;
}

void write_scannet(const WrittenRgbd& written) {
  const DepthCamera depth = miniature_depth_camera();
  // Poses are the depth camera's, as ScanNet's are of what was fused.
  const Pose depth_from_colour = depth.colour_from_depth.inverse();
  const std::filesystem::path folder = written.folder / "intrinsic";
  std::filesystem::create_directories(folder);
  std::filesystem::create_directories(written.folder / "pose");
  write_text_file(folder / "intrinsic_color.txt", matrix_text(intrinsic_matrix(written.source.camera())));
  write_text_file(folder / "intrinsic_depth.txt", matrix_text(intrinsic_matrix(depth.camera)));
  write_text_file(folder / "extrinsic_color.txt", matrix_text(depth_from_colour.matrix()));
  write_text_file(folder / "extrinsic_depth.txt", matrix_text(Eigen::Matrix4d::Identity()));
  for (int i = 0; i < written.frames; ++i) {
    const auto pose = written.pose(i);
    const Eigen::Matrix4d lost = Eigen::Matrix4d::Constant(-INFINITY);
    write_text_file(written.folder / "pose" / fmt::format("{}.txt", i),
                    matrix_text(pose ? (*pose * depth.colour_from_depth).matrix() : lost));
  }
}

}  // namespace

const RgbdLayout kScanNetLayout = {
    "scannet",
    read_scannet,
    {[](int index, double) {
       return RgbdNames{fmt::format("color/{}.jpg", index), fmt::format("depth/{}.png", index),
                        static_cast<double>(index)};
     },
     kMillimetreScale, 0, true, write_scannet, "color/*.jpg depth/*.png pose/*.txt intrinsic/*.txt"}};

}  // namespace stillpoint
