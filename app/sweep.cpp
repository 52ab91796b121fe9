#include "core/run/sweep.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

struct SweepArguments {
  std::vector<std::string> sequences;
  std::string parameter, out;
  bool force = false;
  ConfigArguments config;
  SequenceArguments frames;
};

/// What each sequence gave so far, as tables and for programs.
struct SweepResults {
  Provenance made = made_here();
  std::string markdown;
  Table list{{"sequence", "parameter", "value", "rpe_m", "iou", "coverage", "median_ms", "run_hash", "ate_m",
              "rpe_frame_m", "doubt", "pairs"},
             {}};
  nlohmann::ordered_json json = nlohmann::ordered_json::array();

  void add(const std::string& sequence, const SweepRange& range, const std::vector<SweepPoint>& points) {
    markdown += fmt::format("{}{}:\n\n{}", markdown.empty() ? "" : "\n", sequence,
                            to_markdown(sweep_table(range, points)));
    if (const auto best = best_of(points))
      markdown += fmt::format("\nleast RPE at {} = {:.6g}\n", range.parameter, points[*best].value);
    if (const std::string notes = notes_text(notes_on(range, points)); !notes.empty())
      markdown += "\n" + notes;
    json.push_back(sweep_json(sequence, range, points));
    json.back().update(to_json(made));
    const auto number = [](const std::optional<double>& value) {
      return value ? fmt::format("{}", *value) : std::string();
    };
    for (const SweepPoint& point : points)
      list.rows.push_back(
          {sequence, range.parameter, fmt::format("{}", point.value), number(point.reached.rpe_m),
           number(point.reached.mask_iou), fmt::format("{}", point.reached.coverage),
           fmt::format("{:.3f}", point.reached.median_ms), point.reached.hash, number(point.reached.ate_m),
           number(point.reached.rpe_frame_m), point.reached.doubt, fmt::format("{}", point.reached.pairs)});
  }

  void write(const std::filesystem::path& folder) const {
    write_text_file(folder / "sweep.md", markdown);
    write_text_file(folder / "sweep.csv", to_csv(list));
    write_text_file(folder / "sweep.json", json.dump(1) + "\n");
  }
};

void sweep(const SweepArguments& arguments) {
  const NewFolders made(arguments.out);
  const Config config = arguments.config.config();
  const SweepRange range = arguments.parameter.find('=') == std::string::npos
                               ? usual_sweep(config, arguments.parameter)
                               : sweep_range(arguments.parameter);
  const std::vector<double> values = sweep_values(config, range);
  for (const std::string& remark : sweep_remarks(config, range, values))
    std::fprintf(stderr, "stillpoint: warning: %s\n", remark.c_str());
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (const std::string& sequence : expanded_sequences(arguments.sequences))
    sources.push_back(arguments.frames.open(
        sequence, config, {.depth = true, .oracle = method_of(config).needs.true_mask, .questioned = true}));
  throw_if_among_data(arguments.out, arguments.sequences);
  if (!arguments.out.empty()) prepare_out_folder(arguments.out, {"sweep.csv"}, arguments.force);
  SweepResults results;
  for (const auto& source : sources) {
    std::vector<SweepPoint> points;
    const int frames = arguments.frames.frames;
    for (const double value : values) {
      Progress progress(fmt::format("{} ({} = {:.6g})", source->name(), range.parameter, value),
                        frames_of(*source, frames));
      auto point = sweep_point(*source, config, range.parameter, value, frames, &stop_requested(),
                               [&progress](const FrameResult& frame) {
                                 progress.advance(std::string(to_string(frame.record.status)));
                               });
      if (!point) break;
      points.push_back(std::move(*point));
    }
    if (!points.empty()) results.add(source->name(), range, points);
    if (!arguments.out.empty() && !points.empty()) results.write(arguments.out);
    if (stop_requested()) break;
  }
  fmt::print(
      "Method {}, one run a value; `benchmark --repeat` tells how far runs scatter by themselves.\n\n{}",
      config.run.method, results.markdown);
  throw_if_interrupted("stopped early; the tables hold the values that were finished");
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  const auto arguments = std::make_shared<SweepArguments>();
  CLI::App* command =
      app.add_subcommand("sweep", "Run sequences at several values of one parameter, and compare");
  command->add_option("SEQUENCES", arguments->sequences, kSequencesHelp)->required();
  command
      ->add_option("--parameter", arguments->parameter,
                   "Which, and from where to where: section.name=LOW:HIGH or …=LOW:HIGH:STEPS (7 otherwise); "
                   "section.name alone: around its value")
      ->required();
  command->add_option("--out", arguments->out, "Folder for the tables, as Markdown, CSV and JSON");
  command->add_flag("--force", arguments->force, "Overwrite earlier tables in that folder");
  arguments->config.add_to(*command, true);
  arguments->frames.add_to(*command);
  command->callback([arguments] { sweep(*arguments); });
}

}  // namespace stillpoint
