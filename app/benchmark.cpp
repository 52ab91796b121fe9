#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "app/arguments.hpp"
#include "app/benchmark_cells.hpp"
#include "app/benchmark_tables.hpp"
#include "app/cell_kinds.hpp"
#include "app/commands.hpp"
#include "app/jobs.hpp"
#include "app/progress.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"
#include "core/run/cell_plan.hpp"
#include "core/run/outside_run.hpp"
#include "core/run/records_file.hpp"
#include "core/run/repeats.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {
namespace {

struct BenchmarkArguments {
  std::vector<std::string> sequences, methods = usual_methods(), engines;
  std::vector<std::string> outside;  // NAME=FILE each
  std::string out;
  bool force = false, resume = false;
  int repeats = 1;
  ConfigArguments config;
  SequenceArguments frames;
  JobArguments work;
};

struct OpenedSequence {
  std::string where;
  SequenceArguments reading;
  std::unique_ptr<FrameSource> source;
  OpenOptions options;
};

/// Everything that can be known to be wrong is told before the first frame, not hours later.
std::vector<OpenedSequence> open_all(const BenchmarkArguments& arguments, Config config) {
  std::set<std::string> methods;
  bool wants_masks = false;
  std::set<std::string> engines;
  for (const std::string& engine : arguments.engines)
    if (!engines.insert(engine).second) throw InputError(fmt::format("--odometry names {} twice", engine));
  for (const std::string& method : arguments.methods) {
    set_parameter(config, "run.method=" + method);
    for (const std::string& engine : arguments.engines) {
      set_parameter(config, "run.odometry=" + engine);
      throw_if_no_pair(config);
    }
    wants_masks = wants_masks || method_of(config).needs.true_mask;
    if (!methods.insert(method).second) throw InputError(fmt::format("--methods names {} twice", method));
  }
  for (const std::string& outside : arguments.outside) {
    const OutsideRunFiles files = outside_run_argument(outside);
    if (!methods.insert(files.name).second) throw InputError(fmt::format("--run names {} twice", files.name));
    if (std::any_of(stillpoint::methods().begin(), stillpoint::methods().end(),
                    [&files](const MethodInfo& method) { return method.name == files.name; }))
      throw InputError(
          fmt::format("--run {}: is called like one of the methods; NAME=FILE names it", outside));
  }
  std::vector<OpenedSequence> sequences;
  for (const std::string& where : expanded_sequences(arguments.sequences)) {
    const SequenceArguments reading = arguments.frames.fixed(where, config);
    sequences.push_back(
        {where, reading,
         reading.open(where, config, {.depth = true, .oracle = wants_masks, .questioned = true}),
         reading.options(config)});
  }
  throw_if_among_data(arguments.out, arguments.sequences);
  if (!arguments.out.empty())
    prepare_out_folder(arguments.out, {"table1.csv", "details.csv", "repeats.csv", kPlanName},
                       arguments.force || arguments.resume);
  return sequences;
}

/// Where a sequence's runs go below the out folder: by its name (`generated:room` as `generated_room`),
/// numbered where several share it.
std::filesystem::path runs_folder(const std::string& out, std::string sequence,
                                  std::set<std::string>& taken) {
  std::replace(sequence.begin(), sequence.end(), ':', '_');
  std::string name = sequence;
  for (int number = 2; !taken.insert(name).second; ++number) name = fmt::format("{}_{}", sequence, number);
  return std::filesystem::path(out) / name;
}

/// A sequence of the benchmark.
struct Place {
  const FrameSource& source;
  std::string where;                       ///< as it was named
  std::string name;                        ///< numbered where several sequences share it
  int frames = 0;                          ///< so many are run
  std::optional<SequenceOrigin> origin{};  ///< where runs are kept …
  std::filesystem::path runs{};            ///< … below this
};

/// A run, kept where the benchmark has a folder and the run is the one without perturbation. Nothing where it
/// was interrupted: half a run is no run to compare with.
/// @throws InputError where the sequence went away meanwhile
std::optional<BenchmarkResult> run_and_keep(const Place& place, const Config& config, int repeat,
                                            const BenchmarkArguments& arguments) {
  const Perturbation by = perturbation(repeat);
  const std::filesystem::path folder = place.runs / run_label(config);
  std::optional<RecordsWriter> records;
  if (place.origin && repeat == 0) {
    prepare_run_folder(folder, arguments.force || arguments.resume);
    records.emplace(folder, *place.origin, config);
  }
  const std::string label =
      arguments.repeats > 1
          ? fmt::format("{} ({}, {} of {})", place.name, run_label(config), repeat + 1, arguments.repeats)
          : fmt::format("{} ({})", place.name, run_label(config));
  RunOptions options;
  options.first = std::min(by.first_frame, place.frames - 1);
  options.count = place.frames - options.first;
  options.measure_orb_unit = true;
  if (records) options.on_frame = [&records](const FrameResult& frame) { records->add(frame); };
  const RunResult result = run_with_progress(place.source, perturbed(config, by), label, options);
  const std::string gone = why_gone(place.where, result);
  if (result.interrupted || !gone.empty()) {
    if (records) records->discard();
    if (!gone.empty()) throw InputError(gone);
    return std::nullopt;
  }
  const RunReport report = report_on(result, place.source);
  if (records) write_run(folder, result, report, place.source, *place.origin, *records);
  BenchmarkResult reached = result_of(report, !method_named(report.method).baseline);
  reached.sequence = place.name;
  reached.repeat = repeat;
  return reached;
}

/// Where another program's run of a sequence lies: {} stands for the sequence's name.
OutsideRunFiles outside_files(const std::string& argument, const std::string& sequence) {
  OutsideRunFiles files = outside_run_argument(argument);
  if (const auto at = files.where.find("{}"); at != std::string::npos) files.where.replace(at, 2, sequence);
  return files;
}

/// Measures another program's run by the frames that ours are measured by.
BenchmarkResult measure_outside(const Place& place, const SequenceOrigin& origin,
                                const std::string& argument) {
  std::vector<std::string> warnings;
  const RecordedRun recorded =
      read_outside_run(place.source, origin, outside_files(argument, place.source.name()), warnings,
                       [](const auto&) { throw_if_interrupted(); });
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
  bool judges = false;
  for (std::size_t i = 0; !judges && i < recorded.run.records.size(); ++i)
    judges = !recorded.details->of(i).mask.empty();
  BenchmarkResult reached = result_of(report_on(recorded.run, place.source), judges);
  reached.sequence = place.name;
  reached.method = recorded.outside;
  reached.odometry = kItsOwnOdometry;
  reached.hash.clear();
  return reached;
}

/// How many frames a run has.
int frames_of_run(const Place& place, int repeat) {
  return place.frames - std::min(perturbation(repeat).first_frame, place.frames - 1);
}

/// The benchmark as a plan: what `results` holds is known.
CellPlan benchmark_plan(const BenchmarkArguments& arguments, const BenchmarkResults& results,
                        const BenchmarkColumns& columns, const std::vector<Place>& places,
                        const std::vector<OpenedSequence>& sequences) {
  CellPlan plan = plan_made_here(benchmark_cells().name, results.config);
  plan.engines = columns.engines;
  plan.methods = columns.methods;
  plan.repeated = columns.repeated;
  std::map<std::tuple<std::string, std::string, std::string, int>, int>
      frames;  // of the runs that are asked for
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place& place = places[i];
    add_sequence(plan, place.name, place.where, sequences[i].reading.words(), place.runs.filename().string());
    for (const std::string& engine : arguments.engines)
      for (const std::string& method : arguments.methods)
        for (int repeat = 0; repeat < arguments.repeats; ++repeat) {
          plan.cells.push_back({place.name, engine, method, repeat, "", frames_of_run(place, repeat)});
          frames[{place.name, engine, method, repeat}] = plan.cells.back().frames;
        }
  }
  for (const BenchmarkResult& run : results.runs) {
    const auto asked = frames.find({run.sequence, run.odometry, run.method, run.repeat});
    if (asked == frames.end() || asked->second == run.frames)
      plan.known.push_back(
          {{run.sequence, run.odometry, run.method, run.repeat, "", run.frames}, to_json(run).dump()});
  }
  return plan;
}

