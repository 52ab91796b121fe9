#pragma once

#include <opencv2/core.hpp>

#include "core/chunked_list.hpp"
#include "core/evaluation/mask_scores.hpp"

namespace stillpoint {

struct FrameResult;

/// A frame's masks and removals against what is truly dynamic.
struct FrameScores {
  bool known = false;       ///< the truth was there, and the frame had a reference to compare with
  MaskScore mask;           ///< the method's mask
  MaskScore partial_mask;   ///< MotionResult::partial_mask, where the method has one
  RemovalScore removal;     ///< features taken out
  int dynamic_inliers = 0;  ///< inliers of the pose that lie on what is truly dynamic

  FrameScores& operator+=(const FrameScores& other);
};

/// One a record.
using ScoreList = ChunkedList<FrameScores>;

/// Scores a frame just processed.
/// @param moving CV_8UC1, 255 = moving; empty = not known
/// @param judges_features MethodInfo::judges_features: masks are not scored then, nor is a stand-in's
[[nodiscard]] FrameScores score_frame(const FrameResult& result, const cv::Mat& moving, bool judges_features);

}  // namespace stillpoint
