#include "core/evaluation/benchmark_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

template <typename Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json sentence_or_null(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
}

void read_sentence(const nlohmann::json& json, const char* key, std::string& text) {
  if (const auto it = json.find(key); it != json.end() && !it->is_null()) it->get_to(text);
}

template <typename Value>
void read_optional(const nlohmann::json& json, const char* key, std::optional<Value>& value) {
  if (const auto it = json.find(key); it != json.end() && !it->is_null()) value = it->get<Value>();
}

BenchmarkResult run_from(const nlohmann::json& json) {
  BenchmarkResult r;
  json.at("sequence").get_to(r.sequence);
  json.at("odometry").get_to(r.odometry);
  json.at("method").get_to(r.method);
  r.repeat = json.value("repeat", 0);
  json.at("frames").get_to(r.frames);
  json.at("coverage").get_to(r.coverage);
  read_optional(json, "ate_m", r.ate_m);
  read_optional(json, "rpe_m", r.rpe_m);
  read_optional(json, "rpe_deg", r.rpe_deg);
  read_optional(json, "rpe_frame_m", r.rpe_frame_m);
  json.at("pairs").get_to(r.pairs);
  read_optional(json, "precision", r.precision);
  read_optional(json, "recall", r.recall);
  read_optional(json, "iou", r.iou);
  read_optional(json, "partial_recall", r.partial_recall);
  read_optional(json, "removed_rightly", r.right);
  read_optional(json, "removed_wrongly", r.wrong);
  json.at("median_ms").get_to(r.median_ms);
  json.at("p99_ms").get_to(r.p99_ms);
  json.at("orb_units").get_to(r.units);
  json.at("run_hash").get_to(r.hash);
  read_sentence(json, "rpe_why_none", r.why_no_rpe);
  read_sentence(json, "doubt", r.doubt);
  return r;
}

MissingRun missing_from(const nlohmann::json& json) {
  MissingRun run;
  json.at("sequence").get_to(run.sequence);
  json.at("odometry").get_to(run.odometry);
  json.at("method").get_to(run.method);
  json.at("repeat").get_to(run.repeat);
  run.without = json.value("without", std::string());
  read_optional(json, "status", run.status);
  json.at("log").get_to(run.log);
  json.at("said").get_to(run.said);
  return run;
}

std::string figure(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
}

std::string whole(const std::optional<std::int64_t>& value) { return value ? std::to_string(*value) : "-"; }

}  // namespace

const BenchmarkResult* BenchmarkResults::find(const std::string& sequence, const std::string& odometry,
                                              const std::string& method, int repeat) const {
  const auto it = std::find_if(runs.begin(), runs.end(), [&](const BenchmarkResult& r) {
    return r.sequence == sequence && (r.odometry == odometry || r.odometry == kItsOwnOdometry) &&
           r.method == method && r.repeat == repeat;
  });
  return it == runs.end() ? nullptr : &*it;
}

std::vector<std::string> BenchmarkResults::sequences() const {
  std::vector<std::string> names;
  for (const BenchmarkResult& r : runs)
    if (std::find(names.begin(), names.end(), r.sequence) == names.end()) names.push_back(r.sequence);
  return names;
}

nlohmann::ordered_json to_json(const BenchmarkResult& r) {
  nlohmann::ordered_json json;
  json["sequence"] = r.sequence;
  json["odometry"] = r.odometry;
  json["method"] = r.method;
  json["repeat"] = r.repeat;
  json["frames"] = r.frames;
  json["coverage"] = r.coverage;
  json["ate_m"] = or_null(r.ate_m);
  json["rpe_m"] = or_null(r.rpe_m);
  json["rpe_deg"] = or_null(r.rpe_deg);
  json["rpe_frame_m"] = or_null(r.rpe_frame_m);
  json["pairs"] = r.pairs;
  json["precision"] = or_null(r.precision);
  json["recall"] = or_null(r.recall);
  json["iou"] = or_null(r.iou);
  json["partial_recall"] = or_null(r.partial_recall);
  json["removed_rightly"] = or_null(r.right);
  json["removed_wrongly"] = or_null(r.wrong);
  json["median_ms"] = r.median_ms;
  json["p99_ms"] = r.p99_ms;
  json["orb_units"] = r.units;
  json["run_hash"] = r.hash;
  json["rpe_why_none"] = sentence_or_null(r.why_no_rpe);
  json["doubt"] = sentence_or_null(r.doubt);
  return json;
}

nlohmann::ordered_json to_json(const MissingRun& run) {
  nlohmann::ordered_json json;
  json["sequence"] = run.sequence;
  json["odometry"] = run.odometry;
  json["method"] = run.method;
  json["repeat"] = run.repeat;
  if (!run.without.empty()) json["without"] = run.without;
  json["status"] = or_null(run.status);
  json["log"] = run.log;
  json["said"] = run.said;
  return json;
}

nlohmann::ordered_json to_json(const Provenance& made) {
  nlohmann::ordered_json json;
  json["program"] = program_text(made.version);
  json["commit"] = made.commit;
  json["machine"] = made.machine;
  json["date"] = made.date;
  json["command"] = made.command;
  return json;
}

Provenance provenance_from_json(const std::string& text, const std::string& where) {
  try {
    return read_provenance(parse_json(text));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: does not say what it was made by ({})", where, printable(error.what())));
  }
}

