#include "ui/panels/run_difference.hpp"

#include <fmt/format.h>

#include "core/geometry/se3.hpp"

namespace stillpoint {

FrameDifference difference_of(const FrameRecord& run, const FrameRecord& ghost) {
  constexpr double kDegrees = 180.0 / 3.14159265358979;
  FrameDifference difference;
  const Pose run_from_ghost = run.world_from_camera.inverse() * ghost.world_from_camera;
  difference.translation_m = run_from_ghost.translation().norm();
  difference.rotation_deg = kDegrees * rotation_angle(run_from_ghost.linear());
  const auto add = [&](const char* name, std::string a, std::string b) {
    const bool differs = a != b;
    difference.figures.push_back({name, std::move(a), std::move(b), differs});
  };
  const auto count = [&](const char* name, int FrameRecord::*field) {
    add(name, fmt::format("{}", run.*field), fmt::format("{}", ghost.*field));
  };
  add("Status", std::string(to_string(run.status)), std::string(to_string(ghost.status)));
  add("Mask", fmt::format("{:.2f} %", 100.0 * run.mask_share),
      fmt::format("{:.2f} %", 100.0 * ghost.mask_share));
  count("Features removed", &FrameRecord::features_removed);
  count("Features kept", &FrameRecord::features_kept);
  count("Matches", &FrameRecord::matches);
  count("Inliers", &FrameRecord::inliers);
  add("Residual", reprojection_text(run), reprojection_text(ghost));
  add("Keyframe", run.keyframe ? "yes" : "no", ghost.keyframe ? "yes" : "no");
  count("Map points", &FrameRecord::map_points);
  return difference;
}

std::optional<double> MaskOverlap::iou() const {
  const int all = both + only_run + only_ghost;
  return all == 0 ? std::nullopt : std::optional(static_cast<double>(both) / all);
}

MaskOverlap overlap_of(const cv::Mat& run, const cv::Mat& ghost) {
  MaskOverlap overlap;
  const int in_run = run.empty() ? 0 : cv::countNonZero(run),
            in_ghost = ghost.empty() ? 0 : cv::countNonZero(ghost);
  if (!run.empty() && !ghost.empty() && run.size() == ghost.size())
    overlap.both = cv::countNonZero(run & ghost);
  overlap.only_run = in_run - overlap.both;
  overlap.only_ghost = in_ghost - overlap.both;
  return overlap;
}

}  // namespace stillpoint
