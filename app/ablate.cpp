#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/cell_kinds.hpp"
#include "app/commands.hpp"
#include "app/jobs.hpp"
#include "app/progress.hpp"
#include "app/slurm.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/run/ablation.hpp"
#include "core/run/cell_plan.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct AblateArguments {
  std::vector<std::string> sequences, without;
  std::string out;
  bool force = false, resume = false;
  ConfigArguments config;
  SequenceArguments frames;
  JobArguments work;
};

constexpr const char* kAblationName = "ablation.json";

/// The variants asked for: the whole method first, then without each ingredient.
std::vector<std::optional<Ingredient>> variants_of(const AblateArguments& arguments,
                                                   const MethodInfo& method) {
  std::vector<std::optional<Ingredient>> variants = {std::nullopt};
  std::set<std::string> taken;
  for (const std::string& name : arguments.without) {
    variants.emplace_back(ingredient_by_name(method, name));
    if (!taken.insert(name).second) throw InputError(fmt::format("--without names {} twice", name));
  }
  if (arguments.without.empty())
    for (const Ingredient& one : ingredients(method)) variants.emplace_back(one);
  return variants;
}

struct AblatedSequence {
  std::string where, name;  ///< as it was named; as tables show it, numbered where several share it
  SequenceArguments reading;
  std::unique_ptr<FrameSource> source;
};

std::vector<AblatedSequence> open_all(const AblateArguments& arguments, const Config& config) {
  std::vector<AblatedSequence> sequences;
  std::set<std::string> names;
  for (const std::string& where : expanded_sequences(arguments.sequences)) {
    const SequenceArguments reading = arguments.frames.fixed(where, config);
    auto source = reading.open(where, config, {.depth = true, .questioned = true});
    std::string name = source->name();
    for (int number = 2; !names.insert(name).second; ++number)
      name = fmt::format("{} {}", source->name(), number);
    sequences.push_back({where, name, reading, std::move(source)});
  }
  return sequences;
}

/// Nothing where it was interrupted.
std::optional<AblationCell> run_variant(const FrameSource& source, const std::string& sequence,
                                        const Config& config, int frames, const std::string& without) {
  RunOptions options;
  options.count = frames;
  const std::string name = without.empty() ? "whole method" : "without " + without;
  const RunResult result = run_with_progress(source, config, fmt::format("{} ({})", sequence, name), options);
  if (result.interrupted) return std::nullopt;
  return ablation_cell(report_on(result, source));
}

/// The two tables and what is to be known beside them.
std::string both_tables(const std::string& method, const std::vector<AblationRow>& rows,
                        const std::vector<std::string>& names) {
  const std::string notes = notes_text(notes_on(rows, names));
  return to_markdown(ablation_summary(method, rows, names)) + "\n" +
         to_markdown(ablation_errors(rows, names)) + (notes.empty() ? notes : "\n" + notes);
}

/// A row a variant, still without cells.
std::vector<AblationRow> rows_of(const std::vector<std::optional<Ingredient>>& variants) {
  std::vector<AblationRow> rows;
  for (const auto& variant : variants)
    rows.push_back(
        {variant ? variant->name : "", variant ? variant->assignments : std::vector<std::string>{}, {}});
  return rows;
}

void write_results(const fs::path& folder, const std::string& method, const std::vector<AblationRow>& rows,
                   const std::vector<std::string>& names, const Provenance& made,
                   const std::vector<MissingRun>& missing = {}, std::size_t asked = 0) {
  std::string text = both_tables(method, rows, names);
  nlohmann::ordered_json json = ablation_json(method, rows, names, made);
  if (!missing.empty()) text += "\n" + missing_text(missing, asked);
  for (const MissingRun& run : missing) json["missing"].push_back(to_json(run));
  write_text_file(folder / "ablation.md", text);
  write_text_file(folder / "ablation.csv", to_csv(ablation_list(rows, names)));
  write_text_file(folder / kAblationName, json.dump(1) + "\n");
}

std::string ablation_text(const std::string& method, const std::vector<AblationRow>& rows,
                          const std::vector<std::string>& names) {
  return fmt::format(
      "Method {}, one ingredient left out at a time. Changes are against the whole method; RPE is "
      "translational, over 1 s, its mean change the geometric mean over the sequences.\n\n{}",
      method, both_tables(method, rows, names));
}

