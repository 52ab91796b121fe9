#pragma once

#include <filesystem>
#include <vector>

#include "core/run/cell_plan.hpp"

namespace stillpoint {

/// Runs cells of a plan, so many at a time, each as a process of its own, which leaves its record and its log
/// in the plan's folder: one that fails, crashes or is killed fails by itself, and its record says so. A line
/// for each that has ended goes to standard error. Ends when all have, or, asked to stop, when all have
/// stopped.
/// @param keeps_stopped whether a cell that is stopped has failed, as where Slurm's time is over; otherwise
/// it leaves no record, as where a person stops all
/// @returns how many failed
/// @throws InputError where a process cannot be started or a record cannot be written
int run_cells(const std::filesystem::path& folder, const CellPlan& plan, const std::vector<int>& cells,
              int jobs, bool keeps_stopped = false);

/// Runs one cell in this process, and writes its record.
/// @param fingerprint as plan_to_go_by has it
/// @throws InputError, Interrupted
void run_cell_here(const std::filesystem::path& folder, int cell, const std::string& fingerprint);

/// The plan in a folder, as a cell or a merge is to go by it.
/// @param fingerprint of the plan that is meant; empty = whichever is there
/// @throws InputError where it is another one, or made by another build
[[nodiscard]] CellPlan plan_to_go_by(const std::filesystem::path& folder,
                                     const std::string& fingerprint = {});

}  // namespace stillpoint
