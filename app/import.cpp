// `stillpoint import`: another program's run, laid onto a sequence's frames and written as a run's folder.
#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/out_folder.hpp"
#include "core/run/outside_run.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {
namespace {

struct ImportArguments {
  std::string sequence, run, out, quaternion, convention;
  double time_offset_s = 0.0;
  bool force = false;
  SequenceArguments frames;
};

void import(const ImportArguments& arguments) {
  const NewFolders made(arguments.out);
  OutsideRunFiles files = outside_run_argument(arguments.run);
  if (!arguments.quaternion.empty())
    files.quaternion = arguments.quaternion == "wxyz" ? QuaternionOrder::wxyz : QuaternionOrder::xyzw;
  files.convention = convention_argument("--estimate", arguments.convention);
  files.time_offset_s = arguments.time_offset_s;
  const Config config;
  const SequenceArguments reading = arguments.frames.fixed(arguments.sequence, config);
  const auto source = reading.open(arguments.sequence, config);
  const SequenceOrigin origin = origin_of(*source, arguments.sequence, reading.options(config));
  std::vector<std::string> warnings;
  const std::string stopped = "stopped before it was done; nothing was written";
  const RecordedRun run = [&] {
    Progress progress(fmt::format("{} ({})", source->name(), files.name), source->size());
    return read_outside_run(*source, origin, files, warnings, [&](const FrameRecord& record) {
      progress.advance(std::string(to_string(record.status)));
      throw_if_interrupted(stopped);
    });
  }();
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
  throw_if_interrupted(stopped);
  throw_if_among_data(arguments.out, {arguments.sequence});
  prepare_run_folder(arguments.out, arguments.force);
  write_outside_run(arguments.out, run, *source);
  RunReport report = report_on(run.run, *source);
  report.method = run.outside, report.odometry = "its own";
  fmt::print("{}  written to    {}\n", to_text(report), arguments.out);
}

}  // namespace

void add_import_command(CLI::App& app) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand(
      "import",
      "Write another program's run as a run's folder, which `view`, `report` and `figures` open: a "
      "trajectory, or a folder of one with masks and features.csv");
  command->add_option("SEQUENCE", arguments->sequence, kSequenceHelp)->required();
  command->add_option("RUN", arguments->run, "NAME=FILE or NAME=FOLDER, or either alone")->required();
  command->add_option("--out", arguments->out, "Folder to write")->required();
  command->add_flag("--force", arguments->force, "Overwrite an earlier run in that folder");
  command
      ->add_option("--quaternion", arguments->quaternion, "Order of its quaternions, where no header tells")
      ->check(CLI::IsMember({"xyzw", "wxyz"}));
  command->add_option(
      "--estimate", arguments->convention,
      "What its poses mean: as-written, inverse, w-first, mirrored-x, mirrored-y, mirrored-z, "
      "opengl, bonn");
  command->add_option("--time-offset", arguments->time_offset_s, "Added to its stamps [s]")
      ->check(number_between(-1e10, 1e10));
  arguments->frames.add_to(*command);
  command->callback([arguments] { import(*arguments); });
}

}  // namespace stillpoint
