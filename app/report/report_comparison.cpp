#include "app/report/report_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "app/report/html.hpp"
#include "app/version.hpp"
#include "core/evaluation/pose_series.hpp"
#include "core/run/removal_errors.hpp"
#include "ui/plot/path_plot.hpp"
#include "ui/plot/plot_file.hpp"

namespace stillpoint {
namespace {

constexpr std::pair<int, int> kSideBySide = {640, 540};  // px
constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"}, kTurnNames = {"roll", "pitch", "yaw"};

/// A run's path, or the truth's, number by number.
struct Path {
  std::string name;
  PoseSeries series;
  Rgb colour;
  SeriesStyle style = SeriesStyle::kLine;
  float width = 1.6F;
};

PoseSeries series_of(const ReportRun& run) {
  const double start = run.result().records.front().timestamp;
  if (!run.report.evaluation || run.report.evaluation->matched.empty())
    return pose_series(run.result().trajectory, start);
  Trajectory aligned;
  for (const MatchedPose& pose : run.report.evaluation->matched)
    aligned.push_back(
        {pose.timestamp, run.report.evaluation->ate.alignment.truth_from_estimate * pose.estimate});
  return pose_series(aligned, start);
}

std::vector<Path> paths_of(const ReportGroup& group) {
  std::vector<Path> paths;
  for (const ReportRun& run : group.runs) {
    if (!run.report.evaluation || run.report.evaluation->matched.empty()) continue;
    Trajectory truth;
    for (const MatchedPose& pose : run.report.evaluation->matched)
      truth.push_back({pose.timestamp, pose.truth});
    paths.push_back({"ground truth", pose_series(truth, run.result().records.front().timestamp),
                     role_colour(Role::kGroundTruth, ThemeName::kLight), SeriesStyle::kLine, 2.4F});
    break;
  }
  for (std::size_t i = 0; i < group.runs.size(); ++i) {
    const RunLook look = look_of_run(group.runs[i], i, ThemeName::kLight);
    PoseSeries series = series_of(group.runs[i]);
    if (!series.time.empty())
      paths.push_back({group.runs[i].label, std::move(series), look.colour, look.line, 1.8F});
  }
  return paths;
}

std::string drawn_figure(const Plot& plot, const std::string& caption) {
  return figure_html_of_png(plot_drawn(PlotFigure(plot, PlotView{}), ".png"), caption);
}

std::string path_picture(const std::vector<Path>& paths) {
  std::vector<PlotPath> flat;
  for (const Path& path : paths)
    flat.push_back({path.name, &path.series.position, path.colour, path.style, path.width});
  const PathPlot made = path_plot(flat);
  return drawn_figure(made.plot, fmt::format("All runs in one scale, along {} and {}, the two axes in which "
                                             "the camera went furthest",
                                             made.across, made.up));
}

std::string pose_plots(const std::vector<Path>& paths, bool turns) {
  std::string html = "<div class=\"grid\">\n";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char* name = turns ? kTurnNames[axis] : kAxisNames[axis];
    Plot plot{.x_label = "time", .x_unit = "s", .y_label = name, .y_unit = turns ? "°" : "m"};
    plot.y_from_zero = false;
    for (const Path& path : paths)
      plot.series.push_back({path.name, path.series.time,
                             turns ? path.series.angle[axis] : path.series.position[axis], path.colour,
                             path.style, path.width});
    html +=
        drawn_figure(plot, fmt::format("{} over time, all runs", turns ? fmt::format("The angle {}", name)
                                                                       : fmt::format("Position {}", name)));
  }
  return html + "</div>\n";
}

double median_of(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// "helped in 12, hurt in 3 of 40 frames; median step error 2.1 mm with, 4.0 mm without".
std::string removal_text(const ReportRun& run) {
  if (!run.result().config.run.check_removal) return "not checked (run.check_removal)";
  if (!run.report.evaluation) return "no ground truth to check against";
  const auto errors = removal_errors(run.result().records, *run.report.evaluation);
  if (errors.empty()) return "no frame could be checked";
  std::vector<double> with, without;
  for (const RemovalError& error : errors) {
    if (std::isfinite(error.with_removal_m)) with.push_back(error.with_removal_m);
    if (std::isfinite(error.without_removal_m)) without.push_back(error.without_removal_m);
  }
  return fmt::format(
      "helped in {}, hurt in {} of {} frames; median step error {:.2f} mm with, {:.2f} mm without",
      std::count_if(errors.begin(), errors.end(), [](const RemovalError& e) { return e.helped; }),
      std::count_if(errors.begin(), errors.end(), [](const RemovalError& e) { return e.hurt; }),
      errors.size(), 1000.0 * median_of(with), 1000.0 * median_of(without));
}

std::string mask_text(const ReportRun& run) {
  const FrameScores& scores = run.report.scores;
  if (!scores.known) return "no true masks";
  if (method_named(run.report.method).baseline) return "removes nothing";
  const auto percent = [](const std::optional<double>& share) {
    return share ? fmt::format("{:.1f} %", 100.0 * *share) : std::string("–");
  };
  return fmt::format("precision {}, recall {}, IoU {}; features removed {} rightly, {} wrongly",
                     percent(scores.mask.precision()), percent(scores.mask.recall()),
                     percent(scores.mask.iou()), scores.removal.removed_rightly,
                     scores.removal.removed_wrongly);
}

}  // namespace

std::string paths_compared(const ReportGroup& group) {
  const std::vector<Path> paths = paths_of(group);
  if (paths.empty()) return "<p class=\"dim\">No run has poses.</p>\n";
  return path_picture(paths) + pose_plots(paths, false) + pose_plots(paths, true);
}

std::string one_frame_compared(Painter& painter, const ReportGroup& group, const ReportProgress& progress) {
  if (group.runs.size() < 2) return {};
  // Of the first run that has a frame worse than others; the baseline's would say little of methods.
  std::optional<WorstFrame> shown;
  for (const ReportRun& run : group.runs) {
    const auto worst = worst_frames_of(run, 1);
    if (worst.empty()) continue;
    if (!shown || method_named(run.report.method).baseline == false) shown = worst.front();
    if (!method_named(run.report.method).baseline) break;
  }
  if (!shown) return {};
  std::string html = fmt::format(
      "<h3>Frame {} by every run</h3>\n<p>{}. Features as each run found them, and the mask it took "
      "out.</p>\n"
      "<div class=\"grid\">\n",
      shown->index, escaped(shown->why));
  for (const ReportRun& run : group.runs) {
    if (shown->index >= run.report.frames) continue;
    progress(fmt::format("{} ({}): frame {}", group.sequence, run.label, shown->index));
    const auto session = session_of_report(group, run, false);
    session->go_to(shown->index);
    html +=
        figure_html(painter.paint_panel(*session->view(), "features_before", kSideBySide),
                    fmt::format("{}: frame {}, features and mask", run.label, shown->index), Packing::kSmall);
  }
  return html + "</div>\n";
}

std::string provenance(const std::vector<ReportGroup>& groups) {
  const BenchmarkResults made = made_here();
  std::string html = "<h2 id=\"made\">What this is of</h2>\n<section class=\"made\">";
  html += table_html({"", ""}, {{{"Page made on"}, {made.date}},
                                {{"by"}, {version_text()}},
                                {{"with"}, {made.command}},
                                {{"on"}, {made.machine}}});
  html += "</section>\n";
  std::vector<std::vector<HtmlCell>> rows;
  for (const ReportGroup& group : groups)
    for (const ReportRun& run : group.runs)
      rows.push_back({{run.label},
                      {group.sequence},
                      {run.opened.source->camera().name},
                      {run.recorded().outside.empty() ? run.result().config.run.odometry : "its own"},
                      {run.report.hash},
                      {removal_text(run)},
                      {mask_text(run)}});
  return html +
         table_html({"Run", "Sequence", "Camera", "Odometry", "Hash", "Did removal help?", "Masks"}, rows);
}

}  // namespace stillpoint
