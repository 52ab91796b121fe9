#include "app/commands.hpp"

namespace stillpoint {

void add_commands(CLI::App& app) {
  add_evaluate(app);
}

}  // namespace stillpoint
