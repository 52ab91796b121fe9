#include "core/run/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

constexpr double kWide = 20.0;    // a range of more than this factor is gone through by factors
constexpr int kMostSteps = 1000;  // runs of a whole sequence: more is a slip of the keyboard

Parameter numeric_parameter(Config& config, const std::string& name) {
  for (const Parameter& parameter : parameters(config)) {
    const bool is_it =
        parameter.key == name ||
        std::find(parameter.old_keys.begin(), parameter.old_keys.end(), name) != parameter.old_keys.end();
    if (!is_it) continue;
    if (std::holds_alternative<std::string*>(parameter.value))
      throw InputError(fmt::format("{} is no number, so that it cannot be swept", name));
    return parameter;
  }
  throw InputError(fmt::format("there is no parameter {}; `stillpoint config` lists all", name));
}

std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string metres(const std::optional<double>& value, int digits = 4) {
  return value ? fmt::format("{:.{}f}", *value, digits) : std::string("–");
}

}  // namespace

std::optional<double> number_of(const Parameter& parameter) {
  if (const auto* flag = std::get_if<bool*>(&parameter.value)) return **flag ? 1.0 : 0.0;
  if (const auto* whole = std::get_if<int*>(&parameter.value)) return **whole;
  if (const auto* real = std::get_if<double*>(&parameter.value)) return **real;
  return std::nullopt;
}

SweepRange sweep_range(const std::string& text) {
  const auto wrong = [&text] {
    return InputError(fmt::format(
        "'{}' is no range of a parameter: write section.name=LOW:HIGH or …=LOW:HIGH:STEPS", text));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw wrong();
  SweepRange range{.parameter = text.substr(0, equals)};
  std::vector<double> numbers;
  for (std::size_t at = equals + 1; at <= text.size();) {
    const std::size_t end = std::min(text.find(':', at), text.size());
    const auto number = number_in(text.substr(at, end - at));
    if (!number) throw wrong();
    numbers.push_back(*number);
    at = end + 1;
  }
  if (numbers.size() < 2 || numbers.size() > 3) throw wrong();
  range.low = numbers[0], range.high = numbers[1];
  if (numbers.size() == 3) {
    if (numbers[2] != std::floor(numbers[2]) || numbers[2] < 1 || numbers[2] > kMostSteps)
      throw InputError(fmt::format("'{}': expected 1 to {} steps", text, kMostSteps));
    range.steps = static_cast<int>(numbers[2]);
  }
  return range;
}

SweepRange usual_sweep(const Config& config, const std::string& parameter) {
  Config copy = config;
  const Parameter found = numeric_parameter(copy, parameter);
  SweepRange range{.parameter = found.key, .low = found.min, .high = found.max};
  const double value = number_of(found).value_or(0.0);
  if (value > 0 && found.max > kWide * std::max(found.min, 1e-9)) {
    range.low = std::max(found.min, 0.25 * value);
    range.high = std::min(found.max, 4.0 * value);
  }
  if (std::holds_alternative<int*>(found.value)) range.low = std::round(range.low);
  return range;
}

std::vector<double> sweep_values(const Config& config, const SweepRange& range) {
  Config copy = config;
  const Parameter parameter = numeric_parameter(copy, range.parameter);
  if (std::holds_alternative<bool*>(parameter.value)) return {0.0, 1.0};
  const double low = std::min(range.low, range.high), high = std::max(range.low, range.high);
  if (!(low >= parameter.min && high <= parameter.max))
    throw InputError(fmt::format("{} goes from {:g} to {:g}{}{}, not from {:g} to {:g}", parameter.key,
                                 parameter.min, parameter.max, parameter.unit.empty() ? "" : " ",
                                 parameter.unit, low, high));
  const bool whole = std::holds_alternative<int*>(parameter.value);
  const bool by_factors = low > 0 && high > kWide * low;
  const int steps = std::clamp(range.steps, 1, kMostSteps);
  std::vector<double> values;
  for (int i = 0; i < steps; ++i) {
    const double share = steps == 1 ? 0.0 : static_cast<double>(i) / (steps - 1);
    double value = by_factors ? low * std::pow(high / low, share) : low + share * (high - low);
    if (i + 1 == steps && steps > 1) value = high;
    if (whole) value = std::round(value);
    if (values.empty() || value > values.back()) values.push_back(value);
  }
  return values;
}

std::vector<std::string> sweep_remarks(const Config& config, const SweepRange& range,
                                       const std::vector<double>& values) {
  Config copy = config;
  const Parameter parameter = numeric_parameter(copy, range.parameter);
  std::vector<std::string> remarks;
  if (std::holds_alternative<bool*>(parameter.value) || values.empty()) return remarks;
  if (range.low > range.high)
    remarks.push_back(fmt::format("{}: its values go up, from {:.6g} to {:.6g}", range.parameter,
                                  values.front(), values.back()));
  if (range.steps == 1 && range.low != range.high)
    remarks.push_back(fmt::format("{}: one step is the lower end alone, {:.6g}; two take both",
                                  range.parameter, values.front()));
  else if (values.size() < static_cast<std::size_t>(range.steps))
    remarks.push_back(fmt::format("{}: from {:.6g} to {:.6g} there are {} and no {} to run", range.parameter,
                                  values.front(), values.back(), counted(values.size(), "value"),
                                  range.steps));
  return remarks;
}

std::vector<RunNote> notes_on(const SweepRange& range, const std::vector<SweepPoint>& points) {
  std::vector<RunNote> notes;
  for (const SweepPoint& point : points)
    notes.push_back({fmt::format("{} = {:.6g}", range.parameter, point.value), point.reached.why_no_rpe,
                     point.reached.doubt});
  return notes;
}

Config swept(const Config& config, const std::string& parameter, double value) {
  Config copy = config;
  const Parameter found = numeric_parameter(copy, parameter);
  if (auto* const* flag = std::get_if<bool*>(&found.value)) **flag = value != 0.0;
  if (auto* const* whole = std::get_if<int*>(&found.value)) **whole = static_cast<int>(std::lround(value));
  if (auto* const* real = std::get_if<double*>(&found.value)) **real = value;
  return copy;
}

std::optional<SweepPoint> sweep_point(const FrameSource& source, const Config& config,
                                      const std::string& parameter, double value, int frames,
                                      const std::atomic<bool>* stop,
                                      const std::function<void(const FrameResult&)>& on_frame) {
  RunOptions options;
  options.count = frames;
  options.stop = stop;
  options.on_frame = on_frame;
  const RunResult run = run_sequence(source, swept(config, parameter, value), options);
  if (run.interrupted) return std::nullopt;
  return SweepPoint{value, ablation_cell(report_on(run, source))};
}

std::optional<std::size_t> best_of(const std::vector<SweepPoint>& points) {
  double most = 0.0;
  for (const SweepPoint& point : points) most = std::max(most, point.reached.coverage);
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const AblationCell& cell = points[i].reached;
    if (!cell.rpe_m || cell.coverage < most) continue;
    if (!best || *cell.rpe_m < *points[*best].reached.rpe_m) best = i;
  }
  return best;
}

