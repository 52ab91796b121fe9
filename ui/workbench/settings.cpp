#include "ui/workbench/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/out_folder.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The file's text; nothing when it cannot be read.
std::optional<std::string> read_whole(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) return std::nullopt;
  return text.str();
}

Json to_json(const RunsShown& runs) {
  return {{"pictures", to_string(runs.pictures)}, {"chosen", runs.ticked}, {"left_out", runs.left_out},
          {"flipped_to", runs.flipped_to},        {"hidden", runs.hidden}, {"dividers", runs.dividers}};
}

RunsShown runs_from(const Json& json) {
  RunsShown runs{.pictures = run_pictures(json.value("pictures", "")),
                 .ticked = json.value("chosen", std::vector<std::string>{}),
                 .left_out = json.value("left_out", std::vector<std::string>{}),
                 .flipped_to = json.value("flipped_to", ""),
                 .hidden = json.value("hidden", std::vector<std::string>{}),
                 .dividers = json.value("dividers", std::vector<float>{})};
  // Whoever wrote the file: strips go from left to right.
  const bool in_order = std::is_sorted(runs.dividers.begin(), runs.dividers.end()) &&
                        std::all_of(runs.dividers.begin(), runs.dividers.end(),
                                    [](float share) { return share >= 0.0F && share <= 1.0F; });
  if (!in_order) runs.dividers.clear();
  return runs;
}

Settings from_json(const Json& json, const fs::path& path, const std::vector<std::string>& known) {
  Settings settings;
  settings.look.theme = parse_theme(json.value("theme", "dark"));
  settings.look.scale = std::clamp(json.value("scale", 1.0F), 0.5F, 4.0F);
  for (const Json& one : json.value("recent", Json::array())) {
    // Earlier versions kept the path alone.
    if (one.is_string()) {
      settings.recent.push_back({.where = one.get<std::string>(), .reading = {}, .settings = {}});
      continue;
    }
    settings.recent.push_back({.where = one.at("where").get<std::string>(),
                               .reading = one.value("reading", std::vector<std::string>{}),
                               .settings = one.value("settings", std::vector<std::string>{}),
                               .frame = std::max(one.value("frame", 1), 0)});
    if (one.contains("runs")) settings.recent.back().runs = runs_from(one["runs"]);
    for (const Json& ghost : one.value("ghosts", Json::array()))
      settings.recent.back().ghosts.push_back({ghost.at("name").get<std::string>(),
                                               ghost.value("settings", std::vector<std::string>{}),
                                               std::max(ghost.value("from", 0), 0)});
  }
  if (json.contains("window")) {
    settings.window_size = json["window"].get<std::array<int, 2>>();
    for (int& side : *settings.window_size) side = std::clamp(side, 320, 16384);
  }
  if (json.contains("layout")) settings.layout = parse_layout(json["layout"].dump(), path.string(), known);
  return settings;
}

}  // namespace

fs::path settings_path() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  if (const std::string folder = variable("XDG_CONFIG_HOME"); !folder.empty())
    return fs::path(folder) / "stillpoint" / "settings.json";
  if (const std::string home = variable("HOME"); !home.empty())
    return fs::path(home) / ".config" / "stillpoint" / "settings.json";
  return {};
}

Settings read_settings(const fs::path& path, const std::vector<std::string>& known, std::string* problem) {
  const auto text = read_whole(path);
  if (!text) return {};
  try {
    return from_json(parse_json<Json>(*text), path, known);
  } catch (const InputError& error) {
    if (problem != nullptr) *problem = error.what();
  } catch (const Json::exception&) {
    if (problem != nullptr)
      *problem = fmt::format("{}: is not as the window leaves it; it is begun anew", path.string());
  }
  return {};
}

void write_settings(const fs::path& path, const Settings& settings) {
  if (path.empty()) return;
  Json json;
  json["theme"] = settings.look.theme == ThemeName::kDark ? "dark" : "light";
  json["scale"] = settings.look.scale;
  if (settings.window_size) json["window"] = *settings.window_size;
  json["recent"] = Json::array();
  for (const RecentSequence& one : settings.recent) {
    Json kept{
        {"where", one.where}, {"reading", one.reading}, {"settings", one.settings}, {"frame", one.frame}};
    for (const KeptGhost& ghost : one.ghosts)
      kept["ghosts"].push_back({{"name", ghost.name}, {"settings", ghost.settings}, {"from", ghost.from}});
    if (!(one.runs == RunsShown{})) kept["runs"] = to_json(one.runs);
    json["recent"].push_back(std::move(kept));
  }
  if (settings.layout) json["layout"] = Json::parse(to_json(*settings.layout));
  prepare_out_folder(path.parent_path(), {}, true);
  write_text_file(path, json.dump(1) + '\n');
}

void remember(std::vector<RecentSequence>& recent, RecentSequence sequence) {
  std::erase_if(recent, [&](const RecentSequence& one) { return one.where == sequence.where; });
  recent.insert(recent.begin(), std::move(sequence));
  if (recent.size() > kRecentKept) recent.resize(kRecentKept);
}

LayoutNode read_layout(const fs::path& path, const std::vector<std::string>& known) {
  const auto text = read_whole(path);
  if (!text)
    throw InputError(
        fmt::format("{}: cannot be read; expected a layout as the window saves it", path.string()));
  const Json json = parse_json<Json>(*text, false);
  // The window's own settings hold a layout too.
  if (json.is_object() && json.contains("layout"))
    return parse_layout(json["layout"].dump(), path.string(), known);
  return parse_layout(*text, path.string(), known);
}

}  // namespace stillpoint
