#include "core/odometry/frame_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stillpoint {

std::string_view to_string(FrameStatus status) {
  switch (status) {
    case FrameStatus::initialised:
      return "initialised";
    case FrameStatus::tracked:
      return "tracked";
    case FrameStatus::relocalised:
      return "relocalised";
    case FrameStatus::lost:
      return "lost";
    case FrameStatus::unreadable:
      return "unreadable";
  }
  return "";
}

int weighing_little(const std::vector<FeatureRecord>& features) {
  return static_cast<int>(std::count_if(features.begin(), features.end(), [](const FeatureRecord& f) {
    return f.fate == FeatureFate::inlier && f.static_weight < kLowWeight;
  }));
}

std::string_view to_string(PoseStart start) {
  switch (start) {
    case PoseStart::none:
      return "none";
    case PoseStart::motion_model:
      return "motion model";
    case PoseStart::wide_search:
      return "wide search";
    case PoseStart::epnp:
      return "EPnP";
    case PoseStart::direct:
      return "direct alignment";
  }
  return "";
}

std::string reprojection_text(const FrameRecord& record) {
  return std::isnan(record.rms_px) ? "–" : fmt::format("{:.3f} px", record.rms_px);
}

std::string remarks_on(const FrameRecord& record) {
  return record.note + (record.note.empty() || record.mask_problem.empty() ? "" : "; ") + record.mask_problem;
}

}  // namespace stillpoint
