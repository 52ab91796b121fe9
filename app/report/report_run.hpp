#pragma once

#include <string>
#include <vector>

#include "core/run/open_run.hpp"
#include "core/run/run_report.hpp"

namespace stillpoint {

/// A run in a report.
struct ReportRun {
  std::string folder;  ///< as it was named
  std::string label;   ///< what the page calls it: its method and, where not the default, its engine, where
                       ///< that tells it from the others
  OpenedRun opened;
  RunReport report;

  [[nodiscard]] const RecordedRun& recorded() const { return *opened.recorded; }
  [[nodiscard]] const RunResult& result() const { return opened.recorded->run; }
};

/// Runs of one sequence, beside each other.
struct ReportGroup {
  std::string sequence;
  std::vector<ReportRun> runs;
  std::vector<std::string> warnings;

  /// The run of method `none`; null where there is none.
  [[nodiscard]] const ReportRun* baseline() const;
};

/// Opens runs and puts those of the same frames together, in the order they were named.
/// @throws InputError as open_run, and for a folder named twice
[[nodiscard]] std::vector<ReportGroup> open_report_runs(const std::vector<std::string>& folders);

}  // namespace stillpoint
