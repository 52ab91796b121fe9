#pragma once

#include <string>

#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {

/// The hash of a sequence's run by the default config on two threads.
inline std::string hash_of_run(const FrameSource& source) {
  Config config;
  config.run.threads = 2;
  return run_hash(run_sequence(source, config).records);
}

}  // namespace stillpoint
