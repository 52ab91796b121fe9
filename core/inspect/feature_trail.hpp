#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/inspect/feature_explanation.hpp"

namespace stillpoint {

/// Where the flow beside a target pixel says it was in the reference: by the nearest forward track, within 16
/// px of it.
[[nodiscard]] std::optional<cv::Point2f> flow_source(const FrameView& view, const cv::Point2f& pixel);

/// A feature frame by frame back through FrameView::history, as far as it is found again.
[[nodiscard]] std::vector<TrailPoint> trail_of(const FrameView& view, int index);

}  // namespace stillpoint
