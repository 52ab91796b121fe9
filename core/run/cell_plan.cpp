#include "core/run/cell_plan.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.hpp"
#include "core/evaluation/provenance.hpp"
#include "core/hash.hpp"
#include "core/json_text.hpp"
#include "core/out_folder.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kCellsFolder = "cells";

/// JSON of whatever bytes there are: those that are no UTF-8 are replaced, for paths and logs may hold any.
std::string text_of(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json cell_json(const PlanCell& cell) {
  Json json;
  json["sequence"] = cell.sequence;
  json["odometry"] = cell.odometry;
  json["method"] = cell.method;
  json["repeat"] = cell.repeat;
  if (!cell.without.empty()) json["without"] = cell.without;
  json["frames"] = cell.frames;
  return json;
}

PlanCell cell_from(const nlohmann::json& json) {
  PlanCell cell;
  json.at("sequence").get_to(cell.sequence);
  json.at("odometry").get_to(cell.odometry);
  json.at("method").get_to(cell.method);
  json.at("repeat").get_to(cell.repeat);
  cell.without = json.value("without", std::string());
  json.at("frames").get_to(cell.frames);
  return cell;
}

Json sequence_json(const PlannedSequence& sequence) {
  return {{"name", sequence.name},
          {"where", sequence.where},
          {"runs", sequence.runs},
          {"reading", sequence.reading}};
}

/// `"name": [` with one value a line, so that a plan is read, and compared, row by row.
template <typename Values, typename Write>
std::string rows_text(const char* name, const Values& values, Write write) {
  std::string text = fmt::format("  \"{}\": [", name);
  const char* between = "\n    ";
  for (const auto& value : values) {
    text += between + text_of(write(value));
    between = ",\n    ";
  }
  return text + (values.empty() ? "]" : "\n  ]");
}

/// What decides a cell's result.
Json settings_json(const CellPlan& plan) {
  Json json;
  json["kind"] = plan.kind;
  json["program"] = program_text(plan.version);
  json["commit"] = plan.commit;
  json["config"] = plan.config;
  json["engines"] = plan.engines;
  json["methods"] = plan.methods;
  json["repeated"] = plan.repeated;
  return json;
}

std::string settings_text(const CellPlan& plan) {
  std::string text = text_of(settings_json(plan), 2);
  text.resize(text.size() - 2);  // without "\n}"
  return text + ",\n" + rows_text("sequences", plan.sequences, sequence_json) + ",\n" +
         rows_text("cells", plan.cells, cell_json);
}

/// Text by which a cell is found.
std::string key_of(const PlanCell& cell) { return text_of(cell_json(cell)); }

/// The number in "000012.json" or ".log"; nothing for other names.
std::optional<int> number_in(const fs::path& name, const char* extension) {
  const std::string stem = name.stem().string();
  int number = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
  if (name.extension() != extension || error != std::errc() || end != stem.data() + stem.size() || number < 0)
    return std::nullopt;
  return number;
}

/// The files of a plan's cells. The folder is listed rather than names tried: opening it makes NFS ask
/// the server, which it need not for a name that was not there a moment ago.
std::vector<fs::path> cell_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / kCellsFolder, none))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

void remove_records(const fs::path& folder, bool with_logs) {
  std::error_code none;
  for (const fs::path& file : cell_files(folder))
    if (with_logs || file.extension() != ".log") fs::remove(file, none);
}

std::string host_name() {
  char name[256] = {};
  (void)::gethostname(name, sizeof name - 1);
  return name;
}

}  // namespace

std::string to_text(const PlanCell& cell) {
  return fmt::format("{} ({}, {}{}{})", cell.sequence, cell.odometry, cell.method,
                     cell.repeat > 0 ? fmt::format(", repeat {}", cell.repeat) : "",
                     cell.without.empty() ? "" : ", without " + cell.without);
}

const PlannedSequence& CellPlan::sequence(const std::string& name) const {
  const auto it = std::find_if(sequences.begin(), sequences.end(),
                               [&name](const PlannedSequence& s) { return s.name == name; });
  if (it == sequences.end()) throw InputError(fmt::format("the plan has no sequence '{}'", printable(name)));
  return *it;
}

std::string CellPlan::fingerprint() const {
  Fingerprint hash;
  hash.add(settings_text(*this));
  return hash.hex();
}

