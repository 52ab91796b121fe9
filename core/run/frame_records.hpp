#pragma once

#include <memory>

#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/tracked_poses.hpp"

namespace stillpoint {

class ByteStore;

/// Where the outlines of records that are put by lie.
enum class Outlines {
  put_by,   ///< with them
  at_hand,  ///< in memory, for who goes over them again and again
};

/// Lists whose full chunks lie in a store, to the last bit and with all their parts.
[[nodiscard]] FrameRecords records_put_by(const std::shared_ptr<ByteStore>& store,
                                          Outlines outlines = Outlines::put_by);
[[nodiscard]] ScoreList scores_put_by(std::shared_ptr<ByteStore> store);
[[nodiscard]] TrackedPoses poses_put_by(std::shared_ptr<ByteStore> store);

}  // namespace stillpoint
