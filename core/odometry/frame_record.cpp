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

FrameOutline outline_of(const FrameRecord& record) {
  const auto position = record.world_from_camera.translation();
  return {.timestamp = record.timestamp,
          .position = {position.x(), position.y(), position.z()},
          .index = record.index,
          .status = record.status,
          .estimated = record.estimated,
          .keyframe = record.keyframe,
          .remarked = !record.note.empty() || !record.mask_problem.empty(),
          .removal_checked = record.removal_check.nothing_removed || record.removal_check.truth_removed};
}

void FrameRecords::push_back(FrameRecord one) {
  outlines_.push_back(outline_of(one));
  ChunkedList::push_back(std::move(one));
}

FrameRecords FrameRecords::first(std::size_t count) const {
  FrameRecords some;
  static_cast<ChunkedList&>(some) = ChunkedList::first(count);
  some.outlines_ = outlines_.first(count);
  return some;
}

void FrameRecords::resize(std::size_t count) {
  if (count < size()) *this = first(count);
  while (size() < count) push_back({});
}

}  // namespace stillpoint
