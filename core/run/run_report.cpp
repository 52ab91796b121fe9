#include "core/run/run_report.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.hpp"
#include "core/evaluation/doubts.hpp"
#include "core/evaluation/evaluation_json.hpp"
#include "core/motion/masks/outside_masks.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

SpeedFigures speed_of(const RunResult& run) {
  SpeedFigures speed;
  std::vector<double> totals;
  for (const FrameRecord& r : run.records) {
    if (r.status == FrameStatus::unreadable) continue;
    totals.push_back(r.ms.total);
    speed.mean.motion += r.ms.motion;
    speed.mean.features += r.ms.features;
    speed.mean.matching += r.ms.matching;
    speed.mean.pose += r.ms.pose;
    speed.mean.mapping += r.ms.mapping;
    speed.mean.bundle += r.ms.bundle;
    speed.mean.total += r.ms.total;
    speed.mean.stereo += r.ms.stereo;
  }
  if (totals.empty()) return speed;
  for (double* sum : {&speed.mean.motion, &speed.mean.features, &speed.mean.matching, &speed.mean.pose,
                      &speed.mean.mapping, &speed.mean.bundle, &speed.mean.total, &speed.mean.stereo})
    *sum /= static_cast<double>(totals.size());
  speed.median_ms = quantile(totals, 0.5);
  speed.p99_ms = quantile(totals, 0.99);
  speed.orb_unit_ms = run.orb_unit_ms;
  if (run.orb_unit_ms > 0) speed.units = speed.median_ms / run.orb_unit_ms;
  return speed;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// What any frame tells of; of a run without frames all, as its figures are sums over none.
RecordParts parts_of(const RunResult& run) {
  if (run.records.empty()) return {};
  RecordParts any = poses_alone();
  for (const FrameRecord& record : run.records) {
    any.mask = any.mask || record.measured.mask;
    any.features = any.features || record.measured.features;
    any.matches = any.matches || record.measured.matches;
  }
  // The rest is the engine's, and so the same for all frames.
  RecordParts parts = run.records.begin()->measured;
  parts.mask = any.mask, parts.features = any.features, parts.matches = any.matches;
  return parts;
}

nlohmann::ordered_json speed_json(const SpeedFigures& speed) {
  nlohmann::ordered_json json;
  json["median_ms"] = speed.median_ms;
  json["p99_ms"] = speed.p99_ms;
  json["orb_unit_ms"] = speed.orb_unit_ms > 0 ? nlohmann::ordered_json(speed.orb_unit_ms) : nullptr;
  json["units"] = speed.units > 0 ? nlohmann::ordered_json(speed.units) : nullptr;
  json["mean_ms"] = {{"motion", speed.mean.motion},     {"features", speed.mean.features},
                     {"matching", speed.mean.matching}, {"pose", speed.mean.pose},
                     {"mapping", speed.mean.mapping},   {"bundle", speed.mean.bundle},
                     {"total", speed.mean.total}};
  if (speed.mean.stereo > 0) json["mean_ms"]["stereo"] = speed.mean.stereo;
  return json;
}

/// "12-15, 40": the frames of a status, neighbours joined.
template <typename Predicate>
std::string ranges(const FrameRecords& records, Predicate is) {
  std::string text;
  int first = 0;
  std::optional<int> last;  // of those that are, while the stretch goes on
  const auto end = [&] {
    if (!last) return;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", first);
    if (*last > first) text += fmt::format("-{}", *last);
    last.reset();
  };
  for (const FrameRecord& record : records) {
    if (!is(record)) {
      end();
      continue;
    }
    if (!last) first = record.index;
    last = record.index;
  }
  end();
  return text;
}

/// A frame that lacks something, and why.
struct Lacking {
  int index = 0;
  std::string why;
};

/// "8 of 40 frames: 2, 11 (no depth image within 0.02 s); 10 (rgb/7.png holds 8 bits)": reasons that differ
/// in numbers alone (names of files) stand together, and what is rare is told as well as what is common.
std::string gaps_text(const RunResult& run, const std::vector<Lacking>& lacking) {
  constexpr std::size_t kMostReasons = 4;  // kinds: the sentence stays readable
  if (lacking.empty()) return {};
  const auto kind_of = [](std::string why) {
    std::erase_if(why, [](char c) { return c >= '0' && c <= '9'; });
    return why;
  };
  std::vector<std::pair<std::string, std::vector<Lacking>>> kinds;
  for (const Lacking& one : lacking) {
    const std::string kind = kind_of(one.why);
    auto at = std::find_if(kinds.begin(), kinds.end(), [&kind](const auto& k) { return k.first == kind; });
    if (at == kinds.end()) at = kinds.insert(kinds.end(), {kind, {}});
    at->second.push_back(one);
  }
  std::string text = fmt::format("{} of {}: ", lacking.size(), counted(run.records.size(), "frame"));
  for (std::size_t k = 0; k < std::min(kinds.size(), kMostReasons); ++k) {
    const std::vector<Lacking>& of_kind = kinds[k].second;
    // In order of frames, as they were found.
    const auto holds = [at = of_kind.begin(), end = of_kind.end()](const FrameRecord& r) mutable {
      while (at != end && at->index < r.index) ++at;
      return at != end && at->index == r.index;
    };
    const bool others = std::any_of(of_kind.begin(), of_kind.end(),
                                    [&](const Lacking& one) { return one.why != of_kind.front().why; });
    text += fmt::format("{}{} ({}{})", k > 0 ? "; " : "", ranges(run.records, holds), of_kind.front().why,
                        others ? ", …" : "");
  }
  if (kinds.size() > kMostReasons) text += fmt::format("; and {} more reasons", kinds.size() - kMostReasons);
  return text;
}

/// Which frames lacked depth, and why.
std::string depth_gaps(const RunResult& run) {
  std::vector<Lacking> lacking;
  for (const DepthGap& gap : run.without_depth) lacking.push_back({gap.index, gap.why});
  return gaps_text(run, lacking);
}

/// Which frames could not be read, and why.
std::string image_gaps(const RunResult& run) {
  std::vector<Lacking> lacking;
  for (const FrameRecord& record : run.records)
    if (record.status == FrameStatus::unreadable) lacking.push_back({record.index, record.note});
  return gaps_text(run, lacking);
}

/// Which frames were read and have no pose, and why.
std::string pose_gaps(const RunResult& run) {
  std::vector<Lacking> lacking;
  for (const FrameRecord& record : run.records)
    if (!record.estimated && record.status != FrameStatus::unreadable)
      lacking.push_back({record.index, record.note.empty() ? "lost" : record.note});
  return gaps_text(run, lacking);
}

/// Which frames lacked the mask that was to be given, and why.
std::string mask_gaps(const RunResult& run) {
  std::vector<Lacking> lacking;
  for (const FrameRecord& record : run.records)
    if (!record.mask_problem.empty()) lacking.push_back({record.index, record.mask_problem});
  return gaps_text(run, lacking);
}

/// What lets truth and estimate fit far better. @param ours whether we made the estimate, from its depth
std::string doubt_of(const TrajectoryEvaluation& evaluation, const RunResult& run, const FrameSource& source,
                     bool ours) {
  if (!ours) {
    std::string all;
    for (const Doubt& doubt : doubts_about(source.ground_truth(), run.trajectory, evaluation, AlignBy::rigid,
                                           "stillpoint evaluate "))
      all += (all.empty() ? "" : "; ") + doubt.sentence;
    return all;
  }
  if (const auto suspicion = suspect_convention(evaluation.matched, false)) return suspicion->sentence();
  const std::string scale = scale_sentence(evaluation);
  if (scale.empty()) return {};
  if (const auto late = source.depth_late_s())
    return fmt::format(
        "its lengths do not fit the ground truth, as happens where depth is of another time than colour: the "
        "clock of depth, which seems {:.3f} s {}, comes first",
        std::abs(*late), *late > 0 ? "late" : "early");
  return scale + ": " + scale_question(evaluation, source.camera().baseline_m);
}

/// That masks made elsewhere hold what stands still, where the truth says so; empty otherwise.
/// @param ours whether they are removed by in a run of ours, or another program's own
std::string inverted_doubt(const MaskScore& mask, const MasksConfig& config, bool ours) {
  constexpr double kGood = 0.5, kBetter = 4.0;  // IoU the other way round, and over that as they are read
  if (ours && config.sources.empty()) return {};
  // What the masks leave, held against the truth.
  const MaskScore other{mask.missed, mask.left_rightly, mask.found_rightly, mask.found_wrongly};
  const double as_read = mask.iou().value_or(0.0), otherwise = other.iou().value_or(0.0);
  if (mask.found_rightly + mask.found_wrongly == 0 || otherwise < kGood || otherwise < kBetter * as_read)
    return {};
  return fmt::format(
      "the masks hold what stands still: the other way round their IoU is {:.2f} instead of {:.2f}{}",
      otherwise, as_read,
      ours ? fmt::format(" (`--set masks.inverted={}` reads them so)", !config.inverted) : "");
}

std::string share_text(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100.0 * *share) : std::string("-");
}

}  // namespace

