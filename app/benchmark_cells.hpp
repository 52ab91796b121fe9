#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/evaluation/benchmark_results.hpp"
#include "core/run/cell_plan.hpp"

namespace stillpoint {

// What a benchmark's folder holds between its first run and its last: of one process, or of jobs.

/// Results that are to take the place of earlier ones, until they are whole.
inline constexpr const char* kUnfinishedName = "results.new.json";

/// What an earlier benchmark left in the folder, to be gone on with.
/// @param config shared_config of the runs that are asked for
/// @param replaces whether it was to take the place of still earlier results, which stay so long
/// @throws InputError where its runs are not what these would be
[[nodiscard]] std::vector<BenchmarkResult> earlier_runs(const std::filesystem::path& out,
                                                        const std::string& config, bool& replaces);

/// CellKind::tables of a benchmark.
[[nodiscard]] std::string benchmark_cell_tables(const CellPlan& plan, const MergedCells& merged,
                                                const std::filesystem::path& folder);

}  // namespace stillpoint
