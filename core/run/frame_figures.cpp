#include "core/run/frame_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/run/figure_table.hpp"
#include "core/run/frame_scores.hpp"

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

template <typename Take>
void walk(const MeasuredFrames& frames, const RemovalErrors& removal, const Take& take) {
  static const FrameScores none;
  static const ScoreList no_scores;
  const ScoreList& scores = frames.scores != nullptr ? *frames.scores : no_scores;
  auto score = scores.begin();
  for (const FrameRecord& record : frames.records) {
    const bool scored = score != scores.end();
    const auto checked = removal.find(record.index);
    take(MeasuredFrame{record, scored ? *score : none, frames.evaluation,
                       checked == removal.end() ? nullptr : &checked->second});
    if (scored) ++score;
  }
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
  std::vector<double> values;
  values.reserve(frames.records.size());
  walk(frames, wanted.of_removal ? removal_of(frames) : RemovalErrors{},
       [&](const MeasuredFrame& row) { values.push_back(value_of(wanted, row)); });
  return values;
}

std::vector<double> figures_of_frame(const MeasuredFrames& frames, std::size_t row) {
  const FrameRecord record = frames.records[row];
  const FrameScores scores =
      frames.scores != nullptr && row < frames.scores->size() ? (*frames.scores)[row] : FrameScores{};
  std::vector<double> values;
  values.reserve(figure_table().size());
  for (const FrameFigure& figure : figure_table())
    values.push_back(value_of(figure, {record, scores, frames.evaluation, nullptr}));
  return values;
}

void walk_figures(const MeasuredFrames& frames,
                  const std::function<void(const FrameRecord&, const std::vector<double>&)>& take) {
  std::vector<double> values(figure_table().size());
  walk(frames, removal_of(frames), [&](const MeasuredFrame& row) {
    std::transform(figure_table().begin(), figure_table().end(), values.begin(),
                   [&row](const FrameFigure& figure) { return value_of(figure, row); });
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
  for (const int figure : figures)
    columns_.at(static_cast<std::size_t>(figure)).reserve(frames.records.size());
  const bool any_of_removal = std::any_of(figures.begin(), figures.end(), [](int figure) {
    return figure_table()[static_cast<std::size_t>(figure)].of_removal;
  });
  walk(frames, any_of_removal ? removal_of(frames) : RemovalErrors{}, [&](const MeasuredFrame& row) {
    frames_.push_back(row.record.index);
    for (const int figure : figures)
      columns_[static_cast<std::size_t>(figure)].push_back(
          value_of(figure_table()[static_cast<std::size_t>(figure)], row));
  });
}

}  // namespace stillpoint
