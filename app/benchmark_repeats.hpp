#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// `benchmark --repeat N`: every cell N times, each a little perturbed.
struct RepeatPlan {
  std::vector<const FrameSource*> sources;
  std::vector<std::string> methods, engines;
  Config config;
  int repeats = 9, frames = 0;  ///< frames of the sequence, 0 = all
  std::string out;              ///< folder, made already; empty = none
};

/// Runs the plan, prints median and spread, and writes them as Markdown, CSV, JSON and LaTeX where a folder
/// is given, after each sequence.
/// @throws Interrupted once what was finished is written
void benchmark_repeats(const RepeatPlan& plan);

}  // namespace stillpoint
