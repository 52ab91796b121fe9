#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/run/ablation.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct AblateArguments {
  std::vector<std::string> sequences, without;
  std::string out;
  bool force = false;
  ConfigArguments config;
  SequenceArguments frames;
};

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

std::vector<std::unique_ptr<FrameSource>> open_all(const AblateArguments& arguments, const Config& config) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (const std::string& sequence : expanded_sequences(arguments.sequences))
    sources.push_back(arguments.frames.open(sequence, config, {.depth = true, .questioned = true}));
  return sources;
}

AblationCell run_variant(const FrameSource& source, const Config& config, int frames, const std::string& name,
                         bool& interrupted) {
  RunOptions options;
  options.count = frames;
  options.stop = &stop_requested();
  const int total = frames > 0 ? std::min(frames, source.size()) : source.size();
  Progress progress(fmt::format("{} ({})", source.name(), name), total);
  options.on_frame = [&progress](const FrameResult& frame) {
    progress.advance(std::string(to_string(frame.record.status)));
  };
  const RunResult result = run_sequence(source, config, options);
  interrupted = result.interrupted;
  return ablation_cell(report_on(result, source));
}

void write_results(const fs::path& folder, const std::string& method, const std::vector<AblationRow>& rows,
                   const std::vector<std::string>& names) {
  write_text_file(folder / "ablation.md", to_markdown(ablation_summary(method, rows, names)) + "\n" +
                                              to_markdown(ablation_errors(rows, names)));
  write_text_file(folder / "ablation.csv", to_csv(ablation_list(rows, names)));
  write_text_file(folder / "ablation.json", ablation_json(method, rows, names).dump(1) + "\n");
}

void ablate(const AblateArguments& arguments) {
  const Config config = arguments.config.config();
  const std::string& method = config.run.method;
  const std::vector<std::optional<Ingredient>> variants = variants_of(arguments, method_of(config));
  const auto sources = open_all(arguments, config);
  if (!arguments.out.empty()) prepare_out_folder(arguments.out, {"ablation.csv"}, arguments.force);
  std::vector<AblationRow> rows;
  for (const auto& variant : variants)
    rows.push_back(
        {variant ? variant->name : "", variant ? variant->assignments : std::vector<std::string>{}, {}});

  std::vector<std::string> names;
  for (const auto& source : sources) {
    // A sequence counts when all variants have run on it.
    std::vector<AblationCell> cells;
    bool interrupted = false;
    for (const auto& variant : variants) {
      const std::string name = variant ? "without " + variant->name : "whole method";
      cells.push_back(run_variant(*source, ablated(config, variant ? &*variant : nullptr),
                                  arguments.frames.frames, name, interrupted));
      if (interrupted) break;
    }
    if (interrupted) break;
    names.push_back(source->name());
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].cells.push_back(cells[i]);
    if (!arguments.out.empty()) write_results(arguments.out, method, rows, names);
  }
  fmt::print(
      "Method {}, one ingredient left out at a time. Changes are against the whole method; RPE is "
      "translational, over 1 s, its mean change the geometric mean over the sequences.\n\n{}\n{}",
      method, to_markdown(ablation_summary(method, rows, names)), to_markdown(ablation_errors(rows, names)));
  if (stop_requested()) fmt::print("\nstopped early; the tables hold the sequences that were finished\n");
  throw_if_interrupted();
}

}  // namespace

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
  arguments->config.add_to(*command, true);
  arguments->frames.add_to(*command);
  command->callback([arguments] { ablate(*arguments); });
}

}  // namespace stillpoint
