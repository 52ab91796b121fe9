#pragma once

#include <CLI/CLI.hpp>

namespace stillpoint {

// Each subcommand lives in a file of its own and adds itself: its options, its help and its callback. A
// callback throws InputError for bad input; main() reports it and sets the exit status.

/// Thrown by a callback that has said all there is to say, to end the program with a status of its own.
struct ExitStatus {
  int status = 0;
};

/// All of them, in the order the help lists them.
void add_commands(CLI::App& app);

void add_run_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_benchmark_command(CLI::App& app);
void add_tables_command(CLI::App& app);
void add_ablate_command(CLI::App& app);
void add_sweep_command(CLI::App& app);
void add_generate_command(CLI::App& app);
void add_motion_command(CLI::App& app);
void add_snapshot_command(CLI::App& app);
void add_figures_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_view_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_import_command(CLI::App& app);
void add_outline_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_config_command(CLI::App& app);
void add_manual_command(CLI::App& app);

/// Opens the window on the generated demo: what `stillpoint` alone does.
void view_demo();

}  // namespace stillpoint
