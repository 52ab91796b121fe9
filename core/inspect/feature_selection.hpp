#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

#include "core/odometry/frame_record.hpp"

namespace stillpoint {

struct FrameView;

// Which feature is meant.

/// The feature of a record nearest to a pixel, within `radius` px; nothing where there is none.
[[nodiscard]] std::optional<int> feature_near(const FrameRecord& record, const Eigen::Vector2d& pixel,
                                              double radius);

/// The feature to tell of when none was chosen: the removed one nearest to the middle of the image, else the
/// one with the largest residual. Nothing where there are no features.
[[nodiscard]] std::optional<int> telling_feature(const FrameRecord& record, const cv::Size& image);

/// A feature a person has chosen, to be found again in the frames about it.
struct FeatureSelection {
  int frame = 0, index = 0;
  FeatureRecord feature;
};

/// The chosen feature in the frame shown: itself, its map point, or where the flow or its trail leads.
/// Nothing where it cannot be told.
[[nodiscard]] std::optional<int> find_selected(const FrameView& view, const FeatureSelection& selected);

}  // namespace stillpoint
