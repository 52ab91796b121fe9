#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "app/arguments.hpp"
#include "app/benchmark_repeats.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/evaluation/benchmark_results.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {
namespace {

constexpr const char* kResultsName = "results.json";

struct BenchmarkArguments {
  std::vector<std::string> sequences, methods = usual_methods(), engines;
  std::string out;
  bool force = false, resume = false;
  int repeats = 1;
  ConfigArguments config;
  SequenceArguments frames;
};

BenchmarkResult result_of(const RunReport& report) {
  BenchmarkResult result;
  result.sequence = report.sequence;
  result.odometry = report.odometry;
  result.method = report.method;
  result.frames = report.frames;
  result.coverage = report.coverage;
  if (const auto& e = report.evaluation) {
    if (e->ate.translation_m.count > 0) result.ate_m = e->ate.translation_m.rmse;
    if (e->rpe_time.translation_m.count > 0) {
      result.pairs = e->rpe_time.translation_m.count;
      result.rpe_m = e->rpe_time.translation_m.rmse;
      result.rpe_deg = e->rpe_time.rotation_deg.rmse;
    }
    if (e->rpe_frame.translation_m.count > 0) result.rpe_frame_m = e->rpe_frame.translation_m.rmse;
  }
  if (report.scores.known && !method_named(report.method).baseline) {
    result.precision = report.scores.mask.precision();
    result.recall = report.scores.mask.recall();
    result.iou = report.scores.mask.iou();
    result.partial_recall = report.scores.partial_mask.recall();
    result.right = report.scores.removal.removed_rightly;
    result.wrong = report.scores.removal.removed_wrongly;
  }
  result.median_ms = report.speed.median_ms;
  result.p99_ms = report.speed.p99_ms;
  result.units = report.speed.units;
  result.hash = report.hash;
  return result;
}

/// Table 1 once an engine: gains are over the baseline behind the same one.
std::string tables_text(const BenchmarkResults& results, const BenchmarkArguments& arguments) {
  std::string text;
  for (const std::string& engine : arguments.engines) {
    if (arguments.engines.size() > 1)
      text += fmt::format("{}Odometry {}\n\n", text.empty() ? "" : "\n", engine);
    text += to_markdown(table_one(results, engine, arguments.methods, baseline_method().name));
  }
  return text;
}

void write_tables(const BenchmarkResults& results, const BenchmarkArguments& arguments) {
  const std::filesystem::path folder = arguments.out;
  write_text_file(folder / kResultsName, to_json(results).dump(2) + "\n");
  write_text_file(folder / "table1.md", tables_text(results, arguments));
  for (const std::string& engine : arguments.engines)
    write_text_file(
        folder / (engine == arguments.engines.front() ? "table1.csv" : fmt::format("table1_{}.csv", engine)),
        to_csv(table_one(results, engine, arguments.methods, baseline_method().name)));
  write_text_file(folder / "details.md", to_markdown(details_table(results)));
  write_text_file(folder / "details.csv", to_csv(details_table(results)));
}

/// The config that all of a benchmark's runs share.
std::string shared_config(Config config) {
  config.run.method = RunConfig().method;
  config.run.odometry = RunConfig().odometry;
  return to_toml(config);
}

/// What an earlier benchmark left in the folder, to be gone on with.
/// @throws InputError where its runs are not what these would be
std::vector<BenchmarkResult> earlier_runs(const BenchmarkArguments& arguments, const Config& config) {
  const std::filesystem::path path = std::filesystem::path(arguments.out) / kResultsName;
  if (!std::filesystem::exists(path)) return {};
  const BenchmarkResults earlier = read_results(path.string());
  if (earlier.commit != made_here().commit)
    throw InputError(
        fmt::format("{}: was made by another build (commit {}), so that --resume cannot go on with "
                    "it; --force begins anew",
                    path.string(), earlier.commit));
  if (earlier.config != shared_config(config))
    throw InputError(
        fmt::format("{}: was made with other parameters, so that --resume cannot go on with it; "
                    "--force begins anew",
                    path.string()));
  return earlier.runs;
}

/// Everything that can be known to be wrong is told before the first frame, not hours later.
std::vector<std::unique_ptr<FrameSource>> open_all(const BenchmarkArguments& arguments, Config config) {
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
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (const std::string& sequence : expanded_sequences(arguments.sequences))
    sources.push_back(arguments.frames.open(sequence, config, {.depth = true, .oracle = wants_masks}));
  if (!arguments.out.empty())
    prepare_out_folder(arguments.out, {"table1.csv", "details.csv", "repeats.csv"},
                       arguments.force || arguments.resume);
  return sources;
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

/// How many frames of a sequence are run. @param asked 0 = all
int frames_of(const FrameSource& source, int asked) {
  return asked > 0 ? std::min(asked, source.size()) : source.size();
}

/// @param records null where the run is not kept
RunResult run_one(const FrameSource& source, const Config& config, int frames, RecordsWriter* records) {
  RunOptions options;
  options.count = frames;
  options.stop = &stop_requested();
  options.measure_orb_unit = true;
  Progress progress(fmt::format("{} ({})", source.name(), run_label(config)), frames_of(source, frames));
  options.on_frame = [&progress, records](const FrameResult& frame) {
    if (records != nullptr) records->add(frame);
    progress.advance(std::string(to_string(frame.record.status)));
  };
  return run_sequence(source, config, options);
}

/// A run, kept below `runs` where an origin is given. Nothing where it was interrupted: half a run is no run
/// to compare with.
/// @throws InputError where the sequence went away meanwhile
std::optional<RunReport> run_and_keep(const FrameSource& source, const std::string& where,
                                      const Config& config, int frames, const std::filesystem::path& runs,
                                      bool force, const std::optional<SequenceOrigin>& origin) {
  const std::filesystem::path folder = runs / run_label(config);
  std::optional<RecordsWriter> records;
  if (origin) {
    prepare_run_folder(folder, force);
    records.emplace(folder, *origin, config);
  }
  const RunResult result = run_one(source, config, frames, records ? &*records : nullptr);
  const std::string gone = why_gone(where, result);
  if (result.interrupted || !gone.empty()) {
    if (records) records->discard();
    if (!gone.empty()) throw InputError(gone);
    return std::nullopt;
  }
  RunReport report = report_on(result, source);
  if (records) write_run(folder, result, report, source, *origin, *records);
  return report;
}

void benchmark(BenchmarkArguments arguments) {
  Config config = arguments.config.config();
  if (arguments.engines.empty()) arguments.engines = {config.run.odometry};
  const auto sources = open_all(arguments, config);
  if (arguments.repeats > 1) {
    RepeatPlan plan{{},           arguments.methods, arguments.engines,
                    config,       arguments.repeats, arguments.frames.frames,
                    arguments.out};
    for (const auto& source : sources) plan.sources.push_back(source.get());
    benchmark_repeats(plan);
    return;
  }
  BenchmarkResults results = made_here();
  results.config = shared_config(config);
  if (arguments.resume) results.runs = earlier_runs(arguments, config);
  std::set<std::string> taken, names;
  const std::vector<std::string> places = expanded_sequences(arguments.sequences);
  for (std::size_t i = 0; i < sources.size() && !stop_requested(); ++i) {
    const auto& source = sources[i];
    std::optional<SequenceOrigin> origin;
    if (!arguments.out.empty()) origin = origin_of(*source, places[i], arguments.frames.options(config));
    const auto runs = runs_folder(arguments.out, source->name(), taken);
    const int frames = frames_of(*source, arguments.frames.frames);
    std::string name = source->name();  // numbered where several sequences share it
    for (int number = 2; !names.insert(name).second; ++number)
      name = fmt::format("{} {}", source->name(), number);
    for (const std::string& engine : arguments.engines)
      for (const std::string& method : arguments.methods) {
        const BenchmarkResult* known = results.find(name, engine, method);
        if (stop_requested() || (known != nullptr && known->frames == frames)) continue;
        if (known != nullptr) results.runs.erase(results.runs.begin() + (known - results.runs.data()));
        set_parameter(config, "run.odometry=" + engine);
        set_parameter(config, "run.method=" + method);
        const std::optional<RunReport> report = run_and_keep(*source, places[i], config, frames, runs,
                                                             arguments.force || arguments.resume, origin);
        if (!report) continue;
        results.runs.push_back(result_of(*report));
        results.runs.back().sequence = name;
        // After each run, so that an interrupted benchmark keeps what it has.
        if (!arguments.out.empty()) write_tables(results, arguments);
      }
  }
  if (!arguments.out.empty() && !results.runs.empty()) write_tables(results, arguments);
  fmt::print("Translational RPE over 1 s, RMSE in m (published columns: Niu & Li 2019, Table 1)\n\n{}\n{}",
             tables_text(results, arguments), to_markdown(details_table(results)));
  if (stop_requested()) fmt::print("\nstopped early; the tables hold what was finished\n");
  throw_if_interrupted();
}

}  // namespace

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
  arguments->config.add_to(*command, false);
  arguments->frames.add_to(*command);
  command->callback([arguments] { benchmark(*arguments); });
}

}  // namespace stillpoint
