#include "core/motion/peng2017/held_edges.hpp"

#include <cmath>
#include <limits>

namespace stillpoint {

std::vector<double> edge_strains(std::span<const PointPair> edges, std::span<const GraphPoint> here,
                                 std::span<const GraphPoint> last, const SceneFlowNoise& noise) {
  std::vector<double> strains;
  for (const PointPair& edge : edges) {
    const auto a = static_cast<std::size_t>(edge[0]), b = static_cast<std::size_t>(edge[1]);
    const EdgeLength now = edge_length(here[a], here[b], noise),
                     before = edge_length(last[a], last[b], noise);
    strains.push_back((now.length - before.length) / std::sqrt(now.variance + before.variance));
  }
  return strains;
}

std::vector<float> held_shares(std::size_t points, std::span<const PointPair> edges,
                               std::span<const double> strains, double cut_sigmas) {
  std::vector<int> all(points, 0), held(points, 0);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (const int end : edges[i]) {
      ++all[static_cast<std::size_t>(end)];
      held[static_cast<std::size_t>(end)] += std::abs(strains[i]) <= cut_sigmas ? 1 : 0;
    }
  std::vector<float> shares;
  for (std::size_t i = 0; i < points; ++i)
    shares.push_back(all[i] == 0 ? std::numeric_limits<float>::quiet_NaN()
                                 : static_cast<float>(held[i]) / static_cast<float>(all[i]));
  return shares;
}

std::vector<PointVerdict> verdicts_by_shares(std::span<const float> shares, double least) {
  std::vector<PointVerdict> verdicts;
  for (const float share : shares)
    verdicts.push_back(std::isnan(share)                    ? PointVerdict::kUnjudged
                       : static_cast<double>(share) > least ? PointVerdict::kStatic
                                                            : PointVerdict::kDynamic);
  return verdicts;
}

}  // namespace stillpoint