/// Runs one cell of a plan as benchmark() does.
std::string run_benchmark_cell(const CellPlan& plan, const PlanCell& cell,
                               const std::filesystem::path& folder) {
  const PlannedSequence& sequence = plan.sequence(cell.sequence);
  BenchmarkArguments arguments;
  arguments.force = true;
  arguments.frames = SequenceArguments::from_words(sequence.reading);
  Config config = config_from_toml(plan.config, kPlanName);
  const auto set_to = [&config](const PlanCell& one) {
    set_parameter(config, "run.odometry=" + one.odometry);
    set_parameter(config, "run.method=" + one.method);
  };
  set_to(plan.cells.back());  // by which --calibrate-time measured when all were opened
  const auto source = arguments.frames.open(
      sequence.where, config, {.depth = true, .oracle = method_named(cell.method).needs.true_mask});
  Place place{*source, sequence.where, sequence.name, frames_of(*source, arguments.frames.frames)};
  if (frames_of_run(place, cell.repeat) != cell.frames)
    throw InputError(fmt::format("{}: has {} frames now, and the plan was made for another number",
                                 sequence.where, source->size()));
  set_to(cell);
  place.origin = origin_of(*source, sequence.where, arguments.frames.options(config));
  place.runs = folder / sequence.runs;
  const auto reached = run_and_keep(place, config, cell.repeat, arguments);
  throw_if_interrupted();
  return to_json(reached.value()).dump();
}

