#include "app/report/live_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/run/frame_figures.hpp"
#include "core/sequence/association.hpp"
#include "ui/shell/event_log.hpp"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoints = 8000;      // of a map: more hide each other, and slow turning down
constexpr std::size_t kMostTruthPoses = 5000;  // of a path
constexpr double kTruthGap = 0.5;              // s without ground truth that breaks its line
constexpr std::array kUsualFigures = {"rpe",         "rpe_1s",     "ate",     "mask",    "mask_precision",
                                      "mask_recall", "mask_iou",   "removed", "matches", "inliers",
                                      "residual",    "map_points", "ms.total"};

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

Json position_json(const Eigen::Vector3d& p) {
  return {rounded(p.x(), 1e4), rounded(p.y(), 1e4), rounded(p.z(), 1e4)};
}

Json turn_json(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {rounded(q.x(), 1e5), rounded(q.y(), 1e5), rounded(q.z(), 1e5), rounded(q.w(), 1e5)};
}

/// To the digits of frames.csv.
Json figure_json(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  if (digits == 0) return static_cast<std::int64_t>(std::llround(value));
  return std::stod(fmt::format("{:.{}f}", value, digits));
}

std::string colour_text(Rgb colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.r, colour.g, colour.b);
}

Json dash_json(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::kDashed:
      return {9, 5};
    case SeriesStyle::kDotted:
      return {2, 4};
    case SeriesStyle::kDashDot:
      return {9, 4, 2, 4};
    default:
      return Json::array();
  }
}

bool has_truth(const ReportGroup& group) {
  return std::any_of(group.runs.begin(), group.runs.end(), [](const ReportRun& run) {
    return run.report.evaluation && !run.report.evaluation->matched.empty();
  });
}

/// The world all runs of a group are shown in is the truth's; without one, the first run's.
Pose world_from_run(const ReportGroup& group, const ReportRun& run) {
  if (run.report.evaluation && !run.report.evaluation->matched.empty())
    return run.report.evaluation->ate.alignment.truth_from_estimate;
  const ReportRun& first = group.runs.front();
  if (run.recorded().outside.empty() && first.recorded().outside.empty()) return Pose::Identity();
  return absolute_error(match_trajectories(first.result().trajectory, run.result().trajectory))
      .alignment.truth_from_estimate;
}

/// The ground truth while the runs last.
Json truth_json(const ReportGroup& group) {
  double from = group.runs.front().result().records.front().timestamp, to = from;
  for (const ReportRun& run : group.runs) {
    from = std::min(from, run.result().records.front().timestamp);
    to = std::max(to, run.result().records.back().timestamp);
  }
  Trajectory truth;
  for (const StampedPose& pose : group.runs.front().recorded().ground_truth)
    if (pose.timestamp >= from - 0.05 && pose.timestamp <= to + 0.05) truth.push_back(pose);
  const std::size_t step = 1 + truth.size() / kMostTruthPoses;
  Json seconds = Json::array(), positions = Json::array(), turns = Json::array();
  for (std::size_t i = 0; i < truth.size(); i += step) {
    if (i > 0 &&
        truth[i].timestamp - truth[i - step].timestamp > kTruthGap + static_cast<double>(step) * 0.05) {
      seconds.push_back(rounded(truth[i].timestamp - from, 1e4));
      positions.push_back(nullptr);
      turns.push_back(nullptr);
    }
    seconds.push_back(rounded(truth[i].timestamp - from, 1e4));
    turns.push_back(turn_json(truth[i].world_from_camera));
    positions.push_back(position_json(truth[i].world_from_camera.translation()));
  }
  return {{"seconds", std::move(seconds)}, {"positions", std::move(positions)}, {"turns", std::move(turns)}};
}

Json points_json(const std::vector<SavedPoint>& points, const Pose& world) {
  const std::size_t step = 1 + points.size() / kMostPoints;
  Json mm = Json::array();
  std::string colours;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector3d p = world * points[i].position * 1000.0;
    if (!p.allFinite()) continue;
    for (const double value : {p.x(), p.y(), p.z()}) mm.push_back(std::llround(value));
    const cv::Vec3b& c = points[i].colour;
    colours += fmt::format("{:02x}{:02x}{:02x}", c[2], c[1], c[0]);
  }
  return {{"mm", std::move(mm)}, {"colours", std::move(colours)}, {"of", points.size()}};
}

