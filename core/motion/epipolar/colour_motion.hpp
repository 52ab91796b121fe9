#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/motion/epipolar/epipolar_config.hpp"
#include "core/motion/epipolar/point_tracks.hpp"
#include "core/motion/epipolar/relative_orientation.hpp"
#include "core/motion/epipolar/shutter.hpp"
#include "core/motion/regions.hpp"

namespace stillpoint {

// What is dynamic, judged from colour alone: points are followed over some tenths of a second, the camera's
// own motion is found from where they go, and what no place in a still room explains is classified as
// dynamic. A point may shift along its epipolar line up to infinity, for that is what parallax does; beside
// the line, and beyond infinity, only what is dynamic can go. Rows that a rolling shutter took at other times
// are first carried to where the middle one's time would show them. Evidence stays with its point from frame
// to frame, is shared among neighbours that have moved alike all along, and spreads to the image up to
// colour's edges.

/// Full-size pixels a side of a small pixel, in which points are followed.
inline constexpr int kSmallerBy = 2;

/// Comparison of the current frame with one some frames back.
struct ColourReference {
  int gap = 0;                 ///< frames back
  RelativeOrientation motion;  ///< the camera's, and whether it only turned
  std::vector<int> points;     ///< indices into EpipolarTrace::points, those seen in both
  std::vector<cv::Point2f>
      shifts;  ///< px, downsampled image, of each of `points` since then beside its rotation
  std::vector<cv::Point2f>
      residuals;              ///< px, downsampled image: what the camera's motion leaves epipolar_residual
  std::vector<float> sigmas;  ///< the same by its own noise, standard deviations
  double sigma = 0.0;         ///< px, downsampled image: noise of the residuals of what is static
  double ms = 0.0;            ///< wall time of the comparison; for reading only
};

/// A followed point and what is held of it.
struct ColourPoint {
  cv::Point2f at;         ///< px, full size
  int age = 0;            ///< frames it has been followed
  float evidence = 0.0F;  ///< of moving: its own, accumulated
  float shared = 0.0F;    ///< after smoothing with neighbours that move alike
};

/// What each step took, ms of wall time. For reading only: no result depends on it.
struct ColourMotionTimes {
  double points = 0.0;    ///< following them
  double evidence = 0.0;  ///< gathering and sharing it
  double spread = 0.0;    ///< over the image
  double mask = 0.0;      ///< its regions
};

/// What colour-only motion detection saw, stage by stage.
struct EpipolarTrace {
  std::vector<ColourPoint> points;
  std::vector<ColourReference> references;
  cv::Mat evidence;  ///< CV_32FC1, a quarter of the frame's side: evidence spread over the image
  cv::Mat mask;      ///< CV_8UC1, full size: 255 = moving; empty when there is no mask
  std::vector<MotionRegion> regions;
  double mask_share = 0.0;  ///< of the frame's pixels, 0 to 1
  std::string note;         ///< why there is no mask, or why it is empty; empty when all is well
  ColourMotionTimes ms;
};

/// Sees frames one after the other. A value: a copy goes on as the original would, with the same bytes.
class ColourMotionDetector {
 public:
  /// @param camera of the sequence; its intrinsics need not be exact
  ColourMotionDetector(const Camera& camera, const EpipolarConfig& config);

  /// The next frame.
  /// @param image CV_8UC3 or CV_8UC1. A frame of another size than the last begins anew.
  /// @param timestamp s, when its middle row was taken; without it a rolling shutter is not undone
  /// @throws InputError for another type, or none
  [[nodiscard]] EpipolarTrace next(const cv::Mat& image, std::optional<double> timestamp = std::nullopt);

 private:
  [[nodiscard]] cv::Size small_size() const;
  void begin_anew(const cv::Size& size);
  void follow_points(const cv::Mat& image, std::optional<double> timestamp, ColourMotionTimes& ms);
  [[nodiscard]] std::vector<ColourReference> compare();
  void paint_mask(const cv::Mat& image, const std::vector<float>& shared, EpipolarTrace& trace) const;
  [[nodiscard]] std::vector<BearingPair> pairs_with(int gap, bool level, std::vector<int>& points) const;
  void measure_rotation(double seconds);
  void judge(ColourReference& reference);
  void gather_evidence(const std::vector<ColourReference>& references);

  Camera camera_;  ///< as given
  Camera small_;   ///< of the downsampled image
  EpipolarConfig config_;
  PointTracks tracks_;
  AngularVelocities rates_;
  std::optional<double> timestamp_;  ///< of the last frame
  cv::Size size_;
};

}  // namespace stillpoint
