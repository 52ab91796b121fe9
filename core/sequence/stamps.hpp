#pragma once

#include <string_view>
#include <vector>

namespace stillpoint {

/// The rate at which frame numbers are taken to have been filmed where nobody says another.
inline constexpr double kFrameNumberRate = 30.0;  // Hz

/// What stamps are written in. Every reader of lists and trajectories converts to seconds by the same rules.
enum class StampUnit { seconds, milliseconds, microseconds, nanoseconds, frames };

/// "seconds", "milliseconds", …, "frame numbers".
[[nodiscard]] std::string_view to_string(StampUnit unit);

/// @param frame_rate Hz, of frame numbers
[[nodiscard]] double seconds_per(StampUnit unit, double frame_rate = kFrameNumberRate);

/// The unit that stamps are most likely written in: by size where they count from 1970 (a second of today has
/// 10 digits, a millisecond 13, …), otherwise by their median step, which for cameras and trackers lies
/// between 2 ms and 2 s. Whole numbers below ten million that go up by ones, or by one small step (every
/// fifth frame), are frame numbers. Nothing is known of an empty list, nor of one small stamp: seconds.
/// @param stamps in any order
[[nodiscard]] StampUnit unit_of(std::vector<double> stamps);

/// The unit of stamps that belong beside others, which are in seconds already: of the reference's own unit,
/// what unit_of says, and all others, the one under which most stamps and references find one another closer
/// than `tolerance` seconds (the fewer of both count); the first of these in case of a draw. Frame numbers are considered only for whole
/// numbers.
/// @param reference_s in increasing order, s; @param stamps in increasing order
[[nodiscard]] StampUnit unit_beside(const std::vector<double>& stamps, const std::vector<double>& reference_s,
                                    StampUnit reference_unit, double frame_rate, double tolerance);

/// How many of `stamps` have one of `reference` closer than `tolerance`; both in increasing order.
[[nodiscard]] int meetings(const std::vector<double>& stamps, const std::vector<double>& reference,
                           double tolerance);

}  // namespace stillpoint
