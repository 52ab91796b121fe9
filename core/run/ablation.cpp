#include "core/run/ablation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_report.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr const char* kWhole = "whole method";
constexpr const char* kNothing = "–";

std::string name_of(const AblationRow& row) {
  return row.without.empty() ? kWhole : "without " + row.without;
}

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : std::string(kNothing);
}

std::string signed_percent(const std::optional<double>& share) {
  return share ? fmt::format("{:+.1f} %", 100.0 * *share) : std::string(kNothing);
}

template <typename Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::optional<std::string> sentence(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

/// Nothing for null, and where an earlier version did not write it.
template <typename Value>
std::optional<Value> optional_in(const nlohmann::json& json, const char* key) {
  const auto it = json.find(key);
  return it == json.end() || it->is_null() ? std::nullopt : std::optional(it->get<Value>());
}

/// A mean of what is known.
std::optional<double> mean_iou(const AblationRow& row) {
  double sum = 0.0;
  int count = 0;
  for (const AblationCell& cell : row.cells)
    if (cell.mask_iou) sum += *cell.mask_iou, ++count;
  if (count == 0) return std::nullopt;
  return sum / count;
}

/// How many pairs a sequence's errors are of: "11", or "7-11" where variants lost frames.
std::string pairs_of(const std::vector<AblationRow>& rows, std::size_t sequence) {
  std::optional<std::size_t> least, most;
  for (const AblationRow& row : rows) {
    if (sequence >= row.cells.size() || !row.cells[sequence].rpe_m) continue;
    const std::size_t pairs = row.cells[sequence].pairs;
    least = std::min(least.value_or(pairs), pairs);
    most = std::max(most.value_or(pairs), pairs);
  }
  if (!least || *most == 0) return kNothing;  // files of earlier versions do not say
  return *least == *most ? fmt::format("{}", *most) : fmt::format("{}-{}", *least, *most);
}

AblationCell ablated_cell_from(const nlohmann::json& json) {
  AblationCell cell;
  if (!json.at("rpe_m").is_null()) cell.rpe_m = json.at("rpe_m").get<double>();
  if (!json.at("iou").is_null()) cell.mask_iou = json.at("iou").get<double>();
  json.at("coverage").get_to(cell.coverage);
  json.at("median_ms").get_to(cell.median_ms);
  json.at("run_hash").get_to(cell.hash);
  cell.ate_m = optional_in<double>(json, "ate_m");
  cell.rpe_frame_m = optional_in<double>(json, "rpe_frame_m");
  cell.pairs = optional_in<std::size_t>(json, "pairs").value_or(0);
  cell.why_no_rpe = optional_in<std::string>(json, "rpe_why_none").value_or("");
  cell.doubt = optional_in<std::string>(json, "doubt").value_or("");
  return cell;
}

}  // namespace

std::vector<Ingredient> ingredients(const MethodInfo& method) {
  std::vector<Ingredient> all = method.ingredients;
  if (method.needs.first_pose) {
    all.push_back({"consensus", "a first pose by consensus of samples", {"tracking.seek_consensus=false"}});
    all.push_back(
        {"gated_start", "a second pose held to the first one's consensus", {"tracking.start_gate=0"}});
  }
  if (method.extends_odometry) {
    all.push_back(
        {"smoother", "solving poses once more by the later map", {"tracking.smoother_lag_frames=0"}});
    all.push_back({"direct", "direct alignment where corners starve", {"direct.below_inliers=0"}});
  }
  if (method.needs.first_pose) {
    all.push_back(
        {"soft_weights", "weighing features by how likely they are static", {"tracking.soft_weights=false"}});
    all.push_back(
        {"cull_dynamic", "taking map points on dynamic objects out of the map", {"map.cull_dynamic=false"}});
  }
  const std::vector<Ingredient> of_all = {
      {"spread_points", "map points in every part of the image", {"map.min_cell_points=0"}},
      {"depth_residual", "depth beside pixels in the pose", {"tracking.depth_weight=0"}},
      {"rolling_shutter", "undoing the rolling shutter", {"tracking.correct_rolling_shutter=false"}},
      {"depth_lag", "undoing the time between depth and colour", {"tracking.correct_depth_lag=false"}},
      {"huber", "Huber's loss; without it one of adaptive shape", {"tracking.adaptive_kernel=true"}}};
  all.insert(all.end(), of_all.begin(), of_all.end());
  return all;
}

