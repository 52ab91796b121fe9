#pragma once

#include <string>

#include "core/hash.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {

/// A fingerprint of all that a run computed, grown frame by frame: equal for equal results, timings left out.
class RunHash {
 public:
  void add(const FrameRecord& record);
  [[nodiscard]] std::string hex() const { return print_.hex(); }  ///< 16 digits, of the frames so far

 private:
  Fingerprint print_;
};

/// Whether two frames were computed alike, as far as a run's hash can tell.
[[nodiscard]] bool computed_alike(const FrameRecord& a, const FrameRecord& b);

/// Whether two runs of different programs part at a frame: one has its pose and the other has not, or the
/// camera's motion since the frame before differs by more than 2 cm or 1 degree. Worlds need not be aligned.
[[nodiscard]] bool part_ways(const FrameRecords& a, const FrameRecords& b, std::size_t frame);

}  // namespace stillpoint
