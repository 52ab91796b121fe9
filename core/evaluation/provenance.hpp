#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace stillpoint {

/// What results were made by. Every file that says so, a benchmark's results, a plan, a cell's record, has
/// these keys, or some of them: program, commit, machine, date, command.
struct Provenance {
  std::string version{}, commit{};  ///< of the program
  std::string machine{};            ///< processor and number of cores
  std::string date{};               ///< of its end, YYYY-MM-DD
  std::string command{};            ///< what was typed
};

/// A version as files have it under `program`.
[[nodiscard]] inline std::string program_text(const std::string& version) { return "stillpoint " + version; }

/// Reads what a file was made by; Json is either of nlohmann's.
/// @param keys that this kind of file has; the rest stays empty
/// @throws nlohmann::json::exception where one of them is missing or no text
template <typename Json>
[[nodiscard]] Provenance read_provenance(const Json& json,
                                         std::initializer_list<std::string_view> keys = {
                                             "program", "commit", "machine", "date", "command"}) {
  Provenance made;
  for (const std::string_view key : keys) {
    const auto text = json.at(std::string(key)).template get<std::string>();
    const std::string name = program_text("");
    if (key == "program")
      made.version = text.starts_with(name) ? text.substr(name.size()) : text;
    else
      (key == "commit"    ? made.commit
       : key == "machine" ? made.machine
       : key == "date"    ? made.date
                          : made.command) = text;
  }
  return made;
}

}  // namespace stillpoint
