#include "core/inspect/frame_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/inspect/run_view.hpp"
#include "core/median.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/worst_frames.hpp"

namespace stillpoint {
namespace {

constexpr double kWorstShare = 0.1;  // of the frames, from the worst one on
constexpr double kTimesUsual = 2.0;  // a bad value is that far off the run's median
constexpr double kManyOnDynamic =
    0.15;                        // share of a pose's inliers: more on dynamic objects explain an error
constexpr double kLowIou = 0.5;  // below, more of mask and truth differs than agrees
constexpr double kWayBack =
    0.5;                    // of a step's error: one that takes so much off the absolute error comes back
constexpr int kFewest = 5;  // frames with a value: among fewer there is no rank and nothing usual

const FigureInfo& info_of(int figure) { return frame_figure_infos()[static_cast<std::size_t>(figure)]; }

std::string ordinal(int n) {
  const int tens = n % 100;
  const char* ending = tens >= 11 && tens <= 13 ? "th"
                       : n % 10 == 1            ? "st"
                       : n % 10 == 2            ? "nd"
                       : n % 10 == 3            ? "rd"
                                                : "th";
  return fmt::format("{}{}", n, ending);
}

/// A figure of one frame among those of its run.
struct Standing {
  double value = 0.0, median = 0.0;
  int rank = 0, of = 0;  // 1 = the worst
  bool bad = false;
};

std::optional<Standing> standing_of(const MeasuredFrames& frames, int figure, std::size_t row) {
  std::vector<double> values = frame_figure_values(frames, figure);
  Standing standing{.value = values[row]};
  if (!std::isfinite(standing.value)) return std::nullopt;
  const bool low_is_bad = info_of(figure).worse == WorseWhen::low;
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  standing.of = static_cast<int>(values.size());
  standing.rank = 1 + static_cast<int>(std::count_if(values.begin(), values.end(), [&](double value) {
                    return low_is_bad ? value < standing.value : value > standing.value;
                  }));
  standing.median = median_of(values);
  const bool among_worst =
      standing.of >= kFewest && standing.rank <= std::max(1.0, std::ceil(kWorstShare * standing.of));
  standing.bad = among_worst && (low_is_bad ? kTimesUsual * standing.value < standing.median
                                            : standing.value > kTimesUsual * standing.median);
  return standing;
}

/// A frame's masks against the true ones; nothing where these are not known.
std::optional<FrameScores> scores_of(const RunView& run, std::size_t row) {
  if (row >= run.scores.size()) return std::nullopt;
  const FrameScores scores = run.scores[row];
  return scores.known ? std::optional(scores) : std::nullopt;
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100.0 * share); }

/// A step that is far off may be the way back from poses that were: says since when. Empty where it is not,
/// and where there is no ground truth.
std::string way_back_of(const RunView& run, std::size_t row, int figure, double step) {
  if (row == 0 || figure != frame_figure("rpe")) return {};
  const int absolute = frame_figure("ate");
  const std::vector<double> off = frame_figure_values(run.measured(), absolute);
  // Where either is not known this compares false.
  if (!(off[row - 1] - off[row] > kWayBack * step)) return {};
  std::size_t since = row - 1;
  while (since > 0 && off[since - 1] < off[since]) --since;
  return fmt::format("the estimate comes back, gone off since frame {} by {}", run.records[since].index,
                     shown_value(info_of(absolute), off[row - 1]));
}

/// What was recorded that explains a bad pose, likeliest first.
std::string cause_of(const RunView& run, std::size_t row, bool removal_hurt) {
  const FrameRecord& record = run.records[row];
  const std::optional<FrameScores> known = scores_of(run, row);
  const FrameScores* scores = known ? &*known : nullptr;
  if (scores != nullptr && record.inliers > 0 &&
      scores->dynamic_inliers > kManyOnDynamic * static_cast<double>(record.inliers)) {
    const std::optional<double> recall = scores->mask.recall();
    return fmt::format("{} of {} inliers lie on dynamic objects{}", scores->dynamic_inliers, record.inliers,
                       recall ? fmt::format("; the mask holds {} of these", percent(*recall)) : "");
  }
  if (removal_hurt) return "solved without removal, the step is better";
  if (std::string remarks = remarks_on(record); !remarks.empty()) return remarks;
  const auto inliers = standing_of(run.measured(), frame_figure("inliers"), row);
  if (inliers && inliers->bad)
    return fmt::format("the pose rests on {:.0f} inliers, usually {:.0f}", inliers->value, inliers->median);
  if (const auto residual = standing_of(run.measured(), frame_figure("residual"), row);
      residual && residual->bad)
    return fmt::format("inliers miss by {:.2f} px, usually {:.2f}", residual->value, residual->median);
  if (scores != nullptr && scores->mask.iou() && *scores->mask.iou() < kLowIou)
    return fmt::format("the mask agrees with the ground truth to {} (IoU)", percent(*scores->mask.iou()));
  return "nothing recorded explains it";
}

/// Through fmt, for GCC 12 warns falsely of a literal copied into an aggregate's string.
FrameVerdict::Part part_of(const char* text, Tone tone) { return {fmt::format("{}", text), tone}; }

FrameVerdict::Part mask_part(const FrameRecord& record, const FrameScores* scores) {
  // A method that judges features, not pixels, has no mask to tell the size of.
  if (record.mask_share == 0.0 && record.features_removed > 0)
    return {fmt::format("{} of {} features removed", record.features_removed, record.features_found),
            Tone::neutral};
  FrameVerdict::Part part{fmt::format("mask {:.1f} %", 100.0 * record.mask_share), Tone::neutral};
  if (scores != nullptr && scores->mask.iou()) {
    part.text += fmt::format(", IoU {}", percent(*scores->mask.iou()));
    part.tone = *scores->mask.iou() < kLowIou ? Tone::bad : Tone::good;
  }
  return part;
}

FrameVerdict without_pose(const FrameRecord& record) {
  FrameVerdict verdict;
  verdict.bad = true;
  verdict.parts.push_back({std::string(to_string(record.status)), Tone::bad});
  verdict.sentence =
      record.note.empty() ? "No pose could be estimated." : fmt::format("No pose: {}.", record.note);
  return verdict;
}

}  // namespace

