#include "core/sequence/association.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace stillpoint {

std::vector<AssociatedPair> associate(const std::vector<double>& first, const std::vector<double>& second,
                                      double tolerance) {
  std::vector<AssociatedPair> candidates;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    while (begin < second.size() && first[i] - second[begin] >= tolerance) ++begin;
    for (std::size_t j = begin; j < second.size() && second[j] - first[i] < tolerance; ++j)
      candidates.push_back({i, j, first[i] - second[j]});
  }
  std::sort(candidates.begin(), candidates.end(), [](const AssociatedPair& a, const AssociatedPair& b) {
    return std::tuple(std::abs(a.difference), a.first, a.second) <
           std::tuple(std::abs(b.difference), b.first, b.second);
  });

  std::vector<bool> first_taken(first.size()), second_taken(second.size());
  std::vector<AssociatedPair> pairs;
  for (const AssociatedPair& pair : candidates) {
    if (first_taken[pair.first] || second_taken[pair.second]) continue;
    first_taken[pair.first] = second_taken[pair.second] = true;
    pairs.push_back(pair);
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const AssociatedPair& a, const AssociatedPair& b) { return a.first < b.first; });
  return pairs;
}

}  // namespace stillpoint
