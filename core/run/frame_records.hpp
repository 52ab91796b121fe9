#pragma once

#include <memory>

#include "core/chunked_list.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

class ByteStore;
struct FrameScores;

/// The records of a run's frames, in order: those of a run that goes on are walked over, and shared with who
/// shows them; those of a run without a window are put by, and read back at its end.
using FrameRecords = ChunkedList<FrameRecord>;
/// One a record.
using ScoreList = ChunkedList<FrameScores>;

/// Lists whose full chunks lie in a store, to the last bit and with all their parts.
[[nodiscard]] FrameRecords records_put_by(std::shared_ptr<ByteStore> store);
[[nodiscard]] ScoreList scores_put_by(std::shared_ptr<ByteStore> store);

}  // namespace stillpoint