FrameVerdict frame_verdict(const RunView& run, std::size_t row, const std::vector<int>& hurt) {
  const FrameRecord& record = run.records[row];
  if (record.status == FrameStatus::lost || record.status == FrameStatus::unreadable)
    return without_pose(record);
  FrameVerdict verdict;
  const bool removal_hurt = std::binary_search(hurt.begin(), hurt.end(), record.index);
  const std::optional<FrameScores> known = scores_of(run, row);
  const FrameScores* scores = known ? &*known : nullptr;

  const int figure = usual_figure(run.measured());
  const auto standing = standing_of(run.measured(), figure, row);
  if (standing) {
    std::string text =
        fmt::format("{} {}", shown_name(info_of(figure)), shown_value(info_of(figure), standing->value));
    if (standing->rank == 1 && standing->of >= kFewest)
      text += fmt::format(", worst of {}", standing->of);
    else if (standing->of >= kFewest && 2 * standing->rank <= standing->of)
      text += fmt::format(", {} worst of {}", ordinal(standing->rank), standing->of);
    verdict.parts.push_back({std::move(text), standing->bad ? Tone::bad : Tone::good});
  }
  if (record.measured.mask) verdict.parts.push_back(mask_part(record, scores));
  if (scores != nullptr && record.inliers > 0) {
    const bool many = scores->dynamic_inliers > kManyOnDynamic * static_cast<double>(record.inliers);
    verdict.parts.push_back(
        {fmt::format("{} of {} inliers on dynamic objects", scores->dynamic_inliers, record.inliers),
         many ? Tone::bad : Tone::good});
  } else if (figure != frame_figure("inliers") && record.inliers > 0) {
    verdict.parts.push_back({fmt::format("{} inliers", record.inliers)});
  }
  if (record.direct.believed)
    verdict.parts.push_back(part_of("aligned directly: too few matches", Tone::neutral));
  if (removal_hurt) verdict.parts.push_back(part_of("removal hurt", Tone::bad));

  verdict.bad = standing && standing->bad;
  if (verdict.bad) {
    std::string cause = way_back_of(run, row, figure, standing->value);
    if (cause.empty()) cause = cause_of(run, row, removal_hurt);
    verdict.sentence = fmt::format("{} where {} is usual: {}.", shown_value(info_of(figure), standing->value),
                                   shown_value(info_of(figure), standing->median), cause);
  } else if (record.status == FrameStatus::initialised)
    verdict.sentence = record.measured.points ? "The map begins here." : "The run begins here.";
  else if (standing && standing->of >= kFewest)
    verdict.sentence =
        fmt::format("As usual in this run (median {}).", shown_value(info_of(figure), standing->median));
  return verdict;
}

}  // namespace stillpoint
