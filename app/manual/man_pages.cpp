#include <fmt/format.h>

#include <cctype>

#include "app/manual/command_help.hpp"

namespace stillpoint {
namespace {

/// A text as roff reads it as itself.
std::string roff(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    if (letter == '\\')
      out += "\\e";
    else if (letter == '-')
      out += "\\-";
    else if (letter == '\'')
      out += "\\(aq";
    else if (letter == '`')
      out += "\\(ga";
    else if (letter == '^')
      out += "\\(ha";
    else if (letter == '~')
      out += "\\(ti";
    else
      out += letter;
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string upper(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return text;
}

std::string heading(const std::string& page, const std::string& version) {
  return fmt::format(".TH {} 1 \"\" \"stillpoint {}\" \"User Commands\"\n", upper(roff(page)), version);
}

/// "\-\-out TEXT" in the fonts of man pages.
std::string term(const OptionHelp& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += fmt::format("{}\\f{}{}\\fR", text.empty() ? "" : ", ", option.positional ? 'I' : 'B', roff(name));
  if (!option.positional && !option.value.empty()) text += fmt::format(" \\fI{}\\fR", option.value);
  return text;
}

std::string entry(const OptionHelp& option) {
  std::string text = fmt::format(".TP\n{}\n{}.\n", term(option), roff(option.what));
  if (!option.range.empty()) text += fmt::format("Range: {}.\n", roff(option.range));
  if (!option.otherwise.empty()) text += fmt::format("Without it: {}.\n", roff(option.otherwise));
  return text;
}

std::string entries(const CommandHelp& command, bool positional, const char* title) {
  std::string text;
  for (const OptionHelp& option : command.options)
    if (option.positional == positional) text += entry(option);
  return text.empty() ? text : fmt::format(".SH {}\n{}", title, text);
}

std::string synopsis(const CommandHelp& command) {
  std::string text = fmt::format(".SH SYNOPSIS\n\\fBstillpoint {}\\fR [\\fIOPTIONS\\fR]", roff(command.name));
  for (const OptionHelp& option : command.options) {
    if (!option.positional) continue;
    const std::string name = fmt::format("\\fI{}\\fR{}", roff(option.names[0]), option.repeats ? "..." : "");
    text += option.required ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

std::string command_page(const CommandHelp& command, const std::string& version) {
  const std::string page = "stillpoint-" + command.name;
  return heading(page, version) + fmt::format(".SH NAME\n{} \\- {}\n", roff(page), roff(command.what)) +
         synopsis(command) + entries(command, true, "ARGUMENTS") + entries(command, false, "OPTIONS") +
         ".SH \"SEE ALSO\"\n.BR stillpoint (1)\n";
}

std::string program_page(const ProgramHelp& program, const std::string& version) {
  const std::string& what = program.itself.what;  // "Stillpoint: a visual debugger …"
  const std::size_t colon = what.find(": ");
  std::string text = heading("stillpoint", version);
  text += fmt::format(".SH NAME\nstillpoint \\- {}\n",
                      roff(colon == std::string::npos ? what : what.substr(colon + 2)));
  text += ".SH SYNOPSIS\n\\fBstillpoint\\fR [\\fIOPTIONS\\fR] [\\fICOMMAND\\fR ...]\n";
  text += entries(program.itself, false, "OPTIONS") + ".SH COMMANDS\n";
  for (const CommandHelp& command : program.commands)
    text += fmt::format(".TP\n.BR stillpoint\\-{} (1)\n{}.\n", roff(command.name), roff(command.what));
  return text;
}

}  // namespace

std::vector<TextFile> man_pages(const ProgramHelp& program, const std::string& version) {
  std::vector<TextFile> pages = {{"stillpoint.1", program_page(program, version)}};
  for (const CommandHelp& command : program.commands)
    pages.push_back({fmt::format("stillpoint-{}.1", command.name), command_page(command, version)});
  return pages;
}

}  // namespace stillpoint
