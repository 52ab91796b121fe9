#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/cell_kinds.hpp"
#include "app/slurm.hpp"
#include "core/config.hpp"
#include "core/run/cell_plan.hpp"

namespace stillpoint {

/// The options of commands whose runs can be made as jobs.
struct JobArguments {
  int jobs = 0;  ///< so many processes at a time; 0 = all runs in this one
  bool slurm = false;
  SlurmOptions options;

  /// @param command has --out already
  void add_to(CLI::App& command);
  [[nodiscard]] bool given() const { return jobs > 0 || slurm; }
};

/// Of an earlier plan in a folder: what is to be gone on with.
struct EarlierCells {
  CellPlan plan;
  MergedCells merged;
};

/// Nothing where the folder holds no plan.
/// @throws InputError where it is not of this kind, this build or these settings
[[nodiscard]] std::optional<EarlierCells> earlier_cells(const std::filesystem::path& folder,
                                                        const std::string& kind, const std::string& config);

/// The config that all of a benchmark's or an ablation's runs share, as TOML.
[[nodiscard]] std::string shared_config(Config config);

/// An empty plan of this build, with the command that was typed.
[[nodiscard]] CellPlan plan_made_here(const std::string& kind, const std::string& config);

/// Adds a sequence.
/// @param where as it was named
/// @param name,reading,runs as PlannedSequence has them
const PlannedSequence& add_sequence(CellPlan& plan, const std::string& name, const std::string& where,
                                    std::vector<std::string> reading, const std::string& runs = {});

/// Writes the plan and has its missing cells run, by processes here or by Slurm; then, or by a job, merges.
/// @param anew what an earlier run of the same plan reached is run again, as --force says
/// @throws InputError, Interrupted, ExitStatus
void run_by_cells(const JobArguments& arguments, const CellPlan& plan, const std::filesystem::path& folder,
                  bool anew);

/// Merges a plan's cells, prints and writes the tables. Where earlier results are to be replaced, they stay
/// as long as not every cell has ended.
/// @throws InputError; ExitStatus 1 where a cell has no result
void merge_and_tell(const std::filesystem::path& folder);

/// The kind of that name.
/// @throws InputError where there is none
[[nodiscard]] const CellKind& cell_kind(const std::string& name);

}  // namespace stillpoint
