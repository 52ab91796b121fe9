#pragma once

#include <cstddef>
#include <initializer_list>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/bag/message_log.hpp"

namespace stillpoint {

/// What a topic of images holds, by its first message that says so: drivers begin with empty ones.
struct ImageTopic {
  std::size_t topic = 0;  ///< index into MessageLog::topics
  bool is_compressed = false;
  std::string encoding;  ///< empty where no message says one
  std::string frame;     ///< that the images are of
  cv::Size size;         ///< px; 0x0 where they are compressed
  bool may_be_depth = false, is_float = false;
};

/// Which topics of a recording are read as what.
struct TopicChoice {
  ImageTopic colour;
  std::optional<ImageTopic> depth;
  std::optional<std::size_t> info;         ///< sensor_msgs/CameraInfo of the colour images
  std::optional<std::size_t> truth;        ///< asked for by name: tf, or a topic of poses
  bool no_info = false, no_truth = false;  ///< `info=none`, `truth=none`
  std::string why_no_depth;                ///< depth is there and of no use: one sentence
  std::vector<std::string> warnings;       ///< what else there was to choose from, and what is of no use
};

/// Chooses topics:
/// - as `asked` says: `colour=/TOPIC,depth=/TOPIC,info=/TOPIC,truth=/TOPIC`, each may be left out, and all
/// but
///   colour may be `none` (`color` and `rgb` mean colour);
/// - otherwise by what they hold and how drivers name them: colour is what has 8 bits and is no infrared
///   image, of a camera with depth before others, raw before compressed; depth what has 16 bits or floats
///   and, of several, what is of the same camera and registered to colour; info as info_beside has it.
/// @throws InputError in one sentence for a recording without images, an option that is none, and a topic
/// that is not there or of another type
[[nodiscard]] TopicChoice choose_topics(const MessageLog& log, const std::string& asked);

/// The topics of sensor_msgs/CameraInfo that can be read.
[[nodiscard]] std::vector<std::size_t> info_topics(const MessageLog& log);

/// The sensor_msgs/CameraInfo that belongs to a topic of images: the one that shares most of its name with
/// it, or else the only one of its frame.
[[nodiscard]] std::optional<std::size_t> info_beside(const MessageLog& log, const ImageTopic& images);

/// Whether the name of a topic or of a coordinate frame, in small letters, holds one of the parts.
[[nodiscard]] bool has_any(const std::string& name, std::initializer_list<const char*> parts);

/// A line a topic: name, type, messages, what it is read as.
[[nodiscard]] std::vector<std::string> describe_topics(const MessageLog& log, const TopicChoice& choice,
                                                       std::optional<std::size_t> truth);

}  // namespace stillpoint
