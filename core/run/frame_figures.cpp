#include "core/run/frame_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <unordered_map>

#include "core/run/figure_table.hpp"
#include "core/run/frame_scores.hpp"

namespace stillpoint {
namespace {

/// A figure that record and scores tell; NaN where it is not known.
double value_of(const FrameFigure& figure, const MeasuredFrame& row) {
  if (figure.of_frame != nullptr) return figure.of_frame(row);
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

/// A figure that errors tell; NaN where it is not known. @param evaluation may be null
double value_of(const FrameFigure& figure, const FrameOutline& frame, const TrajectoryEvaluation* evaluation,
                const RemovalErrors& removal) {
  if (figure.of_evaluation != nullptr)
    return evaluation != nullptr ? figure.of_evaluation(frame, *evaluation) : kUnknownFigure;
  const auto checked = removal.find(frame.index);
  return checked != removal.end() ? figure.of_removal(checked->second) : kUnknownFigure;
}

/// @param from row to begin with
template <typename Take>
void walk(const MeasuredFrames& frames, const Take& take, std::size_t from = 0) {
  static const FrameScores none;
  static const ScoreList no_scores;
  const ScoreList& scores = frames.scores != nullptr ? *frames.scores : no_scores;
  auto score = scores.begin() + static_cast<std::ptrdiff_t>(std::min(from, scores.size()));
  const auto end = frames.records.end();
  for (auto record = frames.records.begin() + static_cast<std::ptrdiff_t>(from); record != end; ++record) {
    const bool scored = score != scores.end();
    take(MeasuredFrame{*record, scored ? *score : none});
    if (scored) ++score;
  }
}

/// All of one frame. @param values one a figure of the table
void figures_into(std::vector<double>& values, const MeasuredFrame& row,
                  const TrajectoryEvaluation* evaluation, const RemovalErrors& removal) {
  const FrameOutline outline = outline_of(row.record);
  std::transform(
      figure_table().begin(), figure_table().end(), values.begin(), [&](const FrameFigure& figure) {
        return figure.is_of_errors() ? value_of(figure, outline, evaluation, removal) : value_of(figure, row);
      });
}

std::vector<double> values_of_errors(const FrameFigure& figure, const MeasuredFrames& frames) {
  const RemovalErrors removal = figure.of_removal != nullptr ? removal_of(frames) : RemovalErrors{};
  std::vector<double> values;
  values.reserve(frames.records.size());
  for (const FrameOutline& frame : frames.records.outlines())
    values.push_back(value_of(figure, frame, frames.evaluation, removal));
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

bool needs_evaluation(int figure) {
  return figure_table().at(static_cast<std::size_t>(figure)).is_of_errors();
}

int first_method_figure() {
  const auto& all = figure_table();
  return static_cast<int>(std::find_if(all.begin(), all.end(), std::mem_fn(&FrameFigure::is_of_method)) -
                          all.begin());
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
  if (wanted.is_of_errors()) return values_of_errors(wanted, frames);
  if (frames.columns != nullptr) return frames.columns->values(frames, figure);
  std::vector<double> values;
  values.reserve(frames.records.size());
  walk(frames, [&](const MeasuredFrame& row) { values.push_back(value_of(wanted, row)); });
  return values;
}

std::vector<double> FigureColumns::values(const MeasuredFrames& frames, int figure) {
  const std::lock_guard lock(mutex_);
  const std::size_t rows = frames.records.size();
  std::vector<double>& column = columns_[figure];
  // One pass for all that go as far as this one, for they are asked for one after the other.
  const std::size_t known = column.size();
  std::vector<std::pair<const FrameFigure*, std::vector<double>*>> behind;
  for (auto& [of, one] : columns_)
    if (one.size() == known) behind.emplace_back(&figure_table().at(static_cast<std::size_t>(of)), &one);
  if (known < rows)
    walk(
        frames,
        [&](const MeasuredFrame& row) {
          for (const auto& [of, one] : behind) one->push_back(value_of(*of, row));
        },
        known);
  return {column.begin(), column.begin() + static_cast<std::ptrdiff_t>(rows)};
}

std::vector<double> figures_of_frame(const MeasuredFrames& frames, std::size_t row) {
  const FrameRecord record = frames.records[row];
  const FrameScores scores =
      frames.scores != nullptr && row < frames.scores->size() ? (*frames.scores)[row] : FrameScores{};
  std::vector<double> values(figure_table().size());
  figures_into(values, {record, scores}, frames.evaluation, {});
  return values;
}

void walk_figures(const MeasuredFrames& frames,
                  const std::function<void(const FrameRecord&, const std::vector<double>&)>& take) {
  std::vector<double> values(figure_table().size());
  const RemovalErrors removal = removal_of(frames);
  walk(frames, [&](const MeasuredFrame& row) {
    figures_into(values, row, frames.evaluation, removal);
    take(row.record, values);
  });
}

namespace {

std::set<int> all_figure_indices() {
  std::set<int> all;
  for (int i = 0; i < static_cast<int>(figure_table().size()); ++i) all.insert(i);
  return all;
}

}  // namespace

FrameFigures::FrameFigures(const MeasuredFrames& frames) : FrameFigures(frames, all_figure_indices()) {}

FrameFigures::FrameFigures(const MeasuredFrames& frames, const std::set<int>& figures)
    : columns_(figure_table().size()) {
  frames_.reserve(frames.records.size());
  for (const FrameOutline& outline : frames.records.outlines()) frames_.push_back(outline.index);
  std::vector<int> in_one_pass;
  for (const int figure : figures) {
    if (needs_evaluation(figure) || frames.columns != nullptr)
      columns_[static_cast<std::size_t>(figure)] = frame_figure_values(frames, figure);
    else
      in_one_pass.push_back(figure);
  }
  if (in_one_pass.empty()) return;
  for (const int figure : in_one_pass)
    columns_[static_cast<std::size_t>(figure)].reserve(frames.records.size());
  walk(frames, [&](const MeasuredFrame& row) {
    for (const int figure : in_one_pass)
      columns_[static_cast<std::size_t>(figure)].push_back(
          value_of(figure_table()[static_cast<std::size_t>(figure)], row));
  });
}

}  // namespace stillpoint
