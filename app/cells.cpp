#include <fmt/format.h>

#include <memory>
#include <vector>

#include "app/cell_processes.hpp"
#include "app/commands.hpp"
#include "app/jobs.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct CellsArguments {
  std::string folder, plan;
  std::vector<int> only;
  int inside = -1, jobs = 1;
};

/// A task of a job array: its cells one after another. One that has a result is not run again, for the task
/// may have been requeued.
void run_task(const CellsArguments& arguments) {
  const fs::path folder = fs::absolute(arguments.folder);
  const CellPlan plan = plan_to_go_by(folder, arguments.plan);
  const std::string fingerprint = plan.fingerprint();
  std::vector<int> cells;
  for (const int cell : arguments.only) {
    if (cell < 0 || cell >= static_cast<int>(plan.cells.size()))
      throw InputError(fmt::format("{}: its plan has cells 0 to {}, and no {}", arguments.folder,
                                   static_cast<int>(plan.cells.size()) - 1, cell));
    const auto record = read_record(folder, plan, fingerprint, cell);
    if (!record || record->status != 0) cells.push_back(cell);
  }
  const int failed = run_cells(folder, plan, cells, arguments.jobs, true);
  throw_if_interrupted();
  if (failed > 0) throw ExitStatus{1};
}

}  // namespace

void add_cells_command(CLI::App& app) {
  const auto arguments = std::make_shared<CellsArguments>();
  CLI::App* command = app.add_subcommand(
      "cells",
      "Run some cells of a plan, as a task of `benchmark --slurm` does, each as a process of its own");
  command->add_option("FOLDER", arguments->folder, "The folder of --out, which holds the plan")->required();
  CLI::Option* only =
      command->add_option("--only", arguments->only, "Their rows in the plan, from 0, separated by commas")
          ->delimiter(',');
  command->add_option("--jobs", arguments->jobs, "So many at a time")->check(CLI::Range(1, 1024));
  CLI::Option* inside = command
                            ->add_option("--inside", arguments->inside,
                                         "Run this one alone, in this process, as under a debugger")
                            ->excludes(only);
  command->add_option("--plan", arguments->plan,
                      "The plan's fingerprint: where it has another, nothing is run");
  command->callback([arguments, only, inside] {
    if (inside->count() + only->count() == 0) throw CLI::RequiredError("--only or --inside");
    if (inside->count() > 0) return run_cell_here(arguments->folder, arguments->inside, arguments->plan);
    run_task(*arguments);
  });
}

void add_merge_command(CLI::App& app) {
  struct MergeArguments {
    std::string folder, plan;
  };
  const auto arguments = std::make_shared<MergeArguments>();
  CLI::App* command = app.add_subcommand(
      "merge",
      "Make the tables of a benchmark or ablation that ran as jobs, and name the runs that are missing");
  command->add_option("FOLDER", arguments->folder, "The folder of --out, which holds the plan")->required();
  command->add_option("--plan", arguments->plan,
                      "The plan's fingerprint: where it has another, nothing is merged");
  command->callback([arguments] {
    (void)plan_to_go_by(arguments->folder, arguments->plan);
    merge_and_tell(arguments->folder);
  });
}

}  // namespace stillpoint
