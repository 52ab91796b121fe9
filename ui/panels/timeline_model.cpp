#include "ui/panels/timeline_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/inspect/run_view.hpp"
#include "core/run/frame_figures.hpp"
#include "ui/session/data_sources.hpp"

namespace stillpoint {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kByBadness{FrameStatus::tracked, FrameStatus::initialised, FrameStatus::relocalised,
                                FrameStatus::lost, FrameStatus::unreadable};

/// The columns a frame fills, cut to those there are; the second below the first = none.
std::pair<int, int> columns_of_frame(int frame, const AxisRange& range, int columns) {
  const double scale = columns / range.span();
  const double from = std::floor((frame - 0.5 - range.low) * scale),
               to = std::max(std::floor((frame + 0.5 - range.low) * scale) - 1.0, from);
  if (to < 0.0 || from >= columns) return {0, -1};
  return {static_cast<int>(std::max(from, 0.0)), static_cast<int>(std::min(to, columns - 1.0))};
}

/// A figure of each frame as people are shown it.
std::vector<double> lane_values(const RunView& run, int figure) {
  std::vector<double> values = frame_figure_values(run.measured(), figure);
  const double factor = shown_unit(frame_figure_infos().at(static_cast<std::size_t>(figure)).unit).factor;
  for (double& value : values) value *= factor;
  return values;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool any_known(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

double highest_of(const std::vector<double>& values, double so_far) {
  for (const double value : values)
    if (std::isfinite(value)) so_far = std::max(so_far, value);
  return so_far;
}

}  // namespace

std::string TimelineLane::range_text() const {
  const std::string_view unit = shown_unit(frame_figure_infos()[static_cast<std::size_t>(figure)].unit).unit;
  return greatest > 0.0 ? fmt::format("0–{}", format_value(greatest, unit)) : format_value(0.0, unit);
}

std::vector<ColumnValues> aggregate(std::span<const int> frames, std::span<const double> values,
                                    const AxisRange& range, int columns) {
  if (columns < 1 || !(range.span() > 0.0)) return {};
  std::vector<ColumnValues> out(static_cast<std::size_t>(columns), {kNothing, kNothing});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const auto [from, to] = columns_of_frame(frames[i], range, columns);
    for (int c = from; c <= to; ++c) {
      ColumnValues& column = out[static_cast<std::size_t>(c)];
      // fmin and fmax pass over NaN.
      column = {std::fmin(column.least, values[i]), std::fmax(column.greatest, values[i])};
    }
  }
  return out;
}

std::vector<ColumnRun> runs_of(const std::vector<ColumnValues>& columns) {
  std::vector<ColumnRun> runs;
  for (int c = 0; c < static_cast<int>(columns.size()); ++c) {
    const ColumnValues& here = columns[static_cast<std::size_t>(c)];
    if (std::isnan(here.greatest)) continue;
    const bool follows = !runs.empty() && runs.back().last == c - 1 &&
                         same(runs.back().values.least, here.least) &&
                         same(runs.back().values.greatest, here.greatest);
    if (follows)
      runs.back().last = c;
    else
      runs.push_back({c, c, here});
  }
  return runs;
}

std::vector<int> columns_of(const std::vector<int>& frames, const AxisRange& range, int columns) {
  std::vector<int> out;
  if (columns < 1 || !(range.span() > 0.0)) return out;
  for (const int frame : frames) {
    const auto [from, to] = columns_of_frame(frame, range, columns);
    if (to < from) continue;
    const int middle = (from + to) / 2;
    if (out.empty() || out.back() != middle) out.push_back(middle);
  }
  return out;
}

double badness_of(FrameStatus status) {
  return static_cast<double>(std::find(kByBadness.begin(), kByBadness.end(), status) - kByBadness.begin());
}

FrameStatus status_of_badness(double badness) {
  return kByBadness.at(static_cast<std::size_t>(std::clamp(badness, 0.0, 4.0)));
}

void TimelineModel::update(const SessionView& session, const std::vector<int>& wanted) {
  const RunView& run = *session.run;
  Key key{&run, session.revision, run.records.size(), {}, wanted};
  for (const GhostView& ghost : session.debug.ghosts)
    key.ghosts.emplace_back(ghost.run.get(), ghost.run->records.size());
  if (key == key_) return;
  key_ = std::move(key);

  const auto read = [](const RunView& one, std::vector<int>& indices, std::vector<double>& worst) {
    indices.clear();
    worst.clear();
    for (const FrameOutline& frame : one.records.outlines()) {
      indices.push_back(frame.index);
      worst.push_back(badness_of(frame.status));
    }
  };
  read(run, frames, badness);
  keyframes.clear();
  for (const FrameOutline& frame : run.records.outlines())
    if (frame.keyframe) keyframes.push_back(frame.index);
  const auto& ghosts = session.debug.ghosts;
  ghost_frames.resize(ghosts.size());
  ghost_badness.resize(ghosts.size());
  for (std::size_t g = 0; g < ghosts.size(); ++g) read(*ghosts[g].run, ghost_frames[g], ghost_badness[g]);

  lanes.clear();
  for (const int figure : wanted) {
    TimelineLane lane{.figure = figure, .values = lane_values(run, figure), .ghosts = {}};
    bool known = any_known(lane.values);
    lane.greatest = highest_of(lane.values, 0.0);
    for (const GhostView& ghost : ghosts) {
      lane.ghosts.push_back(lane_values(*ghost.run, figure));
      lane.greatest = highest_of(lane.ghosts.back(), lane.greatest);
      known = known || any_known(lane.ghosts.back());
    }
    // Without a truth there are no errors, without a clock no times, and a trajectory alone has no masks.
    if (!known) continue;
    lane.highest = lane.greatest > 0.0 ? 1.05 * lane.greatest : 1.0;
    lanes.push_back(std::move(lane));
  }
}

void SpanDrag::begin(int frame, const std::optional<FrameSpan>& present, double reach) {
  at_ = frame;
  moved_ = false;
  anchor_ = frame;
  if (!present) return;
  const int to_first = std::abs(frame - present->first), to_last = std::abs(frame - present->last);
  if (std::min(to_first, to_last) > reach) return;
  anchor_ = to_first < to_last ? present->last : present->first;
  moved_ = true;
}

void SpanDrag::move(int frame) {
  moved_ = moved_ || frame != at_;
  at_ = frame;
}

std::optional<FrameSpan> SpanDrag::span(int frame_count) const {
  if (!anchor_ || !moved_) return std::nullopt;
  return span_between(*anchor_, at_, frame_count);
}

std::optional<FrameSpan> SpanDrag::end(int frame_count) {
  const std::optional<FrameSpan> selected = span(frame_count);
  anchor_.reset();
  moved_ = false;
  return selected;
}

}  // namespace stillpoint