/// Runs one cell of a plan as ablate() does.
std::string run_ablation_cell(const CellPlan& plan, const PlanCell& cell, const fs::path&) {
  const PlannedSequence& sequence = plan.sequence(cell.sequence);
  const SequenceArguments reading = SequenceArguments::from_words(sequence.reading);
  Config config = config_from_toml(plan.config, kPlanName);
  set_parameter(config, "run.odometry=" + cell.odometry);
  set_parameter(config, "run.method=" + cell.method);
  const auto source = reading.open(sequence.where, config, {.depth = true});
  if (frames_of(*source, reading.frames) != cell.frames)
    throw InputError(fmt::format("{}: has {} frames now, and the plan was made for another number",
                                 sequence.where, source->size()));
  std::optional<Ingredient> variant;
  if (!cell.without.empty()) variant = ingredient_by_name(method_of(config), cell.without);
  const auto reached = run_variant(*source, cell.sequence, ablated(config, variant ? &*variant : nullptr),
                                   reading.frames, cell.without);
  throw_if_interrupted();
  return to_json(reached.value()).dump();
}

std::string ablation_cell_tables(const CellPlan& plan, const MergedCells& merged, const fs::path& folder) {
  // A sequence counts when all variants have run on it. Its cells stand together, the whole method first.
  std::vector<std::optional<Ingredient>> variants;
  for (const PlanCell& cell : plan.cells) {
    if (cell.sequence != plan.cells.front().sequence) break;
    variants.emplace_back();
    if (!cell.without.empty()) variants.back() = ingredient_by_name(method_named(cell.method), cell.without);
  }
  std::map<std::pair<std::string, std::string>, AblationCell> reached;
  for (const CellResult& result : merged.results)
    reached.emplace(std::pair(result.cell.sequence, result.cell.without),
                    ablation_cell_from_json(result.json, to_text(result.cell)));
  std::vector<AblationRow> rows = rows_of(variants);
  std::vector<std::string> names;
  for (const PlannedSequence& sequence : plan.sequences) {
    const auto has = [&](const AblationRow& row) { return reached.count({sequence.name, row.without}) > 0; };
    if (!std::all_of(rows.begin(), rows.end(), has)) continue;
    names.push_back(sequence.name);
    for (AblationRow& row : rows) row.cells.push_back(reached.at({sequence.name, row.without}));
  }
  const std::string& method = plan.methods.front();
  Provenance made = made_here();
  if (!merged.machines.empty()) made.machine = fmt::format("{}", fmt::join(merged.machines, "; "));
  made.command = plan.command;
  if (merged.whole || !plan.replaces)
    write_results(folder, method, rows, names, made, merged.missing, plan.cells.size());
  const std::string missing = missing_text(merged.missing, plan.cells.size());
  return ablation_text(method, rows, names) + (missing.empty() ? missing : "\n" + missing);
}

/// The ablation as a plan; what an earlier one in the folder reached is known.
CellPlan ablation_plan(const AblateArguments& arguments, const Config& config,
                       const std::vector<std::optional<Ingredient>>& variants,
                       const std::vector<AblatedSequence>& sequences) {
  CellPlan plan = plan_made_here(ablation_cells().name, shared_config(config));
  plan.engines = {config.run.odometry};
  plan.methods = {config.run.method};
  plan.replaces = arguments.force && fs::exists(fs::path(arguments.out) / kAblationName);
  for (const AblatedSequence& sequence : sequences) {
    add_sequence(plan, sequence.name, sequence.where, sequence.reading.words());
    for (const auto& variant : variants)
      plan.cells.push_back({sequence.name, config.run.odometry, config.run.method, 0,
                            variant ? variant->name : "",
                            frames_of(*sequence.source, sequence.reading.frames)});
  }
  if (!arguments.resume) return plan;
  if (const auto earlier = earlier_cells(arguments.out, plan.kind, plan.config)) {
    plan.replaces = earlier->plan.replaces && !earlier->merged.whole;
    // What is no cell of this one would be another sequence's or variant's.
    for (const CellResult& result : earlier->merged.results)
      if (std::find(plan.cells.begin(), plan.cells.end(), result.cell) != plan.cells.end())
        plan.known.push_back(result);
  }
  return plan;
}

