#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "core/odometry/frame_record.hpp"
#include "core/run/byte_stream.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {

// What a run leaves, as bytes of `records.bin` (records_file.hpp) and back, to the last bit.

/// A mask as the lengths of its runs: far smaller, and quickly made.
using PackedMask = std::vector<std::uint8_t>;

/// @param mask CV_8UC1, zero or not; empty gives an empty pack
[[nodiscard]] PackedMask pack_mask(const cv::Mat& mask);

/// CV_8UC1, 0 and 255; empty for an empty pack.
/// @throws ByteReader::Exhausted for a pack that is not whole
[[nodiscard]] cv::Mat unpack_mask(const PackedMask& pack);

/// A record with its features.
void write_record(ByteWriter& to, const FrameRecord& record);
/// @throws ByteReader::Exhausted
[[nodiscard]] FrameRecord read_record(ByteReader& from);

/// What is known once a run has ended.
struct RunEnd {
  std::vector<FrameScores> scores;  ///< one a record
  std::vector<SavedKeyframe> keyframes;
  std::vector<SavedPoint> points, moved;
  Trajectory trajectory;    ///< as trajectory.txt holds it, unrounded
  Trajectory ground_truth;  ///< the sequence's
  double orb_unit_ms = 0.0;
  bool interrupted = false;
};

void write_end(ByteWriter& to, const RunEnd& end);
/// @throws ByteReader::Exhausted
[[nodiscard]] RunEnd read_end(ByteReader& from);

}  // namespace stillpoint
