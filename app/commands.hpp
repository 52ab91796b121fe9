#pragma once

#include <CLI/CLI.hpp>

namespace stillpoint {

// Each subcommand lives in a file of its own and adds itself: its options, its help and its callback. A callback
// throws InputError for bad input; main() reports it and sets the exit status.

/// All of them, in the order the help lists them.
void add_commands(CLI::App& app);

void add_run_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_benchmark_command(CLI::App& app);
void add_generate_command(CLI::App& app);
void add_motion_command(CLI::App& app);
void add_config_command(CLI::App& app);

}  // namespace stillpoint