Json run_json(const ReportGroup& group, std::size_t place, double start, const std::set<int>& figures) {
  const ReportRun& run = group.runs[place];
  const RunResult& result = run.result();
  const RunLook light = look_of_run(run, place, ThemeName::kLight),
                dark = look_of_run(run, place, ThemeName::kDark);
  const Pose world = world_from_run(group, run);
  Json json = {{"name", run.label},
               {"colours", {colour_text(light.colour), colour_text(dark.colour)}},
               {"dash", dash_json(light.line)}};
  for (const char* list : {"frames", "seconds", "status", "note", "positions", "turns", "keyframes"})
    json[list] = Json::array();
  for (const FrameRecord& record : result.records) {
    json["frames"].push_back(record.index);
    json["seconds"].push_back(rounded(record.timestamp - start, 1e4));
    json["status"].push_back(to_string(record.status));
    json["note"].push_back(remarks_on(record));
    const auto pose = record.estimated
                          ? nearest_pose(result.trajectory, record.timestamp, kAssociationTolerance)
                          : std::nullopt;
    const bool finite = pose && result.trajectory[*pose].world_from_camera.matrix().allFinite();
    if (finite) {
      const Pose shown = world * result.trajectory[*pose].world_from_camera;
      json["positions"].push_back(position_json(shown.translation()));
      json["turns"].push_back(turn_json(shown));
    } else {
      json["positions"].push_back(nullptr);
      json["turns"].push_back(nullptr);
    }
  }
  for (const SavedKeyframe& keyframe : result.keyframes) json["keyframes"].push_back(keyframe.frame_index);
  json["points"] = points_json(result.points, world);
  const MeasuredFrames measured{result.records, run.report.evaluation ? &*run.report.evaluation : nullptr,
                                &result.scores};
  json["figures"] = Json::object();
  for (const int figure : figures) {
    const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(figure)];
    Json& values = json["figures"][info.name] = Json::array();
    for (const double value : frame_figure_values(measured, figure))
      values.push_back(figure_json(value, info.digits));
  }
  return json;
}

/// Those that are known of any frame of any run: indices into frame_figure_infos().
std::set<int> known_figures(const std::vector<ReportGroup>& groups) {
  std::set<int> known;
  for (const ReportGroup& group : groups)
    for (const ReportRun& run : group.runs) {
      const MeasuredFrames measured{run.result().records,
                                    run.report.evaluation ? &*run.report.evaluation : nullptr,
                                    &run.result().scores};
      const FrameFigures figures(measured);
      for (int i = 0; i < static_cast<int>(frame_figure_infos().size()); ++i)
        for (int row = 0; row < figures.rows(); ++row)
          if (std::isfinite(figures.value(row, i))) {
            known.insert(i);
            break;
          }
    }
  known.erase(frame_figure("frame"));  // the page counts frames itself
  return known;
}

Json figure_infos_json(const std::set<int>& figures) {
  Json infos = Json::array();
  for (const int figure : figures) {
    const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(figure)];
    const ShownUnit shown = shown_unit(info.unit);
    const bool fine = info.unit == FigureUnit::metres || info.unit == FigureUnit::share;
    infos.push_back(
        {{"name", info.name},
         {"title", shown_name(info)},
         {"unit", shown.unit},
         {"factor", shown.factor},
         {"digits", info.digits == 0 ? 0
                    : fine           ? 2
                                     : 3},
         {"truth", info.unit == FigureUnit::truth},
         {"usual", std::find(kUsualFigures.begin(), kUsualFigures.end(), info.name) != kUsualFigures.end()},
         {"worse", info.worse == WorseWhen::high  ? "high"
                   : info.worse == WorseWhen::low ? "low"
                                                  : ""},
         {"help", info.help}});
  }
  return infos;
}

}  // namespace

nlohmann::ordered_json live_data(const std::vector<ReportGroup>& groups,
                                 std::vector<LivePictures>& pictures) {
  const std::set<int> figures = known_figures(groups);
  Json json = {{"figures", figure_infos_json(figures)}, {"sequences", Json::array()}};
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const ReportGroup& group = groups[i];
    const Camera& camera = group.runs.front().opened.source->camera();
    double start = group.runs.front().result().records.front().timestamp;
    for (const ReportRun& run : group.runs) start = std::min(start, run.result().records.front().timestamp);
    Json sequence = {{"name", group.sequence},
                     {"up", has_truth(group) ? Json{0, 0, 1} : Json{0, -1, 0}},
                     {"camera", {camera.width, camera.height, camera.fx, camera.fy}},
                     {"pictures",
                      {{"told", pictures_text(pictures[i])},
                       {"size", {pictures[i].size.width, pictures[i].size.height}},
                       {"layers", pictures[i].layers},
                       {"frames", std::move(pictures[i].pictures)}}},
                     {"truth", truth_json(group)},
                     {"runs", Json::array()}};
    for (std::size_t run = 0; run < group.runs.size(); ++run)
      sequence["runs"].push_back(run_json(group, run, start, figures));
    json["sequences"].push_back(std::move(sequence));
  }
  return json;
}

}  // namespace stillpoint
