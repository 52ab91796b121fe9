#include "app/benchmark_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/evaluation/spread.hpp"
#include "core/motion/methods.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

/// Table 1 once an engine: gains are over the baseline behind the same one.
std::string table_one_text(const BenchmarkResults& results, const BenchmarkColumns& columns) {
  std::string text;
  for (const std::string& engine : columns.engines) {
    if (columns.engines.size() > 1)
      text += fmt::format("{}Odometry {}\n\n", text.empty() ? "" : "\n", engine);
    text += to_markdown(table_one(results, engine, columns.methods, baseline_method().name));
  }
  return text;
}

/// What is to be known beside the figures, and which runs are missing, where there is anything.
std::string after_tables(const BenchmarkResults& results, const BenchmarkColumns& columns) {
  std::string text;
  for (const std::string& part : {published_notes(results.sequences()) + notes_text(notes_on(results)),
                                  missing_text(results.missing, columns.asked)})
    if (!part.empty()) text += "\n" + part;
  return text;
}

/// Another program's run has none, whatever it is called.
bool has_partial_mask(const std::string& method) {
  return std::any_of(methods().begin(), methods().end(), [&method](const MethodInfo& info) {
    return info.name == method && !info.partial_mask.empty();
  });
}

}  // namespace

BenchmarkResult result_of(const RunReport& report, bool judges) {
  BenchmarkResult result;
  result.sequence = report.sequence;
  result.odometry = report.odometry;
  result.method = report.method;
  result.frames = report.frames;
  result.coverage = report.coverage;
  if (const auto& e = report.evaluation) {
    if (e->ate.translation_m.count > 0) result.ate_m = e->ate.translation_m.rmse;
    if (e->rpe_time.translation_m.count > 0) {
      result.pairs = e->rpe_time.translation_m.count;
      result.rpe_m = e->rpe_time.translation_m.rmse;
      result.rpe_deg = e->rpe_time.rotation_deg.rmse;
    }
    if (e->rpe_frame.translation_m.count > 0) result.rpe_frame_m = e->rpe_frame.translation_m.rmse;
  }
  if (report.scores.known && judges) {
    result.precision = report.scores.mask.precision();
    result.recall = report.scores.mask.recall();
    result.iou = report.scores.mask.iou();
    if (has_partial_mask(report.method)) result.partial_recall = report.scores.partial_mask.recall();
    if (report.measured.features) {
      result.right = report.scores.removal.removed_rightly;
      result.wrong = report.scores.removal.removed_wrongly;
    }
  }
  result.median_ms = report.speed.median_ms;
  result.p99_ms = report.speed.p99_ms;
  result.units = report.speed.units;
  result.hash = report.hash;
  result.why_no_rpe = why_no_rpe(report);
  result.doubt = report.doubt;
  return result;
}

std::string tables_text(const BenchmarkResults& results, const BenchmarkColumns& columns) {
  const std::string after = after_tables(results, columns);
  if (!columns.repeated)
    return fmt::format(
        "Translational RPE over 1 s, RMSE in m (published columns: Niu & Li 2019, Table 1)\n\n{}\n{}\n{}{}",
        table_one_text(results, columns), to_markdown(details_table(results)), details_legend(), after);
  const SpreadTable table = spread_of_runs(results, columns.engines, columns.methods);
  return fmt::format(
      "Translational RPE over 1 s, RMSE in m: median of several runs and half the distance of their "
      "quartiles;\n"
      "runs differ by a few features, the seed and the first frame. Best and second are marked only where "
      "the\n"
      "quartiles do not overlap.\n\n{}{}",
      spread_text(table.rows, table.methods, "RPE 1 s, RMSE [m]", TableMarkup::markdown), after);
}

void write_tables(const BenchmarkResults& results, const BenchmarkColumns& columns, const std::string& to) {
  const std::filesystem::path folder = to;
  write_text_file(folder / kResultsName, to_json(results).dump(2) + "\n");
  write_text_file(folder / "table1.md", table_one_text(results, columns) + after_tables(results, columns));
  for (const std::string& engine : columns.engines)
    write_text_file(
        folder / (engine == columns.engines.front() ? "table1.csv" : fmt::format("table1_{}.csv", engine)),
        to_csv(table_one(results, engine, columns.methods, baseline_method().name)));
  write_text_file(folder / "details.md", to_markdown(details_table(results)) + "\n" + details_legend() +
                                             after_tables(results, columns));
  write_text_file(folder / "details.csv", to_csv(details_table(results)));
  if (!columns.repeated) return;
  const SpreadTable table = spread_of_runs(results, columns.engines, columns.methods);
  const auto text = [&table](TableMarkup markup) {
    return spread_text(table.rows, table.methods, "RPE 1 s, RMSE [m]", markup);
  };
  write_text_file(folder / "repeats.md", text(TableMarkup::markdown) + after_tables(results, columns));
  write_text_file(folder / "repeats.csv", text(TableMarkup::csv));
  write_text_file(folder / "repeats.tex", text(TableMarkup::latex));
  write_text_file(folder / "repeats.json", spread_json(table.rows, table.methods).dump(2) + "\n");
}

}  // namespace stillpoint
