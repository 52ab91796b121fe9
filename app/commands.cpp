#include "app/commands.hpp"

namespace stillpoint {

void add_commands(CLI::App& app) {
  add_run_command(app);
  add_evaluate_command(app);
  add_check_command(app);
  add_benchmark_command(app);
  add_tables_command(app);
  add_ablate_command(app);
  add_sweep_command(app);
  add_generate_command(app);
  add_motion_command(app);
  add_snapshot_command(app);
  add_figures_command(app);
  add_report_command(app);
  add_view_command(app);
  add_export_command(app);
  add_import_command(app);
  add_outline_command(app);
  add_replay_command(app);
  add_config_command(app);
  add_manual_command(app);
}

}  // namespace stillpoint