Ingredient ingredient_by_name(const MethodInfo& method, const std::string& name) {
  std::vector<std::string> names;
  for (const Ingredient& one : ingredients(method)) {
    if (one.name == name) return one;
    names.push_back(one.name);
  }
  throw InputError(fmt::format("there is no ingredient '{}' of method {}; there are: {}", name, method.name,
                               fmt::join(names, ", ")));
}

Config ablated(Config config, const Ingredient* without) {
  if (without)
    for (const std::string& assignment : without->assignments) set_parameter(config, assignment);
  return config;
}

AblationCell ablation_cell(const RunReport& report) {
  AblationCell cell;
  const auto rmse = [](const ErrorStatistics& errors) {
    return errors.count > 0 ? std::optional(errors.rmse) : std::nullopt;
  };
  if (const auto& e = report.evaluation) {
    cell.rpe_m = rmse(e->rpe_time.translation_m);
    cell.pairs = static_cast<std::size_t>(e->rpe_time.translation_m.count);
    cell.ate_m = rmse(e->ate.translation_m);
    cell.rpe_frame_m = rmse(e->rpe_frame.translation_m);
  }
  cell.why_no_rpe = why_no_rpe(report);
  cell.doubt = report.doubt;
  // A baseline makes no masks that could be right or wrong.
  if (report.scores.known && !method_named(report.method).baseline) cell.mask_iou = report.scores.mask.iou();
  cell.coverage = report.coverage;
  cell.median_ms = report.speed.median_ms;
  cell.hash = report.hash;
  return cell;
}

nlohmann::ordered_json to_json(const AblationCell& cell) {
  return {{"rpe_m", or_null(cell.rpe_m)},
          {"iou", or_null(cell.mask_iou)},
          {"coverage", cell.coverage},
          {"median_ms", cell.median_ms},
          {"run_hash", cell.hash},
          {"ate_m", or_null(cell.ate_m)},
          {"rpe_frame_m", or_null(cell.rpe_frame_m)},
          {"pairs", cell.pairs},
          {"rpe_why_none", or_null(sentence(cell.why_no_rpe))},
          {"doubt", or_null(sentence(cell.doubt))}};
}

AblationCell ablation_cell_from_json(const std::string& text, const std::string& where) {
  try {
    return ablated_cell_from(parse_json(text));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: is no result of an ablation ({})", where, printable(error.what())));
  }
}

AblationChange change_of(const AblationRow& row, const AblationRow& whole) {
  AblationChange change;
  double logs = 0.0, iou = 0.0;
  int errors = 0, masks = 0;
  const std::size_t count = std::min(row.cells.size(), whole.cells.size());
  for (std::size_t i = 0; i < count; ++i) {
    const AblationCell &now = row.cells[i], &then = whole.cells[i];
    change.median_ms += now.median_ms / static_cast<double>(count);
    change.coverage = std::min(change.coverage, now.coverage);
    if (now.hash == then.hash && now.rpe_m == then.rpe_m) ++change.unchanged;
    if (now.mask_iou && then.mask_iou) iou += *now.mask_iou - *then.mask_iou, ++masks;
    if (!now.rpe_m || !then.rpe_m || *now.rpe_m <= 0 || *then.rpe_m <= 0) continue;
    const double ratio = *now.rpe_m / *then.rpe_m;
    logs += std::log(ratio);
    ++errors;
    if (!change.worst || ratio - 1.0 > *change.worst) change.worst = ratio - 1.0, change.worst_sequence = i;
  }
  if (errors > 0) change.mean = std::exp(logs / errors) - 1.0;
  if (masks > 0) change.mask_iou = iou / masks;
  return change;
}

Table ablation_summary(const std::string& method, const std::vector<AblationRow>& rows,
                       const std::vector<std::string>& sequences) {
  Table table;
  table.header = {method,           "RPE, mean change", "worst change",      "on", "mask IoU", "IoU change",
                  "least coverage", "median ms",        "nothing changed on"};
  for (const AblationRow& row : rows) {
    const AblationChange change = change_of(row, rows.front());
    const bool whole = row.without.empty();
    table.rows.push_back({name_of(row), whole ? kNothing : signed_percent(change.mean),
                          whole ? kNothing : signed_percent(change.worst),
                          whole || !change.worst ? kNothing : sequences[change.worst_sequence],
                          number(mean_iou(row), 3),
                          whole || !change.mask_iou ? kNothing : fmt::format("{:+.3f}", *change.mask_iou),
                          fmt::format("{:.1f} %", std::floor(1000.0 * change.coverage) / 10.0),
                          fmt::format("{:.1f}", change.median_ms),
                          whole ? kNothing : fmt::format("{} of {}", change.unchanged, row.cells.size())});
  }
  return table;
}

