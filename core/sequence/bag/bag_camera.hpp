#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/sequence/bag/message_log.hpp"
#include "core/sequence/bag/messages.hpp"

namespace stillpoint {

/// The camera that a sensor_msgs/CameraInfo describes: K and D of images as they are, P of rectified ones.
/// plumb_bob is Camera's own distortion. rational_polynomial is, where its denominator is 1; otherwise
/// Camera's distortion is laid through it by least squares over the image, and `warnings` say by how much
/// that is off. Its region of interest and binning make it the camera of the images that are sent.
/// @param is_rectified the images are
/// @param images their size, px; 0x0 where it is not known
/// @param why_not receives one sentence where there is no such camera: not calibrated, another distortion
[[nodiscard]] std::optional<Camera> camera_of_info(const CameraInfoMessage& info, bool is_rectified,
                                                   cv::Size images, const std::string& path,
                                                   std::string& why_not, std::vector<std::string>& warnings);

/// The camera that a topic of sensor_msgs/CameraInfo describes: that of the first message that has one. One
/// that changes later is told. @param why_not receives what is wrong with the first message where none has
/// one
[[nodiscard]] std::optional<Camera> camera_of_topic(const MessageLog& log, std::size_t topic,
                                                    bool is_rectified, cv::Size images, std::string& why_not,
                                                    std::vector<std::string>& warnings);

/// Whether it is the made-up calibration that drivers give a Kinect nobody calibrated: 525 px, no distortion.
[[nodiscard]] bool is_factory_default(const Camera& camera);

}  // namespace stillpoint
