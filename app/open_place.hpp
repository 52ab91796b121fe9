#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/arguments.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {

/// The options of commands that look at a sequence or at a finished run.
struct PlaceArguments {
  std::string place;     ///< a sequence, or a run's folder
  std::string baseline;  ///< a run's folder; empty = the one of method none beside it, where there is one
  std::string sequence;  ///< where a run's sequence lies now; empty = where it lay
  ConfigArguments config;
  SequenceArguments source;

  /// Adds --baseline and --sequence; the rest is the command's.
  void add_to(CLI::App& command);
};

/// A sequence or a finished run, ready for a Session.
struct OpenedPlace {
  std::shared_ptr<const FrameSource> source;
  Config config;
  SessionOptions options;  ///< with the finished run and its baseline in it
  std::string problem;  ///< what is missing though it could be opened, one sentence; empty when all is well
};

/// @throws InputError in one sentence for what cannot be opened, and for options that a finished run, which
/// has its own, does not take
[[nodiscard]] OpenedPlace open_place(const PlaceArguments& arguments);

}  // namespace stillpoint
