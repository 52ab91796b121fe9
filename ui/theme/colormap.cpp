#include "ui/theme/colormap.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

using Table = std::array<Rgb, 256>;

Table make_table(int opencv_map) {
  cv::Mat ramp(1, 256, CV_8UC1), coloured;
  std::iota(ramp.begin<std::uint8_t>(), ramp.end<std::uint8_t>(), std::uint8_t{0});
  cv::applyColorMap(ramp, coloured, opencv_map);
  Table table;
  for (int i = 0; i < 256; ++i) {
    const auto& bgr = coloured.at<cv::Vec3b>(0, i);
    table[static_cast<std::size_t>(i)] = {bgr[2], bgr[1], bgr[0]};
  }
  return table;
}

}  // namespace

Rgb map_colour(Colormap map, float value) {
  static const std::array<Table, 3> tables = {
      make_table(cv::COLORMAP_VIRIDIS), make_table(cv::COLORMAP_CIVIDIS), make_table(cv::COLORMAP_INFERNO)};
  const float clamped = std::isnan(value) ? 0.0F : std::clamp(value, 0.0F, 1.0F);
  return tables[static_cast<std::size_t>(map)][static_cast<std::size_t>(std::lround(255.0F * clamped))];
}

}  // namespace stillpoint
