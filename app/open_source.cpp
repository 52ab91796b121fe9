#include "app/open_source.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>

#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/open_run.hpp"
#include "core/run/outside_run.hpp"
#include "core/sequence/fingerprint.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A run's records, with what they lack told.
RecordedRun read_run_records(const fs::path& folder) {
  throw_if_no_records(folder);
  RecordedRun run = read_records(folder);
  warn_once(run.cut_short);
  return run;
}

/// A run of the same sequence to stand beside `run`.
/// @throws InputError for one that was named and is of another sequence
std::shared_ptr<const RecordedRun> baseline_beside(const SourceArguments& arguments, const RecordedRun& run) {
  if (!arguments.baseline.empty()) {
    auto named = std::make_shared<const RecordedRun>(read_run_records(arguments.baseline));
    if (named->origin.fingerprint != run.origin.fingerprint)
      throw InputError(fmt::format("--baseline {}: is a run of {}, and {} is one of {}, not the same frames",
                                   arguments.baseline, named->origin.name, arguments.place, run.origin.name));
    return named;
  }
  if (method_of(run.run.config).baseline) return nullptr;
  const fs::path beside =
      (fs::path(arguments.place) / "." / "..").lexically_normal() / baseline_method().name;
  try {
    if (!is_run_folder(beside)) return nullptr;
    auto found = std::make_shared<const RecordedRun>(read_records(beside));
    if (found->origin.fingerprint == run.origin.fingerprint && method_of(found->run.config).baseline) {
      warn_once(found->cut_short);
      return found;
    }
  } catch (const InputError&) {  // nobody asked for it
  }
  return nullptr;
}

OpenedSource open_finished_run(const SourceArguments& arguments) {
  if (arguments.config.given() || arguments.source.given())
    throw InputError(
        fmt::format("{}: is a finished run, which has its own configuration and frames; options that "
                    "change them go with its sequence",
                    arguments.place));
  const OpenedRun run = open_run_and_tell(arguments.place, arguments.sequence);
  if (run.recorded->run.records.empty())
    throw InputError(fmt::format("{}: is a run without frames", arguments.place));
  OpenedSource opened;
  opened.source = run.source;
  opened.frames = static_cast<int>(run.recorded->run.records.size());
  opened.config = run.recorded->run.config;
  if (arguments.config.threads > 0) opened.config.run.threads = arguments.config.threads;
  opened.options.recorded = run.recorded;
  opened.options.recorded_baseline = baseline_beside(arguments, *run.recorded);
  opened.options.no_images = run.no_images;
  opened.problem = run.no_images.empty() ? run.recorded->cut_short : run.no_images;
  return opened;
}

OpenedSource open_sequence_at(const std::string& where, const SequenceArguments& source, Config config) {
  OpenedSource opened;
  opened.config = std::move(config);
  opened.source = source.open(where, opened.config);
  opened.frames = opened.source->size();
  if (!opened.source->warnings().empty()) opened.problem = opened.source->warnings().front();
  return opened;
}

}  // namespace

void warn_once(const std::string& sentence) {
  static std::set<std::string> told;
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (!sentence.empty() && told.insert(sentence).second)
    std::fprintf(stderr, "stillpoint: warning: %s\n", sentence.c_str());
}

OpenedRun open_run_and_tell(const fs::path& folder, const std::string& sequence) {
  OpenedRun opened = open_run(folder, sequence);
  warn_once(opened.recorded->cut_short);
  return opened;
}

void SourceArguments::add_to(CLI::App& command) {
  command.add_option("--baseline", baseline,
                     "Of a finished run: another run's folder to compare with; otherwise the folder none "
                     "beside it, where there is one");
  command.add_option("--run", runs,
                     "Another program's run to stand beside: NAME=FILE, a trajectory or a folder of one with "
                     "masks and features.csv, or a finished run's folder; may be given again");
  command.add_option("--sequence", sequence, "Of a finished run: where its sequence lies now");
}

namespace {

/// Other programs' runs, laid onto the frames that were opened.
void stand_beside(const SourceArguments& arguments, OpenedSource& opened) {
  for (const std::string& text : arguments.runs) {
    const OutsideRunFiles files = outside_run_argument(text);
    std::vector<std::string> warnings;
    auto run = std::make_shared<RecordedRun>(
        is_run_folder(files.where) ? read_run_records(files.where)
                                   : read_outside_run(*opened.source, {}, files, warnings,
                                                      [](const auto&) { throw_if_interrupted(); }));
    if (is_run_folder(files.where) && run->origin.fingerprint != sequence_fingerprint(*opened.source))
      throw InputError(
          fmt::format("--run {}: is a run of {}, not of the frames opened", text, run->origin.name));
    if (text != files.where) run->called = files.name;
    opened.options.beside.push_back(std::move(run));
    for (const std::string& warning : warnings)
      std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
  }
}

}  // namespace

OpenedSource open_source(const SourceArguments& arguments) {
  if (is_run_folder(arguments.place)) {
    OpenedSource opened = open_finished_run(arguments);
    stand_beside(arguments, opened);
    return opened;
  }
  for (const auto& [option, value] :
       {std::pair("--baseline", arguments.baseline), std::pair("--sequence", arguments.sequence)})
    if (!value.empty())
      throw InputError(
          fmt::format("{}: goes with a finished run's folder, and {} is none", option, arguments.place));
  OpenedSource opened = open_sequence_at(arguments.place, arguments.source, arguments.config.config());
  stand_beside(arguments, opened);
  return opened;
}

std::vector<std::string> SourceArguments::words() const {
  std::vector<std::string> words = source.words();
  for (const std::string& run : runs) {
    const OutsideRunFiles files = outside_run_argument(run);
    words.push_back(
        fmt::format("run={}={}", files.name, fs::absolute(files.where).lexically_normal().string()));
  }
  return words;
}

OpenedSource open_source_as(const std::string& where, const std::vector<std::string>& reading,
                            const Config& config) {
  constexpr std::string_view kRun = "run=";
  SourceArguments arguments;
  arguments.place = where;
  for (const std::string& word : reading)
    if (word.starts_with(kRun)) arguments.runs.push_back(word.substr(kRun.size()));
  OpenedSource opened = is_run_folder(where)
                            ? open_finished_run(arguments)
                            : open_sequence_at(where, SequenceArguments::from_words(reading), config);
  const std::vector<std::string> runs = std::exchange(arguments.runs, {});
  for (const std::string& run : runs) {
    arguments.runs = {run};
    try {
      stand_beside(arguments, opened);
    } catch (const InputError& error) {
      opened.runs_missing.emplace_back(error.what());
    }
  }
  return opened;
}

}  // namespace stillpoint
