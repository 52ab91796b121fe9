#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/benchmark_results.hpp"
#include "core/evaluation/tables.hpp"

namespace stillpoint {

// A figure that was measured several times: one number says nothing about two that lie close.

/// What several runs of the same thing reached.
struct Spread {
  std::vector<double> values;       ///< of the runs that gave one, in order of the runs
  int failed = 0;                   ///< runs that gave none: lost, or nothing to measure
  double median = 0.0;              ///< of values; 0 where there are none
  double lower = 0.0, upper = 0.0;  ///< quartiles
};

/// @param values one a run, nothing where a run gave none
[[nodiscard]] Spread spread_of(const std::vector<std::optional<double>>& values);

/// Which of several is the best, and which the second: smaller is better. Only where that survives the
/// spread: its upper quartile lies below the lower one of all that come after it, not a run of it failed, and
/// there were several: one run has no spread.
struct Ranking {
  std::optional<std::size_t> best, second;
};
[[nodiscard]] Ranking rank(const std::vector<Spread>& spreads);

/// What several methods reached on one sequence.
struct SpreadRow {
  std::string sequence;
  std::vector<Spread> cells;  ///< one a method
};

/// A table of spreads.
struct SpreadTable {
  std::vector<std::string>
      methods;  ///< of the columns: METHOD, or "ENGINE, METHOD" where there are several engines
  std::vector<SpreadRow> rows;
};

/// The RPE over 1 s of all runs of a benchmark, by sequence, engine and method. A run that lost half its
/// frames has no figure. @param engines, methods of the columns; another program's run stands once
[[nodiscard]] SpreadTable spread_of_runs(const BenchmarkResults& results,
                                         const std::vector<std::string>& engines,
                                         const std::vector<std::string>& methods);

/// How a table is written down.
enum class TableMarkup { markdown, latex, csv };

/// The rows in that markup: median and half the distance of the quartiles, best bold and second underlined
/// where Ranking names them; a failed run is counted beside. CSV has a row a sequence and method, with
/// quartiles and all values. LaTeX needs the package booktabs.
/// @param what the figure, for the head: "RPE 1 s, RMSE [m]"
[[nodiscard]] std::string spread_text(const std::vector<SpreadRow>& rows,
                                      const std::vector<std::string>& methods, const std::string& what,
                                      TableMarkup markup);

/// A list of {sequence, method, median, lower_quartile, upper_quartile, failed, values, figure, unit}: of the
/// RPE over 1 s in m.
[[nodiscard]] nlohmann::ordered_json spread_json(const std::vector<SpreadRow>& rows,
                                                 const std::vector<std::string>& methods);

}  // namespace stillpoint
