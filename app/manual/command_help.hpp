#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace stillpoint {

// The commands as `--help` describes them, as data: what man pages and completions are made of.

/// An option, or a positional argument.
struct OptionHelp {
  std::vector<std::string> names;    ///< "-h", "--help"; of a positional, "SEQUENCE"
  std::string value;                 ///< what it takes: "TEXT", "INT"; empty for flags
  std::string range;                 ///< "1 - 64"; empty where there is none
  std::vector<std::string> choices;  ///< the values it may have; empty where these are not listed
  std::string what;                  ///< its help
  std::string otherwise;             ///< its value where none is given; empty where that is not said
  bool positional = false, required = false, repeats = false;
};

struct CommandHelp {
  std::string name;  ///< "run"; "stillpoint" for the program itself
  std::string what;
  std::vector<OptionHelp> options;
};

/// The program itself, and its commands in the order of its help.
struct ProgramHelp {
  CommandHelp itself;
  std::vector<CommandHelp> commands;
};

[[nodiscard]] ProgramHelp help_of(const CLI::App& program);

/// A man page's name and its text in roff.
struct TextFile {
  std::string name, text;
};

/// `stillpoint.1`, and `stillpoint-NAME.1` for each command.
[[nodiscard]] std::vector<TextFile> man_pages(const ProgramHelp& program, const std::string& version);

/// Completions as the shells look for them: `stillpoint` for bash, `_stillpoint` for zsh, `stillpoint.fish`.
[[nodiscard]] std::vector<TextFile> completions(const ProgramHelp& program);

}  // namespace stillpoint
