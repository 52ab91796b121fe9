// Going on from the middle of a run: with another config, or from a copy that was put by.
#include <limits>

#include "core/odometry/feature_odometry.hpp"

namespace stillpoint {

void FeatureOdometry::shelve_features(ByteStore& store) { mapper_.shelve_features(store); }

void FeatureOdometry::drop_images() {
  mapper_.drop_features();
  preparer_.motion().forget();
  motion_.drop_images();
  solver_.direct().drop_images();
}

void FeatureOdometry::restore_images(int next, const std::function<Frame(int)>& read) {
  mapper_.restore_features();
  preparer_.motion().restore(next, config_.run.threads, read);
  motion_.restore_images(next, std::numeric_limits<int>::max(), read);
  solver_.direct().restore_images(next, read);
}

int FeatureOdometry::frames_wanted(const Config& config) const { return motion_.frames_wanted(config); }

std::unique_ptr<OdometryEngine> FeatureOdometry::continued_with(const Config& config,
                                                                const std::vector<PastFrame>& before) const {
  if (config.run.odometry != config_.run.odometry || config.features.levels != config_.features.levels ||
      config.features.scale_factor != config_.features.scale_factor)
    return nullptr;
  auto continued = std::make_unique<FeatureOdometry>(*this);
  FeatureOdometry& next = *continued;
  next.config_ = config;
  next.preparer_ = FramePreparer(camera_, config);
  next.motion_ = motion_.continued_with(config, before);
  next.solver_.adopt(config);
  next.mapper_.adopt(config);
  if (!next.looks_back()) next.smoother_.forget_pending();
  if (frames_wanted(config) == 0) {
    for (const auto& preparation : preparer_.motion().past()) next.preparer_.motion().pass(preparation);
  } else {
    for (const PastFrame& past : before)
      if (past.frame.readable()) (void)next.preparer_.motion().prepare(past.frame, config.run.threads);
  }
  return continued;
}

}  // namespace stillpoint
