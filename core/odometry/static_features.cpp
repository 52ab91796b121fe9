#include "core/odometry/static_features.hpp"

#include <algorithm>
#include <array>

#include "core/odometry/rolling_shutter.hpp"
#include "core/odometry/static_weight.hpp"

namespace stillpoint {
namespace {

/// One a feature: 0 where the judgement takes it out.
std::vector<std::uint8_t> kept_features(const std::vector<cv::Point2f>& pixels, const cv::Mat& mask,
                                        const std::vector<float>& weight_of_feature) {
  std::vector<std::uint8_t> keep(pixels.size(), 1);
  if (!mask.empty())
    for (std::size_t i = 0; i < keep.size(); ++i)
      keep[i] = mask.at<uchar>(cvRound(pixels[i].y), cvRound(pixels[i].x)) == 0;
  if (weight_of_feature.size() == keep.size())
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (weight_of_feature[i] <= 0.0F) keep[i] = 0;
  return keep;
}

}  // namespace

TrackedFrame StaticFeatures::select(const Frame& frame, const PreparedFrame& prepared, const cv::Mat& mask,
                                    const Vector6d& velocity, const MotionResult& motion) const {
  const OrbFeatures& found = prepared.found;
  const std::vector<cv::Point2f>& pixels = prepared.pixels;
  FeatureSet all;
  all.keypoints = found.keypoints;
  all.descriptors = found.descriptors;
  all.undistorted = prepared.undistorted;
  all.depth = depth_at(pixels, all.undistorted, frame.depth, camera_, velocity, depth_lag(frame));
  if (tracking_.correct_rolling_shutter)
    correct_rolling_shutter(camera_, velocity, pixels, all.undistorted, all.depth);

  const std::vector<std::uint8_t> keep = kept_features(pixels, mask, motion.weight_of_feature);
  all.static_weight = static_weights_at(pixels, tracking_.soft_weights ? motion.log_odds : cv::Mat(),
                                        frame.gray.size(), tracking_.half_weight_log_odds);
  if (motion.weight_of_feature.size() == keep.size())
    for (std::size_t i = 0; i < keep.size(); ++i) all.static_weight[i] *= motion.weight_of_feature[i];
  raise_least_weight(keep, all.static_weight);

  TrackedFrame selected;
  selected.mask = mask;
  selected.records.resize(keep.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    FeatureRecord& feature = selected.records[i];
    feature.pixel = pixels[i];
    feature.depth = all.depth[i];
    feature.octave = static_cast<std::uint8_t>(found.keypoints[i].octave);
    feature.static_weight = all.static_weight[i];
    if (keep[i])
      selected.record_of.push_back(static_cast<int>(i));
    else
      feature.fate = FeatureFate::removed;
  }
  selected.features = std::make_shared<const FeatureSet>(subset(all, keep, camera_.width, camera_.height));
  selected.points.assign(selected.record_of.size(), kNone);
  return selected;
}

bool StaticFeatures::depend_on_velocity(const Frame& frame) const {
  const auto lag = depth_lag(frame);
  return (camera_.readout_s != 0.0 && tracking_.correct_rolling_shutter) ||
         (lag && camera_.depth_is_late(*lag));
}

std::optional<double> StaticFeatures::depth_lag(const Frame& frame) const {
  if (!tracking_.correct_depth_lag || !frame.has_depth()) return std::nullopt;
  return frame.depth_timestamp - frame.timestamp;
}

bool StaticFeatures::too_few_places(const TrackedFrame& frame) const {
  constexpr int kColumns = 8, kRows = 6;  // parts of the image, 80 px a side in 640 x 480
  constexpr int kLeastParts =
      5;  // of those 48 that features must lie in, or they tell no room from a dynamic object
  if (!frame.lost_features()) return false;
  std::array<bool, kColumns * kRows> before{}, after{};
  for (const FeatureRecord& feature : frame.records) {
    const int column =
        std::clamp(static_cast<int>(feature.pixel.x) * kColumns / camera_.width, 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(feature.pixel.y) * kRows / camera_.height, 0, kRows - 1);
    const auto part = static_cast<std::size_t>(row * kColumns + column);
    before[part] = true;
    after[part] = after[part] || feature.fate != FeatureFate::removed;
  }
  const auto had = std::count(before.begin(), before.end(), true);
  const auto has = std::count(after.begin(), after.end(), true);
  return has < std::min<std::ptrdiff_t>(kLeastParts, had);
}

}  // namespace stillpoint
