#pragma once

#include <memory>

#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {

class ByteStore;

/// Lists whose full chunks lie in a store, to the last bit and with all their parts.
[[nodiscard]] FrameRecords records_put_by(std::shared_ptr<ByteStore> store);
[[nodiscard]] ScoreList scores_put_by(std::shared_ptr<ByteStore> store);

}  // namespace stillpoint
