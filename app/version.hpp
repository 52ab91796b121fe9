#pragma once

#include <string>

#include "core/evaluation/benchmark_results.hpp"

namespace stillpoint {

/// "stillpoint 0.1.0 (commit 0123abcdef)".
[[nodiscard]] std::string version_text();

/// Empty results of a benchmark that say which program made them, on what machine, today, and by what
/// command.
[[nodiscard]] BenchmarkResults made_here();

}  // namespace stillpoint
