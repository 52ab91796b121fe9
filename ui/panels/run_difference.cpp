#include "ui/panels/run_difference.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/se3.hpp"
#include "core/motion/figure_info.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint {
namespace {

constexpr const char* kDash = "–";  // as shown_value has it

}  // namespace

FrameDifference difference_of(const MeasuredFrames& run, std::size_t row, const MeasuredFrames& ghost,
                              std::size_t ghost_row) {
  constexpr double kDegrees = 180.0 / 3.14159265358979;  // degrees a radian
  const FrameRecord here = run.records[row], there = ghost.records[ghost_row];
  FrameDifference difference;
  const Pose run_from_ghost = here.world_from_camera.inverse() * there.world_from_camera;
  difference.translation_m = run_from_ghost.translation().norm();
  difference.rotation_deg = kDegrees * rotation_angle(run_from_ghost.linear());
  const bool both_ours = here.measured.solving && there.measured.solving;
  const auto add = [&](const std::string& name, std::string a, std::string b) {
    // What another program did not tell is no difference.
    const bool told = both_ours || (a != kDash && b != kDash);
    const bool differs = a != b && told;
    difference.figures.push_back({name, std::move(a), std::move(b), differs});
  };
  add("Status", std::string(to_string(here.status)), std::string(to_string(there.status)));
  const auto keyframe = [](const FrameRecord& record) {
    return !record.measured.keyframes ? kDash : record.keyframe ? "yes" : "no";
  };
  if (here.measured.keyframes || there.measured.keyframes) add("Keyframe", keyframe(here), keyframe(there));
  const std::vector<double> a = figures_of_frame(run, row), b = figures_of_frame(ghost, ghost_row);
  const auto& infos = frame_figure_infos();
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const bool of_time = infos[i].unit == FigureUnit::milliseconds;  // noise, and never the same twice
    if (infos[i].title.empty() || of_time || (std::isnan(a[i]) && std::isnan(b[i]))) continue;
    add(infos[i].title, shown_value(infos[i], a[i]), shown_value(infos[i], b[i]));
  }
  return difference;
}

bool in_worlds_of_their_own(const SessionView& session, const GhostView& ghost) {
  return ghost.outside || !session.outside.empty();
}

std::string pose_text(const FrameDifference& difference, const std::string& other, bool apart) {
  if (apart)
    return fmt::format("{}'s poses are of a world of its own: errors and the trajectory compare them.",
                       other);
  if (difference.translation_m == 0.0 && difference.rotation_deg == 0.0) return "Both poses are the same.";
  return fmt::format("Poses differ by {:.2f} mm and {:.3f} °.", 1000.0 * difference.translation_m,
                     difference.rotation_deg);
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
