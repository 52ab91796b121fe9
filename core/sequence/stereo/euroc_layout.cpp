#include <fmt/format.h>

#include "core/error.hpp"
#include "core/geometry/camera_yaml.hpp"
#include "core/sequence/stereo/stereo_recording.hpp"

namespace stillpoint {
namespace {

/// One of the two cameras as its folder has it.
struct AslCamera {
  ImageList images;
  Camera camera;
  Pose body_from_camera;
};

AslCamera read_camera_folder(const FileStore& folder, const std::string& name,
                             std::vector<std::string>& warnings) {
  if (!folder.is_folder(name))
    throw InputError(fmt::format("{}: is missing; depth comes of two images a frame, of cam0 and cam1",
                                 folder.path_of(name)));
  AslCamera read;
  const std::string data = name + "/data", list = name + "/data.csv", sensor = name + "/sensor.yaml";
  if (folder.is_there(list)) {
    read.images.path = folder.path_of(list);
    read.images.entries = read_list(read.images.path, folder.read_text(list), warnings);
    for (ListEntry& entry : read.images.entries) entry.file = data + "/" + entry.file;
  } else {
    read.images = images_of(folder, data);
    warnings.push_back(
        fmt::format("{}: is missing; the images of data/ were read by their names", folder.path_of(list)));
  }
  if (read.images.entries.empty())
    throw InputError(fmt::format("{}: names no images, and data/ holds none", folder.path_of(name)));
  if (!folder.is_there(sensor))
    throw InputError(
        fmt::format("{}: is missing; it says how the camera sees and where it sits, without which the "
                    "pair cannot be rectified",
                    folder.path_of(sensor)));
  const std::string path = folder.path_of(sensor), text = folder.read_text(sensor);
  read.camera = read_yaml_camera_text(path, text);
  read.body_from_camera = read_yaml_body_from_sensor(path, text);
  return read;
}

}  // namespace

std::optional<StereoRecording> read_euroc(const FileStore& folder, const OpenOptions& options) {
  std::string root;
  if (folder.is_folder("mav0"))
    root = "mav0/";
  else if (!folder.is_folder("cam0/data") && !folder.is_folder("cam1/data"))
    return std::nullopt;
  StereoRecording recording;
  std::vector<std::string>& warnings = recording.lists.warnings;
  AslCamera left = read_camera_folder(folder, root + "cam0", warnings),
            right = read_camera_folder(folder, root + "cam1", warnings);
  recording.rectification = std::make_shared<const StereoRectification>(
      left.camera, right.camera, right.body_from_camera.inverse() * left.body_from_camera, folder.place());
  recording.camera = recording.rectification->camera();
  recording.camera.name = "euroc";
  if (options.camera && options.camera->name != recording.camera.name)
    throw InputError(fmt::format(
        "{}: --camera does not go with two sensor.yaml, which say how to rectify the pair", folder.place()));
  recording.lists.stereo = recording.stamped_in_ns = true;
  recording.lists.colours = std::move(left.images);
  recording.lists.depths = std::move(right.images);
  recording.body_from_camera = left.body_from_camera * recording.rectification->left_from_rectified();
  const std::string truth = root + "state_groundtruth_estimate0/data.csv";
  if (folder.is_file(truth)) recording.truth = truth;
  return recording;
}

}  // namespace stillpoint
