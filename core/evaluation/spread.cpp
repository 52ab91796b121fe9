#include "core/evaluation/spread.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {
namespace {

/// "0.0143 ± 0.0008", marked.
std::string cell_text(const Spread& spread, bool best, bool second, TableMarkup markup) {
  const bool latex = markup == TableMarkup::latex;
  if (spread.values.empty()) return latex ? "--" : kNoFigure;
  const double half = 0.5 * (spread.upper - spread.lower);
  std::string text = latex ? fmt::format("{:.4f} $\\pm$ {:.4f}", spread.median, half)
                           : fmt::format("{:.4f} ± {:.4f}", spread.median, half);
  if (best) text = latex ? fmt::format("\\textbf{{{}}}", text) : fmt::format("**{}**", text);
  if (second) text = latex ? fmt::format("\\underline{{{}}}", text) : fmt::format("_{}_", text);
  if (spread.failed > 0) text += fmt::format(" ({} failed)", spread.failed);
  return text;
}

Table table_of(const std::vector<SpreadRow>& rows, const std::vector<std::string>& methods,
               const std::string& what, TableMarkup markup) {
  Table table;
  table.header = {what};
  table.header.insert(table.header.end(), methods.begin(), methods.end());
  for (const SpreadRow& row : rows) {
    const Ranking ranking = rank(row.cells);
    std::vector<std::string> cells = {row.sequence};
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      cells.push_back(cell_text(row.cells[i], ranking.best == i, ranking.second == i, markup));
    cells.resize(table.header.size(), kNoFigure);
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::string escaped_for_latex(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("_%&#").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::string latex_text(Table table) {
  for (std::string& head : table.header) head = escaped_for_latex(head);
  std::string text = fmt::format("\\begin{{tabular}}{{l{}}}\n\\toprule\n{} \\\\\n\\midrule\n",
                                 std::string(table.header.size() - 1, 'r'), fmt::join(table.header, " & "));
  for (auto& row : table.rows) {
    row.front() = escaped_for_latex(row.front());
    text += fmt::format("{} \\\\\n", fmt::join(row, " & "));
  }
  return text + "\\bottomrule\n\\end{tabular}\n";
}

std::string csv_text(const std::vector<SpreadRow>& rows, const std::vector<std::string>& methods) {
  Table table;
  table.header = {"sequence",       "method", "median", "lower_quartile",
                  "upper_quartile", "runs",   "failed", "values"};
  for (const SpreadRow& row : rows)
    for (std::size_t i = 0; i < row.cells.size() && i < methods.size(); ++i) {
      const Spread& s = row.cells[i];
      const auto figure = [&s](double value) {
        return s.values.empty() ? std::string() : fmt::format("{:.6f}", value);
      };
      std::string values;
      for (const double value : s.values) values += fmt::format("{}{:.6f}", values.empty() ? "" : " ", value);
      table.rows.push_back({row.sequence, methods[i], figure(s.median), figure(s.lower), figure(s.upper),
                            std::to_string(s.values.size() + static_cast<std::size_t>(s.failed)),
                            std::to_string(s.failed), values});
    }
  return to_csv(table);
}

}  // namespace

Spread spread_of(const std::vector<std::optional<double>>& values) {
  Spread spread;
  for (const auto& value : values) {
    if (value)
      spread.values.push_back(*value);
    else
      ++spread.failed;
  }
  const ErrorStatistics statistics = statistics_of(spread.values);
  spread.median = statistics.median;
  spread.lower = statistics.lower_quartile, spread.upper = statistics.upper_quartile;
  return spread;
}

Ranking rank(const std::vector<Spread>& spreads) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < spreads.size(); ++i)
    if (!spreads[i].values.empty()) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return spreads[a].median < spreads[b].median; });
  const auto stands_out = [&](std::size_t place) {
    if (place + 1 >= order.size()) return false;
    const Spread& one = spreads[order[place]];
    if (one.failed > 0 || one.values.size() < 2) return false;
    return std::all_of(order.begin() + static_cast<std::ptrdiff_t>(place) + 1, order.end(),
                       [&](std::size_t other) { return one.upper < spreads[other].lower; });
  };
  Ranking ranking;
  if (stands_out(0)) ranking.best = order[0];
  if (ranking.best && stands_out(1)) ranking.second = order[1];
  return ranking;
}

SpreadTable spread_of_runs(const BenchmarkResults& results, const std::vector<std::string>& engines,
                           const std::vector<std::string>& methods) {
  struct Column {
    std::string engine, method;
  };
  std::vector<Column> columns;
  SpreadTable table;
  const auto is_outside = [&results](const std::string& method) {
    return std::any_of(results.runs.begin(), results.runs.end(), [&method](const BenchmarkResult& r) {
      return r.method == method && r.odometry == kItsOwnOdometry;
    });
  };
  for (const std::string& engine : engines)
    for (const std::string& method : methods) {
      const bool outside = is_outside(method);
      if (outside && engine != engines.front()) continue;
      columns.push_back({outside ? kItsOwnOdometry : engine, method});
      table.methods.push_back(engines.size() > 1 && !outside ? engine + ", " + method : method);
    }
  for (const std::string& sequence : results.sequences()) {
    SpreadRow row{sequence, {}};
    for (const Column& column : columns) {
      std::vector<std::optional<double>> values;
      for (const BenchmarkResult& r : results.runs)
        if (r.sequence == sequence && r.odometry == column.engine && r.method == column.method)
          values.push_back(r.coverage < kLostCoverage ? std::nullopt : r.rpe_m);
      row.cells.push_back(spread_of(values));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string spread_text(const std::vector<SpreadRow>& rows, const std::vector<std::string>& methods,
                        const std::string& what, TableMarkup markup) {
  switch (markup) {
    case TableMarkup::latex:
      return latex_text(table_of(rows, methods, what, markup));
    case TableMarkup::csv:
      return csv_text(rows, methods);
    case TableMarkup::markdown:
      break;
  }
  return to_markdown(table_of(rows, methods, what, markup));
}

nlohmann::ordered_json spread_json(const std::vector<SpreadRow>& rows,
                                   const std::vector<std::string>& methods) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const SpreadRow& row : rows)
    for (std::size_t i = 0; i < row.cells.size() && i < methods.size(); ++i) {
      const Spread& s = row.cells[i];
      const auto figure = [&s](double value) {
        return s.values.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(value);
      };
      all.push_back({{"sequence", row.sequence},
                     {"method", methods[i]},
                     {"median", figure(s.median)},
                     {"lower_quartile", figure(s.lower)},
                     {"upper_quartile", figure(s.upper)},
                     {"failed", s.failed},
                     {"values", s.values},
                     {"figure", "RPE 1 s, RMSE"},
                     {"unit", "m"}});
    }
  return all;
}

}  // namespace stillpoint