nlohmann::ordered_json to_json(const BenchmarkResults& results) {
  nlohmann::ordered_json json = to_json(static_cast<const Provenance&>(results));
  json["config"] = results.config;
  json["runs"] = nlohmann::ordered_json::array();
  for (const BenchmarkResult& r : results.runs) json["runs"].push_back(to_json(r));
  for (const MissingRun& run : results.missing) json["missing"].push_back(to_json(run));
  return json;
}

BenchmarkResults results_from_json(const std::string& text, const std::string& where) {
  try {
    const nlohmann::json json = parse_json(text);
    BenchmarkResults results;
    static_cast<Provenance&>(results) = read_provenance(json);
    json.at("config").get_to(results.config);
    for (const nlohmann::json& run : json.at("runs")) results.runs.push_back(run_from(run));
    if (const auto missing = json.find("missing"); missing != json.end())
      for (const nlohmann::json& run : *missing) results.missing.push_back(missing_from(run));
    return results;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: holds no results of a benchmark ({})", where, printable(error.what())));
  }
}

BenchmarkResult result_from_json(const std::string& text, const std::string& where) {
  try {
    return run_from(parse_json(text));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: is no result of a benchmark ({})", where, printable(error.what())));
  }
}

BenchmarkResults read_results(const std::string& path) { return results_from_json(read_text(path), path); }

Table table_one(const BenchmarkResults& results, const std::string& odometry,
                const std::vector<std::string>& methods, const std::string& baseline) {
  std::vector<BenchmarkRow> rows;
  for (const std::string& sequence : results.sequences()) {
    BenchmarkRow row{sequence, {}};
    for (const std::string& method : methods)
      if (const BenchmarkResult* r = results.find(sequence, odometry, method))
        row.cells.push_back({method, r->rpe_m, r->coverage, r->pairs, r->odometry == kItsOwnOdometry});
    if (!row.cells.empty()) rows.push_back(std::move(row));
  }
  return table_one(rows, methods, baseline);
}

Table details_table(const BenchmarkResults& results) {
  Table table;
  table.header = {"sequence",  "odometry",    "method",         "coverage %",      "ATE m",
                  "RPE 1 s m", "RPE 1 s deg", "pairs",          "RPE 1 frame m",   "mask precision",
                  "recall",    "IoU",         "forward recall", "removed rightly", "removed wrongly",
                  "median ms", "p99 ms",      "ORB units"};
  for (const BenchmarkResult& r : results.runs) {
    if (r.repeat != 0) continue;
    const bool timed = r.median_ms > 0.0;
    const auto time = [timed](double value, int digits) {
      return timed ? fmt::format("{:.{}f}", value, digits) : std::string("-");
    };
    table.rows.push_back({r.sequence, r.odometry, r.method, fmt::format("{:.1f}", 100.0 * r.coverage),
                          figure(r.ate_m, 4), figure(r.rpe_m, 4), figure(r.rpe_deg, 3),
                          std::to_string(r.pairs), figure(r.rpe_frame_m, 5), figure(r.precision, 3),
                          figure(r.recall, 3), figure(r.iou, 3), figure(r.partial_recall, 3), whole(r.right),
                          whole(r.wrong), time(r.median_ms, 1), time(r.p99_ms, 1), time(r.units, 2)});
  }
  return table;
}

std::string details_legend() {
  return "- pairs: poses 1 s apart, of which RPE 1 s is the RMSE; mask precision, recall and IoU: of all "
         "frames' pixels together, 0 to 1; forward recall: of the forward mask alone, of methods that have "
         "one\n"
         "- removed rightly, wrongly: features of all frames together, by whether the true mask holds them; "
         "median, p99: tracking time a frame; ORB units: that median, in times of one cv::ORB of 1000 "
         "features on the same frame\n"
         "- a dash: there is no such figure, for want of truth, because the method removes nothing, or "
         "because it judges features and makes no mask\n";
}

std::vector<RunNote> notes_on(const BenchmarkResults& results) {
  std::vector<RunNote> notes;
  for (const BenchmarkResult& r : results.runs) {
    std::string run = fmt::format("{}, {}", r.sequence, r.method);
    if (r.odometry != kItsOwnOdometry) run += ", odometry " + r.odometry;
    if (r.repeat > 0) run += fmt::format(", run {}", r.repeat + 1);
    notes.push_back({run, r.why_no_rpe, r.doubt});
  }
  return notes;
}

std::string exit_text(int status) {
  constexpr int kBySignal = 128;  // what shells add to a signal's number
  if (status <= kBySignal) return fmt::format("exit status {}", status);
  return fmt::format("exit status {} (signal {})", status, status - kBySignal);
}

std::string why_missing(const MissingRun& run) {
  if (run.status) return exit_text(*run.status);
  return run.log.empty() ? "has not begun" : "has not ended";
}

std::string missing_text(const std::vector<MissingRun>& missing, std::size_t asked) {
  if (missing.empty()) return {};
  constexpr std::size_t kShown = 50;  // rows: more are told by their number
  Table table;
  table.header = {"missing", "odometry", "method", "repeat", "without", "why", "log", "it said last"};
  for (const MissingRun& run : missing) {
    if (table.rows.size() == kShown) break;
    table.rows.push_back({run.sequence, run.odometry, run.method, std::to_string(run.repeat), run.without,
                          why_missing(run), run.log, run.said});
  }
  return fmt::format(
      "Of {} runs, {} {} no result{}:\n\n{}", asked, missing.size(), missing.size() == 1 ? "has" : "have",
      missing.size() > kShown ? fmt::format(", of which the first {} are", kShown) : "", to_markdown(table));
}

}  // namespace stillpoint
