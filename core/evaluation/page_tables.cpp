#include "core/evaluation/page_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/error.hpp"
#include "core/evaluation/spread.hpp"

namespace stillpoint {
namespace {

constexpr std::string_view kBegin = "<!-- table: ", kBeginEnd = " -->", kEnd = "<!-- end of table -->";

using Names = std::vector<std::string>;

Names listed(const std::string& text) {
  Names names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');)
    if (!name.empty()) names.push_back(name);
  return names;
}

/// What a page asks for.
struct Request {
  std::string file, what;
  Names methods, engines, sequences;
  bool long_names = false;
};

Request request_from(const std::string& text, const std::string& where) {
  Request request;
  std::istringstream words(text);
  words >> request.file >> request.what;
  for (std::string word; words >> word;) {
    const auto equals = word.find('=');
    const std::string key = word.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : word.substr(equals + 1);
    if (key == "methods")
      request.methods = listed(value);
    else if (key == "odometry")
      request.engines = listed(value);
    else if (key == "sequences")
      request.sequences = listed(value);
    else if (word == "names=long")
      request.long_names = true;
    else
      throw InputError(fmt::format(
          "{}: a table asks for '{}'; it may choose methods=, odometry=, sequences= and names=long", where,
          word));
  }
  if (request.file.empty() || request.what.empty())
    throw InputError(
        fmt::format("{}: a table names its results and what of them, as in '{}results.json rpe{}'", where,
                    kBegin, kBeginEnd));
  return request;
}

bool chosen(const std::string& name, const Names& patterns) {
  return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&name](const std::string& p) {
           return p.ends_with('*') ? name.starts_with(p.substr(0, p.size() - 1)) : name == p;
         });
}

/// The distinct values of a member, in the order in which they appear.
Names all_of(const BenchmarkResults& results, std::string BenchmarkResult::*member) {
  Names names;
  for (const BenchmarkResult& r : results.runs)
    if (std::find(names.begin(), names.end(), r.*member) == names.end()) names.push_back(r.*member);
  return names;
}

void throw_if_unknown(const Names& asked, const Names& there, const char* what, const std::string& where) {
  for (const std::string& name : asked)
    if (std::find(there.begin(), there.end(), name) == there.end())
      throw InputError(fmt::format("{}: a table asks for {} '{}'; its results have {}", where, what, name,
                                   fmt::join(there, ", ")));
}

std::string error_text(const BenchmarkResult& r, const std::optional<double>& value, int digits) {
  if (r.coverage < kLostCoverage) return "lost";
  if (!value) return kNoFigure;
  const std::string text = fmt::format("{:.{}f}", *value, digits);
  // Rounded down, so that a frame lost never reads as 100 %.
  return r.coverage >= 1.0 ? text : fmt::format("{} ({:.0f} %)", text, std::floor(100.0 * r.coverage));
}

std::string share_text(const std::optional<double>& share) {
  return share ? fmt::format("{:.2f}", *share) : std::string(kNoFigure);
}

/// One cell: the figure of a run, and the run of the baseline behind the same engine (null: there is none).
using Figure = std::function<std::string(const BenchmarkResult&, const BenchmarkResult* base)>;

std::string gain_text(const BenchmarkResult& r, const BenchmarkResult* base) {
  if (base == nullptr || !base->rpe_m || !r.rpe_m || *base->rpe_m <= 0) return kNoFigure;
  if (r.coverage < kLostCoverage) return "lost";
  return fmt::format("{:.0f} %", 100.0 * (1.0 - *r.rpe_m / *base->rpe_m));
}

std::string right_text(const BenchmarkResult& r) {
  if (!r.right || !r.wrong || *r.right + *r.wrong == 0) return kNoFigure;
  return fmt::format("{:.0f} %",
                     100.0 * static_cast<double>(*r.right) / static_cast<double>(*r.right + *r.wrong));
}

std::string time_text(double value, int digits) {
  return value > 0 ? fmt::format("{:.{}f}", value, digits) : std::string(kNoFigure);
}

const std::map<std::string, std::pair<std::string, Figure>>& figures() {
  using R = BenchmarkResult;
  static const std::map<std::string, std::pair<std::string, Figure>> table = {
      {"rpe", {"RPE 1 s, m", [](const R& r, const R*) { return error_text(r, r.rpe_m, 4); }}},
      {"rpe_deg", {"RPE 1 s, deg", [](const R& r, const R*) { return error_text(r, r.rpe_deg, 2); }}},
      {"ate", {"ATE, m", [](const R& r, const R*) { return error_text(r, r.ate_m, 4); }}},
      {"rpe_frame", {"RPE 1 frame, m", [](const R& r, const R*) { return error_text(r, r.rpe_frame_m, 5); }}},
      {"gain", {"gain over the baseline", gain_text}},
      {"iou", {"mask IoU", [](const R& r, const R*) { return share_text(r.iou); }}},
      {"precision", {"mask precision", [](const R& r, const R*) { return share_text(r.precision); }}},
      {"recall", {"mask recall", [](const R& r, const R*) { return share_text(r.recall); }}},
      {"right", {"removed rightly", [](const R& r, const R*) { return right_text(r); }}},
      {"ms", {"median ms a frame", [](const R& r, const R*) { return time_text(r.median_ms, 1); }}},
      {"p99", {"99 % ms a frame", [](const R& r, const R*) { return time_text(r.p99_ms, 1); }}},
      {"units", {"ORB units a frame", [](const R& r, const R*) { return time_text(r.units, 2); }}},
      {"lost",
       {"frames lost",
        [](const R& r, const R*) {
          return fmt::format("{:.0f} of {}", std::round((1.0 - r.coverage) * r.frames), r.frames);
        }}},
  };
  return table;
}

