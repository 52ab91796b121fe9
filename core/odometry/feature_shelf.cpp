#include "core/odometry/feature_shelf.hpp"

#include <cstdint>
#include <vector>

namespace stillpoint {

ShelvedFeatures::ShelvedFeatures(ByteStore& store, const std::shared_ptr<const FeatureSet>& features)
    : lately_(features) {
  const std::vector<std::uint8_t> bytes = features->packed();
  bytes_ = store.put(bytes.data(), bytes.size());
}

std::shared_ptr<const FeatureSet> ShelvedFeatures::get() const {
  if (std::shared_ptr<const FeatureSet> there = lately_.lock()) return there;
  std::vector<std::uint8_t> bytes(bytes_.size());
  bytes_.read(bytes.data());
  return std::make_shared<const FeatureSet>(FeatureSet::unpacked(bytes));
}

}  // namespace stillpoint
