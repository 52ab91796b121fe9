#include "ui/panels/removal_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/run/removal_errors.hpp"

namespace stillpoint {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

RemovalSummary summarise(const std::vector<RemovalError>& errors) {
  RemovalSummary summary;
  std::vector<double> with, without, oracle, widened;
  for (const RemovalError& one : errors) {
    if (!std::isfinite(one.with_removal_m) || !std::isfinite(one.without_removal_m)) continue;
    ++summary.compared;
    summary.helped += one.helped ? 1 : 0;
    summary.hurt += one.hurt ? 1 : 0;
    with.push_back(one.with_removal_m);
    without.push_back(one.without_removal_m);
    if (std::isfinite(one.widened)) widened.push_back(one.widened);
    const double gain = one.without_removal_m - one.with_removal_m;
    if (one.helped && gain > summary.greatest_gain_m) {
      summary.greatest_gain_m = gain;
      summary.best_frame = one.frame;
    }
    if (one.hurt && -gain > summary.greatest_harm_m) {
      summary.greatest_harm_m = -gain;
      summary.worst_frame = one.frame;
    }
    if (!std::isfinite(one.oracle_m)) continue;
    ++summary.oracle;
    summary.beat_oracle += one.with_removal_m < one.oracle_m ? 1 : 0;
    oracle.push_back(one.oracle_m);
  }
  summary.median_widened = median(widened);
  summary.median_with_m = median(std::move(with));
  summary.median_without_m = median(std::move(without));
  summary.median_oracle_m = median(std::move(oracle));
  return summary;
}

std::string sentence_of(const RemovalSummary& summary) {
  if (summary.compared == 0) return "No frame has been solved both with and without removal yet.";
  return fmt::format("Removal helped in {} of {} frame{}, hurt in {}, and changed nothing in {}.",
                     summary.helped, summary.compared, summary.compared == 1 ? "" : "s", summary.hurt,
                     summary.compared - summary.helped - summary.hurt);
}

std::vector<int> by_harm(const std::vector<RemovalError>& errors) {
  std::vector<std::pair<double, int>> ranked;
  for (const RemovalError& one : errors)
    if (one.hurt) ranked.emplace_back(one.without_removal_m - one.with_removal_m, one.frame);
  std::sort(ranked.begin(), ranked.end());
  std::vector<int> frames;
  for (const auto& [gain, frame] : ranked) frames.push_back(frame);
  return frames;
}

}  // namespace stillpoint