std::string to_json_text(const CellPlan& plan) {
  return settings_text(plan) +
         fmt::format(",\n  \"command\": {},\n  \"replaces\": {},\n", text_of(plan.command), plan.replaces) +
         rows_text("known", plan.known,
                   [](const CellResult& known) {
                     Json json = cell_json(known.cell);
                     json["result"] = parse_json<Json>(known.json);
                     return json;
                   }) +
         "\n}\n";
}

CellPlan plan_from_json(const std::string& text, const std::string& where) {
  try {
    const Json json = parse_json<Json>(text);
    CellPlan plan;
    json.at("kind").get_to(plan.kind);
    const Provenance made = read_provenance(json, {"program", "commit", "command"});
    plan.version = made.version, plan.commit = made.commit, plan.command = made.command;
    json.at("config").get_to(plan.config);
    json.at("engines").get_to(plan.engines);
    json.at("methods").get_to(plan.methods);
    json.at("repeated").get_to(plan.repeated);
    json.at("replaces").get_to(plan.replaces);
    for (const Json& sequence : json.at("sequences"))
      plan.sequences.push_back({sequence.at("name"), sequence.at("where"), sequence.at("runs"),
                                sequence.at("reading").get<std::vector<std::string>>()});
    std::set<std::string> names;
    for (const PlannedSequence& sequence : plan.sequences) names.insert(sequence.name);
    for (const Json& cell : json.at("cells")) {
      plan.cells.push_back(cell_from(cell));
      if (!names.count(plan.cells.back().sequence))
        throw InputError(fmt::format("{}: a cell is of sequence '{}', which the plan does not have", where,
                                     printable(plan.cells.back().sequence)));
    }
    for (const Json& known : json.at("known"))
      plan.known.push_back({cell_from(known), known.at("result").dump()});
    return plan;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: is no plan of cells ({})", where, printable(error.what())));
  }
}

CellPlan read_plan(const fs::path& folder) {
  const fs::path path = folder / kPlanName;
  if (std::error_code none; !fs::exists(path, none))
    throw InputError(
        fmt::format("{}: holds no {}; `benchmark` and `ablate` leave one with --jobs and --slurm",
                    folder.string(), kPlanName));
  return plan_from_json(read_text(path.string()), path.string());
}

void write_plan(const fs::path& folder, const CellPlan& plan) {
  std::string earlier;
  if (std::error_code none; fs::exists(folder / kPlanName, none)) {
    try {
      earlier = read_plan(folder).fingerprint();
    } catch (const InputError&) {  // whatever it was, its records are none of this plan
    }
  }
  write_text_file(folder / kPlanName, to_json_text(plan));
  if (earlier != plan.fingerprint()) remove_records(folder, true);
  std::error_code failed;
  fs::create_directories(folder / kCellsFolder, failed);
  if (failed)
    throw InputError(fmt::format("{}: the folder cannot be made ({})", (folder / kCellsFolder).string(),
                                 failed.message()));
}

void remove_plan(const fs::path& folder) {
  std::error_code none;
  fs::remove(folder / kPlanName, none);
  remove_records(folder, false);
  fs::remove(folder / kCellsFolder, none);  // where it is empty
}

std::string to_json_text(const CellRecord& record) {
  Json json;
  json["cell"] = record.cell;
  json["plan"] = record.plan;
  json["commit"] = record.commit;
  json["machine"] = record.machine;
  json["status"] = record.status;
  if (!record.said.empty()) json["said"] = record.said;
  if (!record.json.empty()) json["result"] = parse_json<Json>(record.json);
  return text_of(json) + "\n";
}

CellRecord record_from_json(const std::string& text, const std::string& where) {
  try {
    const Json json = parse_json<Json>(text);
    CellRecord record;
    json.at("cell").get_to(record.cell);
    json.at("plan").get_to(record.plan);
    const Provenance made = read_provenance(json, {"commit", "machine"});
    record.commit = made.commit, record.machine = made.machine;
    json.at("status").get_to(record.status);
    record.said = json.value("said", std::string());
    if (record.status == 0) record.json = json.at("result").dump();
    return record;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: is no record of a cell ({})", where, printable(error.what())));
  }
}

std::string cell_log_name(int cell) { return fmt::format("{}/{:06}.log", kCellsFolder, cell); }
std::string cell_record_name(int cell) { return fmt::format("{}/{:06}.json", kCellsFolder, cell); }

