#include "core/odometry/odometry_engine.hpp"

#include "core/odometry/feature_odometry.hpp"

namespace stillpoint {

std::unique_ptr<OdometryEngine> make_odometry_engine(const Camera& camera, const Config& config) {
  return std::make_unique<FeatureOdometry>(camera, config);
}

}  // namespace stillpoint
