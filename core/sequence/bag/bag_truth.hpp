#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/trajectory.hpp"
#include "core/sequence/bag/message_log.hpp"
#include "core/sequence/bag/topic_choice.hpp"

namespace stillpoint {

/// Ground truth of a recording, as it was found in it.
struct BagTruth {
  std::optional<std::size_t> topic;  ///< that it is of
  std::string path;                  ///< as messages name it
  Trajectory poses;                  ///< s, increasing
  std::string why_not;               ///< what is there is of no use: one sentence
  std::vector<std::string> warnings;
};

/// Reads ground truth: the topic that was asked for, or else what can be nothing but truth: tf's way from the
/// colour images' frame up to a world, or a topic of poses that is named after motion capture; of several,
/// the one whose body tf joins with the camera, or else whose name speaks most of it, and how many there were
/// is told. Odometry and maps are somebody's estimates, and are read as truth only when asked for.
/// @param camera_frame the colour images'; poses of a body that tf holds fixed to it are made poses of it
[[nodiscard]] BagTruth read_bag_truth(const MessageLog& log, const TopicChoice& choice,
                                      const std::string& camera_frame);

}  // namespace stillpoint
