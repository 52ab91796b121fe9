#include "app/report/report_pictures.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/report/html.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/plot.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/event_log.hpp"

namespace stillpoint {
namespace {

constexpr std::pair<int, int> kPlotSize = {1130, 300}, kScenePanel = {720, 560},
                              kFramePanel = {640, 540};  // px

struct Curve {
  std::string name;
  Series series;
  RunLook look;
};

std::vector<Curve> error_curves(const ReportGroup& group, RelativePoseError TrajectoryEvaluation::*error) {
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < group.runs.size(); ++i) {
    const ReportRun& run = group.runs[i];
    if (!run.report.evaluation) continue;
    const double start = run.result().records.front().timestamp;
    Series series = error_series((*run.report.evaluation).*error, start, false);
    if (!series.x.empty())
      curves.push_back({run.label, std::move(series), look_of_run(run, i, ThemeName::kLight)});
  }
  return curves;
}

/// From the first frame to the last, over all runs.
AxisRange time_of(const ReportGroup& group) {
  AxisRange range{0.0, 1e-3};
  for (const ReportRun& run : group.runs) {
    const FrameRecords& records = run.result().records;
    range.high = std::max(range.high, records.back().timestamp - records.front().timestamp);
  }
  return range;
}

cv::Mat plot_picture(Painter& painter, const std::vector<Curve>& curves, const AxisRange& time,
                     const std::string& label) {
  PlotView view;
  return painter.paint_frame(
      [&](UiFrame& frame) {
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize(frame.size);
        ImGui::PushStyleColor(ImGuiCol_WindowBg, to_vec4(frame.theme.panel));
        ImGui::Begin("##plot", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings);
        Plot plot{.x_label = "time", .x_unit = "s", .y_label = label, .y_unit = "mm"};
        plot.x_limits = time;
        for (const Curve& curve : curves)
          plot.series.push_back(
              {curve.name, curve.series.x, curve.series.y, curve.look.colour, curve.look.line, 1.8F});
        (void)draw_plot(frame, "plot", plot, view);
        ImGui::End();
        ImGui::PopStyleColor();
      },
      kPlotSize);
}

/// What is worth seeing of a frame, by method, with what it is called.
std::vector<std::pair<std::string, std::string>> panels_of(const ReportRun& run, const FrameView& frame) {
  using Panels = std::vector<std::pair<std::string, std::string>>;
  if (!run.opened.no_images.empty())
    return Panels{{"features_before", "Features before removal; the image is missing"},
                  {"features_after", "Features after removal; the image is missing"}};
  const MethodInfo& method = method_named(run.report.method);
  const std::pair<std::string, std::string> before = {"features_before",
                                                      "Features before removal, and the mask"},
                                            after = {"features_after", "Features after removal, as tracked"};
  if (method.baseline) return {{"input", "Input"}, after};
  if (method.reference) return {before, after};
  return {{"input", "Input"},
          before,
          {"motion", fmt::format("What method {} judges by, stage by stage", frame.motion->method)},
          after};
}

}  // namespace

std::unique_ptr<Session> session_of_report(const ReportGroup& group, const ReportRun& run, bool catch_up) {
  SessionOptions options;
  options.recorded = run.opened.recorded;
  if (group.baseline() != nullptr && group.baseline() != &run)
    options.recorded_baseline = group.baseline()->opened.recorded;
  options.no_images = run.opened.no_images;
  options.catch_up = catch_up;
  return std::make_unique<Session>(run.opened.source, run.result().config, options);
}

RunLook look_of_run(const ReportRun& run, std::size_t place, ThemeName theme) {
  // Another program's run is by none of our methods, the baseline's least of all.
  const bool ours = run.recorded().outside.empty();
  if (ours && method_named(run.report.method).baseline)
    return {role_colour(Role::kBaseline, theme), SeriesStyle::kDashed};
  if (ours && run.report.method == kDefaultMethod)
    return {role_colour(Role::kEstimate, theme), SeriesStyle::kLine};
  return ghost_look(place, theme);
}

std::vector<WorstFrame> worst_frames_of(const ReportRun& run, int count) {
  const RunResult& result = run.result();
  const MeasuredFrames frames{result.records, run.report.evaluation ? &*run.report.evaluation : nullptr,
                              &result.scores};
  return worst_frames(frames, usual_figure(frames), kWorstApart, static_cast<std::size_t>(count));
}

std::string frame_anchor(const ReportGroup& group, const ReportRun& run, int frame) {
  return fmt::format("frame{}-run{}-{}", frame, 1 + (&run - group.runs.data()),
                     run.recorded().origin.fingerprint.substr(0, 8));
}

std::string error_plots(Painter& painter, const ReportGroup& group) {
  const auto over_second = error_curves(group, &TrajectoryEvaluation::rpe_time),
             over_frame = error_curves(group, &TrajectoryEvaluation::rpe_frame);
  if (over_second.empty() && over_frame.empty())
    return "<p class=\"dim\">The sequence has no ground truth to measure errors against.</p>\n";
  std::string html;
  if (!over_second.empty())
    html += figure_html(plot_picture(painter, over_second, time_of(group), "RPE over 1 s"),
                        "Translational error of relative motion over one second, at the end of each");
  if (!over_frame.empty())
    html += figure_html(plot_picture(painter, over_frame, time_of(group), "RPE per frame"),
                        "Translational error of relative motion from one frame to the next");
  return html;
}

std::string trajectories(Painter& painter, const ReportGroup& group) {
  std::string html = "<div class=\"grid\">\n";
  for (const ReportRun& run : group.runs) {
    const auto session = session_of_report(group, run, false);
    session->go_to(run.report.frames - 1);
    html += figure_html(
        painter.paint_panel(*session->view(), "trajectory", kScenePanel),
        fmt::format("{}: estimate, map, ground truth and baseline where there are any", run.label));
  }
  return html + "</div>\n";
}

std::string worst_frame_panels(Painter& painter, const ReportGroup& group, const ReportRun& run, int count,
                               const std::string& link, const ReportProgress& progress) {
  const std::vector<WorstFrame> worst = worst_frames_of(run, count);
  if (worst.empty()) return {};
  const bool again = method_named(run.report.method).needs.keeps_state && run.opened.no_images.empty();
  const auto session = session_of_report(group, run, again);
  const double start = run.result().records.front().timestamp;
  std::string html = fmt::format("<h3>Worst frames of {}</h3>\n", escaped(run.label));
  if (count > 1)
    html += fmt::format("<p class=\"dim\">Each is {} frames or more from a worse one.</p>\n", kWorstApart);
  for (const WorstFrame& frame : worst) {
    session->go_to(frame.index, [&](const FrameRecord&) {
      progress(fmt::format("{} ({}): stages of frame {}", group.sequence, run.label, frame.index));
    });
    const auto view = session->view();
    std::string name = fmt::format("<strong>Frame {}</strong>", frame.index);
    if (!link.empty())
      name =
          fmt::format("<a href=\"{}\">{}</a>", escaped(fmt::format(fmt::runtime(link), frame.index)), name);
    html += fmt::format("<p id=\"{}\">{}, {:.2f} s: {}.</p>\n<div class=\"grid\">\n",
                        frame_anchor(group, run, frame.index), name, view->current->frame.timestamp - start,
                        escaped(frame.why));
    for (const auto& [panel, caption] : panels_of(run, *view->current))
      html += figure_html(painter.paint_panel(*view, panel, kFramePanel), caption, Packing::kSmall);
    html += "</div>\n";
  }
  return html;
}

}  // namespace stillpoint