RunReport report_on(const RunResult& run, const FrameSource& source) {
  RunReport report;
  report.sequence = source.name();
  report.method = run.config.run.method;
  report.odometry = run.config.run.odometry;
  report.frames = static_cast<int>(run.records.size());
  report.tracked = run.tracked();
  report.lost = report.frames - report.tracked;
  report.coverage = report.frames > 0 ? static_cast<double>(report.tracked) / report.frames : 0.0;
  report.keyframes = static_cast<int>(run.keyframes.size());
  report.map_points = static_cast<int>(run.points.size());
  report.has_truth = !source.ground_truth().empty();
  if (report.has_truth && !run.trajectory.empty()) {
    EvaluationOptions options;
    options.expected_frames = report.frames;
    report.evaluation = evaluate_trajectory(source.ground_truth(), run.trajectory, options);
    report.evaluation_live = evaluate_trajectory(source.ground_truth(), run.live, options);
  }
  report.truth_why_not = source.why_not(FramePart::truth);
  report.without_image = image_gaps(run);
  report.without_depth = depth_gaps(run);
  report.without_mask = mask_gaps(run);
  report.without_pose = pose_gaps(run);
  for (const FrameScores& scores : run.scores) report.scores += scores;
  report.measured = parts_of(run);
  if (report.evaluation) report.doubt = doubt_of(*report.evaluation, run, source, report.measured.solving);
  // Masks of ours that leave nothing but what moves are to blame for all else.
  const bool ours = report.measured.solving;
  if (std::string inverted = inverted_doubt(report.scores.mask, run.config.of<MasksConfig>(), ours);
      !inverted.empty())
    report.doubt = ours || report.doubt.empty() ? std::move(inverted) : report.doubt + "; " + inverted;
  report.speed = speed_of(run);
  report.hash = run_hash(run.records);
  report.peak_memory_mb = peak_memory_mb();
  return report;
}