/// Runs a plan's cells here, one after another, with the sequences that are open: each result is kept as
/// those of processes are, so that --resume goes on where this was stopped, and earlier tables stay until
/// these are whole.
void ablate_into(const fs::path& folder, const CellPlan& plan, const Config& config,
                 const std::vector<std::optional<Ingredient>>& variants,
                 const std::vector<AblatedSequence>& sequences) {
  throw_if_queued(folder);
  remove_plan(folder);  // what --force replaces is not gone on with
  write_plan(folder, plan);
  CellRecord record{0, plan.fingerprint(), made_here().commit, made_here().machine};
  const auto tables = [&] {
    return ablation_cell_tables(plan, merge_cells(plan, read_records(folder, plan)), folder);
  };
  for (const AblatedSequence& sequence : sequences) {
    for (const auto& variant : variants) {
      const auto reached =
          run_variant(*sequence.source, sequence.name, ablated(config, variant ? &*variant : nullptr),
                      sequence.reading.frames, variant ? variant->name : "");
      if (!reached) break;
      record.json = to_json(*reached).dump();
      write_record(folder, record);
      ++record.cell;
    }
    if (stop_requested()) break;
    (void)tables();
  }
  fmt::print("{}", tables());
  throw_if_interrupted(plan.replaces
                           ? "stopped early; the earlier tables stay until --resume has made these whole"
                           : "stopped early; the tables hold the sequences that were finished, and --resume "
                             "goes on");
  remove_plan(folder);
}

void ablate(const AblateArguments& arguments) {
  const NewFolders made(arguments.out);
  const Config config = arguments.config.config();
  const std::string& method = config.run.method;
  const std::vector<std::optional<Ingredient>> variants = variants_of(arguments, method_of(config));
  const auto sequences = open_all(arguments, config);
  throw_if_among_data(arguments.out, arguments.sequences);
  if (!arguments.out.empty())
    prepare_out_folder(arguments.out, {"ablation.csv", kPlanName}, arguments.force || arguments.resume);
  if (arguments.work.given() || arguments.resume)
    return run_by_cells(arguments.work, ablation_plan(arguments, config, variants, sequences), arguments.out,
                        arguments.force);
  if (!arguments.out.empty())
    return ablate_into(fs::absolute(arguments.out).lexically_normal(),
                       ablation_plan(arguments, config, variants, sequences), config, variants, sequences);
  std::vector<AblationRow> rows = rows_of(variants);
  std::vector<std::string> names;
  for (const AblatedSequence& sequence : sequences) {
    // A sequence counts when all variants have run on it.
    std::vector<AblationCell> cells;
    for (const auto& variant : variants) {
      const auto cell =
          run_variant(*sequence.source, sequence.name, ablated(config, variant ? &*variant : nullptr),
                      arguments.frames.frames, variant ? variant->name : "");
      if (!cell) break;
      cells.push_back(*cell);
    }
    if (cells.size() < variants.size()) break;
    names.push_back(sequence.name);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].cells.push_back(cells[i]);
  }
  fmt::print("{}", ablation_text(method, rows, names));
  throw_if_interrupted("stopped early; the tables are of the sequences that were finished");
}

}  // namespace

const CellKind& ablation_cells() {
  static const CellKind kind{"ablate", run_ablation_cell, ablation_cell_tables};
  return kind;
}

void add_ablate_command(CLI::App& app) {
  const auto arguments = std::make_shared<AblateArguments>();
  CLI::App* command = app.add_subcommand(
      "ablate", "Run a method whole and with one ingredient left out at a time, and compare");
  command->add_option("SEQUENCES", arguments->sequences, kSequencesHelp)->required();
  std::string names;
  for (const Ingredient& one : ingredients(method_named(kDefaultMethod)))
    names += fmt::format("\n  {}: {}", one.name, one.help);
  command
      ->add_option("--without", arguments->without,
                   "Ingredients to leave out, one at a time, separated by commas; all when none is named. Of "
                   "the default method:" +
                       names)
      ->delimiter(',');
  command->add_option("--out", arguments->out, "Folder for the tables, as Markdown, CSV and JSON");
  command->add_flag("--force", arguments->force, "Overwrite earlier tables in that folder");
  command
      ->add_flag("--resume", arguments->resume,
                 "Go on with the ablation in the folder of --out: runs that it has are not made again")
      ->needs("--out")
      ->excludes("--force");
  arguments->config.add_to(*command, true);
  arguments->frames.add_to(*command);
  arguments->work.add_to(*command);
  command->callback([arguments] { ablate(*arguments); });
}

}  // namespace stillpoint
