#include "core/motion/lin2017/feature_flow.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>

namespace stillpoint {

std::vector<FeatureFlow> follow_features(std::span<const MotionFeature> features, const FlowFrame& here,
                                         const FlowFrame& last, const Lin2017Config& config) {
  std::vector<FeatureFlow> flows(features.size());
  if (features.empty()) return flows;
  std::vector<cv::Point2f> from, to, back;
  for (const MotionFeature& feature : features) from.push_back(feature.pixel);
  std::vector<std::uint8_t> is_found, is_back;
  const cv::Size window(config.window_px, config.window_px);
  cv::calcOpticalFlowPyrLK(here.pyramid, last.pyramid, from, to, is_found, cv::noArray(), window,
                           config.levels);
  cv::calcOpticalFlowPyrLK(last.pyramid, here.pyramid, to, back, is_back, cv::noArray(), window,
                           config.levels);
  for (std::size_t i = 0; i < flows.size(); ++i) {
    const cv::Point2f miss = back[i] - from[i];
    if (is_found[i] == 0 || is_back[i] == 0 || !(std::hypot(miss.x, miss.y) <= config.forward_backward_px))
      continue;
    FeatureFlow& flow = flows[i];
    flow.followed = true;
    flow.before = to[i];
    flow.pair.z_here = surface_depth(here.depth, from[i].x, from[i].y);
    flow.pair.z_last = surface_depth(last.depth, to[i].x, to[i].y);
    flow.measured = flow.pair.z_here > 0.0F && flow.pair.z_last > 0.0F;
    if (!flow.measured) continue;
    flow.pair.ray_here = here.rays.at(from[i].x, from[i].y);
    flow.pair.ray_last = last.rays.at(to[i].x, to[i].y);
  }
  return flows;
}

int direction_bin(const Eigen::Vector3f& flow, int azimuth_bins, int elevation_bins) {
  const double length = static_cast<double>(flow.norm());
  if (!(length > 0.0)) return -1;
  // The camera's y points down.
  const double azimuth = std::atan2(static_cast<double>(flow.x()), static_cast<double>(flow.z()));
  const double elevation = std::asin(std::clamp(-static_cast<double>(flow.y()) / length, -1.0, 1.0));
  const double turn = azimuth < 0.0 ? azimuth + 2.0 * CV_PI : azimuth;
  const int a = std::min(azimuth_bins - 1, static_cast<int>(turn / (2.0 * CV_PI) * azimuth_bins));
  const int e = std::min(elevation_bins - 1, static_cast<int>((elevation / CV_PI + 0.5) * elevation_bins));
  return e * azimuth_bins + a;
}

void measure_flow(std::vector<FeatureFlow>& flows, const CameraMotion& camera, const SceneFlowNoise& noise,
                  const Lin2017Config& config) {
  for (FeatureFlow& flow : flows) {
    if (!flow.measured) continue;
    const ResidualMotion residual = residual_motion(flow.pair, camera, noise);
    flow.flow = residual.motion;
    flow.sigma = residual.sigma();
    const double limit = std::max(config.sigmas * static_cast<double>(flow.sigma), config.least_flow_m);
    const bool moves = static_cast<double>(flow.flow.norm()) > limit;
    flow.bin = moves ? direction_bin(flow.flow, config.azimuth_bins, config.elevation_bins) : -1;
    flow.kind = moves ? FeatureClass::kStray : FeatureClass::kStatic;
  }
}

std::vector<int> find_moving_things(std::span<const MotionFeature> features, std::vector<FeatureFlow>& flows,
                                    const Lin2017Config& config) {
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < flows.size(); ++i)
    if (flows[i].bin >= 0) candidates.push_back(i);
  std::vector<std::size_t> supported;
  std::vector<int> count(static_cast<std::size_t>(config.azimuth_bins * config.elevation_bins), 0);
  for (const std::size_t i : candidates) {
    int alike = 0;
    for (const std::size_t j : candidates) {
      const cv::Point2f apart = features[i].pixel - features[j].pixel;
      if (j != i && flows[j].bin == flows[i].bin && std::hypot(apart.x, apart.y) <= config.neighbour_px)
        ++alike;
    }
    if (alike < config.like_neighbours) continue;
    supported.push_back(i);
    ++count[static_cast<std::size_t>(flows[i].bin)];
  }
  std::vector<int> things;
  for (std::size_t bin = 0; bin < count.size(); ++bin)
    if (count[bin] >= config.least_features) things.push_back(static_cast<int>(bin));
  for (const std::size_t i : supported)
    if (count[static_cast<std::size_t>(flows[i].bin)] >= config.least_features)
      flows[i].kind = FeatureClass::kMoving;
  return things;
}

}  // namespace stillpoint
