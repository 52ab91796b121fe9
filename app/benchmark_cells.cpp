#include "app/benchmark_cells.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/benchmark_tables.hpp"
#include "app/cell_kinds.hpp"
#include "app/jobs.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/motion/methods.hpp"

namespace stillpoint {
namespace {

std::vector<BenchmarkResult> runs_of(const std::vector<CellResult>& cells) {
  std::vector<BenchmarkResult> runs;
  for (const CellResult& cell : cells) runs.push_back(result_from_json(cell.json, to_text(cell.cell)));
  return runs;
}

}  // namespace

std::vector<BenchmarkResult> earlier_runs(const std::filesystem::path& out, const std::string& config,
                                          bool& replaces) {
  if (const auto earlier = earlier_cells(out, benchmark_cells().name, config)) {
    replaces = earlier->plan.replaces && !earlier->merged.whole;
    return runs_of(earlier->merged.results);
  }
  replaces = std::filesystem::exists(out / kUnfinishedName);
  const std::filesystem::path path = out / (replaces ? kUnfinishedName : kResultsName);
  if (!std::filesystem::exists(path)) return {};
  const BenchmarkResults earlier = read_results(path.string());
  if (earlier.commit != made_here().commit)
    throw InputError(
        fmt::format("{}: was made by another build (commit {}), so that --resume cannot go on with "
                    "it; --force begins anew",
                    path.string(), earlier.commit));
  if (earlier.config != config)
    throw InputError(
        fmt::format("{}: was made with other parameters, so that --resume cannot go on with it; "
                    "--force begins anew",
                    path.string()));
  return earlier.runs;
}

std::string benchmark_cell_tables(const CellPlan& plan, const MergedCells& merged,
                                  const std::filesystem::path& folder) {
  BenchmarkResults results = made_here();
  if (!merged.machines.empty()) results.machine = fmt::format("{}", fmt::join(merged.machines, "; "));
  results.command = plan.command;
  results.config = plan.config;
  results.runs = runs_of(merged.results);
  results.missing = merged.missing;
  const BenchmarkColumns columns{plan.engines, plan.methods, plan.repeated, plan.cells.size()};
  if (merged.whole || !plan.replaces) {
    write_tables(results, columns, folder.string());
    std::filesystem::remove(folder / kUnfinishedName);
  }
  return tables_text(results, columns);
}

}  // namespace stillpoint