void benchmark(BenchmarkArguments arguments) {
  const NewFolders made(arguments.out);
  Config config = arguments.config.config();
  if (arguments.engines.empty()) arguments.engines = {config.run.odometry};
  const auto sequences = open_all(arguments, config);
  BenchmarkResults results = made_here();
  results.config = shared_config(config);
  const std::filesystem::path out = arguments.out;
  bool replaces = false;
  if (!out.empty() && arguments.force) {
    replaces = std::filesystem::exists(out / kResultsName);
    std::filesystem::remove(out / kUnfinishedName);
  }
  if (arguments.resume) results.runs = earlier_runs(arguments.out, results.config, replaces);
  BenchmarkColumns columns{arguments.engines, arguments.methods, arguments.repeats > 1};
  for (const std::string& outside : arguments.outside)
    columns.methods.push_back(outside_run_argument(outside).name);

  std::set<std::string> taken, names;
  std::vector<Place> places;
  for (const OpenedSequence& sequence : sequences) {
    const FrameSource& source = *sequence.source;
    Place place{source, sequence.where, source.name(), frames_of(source, arguments.frames.frames)};
    for (int number = 2; !names.insert(place.name).second; ++number)
      place.name = fmt::format("{} {}", source.name(), number);
    const SequenceOrigin origin = origin_of(source, sequence.where, sequence.options);
    if (!arguments.out.empty()) {
      place.origin = origin;
      place.runs = runs_folder(arguments.out, source.name(), taken);
    }
    // Measured at once: what is wrong with a file is told before the first frame.
    for (const std::string& outside : arguments.outside) {
      const BenchmarkResult reached = measure_outside(place, origin, outside);
      std::erase_if(results.runs, [&reached](const BenchmarkResult& r) {
        return r.sequence == reached.sequence && r.method == reached.method;
      });
      results.runs.push_back(reached);
    }
    places.push_back(std::move(place));
  }
  if (arguments.work.given()) {
    CellPlan plan = benchmark_plan(arguments, results, columns, places, sequences);
    plan.replaces = replaces;
    return run_by_cells(arguments.work, plan, out, arguments.force);
  }
  // After each run, so that an interrupted benchmark keeps what it has; earlier results stay until all is
  // there.
  const auto keep = [&](bool whole) {
    if (arguments.out.empty() || results.runs.empty()) return;
    if (!whole && replaces) return write_text_file(out / kUnfinishedName, to_json(results).dump(2) + "\n");
    write_tables(results, columns, arguments.out);
    std::filesystem::remove(out / kUnfinishedName);
  };
  if (!arguments.out.empty() && std::filesystem::exists(out / kPlanName)) {
    keep(false);  // what it had is among the results
    remove_plan(out);
  }
  for (const Place& place : places)
    for (const std::string& engine : arguments.engines)
      for (const std::string& method : arguments.methods)
        for (int repeat = 0; repeat < arguments.repeats && !stop_requested(); ++repeat) {
          const BenchmarkResult* known = results.find(place.name, engine, method, repeat);
          if (known != nullptr && known->frames == frames_of_run(place, repeat)) continue;
          if (known != nullptr) results.runs.erase(results.runs.begin() + (known - results.runs.data()));
          set_parameter(config, "run.odometry=" + engine);
          set_parameter(config, "run.method=" + method);
          const auto reached = run_and_keep(place, config, repeat, arguments);
          if (!reached) continue;
          results.runs.push_back(*reached);
          keep(false);
        }
  keep(!stop_requested());
  fmt::print("{}", tables_text(results, columns));
  throw_if_interrupted(replaces ? "stopped early; the earlier tables stay until --resume has made these whole"
                                : "stopped early; the tables hold what was finished");
}

}  // namespace

const CellKind& benchmark_cells() {
  static const CellKind kind{"benchmark", run_benchmark_cell, benchmark_cell_tables};
  return kind;
}

void add_benchmark_command(CLI::App& app) {
  const auto arguments = std::make_shared<BenchmarkArguments>();
  CLI::App* command = app.add_subcommand(
      "benchmark", "Run sequences by several methods and print the paper's Table 1 with our columns");
  command->add_option("SEQUENCES", arguments->sequences, kSequencesHelp)->required();
  command->add_option("--methods", arguments->methods, "Methods to compare, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--odometry", arguments->engines,
                   fmt::format("Engines to run them behind, separated by commas, of: {}; otherwise the "
                               "config's",
                               fmt::join(engine_names(), ", ")))
      ->delimiter(',');
  command->add_option(
      "--out", arguments->out,
      "Folder for the tables, as Markdown, CSV and JSON, and for SEQUENCE/METHOD folders of the runs");
  command->add_flag("--force", arguments->force, "Overwrite earlier tables in that folder");
  command
      ->add_flag("--resume", arguments->resume,
                 "Go on with the benchmark in the folder of --out: runs that it has are not made again")
      ->needs("--out")
      ->excludes("--force");
  command
      ->add_option(
          "--repeat", arguments->repeats,
          "Run each so many times, with a few features more or fewer, another seed and first frame, and "
          "print median and spread; --out has them as Markdown, CSV, JSON and LaTeX")
      ->check(CLI::Range(1, 99));
  command->add_option("--run", arguments->outside,
                      "Another program's run as a further column: NAME=FILE or NAME=FOLDER, as import takes "
                      "it; {} in it stands for the sequence's name");
  arguments->config.add_to(*command, false);
  arguments->frames.add_to(*command);
  arguments->work.add_to(*command);
  command->callback([arguments] { benchmark(*arguments); });
}

}  // namespace stillpoint
