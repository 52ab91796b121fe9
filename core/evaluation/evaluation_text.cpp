// An evaluation as people read it: every figure with its association, alignment, delta, unit and number of
// pairs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/counted.hpp"
#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {
namespace {

/// Rows of statistics under one head.
class StatisticsTable {
 public:
  explicit StatisticsTable(std::string& text) : text_(text) {
    text_ += fmt::format("\n{:<27}{:<5}{:>7}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "unit", "pairs",
                         "RMSE", "mean", "median", "std", "min", "max");
  }
  void row(const std::string& name, const char* unit, const ErrorStatistics& s, const std::string& why) {
    if (s.count == 0) {
      text_ += fmt::format("{:<26} {:<5}{:>7}{:>10}  {}\n", name, unit, s.count, "–", why);
      return;
    }
    text_ += fmt::format("{:<26} {:<5}{:>7} {:>9.5f} {:>9.5f} {:>9.5f} {:>9.5f} {:>9.5f} {:>9.5f}\n", name,
                         unit, s.count, s.rmse, s.mean, s.median, s.stddev, s.min, s.max);
  }
  void rows(const RelativePoseError& rpe) {
    row(fmt::format("RPE {} translation", rpe.delta), "m", rpe.translation_m, rpe.why_none);
    row(fmt::format("RPE {} rotation", rpe.delta), "deg", rpe.rotation_deg, rpe.why_none);
  }

 private:
  std::string& text_;
};

std::string association_text(const EvaluationOptions& options) {
  if (options.interpolate_truth)
    return fmt::format("truth interpolated at the estimate's stamps, across gaps up to {} s",
                       options.interpolation_gap_s);
  return options.nearest ? fmt::format("each to the nearest, at most {} s apart", options.max_difference_s)
                         : fmt::format("one to one, closer than {} s", options.max_difference_s);
}

std::string alignment_text(const TrajectoryEvaluation& e, const EvaluationOptions& options) {
  switch (options.align) {
    case AlignBy::nothing:
      return "not at all";
    case AlignBy::origin:
      return "by the first matched pose";
    case AlignBy::first:
      return options.align_first > static_cast<int>(e.matched.size())
                 ? fmt::format("rigidly (SE(3)) by all {}, fewer than the first {} asked for",
                               counted(e.matched.size(), "matched pose"), options.align_first)
                 : fmt::format("rigidly (SE(3)) by the first {} matched poses", options.align_first);
    case AlignBy::similarity:
      return "with scale (Sim(3))";
    case AlignBy::rigid:
      break;
  }
  return fmt::format(
      "rigidly, without scale{}",
      e.ate.alignment.degenerate ? "; positions on a line or too few, so by orientations too" : "");
}

/// A box of the middle half with its median, and the ends as whiskers, on a scale from 0 to `largest`.
std::string box_plot(const ErrorStatistics& s, double largest, int width) {
  const auto at = [&](double value) {
    return largest > 0
               ? std::clamp(static_cast<int>(std::lround(value / largest * (width - 1))), 0, width - 1)
               : 0;
  };
  std::vector<std::string> cells(static_cast<std::size_t>(width), " ");
  for (int i = at(s.min); i <= at(s.max); ++i) cells[static_cast<std::size_t>(i)] = "─";
  for (int i = at(s.lower_quartile); i <= at(s.upper_quartile); ++i) cells[static_cast<std::size_t>(i)] = "▒";
  cells[static_cast<std::size_t>(at(s.min))] = "├";
  cells[static_cast<std::size_t>(at(s.max))] = "┤";
  cells[static_cast<std::size_t>(at(s.median))] = "█";
  std::string plot;
  for (const std::string& cell : cells) plot += cell;
  return plot;
}

std::string lengths_text(const std::vector<RelativePoseError>& by_length) {
  constexpr int kPlotWidth = 40;  // characters: a row still fits a screen
  double largest = 0.0;
  for (const RelativePoseError& part : by_length) largest = std::max(largest, part.translation_m.max);
  std::string text = fmt::format(
      "\nParts of the path by length: translation at their ends, each aligned at its start [m]\n"
      "{:<10}{:>7}{:>10}{:>10}{:>10}{:>10}{:>10}{:>9}  0 to {:.4f} m\n",
      "length", "parts", "min", "quartile", "median", "quartile", "max", "deg", largest);
  for (const RelativePoseError& part : by_length) {
    const ErrorStatistics& s = part.translation_m;
    text += s.count == 0
                ? fmt::format("{:<10}{:>7}{:>10}  {}\n", part.delta, 0, "–", part.why_none)
                : fmt::format("{:<10}{:>7}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>9.3f}  {}\n",
                              part.delta, s.count, s.min, s.lower_quartile, s.median, s.upper_quartile, s.max,
                              part.rotation_deg.median, box_plot(s, largest, kPlotWidth));
  }
  return text;
}

}  // namespace

std::string to_text(const TrajectoryEvaluation& e, const EvaluationOptions& options) {
  std::string text;
  if (options.protocol != Protocol::stillpoint)
    text += fmt::format("Protocol  {}\n", options.protocol == Protocol::evo
                                              ? "evo's: evo_ape and evo_rpe without options"
                                              : "the TUM benchmark's scripts without options");
  text += fmt::format("Matched   {} of {}, to {} of ground truth: {}\n", e.matched.size(),
                      counted(e.estimated_poses, "estimated pose"), e.truth_poses, association_text(options));
  text += e.coverage ? fmt::format("Coverage  {:.1f} %: {} for {}\n", 100.0 * *e.coverage,
                                   counted(e.estimated_poses, "pose"), counted(e.expected_frames, "frame"))
                     : "Coverage  not known without the number of frames (--frames, --sequence)\n";
  if (e.truth_span_s > 0)
    text += fmt::format("Time      matched poses span {:.3f} s of the truth's {:.3f} s ({:.1f} %)\n",
                        e.matched_span_s, e.truth_span_s, 100.0 * e.matched_span_s / e.truth_span_s);
  text += fmt::format("Aligned   {}\n", alignment_text(e, options));
  if (options.align == AlignBy::similarity)
    text += fmt::format("Scale     the estimate's lengths were multiplied by {:.4f}\n", e.applied_scale);
  else if (e.ate.similarity)
    text += fmt::format(
        "Scale     {:.4f} would fit best, and leave an ATE of {:.5f} m (--align sim3 applies it)\n",
        e.ate.similarity->scale, e.ate.similarity->rmse_m);
  StatisticsTable table(text);
  table.row("ATE translation", "m", e.ate.translation_m, e.ate.why_none);
  table.row("ATE rotation", "deg", e.ate.rotation_deg, e.ate.why_none);
  if (options.protocol == Protocol::stillpoint) table.rows(e.rpe_time);
  if (options.protocol != Protocol::tum) table.rows(e.rpe_frame);
  for (const RelativePoseError& rpe : e.rpe_more) table.rows(rpe);
  if (options.protocol == Protocol::stillpoint)
    text += fmt::format(
        "\nRPE {}: each matched pose with the one nearest {} later; {} without one within {} s dropped\n"
        "RPE {}: each matched pose with the next; {} above {:.3f} s ({} times the median) dropped\n",
        e.rpe_time.delta, e.rpe_time.delta, e.rpe_time.dropped, e.rpe_time.limit_s, e.rpe_frame.delta,
        counted(e.rpe_frame.dropped, "gap"), e.rpe_frame.limit_s, options.neighbour_gap);
  if (!e.by_length.empty()) text += lengths_text(e.by_length);
  return text;
}

}  // namespace stillpoint
