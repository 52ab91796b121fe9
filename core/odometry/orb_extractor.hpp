#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/config.hpp"
#include "core/odometry/feature_set.hpp"
#include "core/odometry/orb_blur.hpp"

namespace stillpoint {

/// Keypoints over all pyramid levels and their descriptors, one row each.
struct OrbFeatures {
  std::vector<cv::KeyPoint> keypoints;  ///< in pixels of the full image
  std::vector<Descriptor> descriptors;
};

/// ORB (Rublee et al. 2011) with corners spread over the image: FAST on every pyramid level, a lower
/// threshold in cells that would stay empty, and so many corners a level as its area asks for, the best of
/// each neighbourhood first. Orientation by intensity centroid; descriptors are OpenCV's.
class OrbExtractor {
 public:
  explicit OrbExtractor(const FeatureConfig& config);

  /// Features of a grey image, CV_8UC1. Images too small for a level simply have none there.
  /// @param threads above 1, the levels are shared between two; the result is the same
  [[nodiscard]] OrbFeatures extract(const cv::Mat& gray, int threads = 1) const;

 private:
  /// One level of the pyramid.
  struct Level {
    cv::Mat image;                         // CV_8UC1
    std::vector<cv::KeyPoint> candidates;  // all its corners
    BlurredLevel blurred;                  // what descriptors look at
    OrbFeatures found;
  };

  void find_corners(int wanted, Level& level) const;
  void extract_level(int index, const cv::Size& full, Level& level) const;
  /// Makes every level but the first; returns how many levels the image has room for.
  int fill_pyramid(const cv::Size& full, std::vector<Level>& levels) const;

  FeatureConfig config_;
  std::vector<int> wanted_;  // corners a level
};

/// Picks `wanted` of the candidates so that they spread over a `width` x `height` image: round by round, the
/// best not yet taken of each cell. Order of the result is by cell, then response.
[[nodiscard]] std::vector<cv::KeyPoint> spread(const std::vector<cv::KeyPoint>& candidates, int wanted,
                                               int width, int height);

}  // namespace stillpoint
