#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/export_mcap.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/export/mcap_export.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/out_folder.hpp"
#include "core/run/condition.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {
namespace {

struct RunArguments {
  std::string sequence, out, break_at, mcap;
  bool force = false, measure_unit = false;
  ConfigArguments config;
  SequenceArguments frames;
};

constexpr int kConditionHeld = 3;  // the exit status, so that scripts tell it from a failure

std::optional<Condition> break_condition(const RunArguments& arguments) {
  if (arguments.break_at.empty()) return std::nullopt;
  try {
    return Condition(arguments.break_at);
  } catch (const ConditionError& error) {
    throw InputError(fmt::format("--break: {}\n  {}\n  {:>{}}", error.what(), arguments.break_at, "^",
                                 error.column() + 1));
  }
}

/// Tells where a condition holds. @returns whether it does anywhere
bool tell_frames(const Condition& condition, const RunResult& result, const RunReport& report) {
  const FrameFigures figures(
      {result.records, report.evaluation ? &*report.evaluation : nullptr, &result.scores},
      condition.figures());
  const auto frames = condition.frames(figures);
  fmt::print("  {}: ", condition.text());
  if (frames.empty()) {
    std::vector<int> all;
    for (int row = 0; row < figures.rows(); ++row) all.push_back(figures.frame(row));
    const std::string reach = condition.reach(figures, all);
    fmt::print("at no frame{}{}\n", reach.empty() ? "" : "; ", reach);
  } else {
    fmt::print("at {} of {}: {}\n", frames.size(), counted(result.records.size(), "frame"),
               frames_text(frames));
  }
  return !frames.empty();
}

void run(const RunArguments& arguments) {
  if (arguments.break_at == "help") {
    fmt::print("{}", condition_help());
    return;
  }
  const NewFolders made(arguments.out);
  const std::optional<Condition> condition = break_condition(arguments);
  const Config config = arguments.config.config();
  throw_if_no_pair(config);
  const SequenceArguments reading = arguments.frames.fixed(arguments.sequence, config);
  const auto source =
      reading.open(arguments.sequence, config,
                   {.depth = true, .oracle = method_of(config).needs.true_mask, .questioned = true});
  RunOptions options;
  options.count = arguments.frames.frames;
  std::optional<SequenceOrigin> origin;
  std::optional<RecordsWriter> records;
  if (!arguments.out.empty()) {
    throw_if_among_data(arguments.out, {arguments.sequence});
    prepare_run_folder(arguments.out, arguments.force);
    origin = origin_of(*source, arguments.sequence, reading.options(config));
    records.emplace(arguments.out, *origin, config);
  }
  options.measure_orb_unit = arguments.measure_unit;
  std::optional<McapFileName> mcap_name;
  std::optional<McapExport> mcap;
  if (!arguments.mcap.empty()) {
    mcap_name.emplace(arguments.mcap, arguments.force);
    mcap.emplace(mcap_name->while_written(), source->camera());
  }
  options.on_frame = [&](const FrameResult& frame) {
    if (records) records->add(frame);
    if (mcap) mcap->add(source->read(frame.record.index), frame.record, frame.mask);
  };
  const RunResult result =
      run_with_progress(*source, config, fmt::format("{} ({})", source->name(), run_label(config)), options);
  const RunReport report = report_on(result, *source);
  // Told before it is written: on a full disk the figures at least are seen.
  fmt::print("{}", to_text(report));
  if (records) {
    write_run(arguments.out, result, report, *source, *origin, *records);
    fmt::print("  written to    {}\n", arguments.out);
  }
  if (mcap) {
    mcap->finish(result, source->ground_truth());
    mcap_name->finish();
    fmt::print("  written to    {}\n", arguments.mcap);
  }
  if (result.interrupted)
    throw_if_interrupted(fmt::format("stopped after {} of {}{}", report.frames,
                                     counted(frames_of(*source, options.count), "frame"),
                                     arguments.out.empty() ? "" : "; what was done is kept"));
  if (const std::string gone = why_gone(arguments.sequence, result); !gone.empty()) throw InputError(gone);
  const bool held = condition && tell_frames(*condition, result, report);
  if (report.tracked == 0)
    throw InputError(fmt::format("{}: no frame could be tracked ({})", arguments.sequence,
                                 result.records.empty() ? "there was none" : result.records.front().note));
  if (held) throw ExitStatus{kConditionHeld};
}

}  // namespace

void add_run_command(CLI::App& app) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* command =
      app.add_subcommand("run", "Run odometry over a sequence: trajectory, figures and per-frame data");
  const CLI::Option* sequence = command->add_option("SEQUENCE", arguments->sequence, kSequenceHelp);
  command->add_option("--out", arguments->out,
                      "Folder for trajectory, frames.csv, summary.json, config and map");
  command->add_option(
      "--mcap", arguments->mcap,
      "Also write the run to this .mcap file while it goes on, for Foxglove, Rerun, PlotJuggler");
  command->add_flag("--force", arguments->force, "Overwrite an earlier run in that folder");
  command->add_flag("--measure-unit", arguments->measure_unit,
                    "Also time OpenCV's ORB on every frame, the unit in which speed is compared");
  command->add_option(
      "--break", arguments->break_at,
      "Tell the frames at which a condition holds, such as 'rpe > 5 cm || lost'; the status is then "
      "3. `help` lists what it may be made of");
  arguments->config.add_to(*command, true);
  arguments->frames.add_to(*command);
  command->callback([arguments, sequence] {
    // Only the list of names does without one.
    if (sequence->count() == 0 && arguments->break_at != "help") throw CLI::RequiredError("SEQUENCE");
    run(*arguments);
  });
}

}  // namespace stillpoint
