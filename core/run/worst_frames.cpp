#include "core/run/worst_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

namespace stillpoint {
namespace {

std::vector<WorstFrame> lost_frames(const RunResult& run) {
  std::vector<WorstFrame> lost;
  bool before = false;
  for (const FrameRecord& record : run.records) {
    if (!record.estimated && !before)
      lost.push_back({record.index, fmt::format("{}{}{}", to_string(record.status),
                                                record.note.empty() ? "" : ": ", record.note)});
    before = !record.estimated;
  }
  return lost;
}

std::vector<WorstFrame> by_error(const RunResult& run, const TrajectoryEvaluation& evaluation) {
  std::map<double, int> index_of;
  for (const FrameRecord& record : run.records) index_of[record.timestamp] = record.index;
  std::vector<RelativeError> errors = evaluation.rpe_frame.errors;
  std::stable_sort(errors.begin(), errors.end(), [](const RelativeError& a, const RelativeError& b) {
    return a.translation_m > b.translation_m;
  });
  std::vector<WorstFrame> worst;
  for (const RelativeError& error : errors) {
    const auto frame = index_of.find(error.to_timestamp);
    if (frame == index_of.end()) continue;
    worst.push_back(
        {frame->second, fmt::format("the motion from the frame before is {:.1f} mm and {:.2f}° off",
                                    1000.0 * error.translation_m, error.rotation_deg)});
  }
  return worst;
}

std::vector<WorstFrame> by_inliers(const RunResult& run) {
  std::vector<const FrameRecord*> records;
  for (const FrameRecord& record : run.records)
    if (record.estimated && record.status != FrameStatus::initialised) records.push_back(&record);
  std::stable_sort(records.begin(), records.end(),
                   [](const FrameRecord* a, const FrameRecord* b) { return a->inliers < b->inliers; });
  std::vector<WorstFrame> worst;
  for (const FrameRecord* record : records)
    worst.push_back(
        {record->index, fmt::format("its pose rests on {} inliers, few for this run", record->inliers)});
  return worst;
}

}  // namespace

std::vector<WorstFrame> worst_frames(const RunResult& run, const RunReport& report, int count, int apart) {
  std::vector<WorstFrame> candidates = lost_frames(run);
  const std::vector<WorstFrame> rest =
      report.evaluation ? by_error(run, *report.evaluation) : by_inliers(run);
  candidates.insert(candidates.end(), rest.begin(), rest.end());
  std::vector<WorstFrame> chosen;
  for (const WorstFrame& candidate : candidates) {
    if (static_cast<int>(chosen.size()) >= count) break;
    if (std::none_of(chosen.begin(), chosen.end(), [&](const WorstFrame& other) {
          return std::abs(other.index - candidate.index) < apart;
        }))
      chosen.push_back(candidate);
  }
  return chosen;
}

}  // namespace stillpoint
