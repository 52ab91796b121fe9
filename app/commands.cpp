#include "app/commands.hpp"

namespace stillpoint {

void add_commands(CLI::App& app) {
  add_motion_command(app);
  add_evaluate_command(app);
}

}  // namespace stillpoint
