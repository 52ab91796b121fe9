#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/open_source.hpp"
#include "ui/workbench/replay.hpp"

namespace stillpoint {

/// A recording about to be played: read, its sequence opened, its parameters set. `view --replay` plays it in
/// a window, `replay` without a display.
class ReplayPlan {
 public:
  /// @param sequence instead of the one the recording names; empty = that one
  /// @throws InputError for a recording, sequence or parameter that cannot be used
  ReplayPlan(const std::string& file, const std::string& sequence, SequenceArguments source,
             const ConfigArguments& config);

  [[nodiscard]] const RecordingStart& start() const { return recording_.start; }
  [[nodiscard]] Look look() const;
  /// Sets the folder for screenshots and makes it; earlier screenshots there are only overwritten with
  /// `force`.
  void prepare_out(const std::string& folder, bool force);

  /// Plays it and tells on standard output what was done.
  void play(const ReplayShell& shell, std::function<void()> wake);

 private:
  [[nodiscard]] OpenedSource open_untimed(const std::string& where) const;

  Recording recording_;
  SequenceArguments source_arguments_;
  Config config_;
  std::optional<OpenedSource> place_;
  std::string where_;
  std::filesystem::path out_ = ".";
};

}  // namespace stillpoint
