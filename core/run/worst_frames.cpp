#include "core/run/worst_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

std::string in_lower_case(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

}  // namespace

int usual_figure(const MeasuredFrames& frames) {
  const bool truth = frames.evaluation != nullptr && !frames.evaluation->rpe_frame.errors.empty();
  return frame_figure(truth ? "rpe" : "inliers");
}

std::vector<WorstFrame> worst_frames(const MeasuredFrames& frames, int figure, int apart, std::size_t most) {
  const FigureInfo& info = frame_figure_infos().at(static_cast<std::size_t>(figure));
  std::vector<WorstFrame> worst;
  const FrameOutlines& outlines = frames.records.outlines();
  bool posed = true;  // the frame before
  std::size_t row = 0;
  for (const FrameOutline& frame : outlines) {
    if (worst.size() >= most) break;
    if (is_lost(frame.status) && posed) {
      const std::string note = frames.records[row].note;
      worst.push_back(
          {frame.index, fmt::format("{}{}{}", to_string(frame.status), note.empty() ? "" : ": ", note)});
    }
    posed = !is_lost(frame.status);
    ++row;
  }
  struct Ranked {
    double badness;  // negated, so that ties stand in order of time
    int index;
    double value;
  };
  std::vector<Ranked> ranked;
  const std::vector<double> values = frame_figure_values(frames, figure);
  const double sign = info.worse == WorseWhen::low ? 1.0 : -1.0;
  auto value = values.begin();
  for (const FrameOutline& frame : outlines) {
    const double known = *value++;
    if (std::isfinite(known) && !is_lost(frame.status) &&
        (frame.status != FrameStatus::initialised || info.worse != WorseWhen::low))
      ranked.push_back({sign * known, frame.index, known});
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Ranked& a, const Ranked& b) { return a.badness < b.badness; });
  ranked.resize((ranked.size() + 1) / 2);
  for (const Ranked& one : ranked) {
    if (worst.size() >= most) break;
    const auto near = [&](const WorstFrame& other) { return std::abs(other.index - one.index) < apart; };
    if (std::none_of(worst.begin(), worst.end(), near))
      worst.push_back(
          {one.index, fmt::format("{} {}", in_lower_case(shown_name(info)), shown_value(info, one.value))});
  }
  return worst;
}

}  // namespace stillpoint
