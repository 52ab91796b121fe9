#pragma once

#include <string>
#include <vector>

#include "app/report/report_run.hpp"

namespace stillpoint {

// The parts of a report that are text: HTML, all of it escaped.

/// What the page is about, and what its figures mean.
[[nodiscard]] std::string introduction(const std::vector<ReportGroup>& groups);

/// All runs of a sequence side by side.
[[nodiscard]] std::string summary_table(const ReportGroup& group, int worst);

/// What each stage takes, as bars and in figures.
[[nodiscard]] std::string stage_timings(const ReportGroup& group);

/// What differs from the defaults or between the runs, and each run's whole configuration.
[[nodiscard]] std::string configurations(const std::vector<ReportGroup>& groups);

}  // namespace stillpoint
