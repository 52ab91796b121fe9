#include "app/report/report_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "app/report/html.hpp"
#include "app/report/report_pictures.hpp"
#include "core/config.hpp"
#include "core/motion/methods.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {
namespace {

std::string text_of(const std::optional<double>& value, double factor, int digits) {
  return value ? fmt::format("{:.{}f}", factor * *value, digits) : "–";
}

std::optional<double> rmse_of(const ErrorStatistics& statistics) {
  return statistics.count > 0 ? std::optional(statistics.rmse) : std::nullopt;
}

/// The figures of a run that a table compares; nothing where there are none.
struct RunFigures {
  std::optional<double> rpe_m, rpe_deg, ate_m, rpe_frame_m, precision, recall, median_ms, p99_ms;
};

RunFigures figures_of(const RunReport& report) {
  RunFigures figures;
  if (report.evaluation && !report.evaluation->matched.empty()) {
    const TrajectoryEvaluation& e = *report.evaluation;
    figures.rpe_m = rmse_of(e.rpe_time.translation_m);
    figures.rpe_deg = rmse_of(e.rpe_time.rotation_deg);
    figures.ate_m = rmse_of(e.ate.translation_m);
    figures.rpe_frame_m = rmse_of(e.rpe_frame.translation_m);
  }
  if (report.scores.known && !method_named(report.method).baseline) {
    figures.precision = report.scores.mask.precision();
    figures.recall = report.scores.mask.recall();
  }
  if (report.measured.times) {
    figures.median_ms = report.speed.median_ms;
    figures.p99_ms = report.speed.p99_ms;
  }
  return figures;
}

/// The least of a figure over the runs that were not told what is dynamic; nothing with fewer than two of
/// them.
std::optional<double> least(const ReportGroup& group, std::optional<double> RunFigures::*figure) {
  std::optional<double> best;
  int known = 0;
  for (const ReportRun& run : group.runs) {
    const auto value = figures_of(run.report).*figure;
    if (!value || method_named(run.report.method).reference) continue;
    ++known;
    if (!best || *value < *best) best = value;
  }
  return known > 1 ? best : std::nullopt;
}

std::string gain_text(const ReportRun& run, const ReportRun* baseline) {
  if (baseline == nullptr || baseline == &run) return "–";
  const auto before = figures_of(baseline->report).rpe_m, after = figures_of(run.report).rpe_m;
  if (!before || !after || *before <= 0.0) return "–";
  const double gain = std::round(100.0 * (1.0 - *after / *before));
  return fmt::format("{:.0f} %", gain == 0.0 ? 0.0 : gain);  // none is not "-0 %"
}

std::string hex_of(Rgb colour) { return fmt::format("#{:02x}{:02x}{:02x}", colour.r, colour.g, colour.b); }

struct TimedStage {
  const char* name;
  double StageTimes::*ms;
  Rgb colour;
};

constexpr std::array<TimedStage, 6> kStages{
    {{"Motion", &StageTimes::motion, okabe_ito::kPurple},
     {"Features", &StageTimes::features, okabe_ito::kSkyBlue},
     {"Matching", &StageTimes::matching, okabe_ito::kGreen},
     {"Pose", &StageTimes::pose, okabe_ito::kBlue},
     {"Mapping", &StageTimes::mapping, okabe_ito::kOrange},
     {"Bundle adjustment", &StageTimes::bundle, okabe_ito::kVermillion}}};

double sum_of(const StageTimes& ms) {
  double sum = 0.0;
  for (const TimedStage& stage : kStages) sum += ms.*stage.ms;
  return sum;
}

std::string value_text(const Parameter& parameter) {
  if (const auto* flag = std::get_if<bool*>(&parameter.value)) return **flag ? "true" : "false";
  if (const auto* number = std::get_if<int*>(&parameter.value)) return fmt::format("{}", **number);
  if (const auto* number = std::get_if<double*>(&parameter.value)) return fmt::format("{:g}", **number);
  return *std::get<std::string*>(parameter.value);
}

/// The worst frame's number, which leads to it where it is shown.
HtmlCell worst_cell(const ReportGroup& group, const ReportRun& run, int shown) {
  const std::vector<WorstFrame> worst = worst_frames_of(run, 1);
  if (worst.empty()) return {"–", true};
  HtmlCell cell{fmt::format("{}", worst.front().index), true};
  if (shown > 0) cell.link = frame_anchor(group, run, worst.front().index);
  return cell;
}

}  // namespace

