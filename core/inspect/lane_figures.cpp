#include "core/inspect/lane_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace stillpoint {
namespace {

constexpr double kSameTime = 1e-6;  // s

constexpr std::array<LaneInfo, static_cast<std::size_t>(LaneFigure::kCount)> kFigures{
    {{LaneFigure::kRpeFrame, "rpe", "Step error", "mm",
      "Error of the motion from the frame before, against the truth."},
     {LaneFigure::kError, "error", "Error", "mm", "Distance to the truth after alignment of the whole way."},
     {LaneFigure::kMask, "mask", "Mask", "%", "Share of the image held to be moving."},
     {LaneFigure::kInliers, "inliers", "Inliers", "", "Matches that agree with the pose.", true},
     {LaneFigure::kKept, "kept", "Features kept", "", "Features outside the mask.", true},
     {LaneFigure::kRemoved, "removed", "Features removed", "", "Features inside the mask."},
     {LaneFigure::kResidual, "residual", "Residual", "px", "Reprojection error of the inliers, RMS."},
     {LaneFigure::kTotalMs, "ms", "Time", "ms", "What the whole frame took."},
     {LaneFigure::kMotionMs, "motion_ms", "Motion time", "ms", "What finding motion took."},
     {LaneFigure::kFeaturesMs, "features_ms", "Features time", "ms", "What extracting features took."},
     {LaneFigure::kMatchingMs, "matching_ms", "Matching time", "ms", "What matching to the map took."},
     {LaneFigure::kPoseMs, "pose_ms", "Pose time", "ms", "What estimating the pose took."},
     {LaneFigure::kMappingMs, "mapping_ms", "Mapping time", "ms", "What tending the map took."},
     {LaneFigure::kBundleMs, "bundle_ms", "Bundle time", "ms", "What bundle adjustment took."}}};

bool has_no_pose(const FrameRecord& record) {
  return record.status == FrameStatus::lost || record.status == FrameStatus::unreadable;
}

double time_or_none(double ms) { return ms > 0.0 ? ms : std::nan(""); }

/// A figure that a record holds itself.
double value_of(const FrameRecord& record, LaneFigure figure) {
  const bool lost = has_no_pose(record), unread = record.status == FrameStatus::unreadable;
  switch (figure) {
    case LaneFigure::kMask:
      return unread ? std::nan("") : 100.0 * record.mask_share;
    case LaneFigure::kInliers:
      return lost ? std::nan("") : record.inliers;
    case LaneFigure::kKept:
      return unread ? std::nan("") : record.features_kept;
    case LaneFigure::kRemoved:
      return unread ? std::nan("") : record.features_removed;
    case LaneFigure::kResidual:
      return lost || record.inliers == 0 ? std::nan("") : record.rms_px;
    case LaneFigure::kTotalMs:
      return time_or_none(record.ms.total);
    case LaneFigure::kMotionMs:
      return time_or_none(record.ms.motion);
    case LaneFigure::kFeaturesMs:
      return time_or_none(record.ms.features);
    case LaneFigure::kMatchingMs:
      return time_or_none(record.ms.matching);
    case LaneFigure::kPoseMs:
      return time_or_none(record.ms.pose);
    case LaneFigure::kMappingMs:
      return time_or_none(record.ms.mapping);
    case LaneFigure::kBundleMs:
      return time_or_none(record.ms.bundle);
    case LaneFigure::kRpeFrame:
    case LaneFigure::kError:
    case LaneFigure::kCount:
      break;
  }
  return std::nan("");
}

/// Errors laid at the records of their times; both go forward in time.
template <typename Errors, typename Time>
std::vector<double> at_records(const RunView& run, const Errors& errors, Time time_of) {
  std::vector<double> values(run.records.size(), std::nan(""));
  std::size_t next = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double time = run.records[i].timestamp;
    while (next < errors.size() && time_of(errors[next]) < time - kSameTime) ++next;
    if (next < errors.size() && std::abs(time_of(errors[next]) - time) < kSameTime)
      values[i] = 1000.0 * errors[next].translation_m;
  }
  return values;
}

}  // namespace

std::span<const LaneInfo> lane_infos() { return kFigures; }

const LaneInfo& info_of(LaneFigure figure) { return kFigures.at(static_cast<std::size_t>(figure)); }

std::vector<double> lane_values(const RunView& run, LaneFigure figure) {
  if (figure == LaneFigure::kRpeFrame)
    return at_records(run, run.evaluation.rpe_frame.errors,
                      [](const RelativeError& error) { return error.to_timestamp; });
  if (figure == LaneFigure::kError)
    return at_records(run, run.evaluation.ate.errors,
                      [](const AbsoluteError& error) { return error.timestamp; });
  std::vector<double> values;
  values.reserve(run.records.size());
  for (const FrameRecord& record : run.records) values.push_back(value_of(record, figure));
  return values;
}

LaneFigure usual_figure(const RunView& run) {
  return run.evaluation.rpe_frame.errors.empty() ? LaneFigure::kInliers : LaneFigure::kRpeFrame;
}

std::vector<int> worst_frames(const RunView& run, LaneFigure figure, int apart, std::size_t most) {
  std::vector<int> worst;
  for (std::size_t i = 0; i < run.records.size() && worst.size() < most; ++i)
    if (has_no_pose(run.records[i]) && (i == 0 || !has_no_pose(run.records[i - 1])))
      worst.push_back(run.records[i].index);
  std::vector<std::pair<double, int>> ranked;  // badness, negated so that ties stand in order of time
  const std::vector<double> values = lane_values(run, figure);
  const double sign = info_of(figure).low_is_bad ? 1.0 : -1.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i])) ranked.emplace_back(sign * values[i], run.records[i].index);
  std::sort(ranked.begin(), ranked.end());
  // The better half of the run holds no failures, though nothing near some frame may be worse.
  ranked.resize((ranked.size() + 1) / 2);
  for (const auto& [badness, frame] : ranked) {
    if (worst.size() >= most) break;
    const auto near = [&, at = frame](int other) { return std::abs(other - at) < apart; };
    if (std::none_of(worst.begin(), worst.end(), near)) worst.push_back(frame);
  }
  return worst;
}

}  // namespace stillpoint
