#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/run/cell_plan.hpp"

namespace stillpoint {

/// What a job of Slurm asks for.
struct SlurmOptions {
  std::string mem = "4G";           ///< of a cell, as sbatch takes it
  std::string time = "4:00:00";     ///< of a cell, as sbatch takes it
  std::vector<std::string> others;  ///< further options of sbatch, `--partition=long`
};

/// Minutes of a time as Slurm writes it: M, M:S, H:M:S, D-H, D-H:M, D-H:M:S; rounded up.
/// @throws InputError where it is none
[[nodiscard]] int slurm_minutes(const std::string& time);

/// Asked before anything is written.
/// @throws InputError where there is no Slurm with job arrays, or its scripts cannot name the folder
void throw_if_no_jobs(const std::filesystem::path& folder);

/// Submits cells of a plan as a job array and, after it, a job that merges. As many cells go one after
/// another into a task as MaxArraySize asks for. Scripts, the list of tasks, the jobs' numbers and their logs
/// are kept in the plan's folder, below `jobs`. What was submitted is printed.
/// @throws InputError where there is no Slurm, or it refuses
void submit_cells(const std::filesystem::path& folder, const CellPlan& plan, const std::vector<int>& cells,
                  const SlurmOptions& options);

/// @throws InputError where jobs that were submitted for a folder are still queued or running
void throw_if_queued(const std::filesystem::path& folder);

}  // namespace stillpoint
