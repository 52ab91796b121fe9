#include "core/run/frame_scores.hpp"

#include "core/odometry/frame_record.hpp"
#include "core/odometry/frame_result.hpp"

namespace stillpoint {

FrameScores& FrameScores::operator+=(const FrameScores& other) {
  known = known || other.known;
  mask += other.mask;
  partial_mask += other.partial_mask;
  removal += other.removal;
  dynamic_inliers += other.dynamic_inliers;
  return *this;
}

FrameScores score_frame(const FrameResult& result, const cv::Mat& moving, bool judges_features) {
  FrameScores scores;
  const FrameRecord& record = result.record;
  if (moving.empty() || record.status == FrameStatus::unreadable) return scores;
  if (!result.mask.empty() && result.mask.size() != moving.size()) return scores;
  scores.known = true;
  if (!judges_features) scores.mask = score_mask(result.mask, moving);
  scores.partial_mask = score_mask(result.motion.partial_mask, moving);
  std::vector<FeatureVerdict> verdicts;
  verdicts.reserve(record.features.size());
  for (const FeatureRecord& feature : record.features) {
    verdicts.push_back({feature.pixel, feature.fate == FeatureFate::removed});
    if (feature.fate == FeatureFate::inlier && is_dynamic_at(moving, feature.pixel)) ++scores.dynamic_inliers;
  }
  scores.removal = score_removal(verdicts, moving);
  return scores;
}

}  // namespace stillpoint