std::string introduction(const std::vector<ReportGroup>& groups) {
  std::size_t runs = 0;
  for (const ReportGroup& group : groups) runs += group.runs.size();
  std::string html = fmt::format(
      "<h1>Odometry runs compared</h1>\n<p class=\"dim\">{} run{} of {} sequence{}, by Stillpoint.</p>\n",
      runs, runs == 1 ? "" : "s", groups.size(), groups.size() == 1 ? "" : "s");
  html += "<nav>";
  for (std::size_t i = 0; i < groups.size(); ++i)
    html += fmt::format("<a href=\"#sequence{}\">{}</a>", i + 1, escaped(groups[i].sequence));
  html += "<a href=\"#configuration\">Configuration</a><a href=\"#made\">What this is of</a></nav>\n";
  html +=
      "<p>RPE is the error of relative motion over one second, or from one frame to the next; ATE that of "
      "positions after the best rigid alignment. Both are RMSE, and less is better. Gain is the share of the "
      "RPE over one second that a run takes away from the one with nothing removed (none). A mask's "
      "precision "
      "is the share of it that is truly dynamic, its recall the share of what is dynamic that it holds. "
      "oracle is told "
      "the true masks: a reference, not a method. ✓ marks the least error and time among the others.</p>\n";
  return html;
}

std::string summary_table(const ReportGroup& group, int worst) {
  const auto best_rpe = least(group, &RunFigures::rpe_m), best_deg = least(group, &RunFigures::rpe_deg),
             best_ate = least(group, &RunFigures::ate_m), best_frame = least(group, &RunFigures::rpe_frame_m),
             best_ms = least(group, &RunFigures::median_ms);
  std::vector<std::vector<HtmlCell>> rows;
  for (const ReportRun& run : group.runs) {
    const RunReport& r = run.report;
    const RunFigures f = figures_of(r);
    const auto cell = [&r](const std::optional<double>& value, double factor, int digits,
                           const std::optional<double>& best) {
      return HtmlCell{text_of(value, factor, digits), true,
                      value && best && *value == *best && !method_named(r.method).reference};
    };
    const auto plain = [](std::string text) { return HtmlCell{std::move(text), true, false}; };
    const bool masks = r.scores.known && !method_named(r.method).baseline;
    rows.push_back(
        {{run.label},
         plain(fmt::format("{:.1f} % of {}", 100.0 * r.coverage, r.frames)),
         cell(f.rpe_m, 1000.0, 1, best_rpe),
         plain(gain_text(run, group.baseline())),
         cell(f.rpe_deg, 1.0, 3, best_deg),
         cell(f.ate_m, 1000.0, 1, best_ate),
         cell(f.rpe_frame_m, 1000.0, 2, best_frame),
         plain(masks ? fmt::format("{} / {}", text_of(f.precision, 100.0, 1), text_of(f.recall, 100.0, 1))
                     : "–"),
         plain(masks && r.measured.features ? fmt::format("{} / {}", r.scores.removal.removed_rightly,
                                                          r.scores.removal.removed_wrongly)
                                            : "–"),
         cell(f.median_ms, 1.0, 1, best_ms),
         plain(text_of(f.p99_ms, 1.0, 1)),
         worst_cell(group, run, worst)});
  }
  std::string html =
      table_html({"Run", "Tracked", "RPE 1 s, mm", "Gain", "RPE 1 s, °", "ATE, mm", "RPE frame, mm",
                  "Mask precision / recall, %", "Features removed rightly / wrongly", "Median, ms",
                  "99th, ms", "Worst frame"},
                 rows);
  for (const ReportRun& run : group.runs)
    if (run.result().interrupted)
      html += fmt::format("<p class=\"warning\">{} was stopped after {} of {} frames.</p>\n",
                          escaped(run.label), run.report.frames, run.result().frames_in_sequence);
  for (const ReportRun& run : group.runs)
    if (!run.report.doubt.empty())
      html += fmt::format("<p class=\"warning\">{}: {}</p>\n", escaped(run.label), escaped(run.report.doubt));
  for (const std::string& warning : group.warnings)
    html += fmt::format("<p class=\"warning\">{}</p>\n", escaped(warning));
  return html;
}

