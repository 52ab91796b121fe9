#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/motion/paper/paper_config.hpp"
#include "core/motion/paper/paper_trace.hpp"

namespace stillpoint {

/// Where H carries a point. The point must not lie on H's horizon.
[[nodiscard]] inline cv::Point2d carry(const cv::Matx33d& homography, const cv::Point2d& point) {
  const cv::Vec3d moved = homography * cv::Vec3d(point.x, point.y, 1.0);
  return {moved[0] / moved[2], moved[1] / moved[2]};
}

/// How far the image's corners move from one homography to the other, px; the furthest counts.
[[nodiscard]] double corner_shift_px(const cv::Matx33d& before, const cv::Matx33d& after,
                                     const cv::Size& size);

/// ε of eq. (4) as a root mean square, px: how far H carries each `from` off its `to`. 0 without tracks.
[[nodiscard]] double reprojection_error_px(const cv::Matx33d& homography, const std::vector<Track>& tracks);

/// A homography that could be the motion of a camera between two frames: finite, invertible, no fold or
/// horizon inside the image, and no corner of the image magnified or shrunk beyond reason.
[[nodiscard]] bool is_plausible(const cv::Matx33d& homography, const cv::Size& image);

/// RANSAC's homography of the tracks, eq. (3), or nothing when it finds none. Deterministic: its random
/// numbers begin anew with every call.
[[nodiscard]] std::optional<cv::Matx33d> ransac_homography(const std::vector<Track>& tracks,
                                                           const PaperConfig& config);

/// What Levenberg-Marquardt made of a homography.
struct RefinedHomography {
  cv::Matx33d matrix;
  int iterations = 0;
};

/// Minimises eq. (4), the squared reprojection error of `inliers`, from `start`. Eight parameters: the ninth
/// is fixed to 1 in Hartley-normalised coordinates, where it cannot vanish for a homography that keeps the
/// points finite.
[[nodiscard]] RefinedHomography refine_homography(const cv::Matx33d& start, const std::vector<Track>& inliers,
                                                  int max_iterations);

/// METHOD.md §1 step 2: RANSAC over the tracks that are not removed, then Levenberg-Marquardt on its inliers.
/// Sets Track::inlier, also false for removed tracks.
/// @param fall_back `matrix` of an estimate that is not valid
[[nodiscard]] HomographyEstimate estimate_homography(std::vector<Track>& tracks, const cv::Size& image,
                                                     const PaperConfig& config, const cv::Matx33d& fall_back);

}  // namespace stillpoint
