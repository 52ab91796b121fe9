#include "core/media/stored_depth.hpp"

#include <fmt/format.h>

#include <opencv2/core/fast_math.hpp>

namespace stillpoint {

StoredDepth stored_depth(const cv::Mat& metres, double units, std::uint16_t none) {
  StoredDepth stored;
  stored.image.create(metres.size(), CV_16UC1);
  for (int y = 0; y < metres.rows; ++y) {
    const auto* from = metres.ptr<float>(y);
    auto* to = stored.image.ptr<std::uint16_t>(y);
    for (int x = 0; x < metres.cols; ++x) {
      const double value = static_cast<double>(from[x]) * units;
      const bool too_far = value > kMostStored + 0.5;
      const int rounded = value > 0 && !too_far ? cvRound(value) : 0;
      to[x] = rounded > 0 ? static_cast<std::uint16_t>(rounded) : none;
      stored.too_far += too_far ? 1 : 0;
    }
  }
  return stored;
}

cv::Mat metres_of(const cv::Mat& stored, double units) {
  constexpr int kNothing = 65535;  // the largest value is what sensors write where they measured nothing
  CV_Assert(stored.type() == CV_16UC1);
  cv::Mat metres(stored.size(), CV_32FC1);
  const auto unit = static_cast<float>(1.0 / units);
  for (int y = 0; y < stored.rows; ++y) {
    const auto* from = stored.ptr<std::uint16_t>(y);
    auto* to = metres.ptr<float>(y);
    for (int x = 0; x < stored.cols; ++x)
      to[x] = static_cast<float>(from[x] == kNothing ? 0 : static_cast<int>(from[x])) * unit;
  }
  return metres;
}

std::string too_far_told(std::int64_t pixels, double units) {
  if (pixels == 0) return "";
  return fmt::format(
      "{} pixels of depth are farther than the {:.1f} m that 16 bits hold, and are written as not measured",
      pixels, kMostStored / units);
}

}  // namespace stillpoint
