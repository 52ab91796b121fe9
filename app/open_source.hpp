#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/arguments.hpp"
#include "core/run/open_run.hpp"
#include "ui/session/opened_source.hpp"

namespace stillpoint {

/// The options of commands that look at a sequence or at a finished run.
struct SourceArguments {
  std::string place;     ///< a sequence, or a run's folder
  std::string baseline;  ///< a run's folder; empty = the one of method none beside it, where there is one
  std::string sequence;  ///< where a run's sequence lies now; empty = where it lay
  std::vector<std::string> runs;  ///< other programs' runs to stand beside, NAME=FILE
  ConfigArguments config;
  SequenceArguments source;

  /// How it is read, as RecentSequence keeps it: SequenceArguments::words(), and "run=NAME=FILE" a run.
  [[nodiscard]] std::vector<std::string> words() const;

  /// Adds --baseline, --sequence and --run; the rest is the command's.
  void add_to(CLI::App& command);
};

/// Warns of it on standard error, where nobody has in this process; empty sentences are none.
void warn_once(const std::string& sentence);

/// open_run, and a warning where its records were cut short: for every command, so that none is silent.
[[nodiscard]] OpenedRun open_run_and_tell(const std::filesystem::path& folder,
                                          const std::string& sequence = "");

/// @throws InputError in one sentence for what cannot be opened, and for options that a finished run, which
/// has its own, does not take
[[nodiscard]] OpenedSource open_source(const SourceArguments& arguments);

/// A finished run with its own config, or a sequence to be run with `config`.
/// @param reading as SourceArguments::words(); a run beside it that is there no more is told as its problem
/// @throws InputError in one sentence for what cannot be opened
[[nodiscard]] OpenedSource open_source_as(const std::string& where, const std::vector<std::string>& reading,
                                          const Config& config);

}  // namespace stillpoint
