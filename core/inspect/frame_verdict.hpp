#pragma once

#include <string>
#include <vector>

namespace stillpoint {

struct RunView;

/// How a part of a verdict reads.
enum class Tone { neutral, good, bad };

/// How one frame of a run went, in a line: figures first, then a sentence that names the likeliest cause.
struct FrameVerdict {
  struct Part {
    std::string text;  ///< "step error 37.10 mm, 1st of 59", "mask 3.3 %, IoU 12 %"
    Tone tone = Tone::neutral;
  };
  std::vector<Part> parts;
  std::string sentence;  ///< "31 of 60 inliers lie on dynamic objects; the mask holds 12 % of these."
  bool bad = false;      ///< the sentence tells of a failure
};

/// @param row index into run.records
/// @param hurt frames that removal made worse, ascending (removal_errors)
/// A step counts as bad when it is among the worst tenth and more than twice the median of the run. One that is off
/// because it comes back to the truth is told from one that leaves it.
[[nodiscard]] FrameVerdict frame_verdict(const RunView& run, std::size_t row,
                                         const std::vector<int>& hurt = {});

}  // namespace stillpoint
