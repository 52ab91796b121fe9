#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace stillpoint {

/// Pixels of a motion mask against the truth, of one frame or of many added up.
struct MaskScore {
  std::int64_t found_rightly = 0;  ///< px, moving and in the mask
  std::int64_t found_wrongly = 0;  ///< px, still but in the mask
  std::int64_t missed = 0;         ///< px, moving but not in the mask
  std::int64_t left_rightly = 0;   ///< px, still and not in the mask

  /// Share of the mask that moves, 0 to 1; nothing when the mask is empty.
  [[nodiscard]] std::optional<double> precision() const;
  /// Share of what is dynamic that is in the mask, 0 to 1; nothing when nothing moves.
  [[nodiscard]] std::optional<double> recall() const;
  /// Intersection over union, 0 to 1; nothing when nothing moves and the mask is empty.
  [[nodiscard]] std::optional<double> iou() const;
  MaskScore& operator+=(const MaskScore& other);
};

/// Scores a mask. Non-zero means moving in both.
/// @param found CV_8UC1; empty = nothing was found
/// @param truth CV_8UC1; empty = not known, which gives a score without pixels
/// @throws InputError when the sizes differ
[[nodiscard]] MaskScore score_mask(const cv::Mat& found, const cv::Mat& truth);

/// Whether a mask (CV_8UC1, not empty) holds the pixel nearest to a place, px.
[[nodiscard]] bool is_dynamic_at(const cv::Mat& truth, const cv::Point2f& pixel);

/// A feature and whether it was taken out.
struct FeatureVerdict {
  cv::Point2f pixel;  ///< px, in the image as it is
  bool removed = false;
};

/// Features against the truth, of one frame or of many added up.
struct RemovalScore {
  std::int64_t removed_rightly = 0;  ///< features on what is dynamic, removed
  std::int64_t removed_wrongly = 0;  ///< … on what is static, removed
  std::int64_t kept_wrongly = 0;     ///< … on what is dynamic, kept
  std::int64_t kept_rightly = 0;     ///< … on what is static, kept

  /// Share of the removed that moved, 0 to 1; nothing when none was removed.
  [[nodiscard]] std::optional<double> precision() const;
  /// Share of the moving that were removed, 0 to 1; nothing when none moved.
  [[nodiscard]] std::optional<double> recall() const;
  RemovalScore& operator+=(const RemovalScore& other);
};

/// Scores which features were removed; a feature moves when the mask does at its nearest pixel.
/// @param truth CV_8UC1; empty = not known, which gives a score without features
[[nodiscard]] RemovalScore score_removal(const std::vector<FeatureVerdict>& features, const cv::Mat& truth);

}  // namespace stillpoint
