#pragma once

#include <opencv2/core.hpp>

namespace stillpoint {

/// Whether the processor has AVX2, for which some loops are compiled a second time. What they give is the
/// same.
[[nodiscard]] inline bool has_wide_lanes() {
  static const bool has = cv::checkHardwareSupport(CV_CPU_AVX2);
  return has;
}

}  // namespace stillpoint
