#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/manual/command_help.hpp"

namespace stillpoint {
namespace {

/// A text with a backslash before each of `letters`.
std::string escaped(const std::string& text, const std::string& letters) {
  std::string out;
  for (const char letter : text) {
    if (letters.find(letter) != std::string::npos) out += '\\';
    out += letter;
  }
  return out;
}

/// In single quotes, as bash and zsh read them.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char letter : text) out += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return out + "'";
}

std::string option_names(const CommandHelp& command) {
  std::string names;
  for (const OptionHelp& option : command.options)
    if (!option.positional) names += fmt::format(" {}", fmt::join(option.names, " "));
  return names.empty() ? names : names.substr(1);
}

// bash: what follows an option that takes a value, then the options, else files, which `complete` falls back
// on.

std::string bash_values(const CommandHelp& command) {
  std::string with_files, text;
  for (const OptionHelp& option : command.options) {
    if (option.positional || option.value.empty()) continue;
    for (const std::string& name : option.names) {
      const std::string when = fmt::format("'{} {}'", command.name, name);
      if (option.choices.empty())
        with_files += (with_files.empty() ? "" : " | ") + when;
      else
        text += fmt::format("    {}) words={} ;;\n", when,
                            quoted(fmt::format("{}", fmt::join(option.choices, " "))));
    }
  }
  return with_files.empty() ? text : text + fmt::format("    {}) return ;;\n", with_files);
}

std::string bash(const ProgramHelp& program) {
  std::string values, options, names;
  for (const CommandHelp& command : program.commands) {
    values += bash_values(command);
    options += fmt::format("      {}) words={} ;;\n", command.name, quoted(option_names(command)));
    names += command.name + " ";
  }
  return fmt::format(R"(# Completion of stillpoint's commands for bash; `stillpoint manual` writes it.
_stillpoint() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command=${{COMP_WORDS[1]}} words=
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '{}{}' -- "$current")
    return
  fi
  case "$command $before" in
{}  esac
  if [[ -z $words && $current == -* ]]; then
    case $command in
{}    esac
  fi
  [[ -z $words ]] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o default -F _stillpoint stillpoint
)",
                     names, option_names(program.itself), values, options);
}

// zsh: a specification of _arguments a name.

std::string zsh_spec(const OptionHelp& option) {
  const std::string action =
      option.choices.empty() ? "_files" : fmt::format("({})", fmt::join(option.choices, " "));
  const std::string what = escaped(option.what, "[]:\\");
  if (option.positional)
    return fmt::format("      {} \\\n",
                       quoted(fmt::format("{}:{}:{}", option.repeats ? "*" : "", option.names[0], action)));
  std::string text;
  for (const std::string& name : option.names) {
    const std::string value = option.value.empty() ? "" : fmt::format(":{}:{}", option.value, action);
    text += fmt::format("      {} \\\n",
                        quoted(fmt::format("{}{}[{}]{}", option.repeats ? "*" : "", name, what, value)));
  }
  return text;
}

std::string zsh_specs(const CommandHelp& command) {
  std::string text;
  for (const OptionHelp& option : command.options) text += zsh_spec(option);
  return text.substr(0, text.rfind(" \\"));
}

std::string zsh(const ProgramHelp& program) {
  std::string names, cases;
  for (const CommandHelp& command : program.commands) {
    names +=
        fmt::format("    {}\n", quoted(fmt::format("{}:{}", command.name, escaped(command.what, ":\\"))));
    cases += fmt::format("    {}) _arguments \\\n{} ;;\n", command.name, zsh_specs(command));
  }
  return fmt::format(R"(#compdef stillpoint
# Completion of stillpoint's commands for zsh; `stillpoint manual` writes it.
local -a commands=(
{})
if ((CURRENT == 2)); then
  _describe -t commands 'command' commands
  _arguments \
{}
  return
fi
shift words
((CURRENT--))
case $words[1] in
{}esac
)",
                     names, zsh_specs(program.itself), cases);
}

// fish: a line an option.

std::string fish_line(const CommandHelp& command, const OptionHelp& option) {
  std::string text = fmt::format("complete -c stillpoint -n '__fish_seen_subcommand_from {}'", command.name);
  for (const std::string& name : option.names)
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.choices.empty())
    text += fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
  else if (!option.value.empty())
    text += " -r";
  return text + fmt::format(" -d '{}'\n", escaped(option.what, "'\\"));
}

std::string fish(const ProgramHelp& program) {
  std::string text = "# Completion of stillpoint's commands for fish; `stillpoint manual` writes it.\n";
  for (const CommandHelp& command : program.commands)
    text += fmt::format("complete -c stillpoint -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        escaped(command.what, "'\\"));
  for (const CommandHelp& command : program.commands)
    for (const OptionHelp& option : command.options)
      if (!option.positional) text += fish_line(command, option);
  return text;
}

}  // namespace

std::vector<TextFile> completions(const ProgramHelp& program) {
  return {{"stillpoint", bash(program)}, {"_stillpoint", zsh(program)}, {"stillpoint.fish", fish(program)}};
}

}  // namespace stillpoint
