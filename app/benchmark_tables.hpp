#pragma once

#include <string>
#include <vector>

#include "core/evaluation/benchmark_results.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {

inline constexpr const char* kResultsName = "results.json";

/// What a benchmark's tables have as columns.
struct BenchmarkColumns {
  std::vector<std::string> engines;
  std::vector<std::string> methods;  ///< and after them other programs' runs
  bool repeated = false;             ///< each was run several times
  std::size_t asked = 0;             ///< runs, where they were made as jobs
};

/// What a run reached. @param judges whether it says what is dynamic, so that its masks can be scored
[[nodiscard]] BenchmarkResult result_of(const RunReport& report, bool judges);

/// What is printed at the end: Table 1 once an engine and all other figures, or median and spread.
[[nodiscard]] std::string tables_text(const BenchmarkResults& results, const BenchmarkColumns& columns);

/// Writes results.json and the tables made of it: Table 1 and details as Markdown and CSV, and where runs
/// were repeated `repeats` as Markdown, CSV, JSON and LaTeX.
/// @throws InputError where they cannot be written
void write_tables(const BenchmarkResults& results, const BenchmarkColumns& columns,
                  const std::string& folder);

}  // namespace stillpoint