std::string stage_timings(const ReportGroup& group) {
  double widest = 1e-9;
  for (const ReportRun& run : group.runs) widest = std::max(widest, sum_of(run.report.speed.mean));
  std::string html = "<p class=\"dim\">Mean milliseconds a frame, decoding excluded.";
  if (std::any_of(group.runs.begin(), group.runs.end(), [](const ReportRun& run) {
        return sum_of(run.report.speed.mean) > run.report.speed.mean.total;
      }))
    html += " Stages that go on beside each other add up to more than the frame takes.";
  html += "</p>\n<p>";
  for (const TimedStage& stage : kStages)
    html += fmt::format("<span class=\"key\" style=\"background:{}\"></span>{}", hex_of(stage.colour),
                        stage.name);
  html += "</p>\n<div class=\"scroll\"><table><thead><tr><th>Run</th><th>Stages</th>";
  for (const TimedStage& stage : kStages) html += fmt::format("<th>{}</th>", stage.name);
  html += "<th>Frame, mean</th></tr></thead><tbody>\n";
  for (const ReportRun& run : group.runs) {
    if (!run.report.measured.times) continue;
    const StageTimes& ms = run.report.speed.mean;
    html += fmt::format("<tr><td>{}</td><td style=\"width:36%\"><div class=\"bar\">", escaped(run.label));
    for (const TimedStage& stage : kStages)
      html += fmt::format("<span style=\"width:{:.2f}%;background:{}\"></span>",
                          100.0 * (ms.*stage.ms) / widest, hex_of(stage.colour));
    html += "</div></td>";
    for (const TimedStage& stage : kStages)
      html += fmt::format("<td class=\"number\">{:.2f}</td>", ms.*stage.ms);
    html += fmt::format("<td class=\"number\">{:.2f}</td></tr>\n", ms.total);
  }
  html += "</tbody></table></div>\n";
  for (const ReportRun& run : group.runs)
    if (!run.report.measured.times)
      html += fmt::format("<p class=\"dim\">{} left no times.</p>\n", escaped(run.label));
  for (const ReportRun& run : group.runs)
    if (const double stereo = run.report.speed.mean.stereo; stereo > 0)
      html +=
          fmt::format("<p class=\"dim\">{}: matching left to right took {:.2f} ms a frame beside that.</p>\n",
                      escaped(run.label), stereo);
  return html;
}

std::string configurations(const std::vector<ReportGroup>& groups) {
  struct Column {
    std::string name;
    Config config;
  };
  std::vector<Column> columns;
  for (const ReportGroup& group : groups)
    for (const ReportRun& run : group.runs)
      if (run.recorded().outside.empty())  // another program went by no configuration of ours
        columns.push_back({groups.size() > 1 ? fmt::format("{}: {}", group.sequence, run.label) : run.label,
                           run.result().config});
  Config defaults;
  const std::vector<Parameter> standard = parameters(defaults);
  std::vector<std::vector<HtmlCell>> rows;
  for (std::size_t i = 0; i < standard.size(); ++i) {
    const std::string unit = standard[i].unit.empty() ? "" : fmt::format(" [{}]", standard[i].unit);
    std::vector<HtmlCell> row = {{standard[i].key + unit}, {value_text(standard[i])}};
    bool differs = false;
    for (Column& column : columns) {
      const std::string value = value_text(parameters(column.config)[i]);
      row.push_back({value, false, false});
      differs = differs || value != row[1].text;
    }
    if (differs) rows.push_back(std::move(row));
  }
  if (columns.empty())
    return "<h2 id=\"configuration\">Configuration</h2>\n<p>None: these runs are other programs'.</p>\n";
  std::vector<std::string> header = {"Parameter", "Default"};
  for (const Column& column : columns) header.push_back(column.name);
  std::string html = "<h2 id=\"configuration\">Configuration</h2>\n";
  html += rows.empty() ? "<p>Every run has the default configuration.</p>\n"
                       : "<p>What differs from the defaults in any run:</p>\n" + table_html(header, rows);
  for (const Column& column : columns)
    html +=
        fmt::format("<details><summary>All of {}, as TOML</summary><pre><code>{}</code></pre></details>\n",
                    escaped(column.name), escaped(to_toml(column.config)));
  return html;
}

}  // namespace stillpoint
