#include "app/motion_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>

namespace stillpoint {
namespace {

struct TrackCounts {
  int all = 0, removed = 0, inliers = 0;
};

TrackCounts count_tracks(const DirectionTrace& direction) {
  TrackCounts counts;
  counts.all = static_cast<int>(direction.tracks.size());
  for (const Track& track : direction.tracks) {
    counts.removed += track.removed ? 1 : 0;
    counts.inliers += track.inlier ? 1 : 0;
  }
  return counts;
}

double share_of(const cv::Mat& mask) {
  return static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

std::string in_quotes(const std::string& text) {
  std::string safe = "\"";
  for (const char letter : text) {
    if (letter == '"') safe += '"';
    safe += letter;
  }
  return safe + '"';
}

std::string direction_columns(const DirectionTrace& direction) {
  const TrackCounts counts = count_tracks(direction);
  std::string columns = fmt::format("{},{},{}", counts.all, counts.removed, counts.inliers);
  const HomographyEstimate& h = direction.homography;
  columns += h.valid ? fmt::format(",{:.4f},{:.4f}", h.ransac_error_px, h.refined_error_px) : ",,";
  columns += direction.mask.empty()
                 ? ",,"
                 : fmt::format(",{},{:.6f}", direction.threshold, share_of(direction.mask));
  return columns;
}

nlohmann::json direction_json(const DirectionTrace& direction) {
  const TrackCounts counts = count_tracks(direction);
  const HomographyEstimate& h = direction.homography;
  nlohmann::json figures = {{"tracks", counts.all},
                            {"removed", counts.removed},
                            {"inliers", counts.inliers},
                            {"homography_valid", h.valid}};
  if (h.valid) {
    figures["ransac_error_px"] = h.ransac_error_px;
    figures["refined_error_px"] = h.refined_error_px;
    figures["refine_iterations"] = h.refine_iterations;
  }
  if (!direction.mask.empty()) {
    figures["homography"] = h.matrix.val;
    figures["threshold"] = direction.threshold;
    figures["mask_share"] = share_of(direction.mask);
  }
  return figures;
}

nlohmann::json round_json(const MotionRound& round) {
  nlohmann::json regions = nlohmann::json::array();
  for (const MotionRegion& region : round.regions)
    regions.push_back({{"x", region.box.x},
                       {"y", region.box.y},
                       {"width", region.box.width},
                       {"height", region.box.height},
                       {"area_px", region.area}});
  return {{"forward", direction_json(round.forward)},
          {"backward", direction_json(round.backward)},
          {"mask_share", round.mask.empty() ? nlohmann::json() : nlohmann::json(round.mask_share)},
          {"regions", regions}};
}

}  // namespace

std::string motion_csv_heading() {
  std::string heading = "reference,target,rounds,converged,mask_share,regions,largest_region_px";
  for (const char* name : {"forward", "backward"})
    for (const char* figure :
         {"tracks", "removed", "inliers", "ransac_error_px", "refined_error_px", "threshold", "mask_share"})
      heading += fmt::format(",{}_{}", name, figure);
  return heading + ",note";
}

std::string motion_csv_row(const std::string& reference, const std::string& target, const PaperTrace& trace) {
  const MotionRound round = trace.rounds.empty() ? MotionRound{} : trace.rounds.back();
  int largest = 0;
  for (const MotionRegion& region : round.regions) largest = std::max(largest, region.area);
  const std::string mask_columns =
      round.mask.empty() ? ",,"
                         : fmt::format("{:.6f},{},{}", round.mask_share, round.regions.size(), largest);
  return fmt::format("{},{},{},{},{},{},{},{}", in_quotes(reference), in_quotes(target), trace.rounds.size(),
                     trace.converged ? 1 : 0, mask_columns, direction_columns(round.forward),
                     direction_columns(round.backward), in_quotes(trace.note));
}

nlohmann::json motion_json(const std::string& reference, const std::string& target, const PaperTrace& trace) {
  nlohmann::json rounds = nlohmann::json::array();
  for (const MotionRound& round : trace.rounds) rounds.push_back(round_json(round));
  return {{"reference", reference},
          {"target", target},
          {"converged", trace.converged},
          {"note", trace.note},
          {"rounds", rounds}};
}

}  // namespace stillpoint
