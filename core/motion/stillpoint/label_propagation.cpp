#include "core/motion/stillpoint/label_propagation.hpp"

#include <algorithm>
#include <vector>

namespace stillpoint {
namespace {

constexpr int kFewestKnown = 5;      // pixels of a superpixel that speak for the rest
constexpr float kFromBeside = 1.5F;  // log-odds that neighbours hand on at most: they make nothing firm

}  // namespace

void propagate_labels(const cv::Mat& newly_observed, const Superpixels& superpixels, cv::Mat& prior) {
  struct Known {
    double sum = 0.0;
    int pixels = 0, newly_observed = 0;
  };
  if (cv::countNonZero(newly_observed) == 0) return;
  const cv::Mat& labels = superpixels.labels;
  const std::size_t count = superpixels.all.size();
  std::vector<Known> known(count);
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* before = prior.ptr<float>(y);
    const auto* new_here = newly_observed.ptr<uchar>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (label[x] < 0) continue;
      Known& superpixel = known[static_cast<std::size_t>(label[x])];
      if (new_here[x] != 0)
        ++superpixel.newly_observed;
      else if (before[x] != 0)  // 0: nothing is known of it
        superpixel.sum += before[x], ++superpixel.pixels;
    }
  }

  std::vector<float> value(count, 0.0F);
  std::vector<std::uint8_t> has(count, 0);
  bool any_unknown = false;
  for (std::size_t i = 0; i < count; ++i) {
    has[i] = known[i].pixels >= kFewestKnown;
    if (has[i] != 0) value[i] = static_cast<float>(known[i].sum / known[i].pixels);
    any_unknown = any_unknown || (has[i] == 0 && known[i].newly_observed > 0);
  }
  if (any_unknown) {
    // Inwards from what is known, a ring of superpixels at a time.
    for (bool grew = true; grew;) {
      grew = false;
      std::vector<float> sums(count, 0.0F), weights(count, 0.0F);
      const auto tell = [&](int from, int to, int boundary) {
        const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
        if (has[f] == 0 || has[t] != 0) return;
        sums[t] += static_cast<float>(boundary) * value[f];
        weights[t] += static_cast<float>(boundary);
      };
      for (const AdjacencyEdge& edge : superpixels.adjacency)
        tell(edge.a, edge.b, edge.boundary), tell(edge.b, edge.a, edge.boundary);
      for (std::size_t i = 0; i < count; ++i)
        if (weights[i] > 0) value[i] = std::min(kFromBeside, sums[i] / weights[i]), has[i] = 1, grew = true;
    }
  }
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* new_here = newly_observed.ptr<uchar>(y);
    auto* out = prior.ptr<float>(y);
    for (int x = 0; x < labels.cols; ++x)
      if (new_here[x] != 0 && label[x] >= 0)
        out[x] = std::max(0.0F, value[static_cast<std::size_t>(label[x])]);
  }
}

}  // namespace stillpoint
