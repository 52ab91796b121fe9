#include "app/jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "app/cell_processes.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// "4G", "800M", "4096" (MB); 0 would be all of a node's.
std::string why_no_memory(const std::string& text) {
  const std::size_t digits = text.find_first_not_of("0123456789");
  const std::string unit = digits == std::string::npos ? "" : text.substr(digits);
  const bool good = digits != 0 && !text.empty() && text[0] != '0' &&
                    (unit.empty() || unit == "K" || unit == "M" || unit == "G" || unit == "T");
  return good ? "" : "expected a number with K, M, G or T, as sbatch takes it, and not 0";
}

std::string why_no_time(const std::string& text) {
  try {
    (void)slurm_minutes(text);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

void JobArguments::add_to(CLI::App& command) {
  CLI::Option* processes =
      command
          .add_option(
              "--jobs", jobs,
              "Make the runs as processes of their own, so many at a time: one that crashes fails by itself")
          ->check(CLI::Range(1, 1024))
          ->needs("--out");
  CLI::Option* by_slurm = command
                              .add_flag("--slurm", slurm,
                                        "Submit the runs to this Slurm cluster as a job array, a task a run, "
                                        "and a job that merges them")
                              ->needs("--out")
                              ->excludes(processes);
  command.add_option("--mem", options.mem, "Of --slurm: memory of a run")
      ->check(CLI::Validator(why_no_memory, ""))
      ->needs(by_slurm)
      ->capture_default_str();
  command
      .add_option("--time", options.time,
                  "Of --slurm: the longest that a run may take, as D-H:M:S, H:M:S or minutes")
      ->check(CLI::Validator(why_no_time, ""))
      ->needs(by_slurm)
      ->capture_default_str();
  command
      .add_option("--sbatch", options.others,
                  "Of --slurm: a further option of sbatch, as --sbatch=--partition=long; may be given again")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return text.starts_with("--") && text.find('\n') == std::string::npos
                       ? std::string()
                       : "expected an option of sbatch, as --sbatch=--partition=long";
          },
          ""))
      ->needs(by_slurm);
}

std::optional<EarlierCells> earlier_cells(const fs::path& folder, const std::string& kind,
                                          const std::string& config) {
  if (std::error_code none; !fs::exists(folder / kPlanName, none)) return std::nullopt;
  EarlierCells earlier{read_plan(folder), {}};
  throw_if_other_build(earlier.plan, made_here().commit, folder.string());
  if (earlier.plan.kind != kind)
    throw InputError(fmt::format("{}: its {} is of `{}`, so that `{} --resume` cannot go on with it",
                                 folder.string(), kPlanName, earlier.plan.kind, kind));
  if (earlier.plan.config != config)
    throw InputError(
        fmt::format("{}: its {} was made with other parameters, so that --resume cannot go on with it; "
                    "--force begins anew",
                    folder.string(), kPlanName));
  earlier.merged = merge_cells(earlier.plan, read_records(folder, earlier.plan));
  return earlier;
}

std::string shared_config(Config config) {
  config.run.method = RunConfig().method;
  config.run.odometry = RunConfig().odometry;
  return to_toml(config);
}

CellPlan plan_made_here(const std::string& kind, const std::string& config) {
  const BenchmarkResults here = made_here();
  CellPlan plan;
  plan.kind = kind;
  plan.version = here.version;
  plan.commit = here.commit;
  plan.command = here.command;
  plan.config = config;
  return plan;
}

const PlannedSequence& add_sequence(CellPlan& plan, const std::string& name, const std::string& where,
                                    std::vector<std::string> reading, const std::string& runs) {
  std::error_code none;
  const std::string place = fs::exists(where, none) ? fs::absolute(where).lexically_normal().string() : where;
  return plan.sequences.emplace_back(PlannedSequence{name, place, runs, std::move(reading)});
}

namespace {

/// What is known was read as it would be now.
void throw_if_read_otherwise(const CellPlan& plan, const fs::path& folder) {
  if (std::error_code none; plan.known.empty() || !fs::exists(folder / kPlanName, none)) return;
  for (const PlannedSequence& earlier : read_plan(folder).sequences)
    for (const PlannedSequence& now : plan.sequences)
      if (now.name == earlier.name && !(now == earlier))
        throw InputError(
            fmt::format("{}: its {} has {} at another place or read otherwise, so that --resume cannot go on "
                        "with it; --force begins anew",
                        folder.string(), kPlanName, now.name));
}

}  // namespace

void run_by_cells(const JobArguments& arguments, const CellPlan& plan, const fs::path& where, bool anew) {
  const fs::path folder = fs::absolute(where).lexically_normal();
  throw_if_queued(folder);
  if (arguments.slurm) throw_if_no_jobs(folder);
  if (anew) remove_plan(folder);
  throw_if_read_otherwise(plan, folder);
  write_plan(folder, plan);
  const std::vector<int> missing = missing_cells(plan, read_records(folder, plan));
  if (arguments.slurm && !missing.empty()) return submit_cells(folder, plan, missing, arguments.options);
  run_cells(folder, plan, missing, arguments.jobs);
  if (!stop_requested()) return merge_and_tell(folder);
  try {
    merge_and_tell(folder);
  } catch (const ExitStatus&) {  // told; that it was stopped says more
  }
  throw_if_interrupted("stopped early; --resume goes on");
}

void merge_and_tell(const fs::path& folder) {
  const CellPlan plan = plan_to_go_by(folder);
  const MergedCells merged = merge_cells(plan, read_records(folder, plan));
  fmt::print("{}", cell_kind(plan.kind).tables(plan, merged, folder));
  if (!merged.whole && plan.replaces) fmt::print("\nthe earlier tables stay until all runs have ended\n");
  if (!merged.missing.empty()) throw ExitStatus{1};
}

const CellKind& cell_kind(const std::string& name) {
  for (const CellKind* kind : {&benchmark_cells(), &ablation_cells()})
    if (name == kind->name) return *kind;
  throw InputError(fmt::format("a plan is of benchmark or ablate, and not of {}", in_quotes(name)));
}

}  // namespace stillpoint
