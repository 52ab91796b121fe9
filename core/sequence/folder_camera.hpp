#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/sequence/file_store.hpp"

namespace stillpoint {

/// The camera of a folder's `camera.toml` or `camera.yaml`; nothing where it has none.
/// @throws InputError for a camera file that cannot be read
[[nodiscard]] std::optional<Camera> camera_in_folder(const FileStore& folder);

/// Refuses intrinsics that no camera has. @param path of the file that gives them, for messages
/// @throws InputError in one sentence
void check_camera(const std::string& path, const Camera& camera);

/// The camera of a folder: `given` (the command line's), else its `camera.toml` or `camera.yaml`, else what
/// its own, its parent's or its archive's name says, else ros_default, which is told.
/// @throws InputError for a camera file that cannot be read
[[nodiscard]] Camera camera_of_folder(const FileStore& folder, const std::optional<Camera>& given,
                                      std::vector<std::string>& warnings);

/// The camera for images of this size. Images of the same sides are scaled. Images of other sides are taken
/// for the middle of what the camera sees, as sensors crop them, and never for stretched; either is told, as
/// is a principal point far from the middle.
[[nodiscard]] Camera camera_for_size(const Camera& camera, cv::Size size, const std::string& folder,
                                     std::vector<std::string>& warnings);

}  // namespace stillpoint
