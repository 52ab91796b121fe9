#include <fmt/format.h>

#include <memory>

#include "app/arguments.hpp"
#include "app/commands.hpp"

namespace stillpoint {

void add_config_command(CLI::App& app) {
  const auto arguments = std::make_shared<ConfigArguments>();
  CLI::App* command = app.add_subcommand(
      "config", "Print every parameter as TOML, with its unit and meaning: a start for a file of one's own");
  arguments->add_to(*command, true);
  command->callback([arguments] { fmt::print("{}", to_toml(arguments->config())); });
}

}  // namespace stillpoint
