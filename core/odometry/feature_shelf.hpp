#pragma once

#include <memory>

#include "core/byte_store.hpp"
#include "core/odometry/feature_set.hpp"

namespace stillpoint {

/// A feature set that was put by: it takes no memory once nobody else holds it, and can be had again.
class ShelvedFeatures {
 public:
  ShelvedFeatures(ByteStore& store, const std::shared_ptr<const FeatureSet>& features);

  /// The same to the last bit: the very set while anybody has it.
  /// @throws InputError when the disk does not give it back
  [[nodiscard]] std::shared_ptr<const FeatureSet> get() const;
  [[nodiscard]] const StoredBytes& bytes() const { return bytes_; }

 private:
  StoredBytes bytes_;
  std::weak_ptr<const FeatureSet> lately_;
};

}  // namespace stillpoint
