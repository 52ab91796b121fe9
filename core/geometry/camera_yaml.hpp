#pragma once

#include <string>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace stillpoint {

/// Reads a camera from another program's YAML: ORB-SLAM's (`Camera.fx`, ORB-SLAM3's `Camera1.fx`, with
/// `DepthMapFactor`), a camchain of Kalibr (its first camera), EuRoC's `sensor.yaml`, or a ROS or OpenCV
/// calibration (`camera_matrix`). Only pinhole cameras with Brown-Conrady distortion are taken. What a file
/// does not say keeps Camera's default.
/// @throws InputError on a missing file, a syntax error (with its line), another camera or distortion model,
/// and values
///         that are missing or out of range.
[[nodiscard]] Camera read_yaml_camera(const std::string& path);

/// The same of a text that is at hand; `path` names it in messages.
[[nodiscard]] Camera read_yaml_camera_text(const std::string& path, std::string text);

/// Where a sensor of EuRoC sits on its body: T_BS of its `sensor.yaml`.
/// @throws InputError where it is missing or no rigid motion
[[nodiscard]] Pose read_yaml_body_from_sensor(const std::string& path, std::string text);

}  // namespace stillpoint
