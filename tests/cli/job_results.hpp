#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

/// Results of a benchmark or an ablation, but for times and for what was typed: they are the same whoever ran
/// them.
inline std::string results_but_times(const TemporaryFolder& folder, const std::string& file) {
  auto json = nlohmann::ordered_json::parse(folder.read(file), nullptr, false);
  if (json.is_discarded()) return file + " is no JSON";
  json.erase("command");
  const auto strip = [](nlohmann::ordered_json& runs) {
    for (auto& run : runs)
      for (const char* time : {"median_ms", "p99_ms", "orb_units"}) run.erase(time);
  };
  if (json.contains("runs")) strip(json["runs"]);
  if (json.contains("variants"))
    for (auto& variant : json["variants"]) strip(variant["runs"]);
  return json.dump(1);
}

/// How many of a folder's files have that extension.
inline int files_that_end(const std::string& folder, const std::string& extension) {
  int count = 0;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    count += entry.path().extension() == extension ? 1 : 0;
  return count;
}

}  // namespace stillpoint