Table sweep_table(const SweepRange& range, const std::vector<SweepPoint>& points) {
  Table table{{range.parameter, "RPE 1 s, m", "pairs", "RPE 1 frame, m", "ATE, m", "mask IoU",
               "frames with a pose", "median ms a frame"},
              {}};
  for (const SweepPoint& point : points) {
    const AblationCell& cell = point.reached;
    table.rows.push_back({fmt::format("{:.6g}", point.value), metres(cell.rpe_m),
                          fmt::format("{}", cell.pairs), metres(cell.rpe_frame_m, 5), metres(cell.ate_m),
                          cell.mask_iou ? fmt::format("{:.3f}", *cell.mask_iou) : "–",
                          // Rounded down, so that a frame lost never reads as 100 %.
                          fmt::format("{:.1f} %", std::floor(1000.0 * cell.coverage) / 10.0),
                          fmt::format("{:.1f}", cell.median_ms)});
  }
  return table;
}

nlohmann::ordered_json sweep_json(const std::string& sequence, const SweepRange& range,
                                  const std::vector<SweepPoint>& points) {
  nlohmann::ordered_json json{{"sequence", sequence}, {"parameter", range.parameter}};
  json["points"] = nlohmann::ordered_json::array();
  for (const SweepPoint& point : points) {
    json["points"].push_back({{"value", point.value}});
    json["points"].back().update(to_json(point.reached));
  }
  return json;
}

}  // namespace stillpoint