std::string short_name(const std::string& sequence, bool keep) {
  constexpr std::string_view kGenerated = "generated:";
  return !keep && sequence.starts_with(kGenerated) ? sequence.substr(kGenerated.size()) : sequence;
}

BenchmarkResults only(const BenchmarkResults& results, const Names& patterns) {
  BenchmarkResults kept = results;
  std::erase_if(kept.runs, [&patterns](const BenchmarkResult& r) { return !chosen(r.sequence, patterns); });
  return kept;
}

std::string made_text(const Provenance& r) {
  return fmt::format("*Made by stillpoint {} at commit {}, on {}, {}, by `{}`.*\n", r.version, r.commit,
                     r.date, r.machine, r.command);
}

Table figure_table(const BenchmarkResults& results, const Request& request, const std::string& baseline,
                   const std::string& where) {
  const auto found = figures().find(request.what);
  if (found == figures().end()) {
    Names names;
    for (const auto& [name, figure] : figures()) names.push_back(name);
    throw InputError(fmt::format("{}: a table asks for '{}'; there are {}, spread, published, ablation, made",
                                 where, request.what, fmt::join(names, ", ")));
  }
  const Names there_engines = all_of(results, &BenchmarkResult::odometry),
              there_methods = all_of(results, &BenchmarkResult::method);
  throw_if_unknown(request.engines, there_engines, "odometry", where);
  throw_if_unknown(request.methods, there_methods, "method", where);
  const Names& engines = request.engines.empty() ? there_engines : request.engines;
  const Names& methods = request.methods.empty() ? there_methods : request.methods;
  Table table{{found->second.first}, {}};
  for (const std::string& engine : engines)
    for (const std::string& method : methods)
      table.header.push_back(engines.size() > 1 ? engine + ", " + method : method);
  for (const std::string& sequence : results.sequences()) {
    std::vector<std::string> row = {short_name(sequence, request.long_names)};
    for (const std::string& engine : engines)
      for (const std::string& method : methods) {
        const BenchmarkResult* r = results.find(sequence, engine, method);
        row.push_back(r == nullptr ? kNoFigure
                                   : found->second.second(*r, results.find(sequence, engine, baseline)));
      }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string table_text(const Request& request, const TableSources& sources, const std::string& baseline,
                       const std::string& where) {
  if (request.what == "made") return made_text(sources.provenance(request.file));
  if (request.what == "ablation") return to_markdown(sources.ablation(request.file));
  const BenchmarkResults results = only(sources.results(request.file), request.sequences);
  if (results.runs.empty())
    throw InputError(
        fmt::format("{}: a table of {} asks for sequences that it has none of", where, request.file));
  if (request.what == "spread") {
    const Names methods =
        request.methods.empty() ? all_of(results, &BenchmarkResult::method) : request.methods;
    throw_if_unknown(methods, all_of(results, &BenchmarkResult::method), "method", where);
    const SpreadTable table = spread_of_runs(
        results, request.engines.empty() ? all_of(results, &BenchmarkResult::odometry) : request.engines,
        methods);
    return spread_text(table.rows, table.methods, "RPE 1 s, m", TableMarkup::markdown);
  }
  if (request.what != "published") return to_markdown(figure_table(results, request, baseline, where));
  const Names methods = request.methods.empty() ? all_of(results, &BenchmarkResult::method) : request.methods;
  throw_if_unknown(methods, all_of(results, &BenchmarkResult::method), "method", where);
  const std::string engine =
      request.engines.empty() ? results.runs.front().odometry : request.engines.front();
  return to_markdown(table_one(results, engine, methods, baseline));
}

}  // namespace

std::string with_tables(const std::string& page, const std::string& where, const std::string& baseline,
                        const TableSources& sources) {
  std::string text;
  std::size_t at = 0;
  for (std::size_t begin = page.find(kBegin); begin != std::string::npos; begin = page.find(kBegin, at)) {
    const std::size_t line_end = page.find('\n', begin), close = page.find(kBeginEnd, begin);
    const std::size_t end = page.find(kEnd, begin);
    if (close == std::string::npos || close > line_end || end == std::string::npos)
      throw InputError(fmt::format("{}: a table begins and has no '{}'", where, kEnd));
    const Request request =
        request_from(page.substr(begin + kBegin.size(), close - begin - kBegin.size()), where);
    text += page.substr(at, line_end + 1 - at);
    text += "\n" + table_text(request, sources, baseline, where) + "\n";
    at = end;
  }
  return text + page.substr(at);
}

}  // namespace stillpoint
