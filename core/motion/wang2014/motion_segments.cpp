#include "core/motion/wang2014/motion_segments.hpp"

#include <algorithm>
#include <utility>

#include "core/motion/wang2014/dense_labels.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

/// The longest time over which half of the chosen trajectories can be looked back, frames.
int longest_baseline(const TrajectorySet& set, const std::vector<int>& chosen, int window) {
  for (int back = window; back > 1; --back) {
    const auto seen = std::count_if(chosen.begin(), chosen.end(), [&](int i) {
      const TrajectoryPoint* point = set.back(static_cast<std::size_t>(i), back);
      return point != nullptr && point->measured();
    });
    if (2 * seen >= static_cast<std::ptrdiff_t>(chosen.size())) return back;
  }
  return 1;
}

void find_pairs(const TrajectorySet& set, MotionSegments& segments) {
  for (const int i : segments.chosen) {
    const auto trajectory = static_cast<std::size_t>(i);
    const TrajectoryPoint *now = set.back(trajectory, 0), *before = set.back(trajectory, segments.baseline);
    if (before == nullptr || !before->measured()) {
      segments.pair_of.push_back(-1);
      continue;
    }
    segments.pair_of.push_back(static_cast<int>(segments.pairs.size()));
    segments.pairs.push_back({before->ray, now->ray, before->z, now->z});
  }
}

/// What is known of the chosen ones, for their pairs alone.
std::vector<int> of_pairs(const std::vector<int>& values, const MotionSegments& segments) {
  std::vector<int> picked(segments.pairs.size(), -1);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (segments.pair_of[i] >= 0) picked[static_cast<std::size_t>(segments.pair_of[i])] = values[i];
  return picked;
}

/// The label whose points move as most points do: of each label's rigid motion, how many of all pairs it
/// explains. Of two that explain as many, the one with the larger area; where none explains any, the largest.
void find_background(const std::vector<int>& label, const SceneFlowNoise& noise, const Wang2014Config& config,
                     MotionSegments& segments, RigidFit& still) {
  const std::vector<int> areas = label_areas(segments.labels, segments.k);
  segments.background = static_cast<int>(std::max_element(areas.begin(), areas.end()) - areas.begin());
  std::pair<int, int> most{0, 0};  // pairs explained, area
  for (int c = 0; c < segments.k; ++c) {
    std::vector<ScenePair> own;
    for (std::size_t i = 0; i < segments.pairs.size(); ++i)
      if (label[i] == c) own.push_back(segments.pairs[i]);
    if (own.empty()) continue;
    const RigidFit fit = fit_rigid(own, noise, config.merge_sigmas, config.ransac_samples,
                                   static_cast<std::uint32_t>(segments.k));
    int explained = 0;
    if (fit.found)
      for (const std::uint8_t one : explained_by(fit.motion, segments.pairs, noise, config.merge_sigmas))
        explained += one != 0 ? 1 : 0;
    const std::pair<int, int> votes{explained, areas[static_cast<std::size_t>(c)]};
    if (votes <= most) continue;
    most = votes;
    segments.background = c;
    still = fit;
  }
}

/// (e): what the background's motion explains rejoins it; all else is dynamic.
void mend(const TrajectoryFrame& here, const Wang2014Config& config, MotionSegments& segments) {
  segments.explained.assign(static_cast<std::size_t>(segments.k), 0.0);
  const std::vector<int> label = of_pairs(segments.label, segments);
  const SceneFlowNoise noise = noise_of(here, config);
  RigidFit still;
  find_background(label, noise, config, segments, still);
  for (int c = 0; c < segments.k && still.found; ++c) {
    double& share = segments.explained[static_cast<std::size_t>(c)];
    share = explained_share(still.motion, segments.pairs, label, c, noise, config.merge_sigmas);
    const bool exists = std::find(segments.label.begin(), segments.label.end(), c) != segments.label.end();
    if (exists && c != segments.background && share > config.merge_share) segments.rejoined.push_back(c);
  }
  cv::Mat dynamic = cv::Mat::zeros(segments.labels.size(), CV_8UC1);
  for (int c = 0; c < segments.k; ++c)
    if (!segments.is_static(c)) dynamic.setTo(255, segments.labels == c + 1);
  segments.mask = holes_filled(dynamic);
}

}  // namespace

bool MotionSegments::is_static(int one_label) const {
  return one_label == background || std::find(rejoined.begin(), rejoined.end(), one_label) != rejoined.end();
}

SceneFlowNoise noise_of(const TrajectoryFrame& frame, const Wang2014Config& config) {
  return {config.pixel_sigma_px / frame.rays.fx(), config.pixel_sigma_px / frame.rays.fy(),
          config.depth_sigma_per_m2, config.depth_floor_m};
}

MotionSegments segment_motion(const TrajectoryFrame& here, const TrajectorySet& set,
                              const Wang2014Config& config) {
  MotionSegments segments;
  segments.chosen = clustered_trajectories(set, config);
  segments.mask = cv::Mat::zeros(here.gray.size(), CV_8UC1);
  segments.labels = segments.mask.clone();
  const int points = static_cast<int>(segments.chosen.size());
  if (points < 3) return segments;
  const SceneFlowNoise noise = noise_of(here, config);
  Stopwatch watch;
  segments.velocities = residual_velocities(set, segments.chosen, noise, config);
  segments.edges = affinity_edges(set, segments.chosen, segments.velocities, config);
  segments.ms_affinity = watch.lap();
  segments.spectrum = laplacian_spectrum(points, segments.edges, config.eigenvectors);
  segments.k = clusters_by_eigengap(segments.spectrum.values, config.least_clusters, config.most_clusters);
  segments.cluster = cluster_rows(segments.spectrum.vectors, segments.k);
  segments.ms_spectrum = watch.lap();
  segments.baseline = longest_baseline(set, segments.chosen, config.window_frames);
  find_pairs(set, segments);
  segments.merged =
      merge_clusters(segments.pairs, of_pairs(segments.cluster, segments), segments.k, noise, config);
  for (const int cluster : segments.cluster)
    segments.label.push_back(segments.merged.merged[static_cast<std::size_t>(cluster)]);
  segments.ms_merge = watch.lap();
  segments.labels = dense_labels(here, set, segments.chosen, segments.label, config);
  mend(here, config, segments);
  segments.ms_labels = watch.lap();
  return segments;
}

}  // namespace stillpoint
