#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/run/condition.hpp"

namespace stillpoint {

std::string Condition::reach(const FrameFigures& figures, const std::vector<int>& among) const {
  std::vector<std::string> parts;
  for (const int column : columns_) {
    const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(column)];
    std::vector<std::pair<double, int>> values;  // with the frame of each
    for (int row = 0; row < figures.rows(); ++row)
      if (const double value = figures.value(row, column);
          !std::isnan(value) && std::binary_search(among.begin(), among.end(), figures.frame(row)))
        values.emplace_back(value, figures.frame(row));
    if (values.empty()) {
      parts.push_back(fmt::format("none has {}", info.name));
      continue;
    }
    const auto by_value = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto [least, most] = std::minmax_element(values.begin(), values.end(), by_value);
    if (least->first == most->first && info.unit == FigureUnit::truth)
      parts.push_back(fmt::format("{} at {}", info.name, least->first == 0.0 ? "none" : "all"));
    else if (least->first == most->first)
      parts.push_back(fmt::format("{} is {} throughout", info.name, shown_value(info, least->first)));
    else if (info.unit == FigureUnit::truth)
      parts.push_back(fmt::format("{} at some", info.name));
    else
      parts.push_back(fmt::format("{} from {} (frame {}) to {} (frame {})", info.name,
                                  shown_value(info, least->first), least->second,
                                  shown_value(info, most->first), most->second));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace stillpoint
