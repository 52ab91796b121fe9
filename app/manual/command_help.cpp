#include "app/manual/command_help.hpp"

#include <algorithm>
#include <regex>

namespace stillpoint {
namespace {

/// "a, b, c" or "a,b,c" in its parts.
std::vector<std::string> parts_of(const std::string& list) {
  static const std::regex comma(", ?");
  return {std::sregex_token_iterator(list.begin(), list.end(), comma, -1), {}};
}

/// What a help ends with after a colon, where that is a list of words: "Which engine …: features, bamvo,
/// dso".
std::vector<std::string> choices_in(const std::string& help) {
  static const std::regex words(".*: ([a-z0-9_-]+(, [a-z0-9_-]+)+)");
  std::smatch match;
  return std::regex_match(help, match, words) ? parts_of(match[1]) : std::vector<std::string>{};
}

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp help;
  help.what = option.get_description();
  help.positional = option.get_positional();
  if (help.positional) {
    help.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) help.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) help.names.push_back("--" + name);
  }
  help.required = option.get_required();
  help.otherwise = option.get_default_str();
  help.repeats = option.get_items_expected_max() > 1;
  if (option.get_items_expected_max() == 0) return help;
  // "TEXT:{evo,tum}", "INT:INT in [1 - 64]"
  const std::string type = option.get_type_name();
  help.value = type.substr(0, type.find(':'));
  std::smatch match;
  if (static const std::regex set(".*\\{(.*)\\}"); std::regex_match(type, match, set))
    help.choices = parts_of(match[1]);
  else if (static const std::regex range(".*\\[(.*)\\]"); std::regex_match(type, match, range))
    help.range = match[1];
  if (help.choices.empty()) help.choices = choices_in(help.what);
  return help;
}

CommandHelp command_help_of(const CLI::App& command) {
  CommandHelp help{command.get_name(), command.get_description(), {}};
  for (const CLI::Option* option : command.get_options())
    if (!option->get_group().empty()) help.options.push_back(help_of(*option));
  std::stable_partition(help.options.begin(), help.options.end(),
                        [](const OptionHelp& option) { return option.positional; });
  return help;
}

}  // namespace

ProgramHelp help_of(const CLI::App& program) {
  ProgramHelp help{command_help_of(program), {}};
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    help.commands.push_back(command_help_of(*command));
  return help;
}

}  // namespace stillpoint