Table ablation_errors(const std::vector<AblationRow>& rows, const std::vector<std::string>& sequences) {
  const auto any = [&rows](std::optional<double> AblationCell::*figure) {
    return std::any_of(rows.begin(), rows.end(), [figure](const AblationRow& row) {
      return std::any_of(row.cells.begin(), row.cells.end(),
                         [figure](const AblationCell& cell) { return (cell.*figure).has_value(); });
    });
  };
  const bool by_frame = !any(&AblationCell::rpe_m) && any(&AblationCell::rpe_frame_m);
  Table table;
  table.header = {by_frame ? "RPE 1 frame, RMSE [m]" : "RPE 1 s, RMSE [m]"};
  if (!by_frame) table.header.push_back("pairs");
  for (const AblationRow& row : rows) table.header.push_back(name_of(row));
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    std::vector<std::string> cells = {sequences[i]};
    if (!by_frame) cells.push_back(pairs_of(rows, i));
    for (const AblationRow& row : rows)
      cells.push_back(i >= row.cells.size() ? kNothing
                      : by_frame            ? number(row.cells[i].rpe_frame_m, 5)
                                            : number(row.cells[i].rpe_m, 4));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::vector<RunNote> notes_on(const std::vector<AblationRow>& rows,
                              const std::vector<std::string>& sequences) {
  std::vector<RunNote> notes;
  for (std::size_t i = 0; i < sequences.size(); ++i)
    for (const AblationRow& row : rows)
      if (i < row.cells.size())
        notes.push_back({sequences[i] + ", " + name_of(row), row.cells[i].why_no_rpe, row.cells[i].doubt});
  return notes;
}

Table ablation_list(const std::vector<AblationRow>& rows, const std::vector<std::string>& sequences) {
  Table table;
  table.header = {"sequence", "without", "rpe_m", "iou", "coverage", "median_ms", "run_hash", "pairs"};
  for (const AblationRow& row : rows)
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const AblationCell& cell = row.cells[i];
      table.rows.push_back({sequences[i], row.without, cell.rpe_m ? fmt::format("{:.6f}", *cell.rpe_m) : "",
                            cell.mask_iou ? fmt::format("{:.4f}", *cell.mask_iou) : "",
                            fmt::format("{:.4f}", cell.coverage), fmt::format("{:.2f}", cell.median_ms),
                            cell.hash, fmt::format("{}", cell.pairs)});
    }
  return table;
}

nlohmann::ordered_json ablation_json(const std::string& method, const std::vector<AblationRow>& rows,
                                     const std::vector<std::string>& sequences, const Provenance& made) {
  nlohmann::ordered_json variants = nlohmann::ordered_json::array();
  for (const AblationRow& row : rows) {
    nlohmann::ordered_json runs = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      nlohmann::ordered_json run = {{"sequence", sequences[i]}};
      run.update(to_json(row.cells[i]));
      runs.push_back(run);
    }
    const AblationChange change = change_of(row, rows.front());
    nlohmann::ordered_json variant;
    variant["without"] =
        row.without.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(row.without);
    if (!row.without.empty()) {
      variant["set"] = row.assignments;
      variant["rpe_mean_change"] = or_null(change.mean);
      variant["iou_change"] = or_null(change.mask_iou);
    }
    variant["runs"] = runs;
    variants.push_back(variant);
  }
  nlohmann::ordered_json json = to_json(made);
  json["method"] = method;
  json["variants"] = variants;
  return json;
}

Ablation read_ablation(const std::string& path) {
  try {
    const nlohmann::json json = parse_json(read_text(path));
    Ablation ablation{json.at("method").get<std::string>(), {}, {}};
    for (const nlohmann::json& variant : json.at("variants")) {
      AblationRow row{
          variant.at("without").is_null() ? "" : variant.at("without").get<std::string>(), {}, {}};
      for (const nlohmann::json& run : variant.at("runs")) {
        row.cells.push_back(ablated_cell_from(run));
        if (ablation.rows.empty()) ablation.sequences.push_back(run.at("sequence").get<std::string>());
      }
      if (row.cells.size() != ablation.sequences.size()) throw InputError("its variants differ in runs");
      ablation.rows.push_back(std::move(row));
    }
    if (ablation.rows.empty()) throw InputError("it has no variants");
    return ablation;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: holds no ablation ({})", path, printable(error.what())));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: holds no ablation ({})", path, error.what()));
  }
}

}  // namespace stillpoint
