#include "core/motion/entering.hpp"

#include <algorithm>
#include <vector>

#include "core/motion/carrier.hpp"
#include "core/motion/segments.hpp"

namespace stillpoint {
namespace {

constexpr int kFewestKnown = 5;      // pixels of a patch that speak for the rest
constexpr float kFromBeside = 1.5F;  // log-odds that neighbours hand on at most: they make nothing firm

}  // namespace

void inherit_memory(const RgbdView& current, const cv::Mat& labels, std::size_t patches,
                    const Pose& previous_from_current, cv::Mat& prior) {
  struct Known {
    double sum = 0.0;
    int pixels = 0, fresh = 0;
  };
  std::vector<Known> known(patches);
  cv::Mat fresh = cv::Mat::zeros(labels.size(), CV_8UC1);
  Carrier carried(current.camera, previous_from_current);
  int all_fresh = 0;
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* remembered = prior.ptr<float>(y);
    carried.carry_row(y, current.depth.ptr<float>(y));
    for (int x = 0; x < labels.cols; ++x) {
      if (label[x] < 0) continue;
      Known& patch = known[static_cast<std::size_t>(label[x])];
      if (carried.inside(x)) {
        if (remembered[x] != 0) patch.sum += remembered[x], ++patch.pixels;  // 0: nothing is known of it
      } else {
        fresh.ptr<uchar>(y)[x] = 255, ++patch.fresh, ++all_fresh;
      }
    }
  }
  if (all_fresh == 0) return;

  std::vector<float> value(patches, 0.0F);
  std::vector<std::uint8_t> has(patches, 0);
  bool any_unknown = false;
  for (std::size_t i = 0; i < patches; ++i) {
    has[i] = known[i].pixels >= kFewestKnown;
    if (has[i] != 0) value[i] = static_cast<float>(known[i].sum / known[i].pixels);
    any_unknown = any_unknown || (has[i] == 0 && known[i].fresh > 0);
  }
  if (any_unknown) {
    // Inwards from what is known, a ring of patches at a time.
    const std::vector<Contact> touching = contacts(current, labels);
    for (bool grew = true; grew;) {
      grew = false;
      std::vector<float> sums(patches, 0.0F), weights(patches, 0.0F);
      const auto tell = [&](int from, int to, int boundary) {
        const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
        if (has[f] == 0 || has[t] != 0) return;
        sums[t] += static_cast<float>(boundary) * value[f];
        weights[t] += static_cast<float>(boundary);
      };
      for (const Contact& contact : touching)
        tell(contact.a, contact.b, contact.boundary), tell(contact.b, contact.a, contact.boundary);
      for (std::size_t i = 0; i < patches; ++i)
        if (weights[i] > 0) value[i] = std::min(kFromBeside, sums[i] / weights[i]), has[i] = 1, grew = true;
    }
  }
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* is_fresh = fresh.ptr<uchar>(y);
    auto* out = prior.ptr<float>(y);
    for (int x = 0; x < labels.cols; ++x)
      if (is_fresh[x] != 0) out[x] = std::max(0.0F, value[static_cast<std::size_t>(label[x])]);
  }
}

}  // namespace stillpoint
