#pragma once

#include <filesystem>
#include <string>

#include "core/run/cell_plan.hpp"

namespace stillpoint {

/// What a command does with its cells; everything else about plans is the same for all.
struct CellKind {
  const char* name;  ///< CellPlan::kind
  /// Runs one cell in this process. @returns CellResult::json
  /// @throws InputError where its sequence is not there, or not what it was; Interrupted
  std::string (*run)(const CellPlan& plan, const PlanCell& cell, const std::filesystem::path& folder);
  /// Writes the tables. @returns what is printed
  std::string (*tables)(const CellPlan& plan, const MergedCells& merged, const std::filesystem::path& folder);
};

[[nodiscard]] const CellKind& benchmark_cells();
[[nodiscard]] const CellKind& ablation_cells();

}  // namespace stillpoint