std::string why_no_rpe(const RunReport& report) {
  if (!report.truth_why_not.empty())
    return fmt::format("the ground truth is of no use: {}", report.truth_why_not);
  if (!report.has_truth) return "there is no ground truth";
  if (!report.evaluation) return "no frame has a pose";
  return report.evaluation->rpe_time.why_none;
}

std::string run_hash(const FrameRecords& records) {
  RunHash hash;
  for (const FrameRecord& record : records) hash.add(record);
  return hash.hex();
}

namespace {

nlohmann::ordered_json number_or_null(bool known, int number) {
  return known ? nlohmann::ordered_json(number) : nlohmann::ordered_json();
}

}  // namespace

nlohmann::ordered_json to_summary(const RunReport& report, const RunResult& run, const FrameSource& source) {
  nlohmann::ordered_json json;
  json["sequence"] = report.sequence;
  json["camera"] = source.camera().name;
  json["depth_scale"] = source.camera().depth_scale;
  json["method"] = report.method;
  json["odometry"] = report.odometry;
  json["frames_in_sequence"] = run.frames_in_sequence;
  json["frames"] = report.frames;
  json["interrupted"] = run.interrupted;
  json["tracked"] = report.tracked;
  json["coverage"] = report.coverage;
  json["lost_frames"] = ranges(run.records, [](const FrameRecord& r) { return !r.estimated; });
  json["unreadable_frames"] =
      ranges(run.records, [](const FrameRecord& r) { return r.status == FrameStatus::unreadable; });
  json["frames_without_depth"] = report.without_depth;
  json["frames_without_mask"] = report.without_mask;
  json["ground_truth_unusable"] =
      report.truth_why_not.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(report.truth_why_not);
  json["doubt"] = report.doubt.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(report.doubt);
  json["keyframes"] = number_or_null(report.measured.keyframes, report.keyframes);
  json["map_points"] = number_or_null(report.measured.points, report.map_points);
  json["run_hash"] = report.hash;
  json["evaluation"] =
      report.evaluation ? nlohmann::ordered_json(nlohmann::json(*report.evaluation)) : nullptr;
  json["evaluation_live"] =
      report.evaluation_live ? nlohmann::ordered_json(nlohmann::json(*report.evaluation_live)) : nullptr;
  json["masks"] = nullptr;
  if (report.scores.known) {
    json["masks"]["mask"] = nlohmann::json(report.scores.mask);
    if (const std::string& part = method_of(run.config).partial_mask; !part.empty())
      json["masks"][part + "_alone"] = nlohmann::json(report.scores.partial_mask);
    if (report.measured.features) json["masks"]["removed_features"] = nlohmann::json(report.scores.removal);
  }
  json["speed"] = report.measured.times ? speed_json(report.speed) : nullptr;
  json["peak_memory_mb"] = report.peak_memory_mb;
  json["warnings"] = source.warnings();
  return json;
}