void write_record(const fs::path& folder, const CellRecord& record) {
  // A requeued task may begin while a lost node still runs its first attempt: each writes beside by a name of
  // its own.
  write_text_file(folder / cell_record_name(record.cell), to_json_text(record),
                  fmt::format("_{}_{}", host_name(), ::getpid()));
}

namespace {

CellRecord checked_record(const fs::path& file, const CellPlan& plan, const std::string& fingerprint,
                          int number) {
  CellRecord record = record_from_json(read_text(file.string()), file.string());
  if (record.commit != plan.commit)
    throw InputError(
        fmt::format("{}: was made by another build (commit {}) than the plan ({}); --force begins anew",
                    file.string(), printable(record.commit), plan.commit));
  if (record.plan != fingerprint || record.cell != number || number >= static_cast<int>(plan.cells.size()))
    throw InputError(
        fmt::format("{}: is of another plan than {}; --force begins anew", file.string(), kPlanName));
  return record;
}

}  // namespace

std::optional<CellRecord> read_record(const fs::path& folder, const CellPlan& plan,
                                      const std::string& fingerprint, int cell) {
  const fs::path file = folder / cell_record_name(cell);
  if (std::error_code none; !fs::exists(file, none)) return std::nullopt;
  return checked_record(file, plan, fingerprint, cell);
}

CellRecords read_records(const fs::path& folder, const CellPlan& plan) {
  CellRecords records;
  records.of_cell.resize(plan.cells.size());
  records.begun.resize(plan.cells.size());
  const std::string fingerprint = plan.fingerprint();
  for (const fs::path& file : cell_files(folder)) {
    if (const auto log = number_in(file.filename(), ".log");
        log && *log < static_cast<int>(plan.cells.size()))
      records.begun[static_cast<std::size_t>(*log)] = true;
    const auto number = number_in(file.filename(), ".json");
    // One that failed is taken away when its cell is run again, perhaps just now.
    if (std::error_code none; !number || !fs::exists(file, none)) continue;
    CellRecord record = checked_record(file, plan, fingerprint, *number);
    records.of_cell[static_cast<std::size_t>(*number)] = std::move(record);
  }
  return records;
}

namespace {

/// What is known of the plan's own cells, by key_of.
std::map<std::string, const CellResult*> known_by_key(const CellPlan& plan) {
  std::map<std::string, const CellResult*> known;
  for (const CellResult& result : plan.known) known.emplace(key_of(result.cell), &result);
  return known;
}

}  // namespace

std::vector<int> missing_cells(const CellPlan& plan, const CellRecords& records) {
  const auto known = known_by_key(plan);
  std::vector<int> missing;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    const auto& record = records.of_cell[i];
    if ((!record || record->status != 0) && !known.count(key_of(plan.cells[i])))
      missing.push_back(static_cast<int>(i));
  }
  return missing;
}

MergedCells merge_cells(const CellPlan& plan, const CellRecords& records) {
  MergedCells merged;
  merged.whole = true;
  const auto known = known_by_key(plan);
  std::set<std::string> keys;
  for (const PlanCell& cell : plan.cells) keys.insert(key_of(cell));
  for (const CellResult& result : plan.known)
    if (!keys.count(key_of(result.cell))) merged.results.push_back(result);
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    const PlanCell& cell = plan.cells[i];
    const auto& record = records.of_cell[i];
    if (record &&
        std::find(merged.machines.begin(), merged.machines.end(), record->machine) == merged.machines.end())
      merged.machines.push_back(record->machine);
    if (const auto it = known.find(key_of(cell)); it != known.end()) {
      merged.results.push_back(*it->second);
    } else if (record && record->status == 0) {
      merged.results.push_back({cell, record->json});
    } else {
      MissingRun run{cell.sequence, cell.odometry, cell.method, cell.repeat, cell.without};
      if (record) run.status = record->status, run.said = record->said;
      if (record || records.begun[i]) run.log = cell_log_name(static_cast<int>(i));
      merged.whole = merged.whole && record;
      merged.missing.push_back(std::move(run));
    }
  }
  return merged;
}

void throw_if_other_build(const CellPlan& plan, const std::string& commit, const std::string& folder) {
  if (plan.commit == commit) return;
  throw InputError(
      fmt::format("{}: its {} was made by another build (commit {}; this one is {}); --force begins anew",
                  folder, kPlanName, plan.commit, commit));
}

}  // namespace stillpoint
