#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>


namespace stillpoint {

/// A corner followed from the source frame to the destination frame.
struct Track {
  cv::Point2f from, to;   ///< px, in source and destination
  float residual = 0.0F;  ///< mean absolute grey-level difference of the two windows
  bool removed = false;   ///< taken out by an earlier round's mask: not used for this round's homography
  bool inlier = false;    ///< of this round's homography
};

/// A homography and how it was come by. eq. (3): x_destination ~ H x_source.
struct HomographyEstimate {
  cv::Matx33d matrix = cv::Matx33d::eye();
  bool valid =
      false;  ///< false: too few tracks or a degenerate estimate; `matrix` is then the one to fall back on
  int ransac_inliers = 0;
  double ransac_error_px = 0.0;   ///< RMS reprojection error ε of the inliers after RANSAC, eq. (4)
  double refined_error_px = 0.0;  ///< … and after Levenberg-Marquardt
  int refine_iterations = 0;
};

/// What each step of one direction took, ms of wall time. For reading only: no result depends on it.
struct DirectionTimes {
  double homography = 0.0, compensation = 0.0, difference = 0.0, threshold = 0.0, cleanup = 0.0;
};

/// Everything one direction of one round saw. Images have the frames' size and are in the destination's
/// camera: frame t for the forward direction, frame t-1 for the backward one.
struct DirectionTrace {
  std::vector<Track> tracks;
  HomographyEstimate homography;
  cv::Mat compensated;    ///< CV_8UC1: the source carried into the destination's camera
  double exposure = 1.0;  ///< what its grey levels were multiplied by, to be as bright as the destination
  cv::Mat valid;          ///< CV_8UC1: 255 where the warp has data, border margin taken off
  cv::Mat difference;     ///< CV_8UC1: eq. (1), 0 where not valid
  double threshold = 0;   ///< grey levels, Otsu's over the valid pixels; eq. (2)
  cv::Mat raw_mask;       ///< CV_8UC1, 0 or 255: difference above threshold
  cv::Mat mask;           ///< raw_mask after erosion and dilation, 0 where not valid
  DirectionTimes ms;
};

/// One pass of fig. 2: homographies, masks, and what they say moves.
struct MotionRound {
  DirectionTrace forward;           ///< reference carried into the target
  DirectionTrace backward;          ///< target carried into the reference
  cv::Mat backward_mask_in_target;  ///< CV_8UC1: backward.mask carried into the target's camera
  cv::Mat mask;                     ///< CV_8UC1, 255 = moving, target's camera: the union
  double mask_share = 0.0;  ///< of the frame's pixels, 0 to 1
  int changed_tracks = 0;   ///< tracks of both directions that this mask removes or gives back
  double union_ms = 0.0;    ///< wall time of carrying and uniting
  double removal_ms = 0.0;  ///< wall time of taking tracks out for the next round
};

/// What motion detection saw of a pair of frames, round by round; the last round's mask is the result.
struct PaperTrace {
  std::vector<MotionRound> rounds;
  bool converged = false;  ///< the rounds ended because nothing changed any more
  std::string note;        ///< why there is no mask, or why it is to be doubted; empty when all is well
  double tracks_ms = 0.0;  ///< wall time of following the corners, both directions

  /// The mask of what is dynamic in the target, CV_8UC1; empty when there is none.
  [[nodiscard]] cv::Mat mask() const { return rounds.empty() ? cv::Mat() : rounds.back().mask; }
};

}  // namespace stillpoint