std::string to_text(const RunReport& report) {
  std::string text =
      fmt::format("{}, method {}, odometry {}: {} of {} tracked ({:.1f} %)", report.sequence, report.method,
                  report.odometry, report.tracked, counted(report.frames, "frame"), 100.0 * report.coverage);
  if (report.measured.keyframes) text += ", " + counted(report.keyframes, "keyframe");
  if (report.measured.points) text += ", " + counted(report.map_points, "map point");
  text += "\n";
  if (report.evaluation && !report.evaluation->matched.empty()) {
    const TrajectoryEvaluation& e = *report.evaluation;
    text += e.ate.translation_m.count > 0
                ? fmt::format("  ATE           {:.4f} m RMSE over {}\n", e.ate.translation_m.rmse,
                              counted(e.ate.translation_m.count, "pose"))
                : fmt::format("  ATE           – ({})\n", e.ate.why_none);
    for (const RelativePoseError* rpe : {&e.rpe_time, &e.rpe_frame})
      text += rpe->translation_m.count > 0
                  ? fmt::format("  RPE {:<9} {:.4f} m, {:.3f} deg RMSE over {}\n", rpe->delta,
                                rpe->translation_m.rmse, rpe->rotation_deg.rmse,
                                counted(rpe->translation_m.count, "pair"))
                  : fmt::format("  RPE {:<9} – ({})\n", rpe->delta, rpe->why_none);
    if (!report.doubt.empty()) text += fmt::format("  doubt         {}\n", report.doubt);
  } else if (!report.truth_why_not.empty()) {
    text += fmt::format("  ground truth  is there and of no use: {}\n", report.truth_why_not);
  } else if (report.evaluation) {
    text += "  ground truth  has no pose at the time of any frame with an estimate: no errors\n";
  } else if (report.has_truth) {
    text += "  errors        none: no frame has a pose to compare with the ground truth\n";
  } else {
    text += "  no ground truth: no errors\n";
  }
  if (!report.without_image.empty()) text += fmt::format("  no image      {}\n", report.without_image);
  // Where no frame has one, the run ends with the reason.
  if (!report.without_pose.empty() && report.tracked > 0)
    text += fmt::format("  no pose       {}\n", report.without_pose);
  if (!report.without_mask.empty()) text += fmt::format("  no mask       {}\n", report.without_mask);
  if (!report.without_depth.empty()) text += fmt::format("  no depth      {}\n", report.without_depth);
  // Another program is no method of ours that could be asked what it removes.
  if (report.scores.known && (!report.measured.solving || !method_named(report.method).baseline)) {
    text += fmt::format("  mask          precision {}, recall {}, IoU {}",
                        share_text(report.scores.mask.precision()), share_text(report.scores.mask.recall()),
                        share_text(report.scores.mask.iou()));
    if (report.measured.features)
      text += fmt::format("; features removed rightly {}, wrongly {}", report.scores.removal.removed_rightly,
                          report.scores.removal.removed_wrongly);
    text += "\n";
  }
  if (!report.measured.times) return text + fmt::format("  run hash      {}\n", report.hash);
  text += fmt::format("  time a frame  median {:.1f} ms, 99th percentile {:.1f} ms", report.speed.median_ms,
                      report.speed.p99_ms);
  if (report.speed.units > 0) text += fmt::format(" ({:.2f} ORB units)", report.speed.units);
  if (report.speed.mean.stereo > 0)
    text += fmt::format("; matching left to right apart, mean {:.1f} ms", report.speed.mean.stereo);
  return text + fmt::format("\n  run hash      {}\n", report.hash);
}

}  // namespace stillpoint
