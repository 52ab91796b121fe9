#include "core/motion/yi2013/grid_motion.hpp"

#include <fmt/format.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/video/tracking.hpp>

namespace stillpoint {
namespace {

/// Centres of the grid's whole cells, to half a pixel: their raster coordinates, which are followed as
/// pixels.
std::vector<cv::Point2f> grid_points(const cv::Size& size, const Yi2013Config& config) {
  std::vector<cv::Point2f> points;
  const int w = config.cell_width_px, h = config.cell_height_px;
  for (int y = 0; y + h <= size.height; y += h)
    for (int x = 0; x + w <= size.width; x += w)
      points.emplace_back(static_cast<float>(x) + 0.5F * static_cast<float>(w),
                          static_cast<float>(y) + 0.5F * static_cast<float>(h));
  return points;
}

}  // namespace

std::vector<cv::Mat> yi2013_pyramid(const cv::Mat& gray, const Yi2013Config& config) {
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, {config.window_px, config.window_px}, config.levels, false);
  return pyramid;
}

Yi2013Motion yi2013_motion(const std::vector<cv::Mat>& here, const std::vector<cv::Mat>& last,
                           const Yi2013Config& config) {
  Yi2013Motion motion;
  const std::vector<cv::Point2f> points = grid_points(here.front().size(), config);
  motion.points = static_cast<int>(points.size());
  std::vector<cv::Point2f> from, to;
  if (!points.empty()) {
    std::vector<cv::Point2f> found;
    std::vector<std::uint8_t> is_found;
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, config.iterations,
                                config.epsilon_px);
    cv::calcOpticalFlowPyrLK(here, last, points, found, is_found, cv::noArray(),
                             {config.window_px, config.window_px}, config.levels, stop);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (is_found[i] != 0) from.push_back(points[i]), to.push_back(found[i]);
  }
  for (std::size_t i = 0; i < from.size(); ++i) motion.tracks.push_back({from[i], to[i], false});
  if (static_cast<int>(from.size()) < config.min_tracks) {
    motion.note =
        fmt::format("only {} points could be followed: the camera is taken to be static", from.size());
    return motion;
  }
  std::vector<std::uint8_t> agrees;
  const cv::Mat homography = cv::findHomography(from, to, cv::RANSAC, config.ransac_px, agrees);
  if (homography.empty()) {
    motion.note = "no homography fits the followed points: the camera is taken to be static";
    return motion;
  }
  motion.last_from_here = cv::Matx33d(homography);
  for (std::size_t i = 0; i < agrees.size(); ++i) motion.tracks[i].inlier = agrees[i] != 0;
  motion.inliers = cv::countNonZero(agrees);
  return motion;
}

}  // namespace stillpoint
