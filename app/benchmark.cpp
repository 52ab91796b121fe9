#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "app/arguments.hpp"
#include "app/benchmark_repeats.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/evaluation/tables.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {
namespace {

struct BenchmarkArguments {
  std::vector<std::string> sequences, methods = usual_methods(), engines;
  std::string out;
  bool force = false;
  int repeats = 1;
  ConfigArguments config;
  SequenceArguments frames;
};

std::string cell(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
}

/// What Table 1 leaves out: the other errors, coverage, masks and speed.
Table details_table(const std::vector<RunReport>& reports) {
  Table table;
  table.header = {"sequence",  "odometry",    "method",         "coverage %",      "ATE m",
                  "RPE 1 s m", "RPE 1 s deg", "pairs",          "RPE 1 frame m",   "mask precision",
                  "recall",    "IoU",         "forward recall", "removed rightly", "removed wrongly",
                  "median ms", "p99 ms",      "ORB units"};
  for (const RunReport& r : reports) {
    std::optional<double> ate, rpe, rpe_deg, rpe_frame;
    int pairs = 0;
    if (r.evaluation && r.evaluation->ate.translation_m.count > 0) ate = r.evaluation->ate.translation_m.rmse;
    if (r.evaluation && (pairs = r.evaluation->rpe_time.translation_m.count) > 0) {
      rpe = r.evaluation->rpe_time.translation_m.rmse;
      rpe_deg = r.evaluation->rpe_time.rotation_deg.rmse;
    }
    if (r.evaluation && r.evaluation->rpe_frame.translation_m.count > 0)
      rpe_frame = r.evaluation->rpe_frame.translation_m.rmse;
    const bool masks = r.scores.known && !method_named(r.method).baseline;
    table.rows.push_back(
        {r.sequence, r.odometry, r.method, fmt::format("{:.1f}", 100.0 * r.coverage), cell(ate, 4),
         cell(rpe, 4), cell(rpe_deg, 3), std::to_string(pairs), cell(rpe_frame, 5),
         masks ? cell(r.scores.mask.precision(), 3) : "-", masks ? cell(r.scores.mask.recall(), 3) : "-",
         masks ? cell(r.scores.mask.iou(), 3) : "-", masks ? cell(r.scores.partial_mask.recall(), 3) : "-",
         masks ? std::to_string(r.scores.removal.removed_rightly) : "-",
         masks ? std::to_string(r.scores.removal.removed_wrongly) : "-",
         fmt::format("{:.1f}", r.speed.median_ms), fmt::format("{:.1f}", r.speed.p99_ms),
         fmt::format("{:.2f}", r.speed.units)});
  }
  return table;
}

BenchmarkCell cell_of(const RunReport& report) {
  BenchmarkCell result;
  result.method = report.method;
  result.coverage = report.coverage;
  if (report.evaluation && report.evaluation->rpe_time.translation_m.count > 0) {
    result.rpe_m = report.evaluation->rpe_time.translation_m.rmse;
    result.pairs = report.evaluation->rpe_time.translation_m.count;
  }
  return result;
}

/// What one engine reached behind each method.
struct EngineRows {
  std::string engine;
  std::vector<BenchmarkRow> rows;
};

/// Table 1 once an engine: gains are over the baseline behind the same one.
std::string tables_text(const std::vector<EngineRows>& all, const std::vector<std::string>& methods) {
  std::string text;
  for (const EngineRows& one : all) {
    if (all.size() > 1) text += fmt::format("{}Odometry {}\n\n", text.empty() ? "" : "\n", one.engine);
    text += to_markdown(table_one(one.rows, methods, baseline_method().name));
  }
  return text;
}

void write_tables(const std::filesystem::path& folder, const std::vector<EngineRows>& all,
                  const std::vector<std::string>& methods, const Table& details) {
  write_text_file(folder / "table1.md", tables_text(all, methods));
  for (const EngineRows& one : all)
    write_text_file(folder / (&one == &all.front() ? "table1.csv" : fmt::format("table1_{}.csv", one.engine)),
                    to_csv(table_one(one.rows, methods, baseline_method().name)));
  write_text_file(folder / "details.md", to_markdown(details));
  write_text_file(folder / "details.csv", to_csv(details));
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
    prepare_out_folder(arguments.out, {"table1.csv", "details.csv", "repeats.csv"}, arguments.force);
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

/// @param records null where the run is not kept
RunResult run_one(const FrameSource& source, const Config& config, int frames, RecordsWriter* records) {
  RunOptions options;
  options.count = frames;
  options.stop = &stop_requested();
  options.measure_orb_unit = true;
  const int total = frames > 0 ? std::min(frames, source.size()) : source.size();
  Progress progress(fmt::format("{} ({})", source.name(), run_label(config)), total);
  options.on_frame = [&progress, records](const FrameResult& frame) {
    if (records != nullptr) records->add(frame);
    progress.advance(std::string(to_string(frame.record.status)));
  };
  return run_sequence(source, config, options);
}

/// A run, kept below `runs` where an origin is given. Nothing where it was interrupted: half a run is no run
/// to compare with.
std::optional<RunReport> run_and_keep(const FrameSource& source, const Config& config, int frames,
                                      const std::filesystem::path& runs, bool force,
                                      const std::optional<SequenceOrigin>& origin) {
  const std::filesystem::path folder = runs / run_label(config);
  std::optional<RecordsWriter> records;
  if (origin) {
    prepare_run_folder(folder, force);
    records.emplace(folder, *origin, config);
  }
  const RunResult result = run_one(source, config, frames, records ? &*records : nullptr);
  if (result.interrupted) {
    if (records) std::filesystem::remove(folder / kRecordsName);
    return std::nullopt;
  }
  RunReport report = report_on(result, source);
  if (records) {
    write_run(folder, result, report, source, *origin);
    records->finish(result, source.ground_truth());
  }
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
  std::vector<EngineRows> all;
  for (const std::string& engine : arguments.engines) all.push_back({engine, {}});
  std::vector<RunReport> reports;
  std::set<std::string> taken;
  const std::vector<std::string> places = expanded_sequences(arguments.sequences);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto& source = sources[i];
    std::optional<SequenceOrigin> origin;
    if (!arguments.out.empty()) origin = origin_of(*source, places[i], arguments.frames.options(config));
    const auto runs = runs_folder(arguments.out, source->name(), taken);
    for (EngineRows& one : all) {
      set_parameter(config, "run.odometry=" + one.engine);
      one.rows.push_back({source->name(), {}});
      for (const std::string& method : arguments.methods) {
        set_parameter(config, "run.method=" + method);
        std::optional<RunReport> report =
            run_and_keep(*source, config, arguments.frames.frames, runs, arguments.force, origin);
        if (!report) break;
        one.rows.back().cells.push_back(cell_of(*report));
        reports.push_back(std::move(*report));
      }
      if (stop_requested()) break;
    }
    // After each sequence, so that an interrupted benchmark keeps what it has.
    if (!arguments.out.empty()) write_tables(arguments.out, all, arguments.methods, details_table(reports));
    if (stop_requested()) break;
  }
  fmt::print("Translational RPE over 1 s, RMSE in m (published columns: Niu & Li 2019, Table 1)\n\n{}\n{}",
             tables_text(all, arguments.methods), to_markdown(details_table(reports)));
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
      "Folder for the tables, as Markdown and CSV, and for SEQUENCE/METHOD folders of the runs");
  command->add_flag("--force", arguments->force, "Overwrite earlier tables in that folder");
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
