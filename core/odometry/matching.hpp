#pragma once

#include <vector>

#include "core/odometry/feature_set.hpp"
#include "core/odometry/local_map.hpp"

namespace stillpoint {

/// A map point to be looked for in a frame.
struct Candidate {
  int point = kNone;    ///< map point id
  cv::Point2f pixel;    ///< px, undistorted: where it is expected
  float radius = 0.0F;  ///< px: half the side of the window searched
  int min_octave = 0, max_octave = 0;
  const Descriptor* descriptor = nullptr;
  float angle = -1.0F;  ///< deg: orientation when last seen; negative = unknown
};

/// A feature taken for a map point.
struct Match {
  int feature = kNone;
  int point = kNone;
  int distance = 0;  ///< bits
  float turned =
      0;  ///< deg: orientation now less orientation when last seen; meaningful where the latter is known
};

/// For each candidate the nearest feature in its window, by descriptor. A candidate whose two best features
/// are too alike (best > ratio * second, on one octave) stays without; of several candidates for a feature
/// the nearest has it. In order of feature.
[[nodiscard]] std::vector<Match> match_in_windows(const FeatureSet& features,
                                                  const std::vector<Candidate>& candidates, int max_distance,
                                                  double ratio);

/// The same without windows, each candidate against every feature: for relocalisation.
[[nodiscard]] std::vector<Match> match_everywhere(const FeatureSet& features,
                                                  const std::vector<Candidate>& candidates, int max_distance,
                                                  double ratio);

/// Keeps the matches whose features turned as most did: the three fullest of 30 bins of 12 degrees.
[[nodiscard]] std::vector<Match> consistently_turned(const std::vector<Match>& matches);

/// Where and at which scale a map point is expected in a view.
struct Projection {
  bool visible = false;  ///< in front, in the image, at a distance and angle at which it can be recognised
  cv::Point2f pixel;     ///< px, undistorted
  double distance = 0;   ///< m
  int octave = 0;        ///< predicted
};

[[nodiscard]] Projection project_point(const MapPoint& point, const Camera& camera,
                                       const Pose& camera_from_world, const FeatureConfig& config);

/// scale_factor to the power of each octave.
[[nodiscard]] std::vector<double> octave_scales(const FeatureConfig& config);

}  // namespace stillpoint
