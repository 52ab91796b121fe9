#include "core/run/frame_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/run/figure_table.hpp"

namespace stillpoint {
namespace {

/// A figure of one frame; NaN where it is not known.
double value_of(const FrameFigure& figure, const MeasuredFrame& row) {
  if (figure.of_removal && row.removal == nullptr) return kUnknownFigure;
  if (figure.of != nullptr) return figure.of(row);
  for (const MotionFigure& one : row.record.motion_figures)
    if (one.name == figure.info.name) return one.value;
  return kUnknownFigure;
}

using RemovalErrors = std::unordered_map<int, RemovalError>;  // by the frame's index

RemovalErrors removal_of(const MeasuredFrames& frames) {
  RemovalErrors errors;
  if (frames.evaluation != nullptr)
    for (const RemovalError& error : removal_errors(frames.records, *frames.evaluation))
      errors.emplace(error.frame, error);
  return errors;
}

MeasuredFrame row_of(const MeasuredFrames& frames, std::size_t row, const RemovalErrors& removal) {
  static const FrameScores none;
  const FrameRecord& record = frames.records[row];
  const auto checked = removal.find(record.index);
  return {record, frames.scores != nullptr && row < frames.scores->size() ? (*frames.scores)[row] : none,
          frames.evaluation, checked == removal.end() ? nullptr : &checked->second};
}

std::vector<double> values_of(const MeasuredFrames& frames, const FrameFigure& figure,
                              const RemovalErrors& removal) {
  std::vector<double> values;
  values.reserve(frames.records.size());
  for (std::size_t row = 0; row < frames.records.size(); ++row)
    values.push_back(value_of(figure, row_of(frames, row, removal)));
  return values;
}

}  // namespace

std::string_view to_string(FigureUnit unit) {
  switch (unit) {
    case FigureUnit::plain:
      return "";
    case FigureUnit::metres:
      return "m";
    case FigureUnit::degrees:
      return "deg";
    case FigureUnit::pixels:
      return "px";
    case FigureUnit::milliseconds:
      return "ms";
    case FigureUnit::share:
      return "share";
    case FigureUnit::truth:
      return "yes/no";
  }
  return "";
}

ShownUnit shown_unit(FigureUnit unit) {
  switch (unit) {
    case FigureUnit::metres:
      return {1000.0, "mm"};
    case FigureUnit::degrees:
      return {1.0, "°"};
    case FigureUnit::share:
      return {100.0, "%"};
    case FigureUnit::plain:
    case FigureUnit::truth:
      return {1.0, ""};
    case FigureUnit::pixels:
    case FigureUnit::milliseconds:
      return {1.0, to_string(unit)};
  }
  return {};
}

std::string shown_value(const FigureInfo& figure, double value) {
  if (!std::isfinite(value)) return "–";
  if (figure.unit == FigureUnit::truth) return value != 0.0 ? "yes" : "no";
  const ShownUnit shown = shown_unit(figure.unit);
  if (figure.digits == 0) return fmt::format("{:.0f}", value);
  const int digits = figure.unit == FigureUnit::metres || figure.unit == FigureUnit::share ? 2 : 3;
  return fmt::format("{:.{}f}{}{}", shown.factor * value, digits, shown.unit.empty() ? "" : " ", shown.unit);
}

const std::string& shown_name(const FigureInfo& figure) {
  return figure.title.empty() ? figure.name : figure.title;
}

const std::vector<FigureInfo>& frame_figure_infos() {
  static const std::vector<FigureInfo> infos = [] {
    std::vector<FigureInfo> all;
    for (const FrameFigure& figure : figure_table()) all.push_back(figure.info);
    return all;
  }();
  return infos;
}

const std::string& column_head(const FigureInfo& figure) {
  return figure.column.empty() ? figure.name : figure.column;
}

int first_method_figure() {
  const auto& all = figure_table();
  const auto is_of_method = [](const FrameFigure& figure) { return figure.of == nullptr; };
  return static_cast<int>(std::find_if(all.begin(), all.end(), is_of_method) - all.begin());
}

int frame_figure(std::string_view name) {
  if (name.empty()) return -1;
  const auto& infos = frame_figure_infos();
  const auto at = std::find_if(infos.begin(), infos.end(), [name](const FigureInfo& info) {
    return info.name == name || info.column == name || info.old_name == name;
  });
  return at == infos.end() ? -1 : static_cast<int>(at - infos.begin());
}

std::vector<double> frame_figure_values(const MeasuredFrames& frames, int figure) {
  const FrameFigure& wanted = figure_table().at(static_cast<std::size_t>(figure));
  return values_of(frames, wanted, wanted.of_removal ? removal_of(frames) : RemovalErrors{});
}

std::vector<double> figures_of_frame(const MeasuredFrames& frames, std::size_t row) {
  std::vector<double> values;
  values.reserve(figure_table().size());
  for (const FrameFigure& figure : figure_table())
    values.push_back(value_of(figure, row_of(frames, row, {})));
  return values;
}

FrameFigures::FrameFigures(const MeasuredFrames& frames) {
  for (const FrameRecord& record : frames.records) frames_.push_back(record.index);
  const RemovalErrors removal = removal_of(frames);
  columns_.reserve(figure_table().size());
  for (const FrameFigure& figure : figure_table()) columns_.push_back(values_of(frames, figure, removal));
}

}  // namespace stillpoint
