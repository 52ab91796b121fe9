#include "app/commands.hpp"

namespace stillpoint {

void add_commands(CLI::App& app) {
  (void)app;
}

}  // namespace stillpoint
