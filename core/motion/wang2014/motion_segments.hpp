#pragma once

#include <vector>

#include "core/motion/wang2014/rigid_clusters.hpp"
#include "core/motion/wang2014/spectral_clusters.hpp"

namespace stillpoint {

/// A segmentation of method `wang2014`, step by step.
struct MotionSegments {
  std::vector<int> chosen;             ///< trajectories that were clustered
  std::vector<Velocities> velocities;  ///< one each
  std::vector<AffinityEdge> edges;     ///< between places among the chosen
  Spectrum spectrum;
  int k = 0;                     ///< clusters by the eigengap
  std::vector<int> cluster;      ///< one each, 0 to k - 1
  int baseline = 0;              ///< frames between the two that rigid motions are of
  std::vector<ScenePair> pairs;  ///< of those seen in both, in the order of the chosen
  std::vector<int> pair_of;      ///< one each: its pair; -1 = none
  MergedClusters merged;
  std::vector<int> label;         ///< one each: its cluster after merging
  cv::Mat labels;                 ///< CV_8UC1, small: 1 + label of each pixel, 0 = none
  int background = -1;            ///< the label whose motion explains the most pairs
  std::vector<int> rejoined;      ///< other labels that the background's motion explains
  std::vector<double> explained;  ///< one a label: share of its pairs that the background's motion explains
  cv::Mat mask;                   ///< CV_8UC1, small: 255 = dynamic
  double ms_affinity = 0.0, ms_spectrum = 0.0, ms_merge = 0.0, ms_labels = 0.0;

  [[nodiscard]] bool is_static(int one_label) const;
};

/// Steps (b) to (e). Fewer than three clustered trajectories give no labels and an empty mask.
[[nodiscard]] MotionSegments segment_motion(const TrajectoryFrame& here, const TrajectorySet& set,
                                            const Wang2014Config& config);

[[nodiscard]] SceneFlowNoise noise_of(const TrajectoryFrame& frame, const Wang2014Config& config);

}  // namespace stillpoint
