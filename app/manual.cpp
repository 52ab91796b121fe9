#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/commands.hpp"
#include "app/manual/command_help.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/version.hpp"

namespace stillpoint {
namespace {

struct ManualArguments {
  std::string man, completions;
};

void write_all(const std::string& folder, const std::vector<TextFile>& files) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: cannot be made ({})", folder, error.message()));
  for (const auto& [name, text] : files) write_text_file(std::filesystem::path(folder) / name, text);
  fmt::print("{} written to {}\n", counted(files.size(), "file"), folder);
}

}  // namespace

void add_manual_command(CLI::App& app) {
  const auto arguments = std::make_shared<ManualArguments>();
  CLI::App* command =
      app.add_subcommand("manual", "Write what --help tells as man pages, and as completions for shells");
  command->add_option("--man", arguments->man, "Folder for a man page a command");
  command->add_option("--completions", arguments->completions,
                      "Folder for the completions: stillpoint (bash), _stillpoint (zsh), stillpoint.fish");
  command->callback([arguments, &app] {
    if (arguments->man.empty() && arguments->completions.empty())
      throw CLI::RequiredError("--man or --completions");
    const ProgramHelp help = help_of(app);
    if (!arguments->man.empty()) write_all(arguments->man, man_pages(help, STILLPOINT_VERSION));
    if (!arguments->completions.empty()) write_all(arguments->completions, completions(help));
  });
}

}  // namespace stillpoint
