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

/// The size (px) of a packed mask; empty for an empty pack. No image is made for it, which may be thousands
/// of times as large.
/// @throws ByteStreamReader::Exhausted for a pack that is not whole
cv::Size check_mask(const PackedMask& pack);

/// CV_8UC1, 0 and 255; empty for an empty pack.
/// @throws ByteStreamReader::Exhausted for a pack that is not whole
[[nodiscard]] cv::Mat unpack_mask(const PackedMask& pack);

/// A record with its features.
void write_record(ByteStreamWriter& to, const FrameRecord& record);
/// @throws ByteStreamReader::Exhausted, for what is of no known kind as well
[[nodiscard]] FrameRecord read_record(ByteStreamReader& from);

/// A record without its features.
void write_record_figures(ByteStreamWriter& to, const FrameRecord& record);
/// @throws as read_record does
[[nodiscard]] FrameRecord read_record_figures(ByteStreamReader& from);

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

/// @param ground_truth the sequence's
void write_end(ByteStreamWriter& to, const RunResult& run, const Trajectory& ground_truth);
/// @throws ByteStreamReader::Exhausted
[[nodiscard]] RunEnd read_end(ByteStreamReader& from);

}  // namespace stillpoint
