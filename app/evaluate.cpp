#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/evaluation/clocks.hpp"
#include "core/evaluation/doubts.hpp"
#include "core/evaluation/evaluation_json.hpp"
#include "core/evaluation/time_offset.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/run/estimate_file.hpp"
#include "core/sequence/source.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

struct EvaluateArguments {
  std::string truth, estimate, sequence, quaternion, truth_convention, estimate_convention;
  std::string align, protocol, time_offset, deltas;
  std::string difference;  ///< s; empty = the protocol's
  bool json = false, scale = false, lengths = false;
  double time_offset_s = 0.0, frame_rate = kFrameNumberRate;
  EvaluationOptions options;
};

constexpr std::pair<std::string_view, AlignBy> kAlignments[] = {{"none", AlignBy::nothing},
                                                                {"origin", AlignBy::origin},
                                                                {"se3", AlignBy::rigid},
                                                                {"sim3", AlignBy::similarity}};

bool is_sequence(const std::string& where) {
  std::error_code none;
  return where.starts_with("generated:") || std::filesystem::is_directory(where, none) ||
         is_sequence_file(where);
}

/// Tells what was mended without touching standard output, which may be JSON.
void tell(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
}

std::string span_of(const Trajectory& trajectory) {
  return fmt::format("{:.3f} s to {:.3f} s", trajectory.front().timestamp, trajectory.back().timestamp);
}

void convert(Trajectory& trajectory, PoseConvention convention) {
  for (StampedPose& pose : trajectory)
    pose.world_from_camera = camera_pose(pose.world_from_camera, convention);
}

/// Both trajectories on one clock, and what was mended on the way.
struct Compared {
  Trajectory truth, estimate;
  std::vector<std::string> warnings;
  ClockOptions clocks;
};

std::unique_ptr<FrameSource> open_frames(const std::string& where, const EvaluateArguments& arguments) {
  OpenOptions options;
  options.frame_rate = arguments.frame_rate;
  options.progress = opening_progress();
  return open_sequence(where, options);
}

/// @returns what rows without stamps are laid on: the frames' stamps, or the rows' numbers of a truth that
///          has none either
std::vector<double> read_truth(const EvaluateArguments& arguments, int& frames, Compared& compared) {
  if (!is_sequence(arguments.truth)) {
    TrajectoryFile file = read_trajectory_file(arguments.truth);
    compared.truth = std::move(file.poses);
    compared.warnings = std::move(file.warnings);
    std::vector<double> numbers;
    for (int i = 0; !file.has_stamps && i < file.rows; ++i) numbers.push_back(i);
    return compared.clocks.frame_stamps.empty() ? numbers : compared.clocks.frame_stamps;
  }
  const auto source = open_frames(arguments.truth, arguments);
  if (source->ground_truth().empty()) {
    const std::string why = source->why_not(FramePart::truth);
    throw InputError(
        why.empty()
            ? fmt::format("{}: the sequence has no ground truth, expected a groundtruth.txt", arguments.truth)
            : fmt::format("{}: its ground truth is of no use: {}", arguments.truth, why));
  }
  if (frames == 0) frames = source->size();
  compared.truth = source->ground_truth();
  compared.clocks.truth_in_seconds = true;
  return compared.clocks.frame_stamps = source->recorded_stamps();
}

void read_estimate(const EvaluateArguments& arguments, const std::vector<double>& frames,
                   Compared& compared) {
  std::optional<QuaternionOrder> order;
  if (!arguments.quaternion.empty())
    order = arguments.quaternion == "wxyz" ? QuaternionOrder::wxyz : QuaternionOrder::xyzw;
  TrajectoryFile file = read_estimate_file(arguments.estimate, order);
  compared.warnings.insert(compared.warnings.end(), file.warnings.begin(), file.warnings.end());
  convert(file.poses, convention_argument("--estimate", arguments.estimate_convention));
  // As many rows as a truth without stamps has are the same ones.
  const bool are_the_truths =
      compared.clocks.frame_stamps.empty() && static_cast<std::size_t>(file.rows) == frames.size();
  if (!are_the_truths)
    if (std::string laid = lay_rows_on_frames(file, frames, compared.truth, arguments.estimate);
        !laid.empty())
      compared.warnings.push_back(std::move(laid));
  compared.estimate = std::move(file.poses);
}

Compared read_both(const EvaluateArguments& arguments, EvaluationOptions& options) {
  Compared compared;
  ClockOptions& clocks = compared.clocks;
  clocks.truth_name = arguments.truth, clocks.estimate_name = arguments.estimate;
  clocks.frame_rate = arguments.frame_rate, clocks.tolerance_s = options.max_difference_s;
  clocks.estimate_offset_s = arguments.time_offset_s;
  if (!arguments.sequence.empty()) {
    const auto source = open_frames(arguments.sequence, arguments);
    options.expected_frames = source->size();
    clocks.frame_stamps = source->recorded_stamps();
  }
  const std::vector<double> frames = read_truth(arguments, options.expected_frames, compared);
  convert(compared.truth, convention_argument("--truth", arguments.truth_convention));
  read_estimate(arguments, frames, compared);
  const auto notes = settle_clocks(compared.truth, compared.estimate, clocks);
  compared.warnings.insert(compared.warnings.end(), notes.begin(), notes.end());
  return compared;
}

/// What makes the figures doubtful.
void question(const TrajectoryEvaluation& evaluation, const EvaluateArguments& arguments,
              Compared& compared) {
  std::vector<std::string>& warnings = compared.warnings;
  const int matched = static_cast<int>(evaluation.matched.size());
  if (2 * matched < evaluation.estimated_poses)
    warnings.push_back(
        fmt::format("{}: only {} of {} poses meet the ground truth in time; the figures are of these alone",
                    arguments.estimate, matched, evaluation.estimated_poses));
  if (evaluation.expected_frames > 0 && evaluation.estimated_poses > evaluation.expected_frames)
    warnings.push_back(fmt::format("{}: holds {}, more than the {}", arguments.estimate,
                                   counted(evaluation.estimated_poses, "pose"),
                                   counted(evaluation.expected_frames, "frame")));
  const bool by_positions = arguments.options.align == AlignBy::rigid ||
                            arguments.options.align == AlignBy::similarity ||
                            arguments.options.align == AlignBy::first;
  if (const std::string open = open_rotation_sentence(evaluation); by_positions && !open.empty())
    warnings.push_back(fmt::format("{}: {}", arguments.estimate, open));
  for (const Doubt& doubt :
       doubts_about(compared.truth, compared.estimate, evaluation, arguments.options.align, ""))
    warnings.push_back(fmt::format("{}: {}", arguments.estimate, doubt.sentence));
}

double number_argument(const char* option, const std::string& text, double least, double most) {
  const auto value = parse_number(text);
  if (!value || !(*value >= least) || !(*value <= most))
    throw CLI::ValidationError(option,
                               fmt::format("{}: expected a number from {:g} to {:g}", text, least, most));
  return *value;
}

/// "none", "origin", "se3", "sim3", or "first:N".
void read_alignment(const std::string& text, EvaluationOptions& options) {
  constexpr std::string_view kFirst = "first:";
  const auto known = std::find_if(std::begin(kAlignments), std::end(kAlignments),
                                  [&text](const auto& named) { return text == named.first; });
  if (known != std::end(kAlignments)) {
    options.align = known->second;
  } else if (text.starts_with(kFirst)) {
    options.align = AlignBy::first;
    options.align_first = static_cast<int>(number_argument("--align", text.substr(kFirst.size()), 3, 1e8));
  } else {
    throw CLI::ValidationError("--align",
                               fmt::format("{}: expected none, origin, first:N, se3 or sim3", text));
  }
}

/// What the options say, over what the protocol says.
void settle_options(EvaluateArguments& arguments) {
  EvaluationOptions& options = arguments.options;
  if (!arguments.protocol.empty())
    use_protocol(arguments.protocol == "evo" ? Protocol::evo : Protocol::tum, options);
  if (!arguments.difference.empty())
    options.max_difference_s = number_argument("--max-difference", arguments.difference, 1e-6, 10.0);
  if (arguments.scale) options.align = AlignBy::similarity;
  if (!arguments.align.empty()) read_alignment(arguments.align, options);
  for (std::size_t at = 0; at < arguments.deltas.size();) {
    const std::size_t comma = std::min(arguments.deltas.find(',', at), arguments.deltas.size());
    options.deltas.push_back(rpe_delta_of(arguments.deltas.substr(at, comma - at)));
    at = comma + 1;
  }
  if (!arguments.time_offset.empty() && arguments.time_offset != "auto")
    arguments.time_offset_s = number_argument("--time-offset", arguments.time_offset, -1e10, 1e10);
}

/// Shifts the estimate to where it fits the truth best, and tells by how much.
void fit_time(const EvaluateArguments& arguments, Compared& compared) {
  const auto found = estimate_time_offset(compared.truth, compared.estimate);
  if (!found) {
    const bool apart = match_trajectories(compared.truth, compared.estimate).empty();
    throw InputError(fmt::format(
        "{}: the two paths do not tell a time offset, which is sought up to half a second to both sides; {}",
        arguments.estimate,
        apart ? why_apart(compared.truth, compared.estimate, compared.clocks)
              : "give it as --time-offset SECONDS"));
  }
  for (StampedPose& pose : compared.estimate) pose.timestamp += found->offset_s;
  compared.warnings.push_back(fmt::format(
      "{}: {:+.6f} s were added to its stamps, which lowers the ATE against interpolated truth from "
      "{:.5f} to {:.5f} m",
      arguments.estimate, found->offset_s, found->rmse_before_m, found->rmse_after_m));
}

void evaluate(EvaluateArguments arguments) {
  EvaluationOptions& options = arguments.options;
  settle_options(arguments);
  Compared compared = read_both(arguments, options);
  if (arguments.time_offset == "auto") fit_time(arguments, compared);
  if (arguments.lengths) {
    options.lengths_m =
        usual_lengths_m(match_trajectories(compared.truth, compared.estimate, options.max_difference_s));
  }
  const TrajectoryEvaluation evaluation = evaluate_trajectory(compared.truth, compared.estimate, options);
  if (evaluation.matched.empty())
    throw InputError(fmt::format("{}: none of its poses ({}) is closer than {} s to one of {} ({}); {}",
                                 arguments.estimate, span_of(compared.estimate), options.max_difference_s,
                                 arguments.truth, span_of(compared.truth),
                                 why_apart(compared.truth, compared.estimate, compared.clocks)));
  question(evaluation, arguments, compared);
  tell(compared.warnings);
  if (arguments.json) {
    nlohmann::ordered_json json = nlohmann::json(evaluation);
    json["max_difference_s"] = options.max_difference_s;
    json["ground_truth"] = arguments.truth;
    json["estimate"] = arguments.estimate;
    json["warnings"] = compared.warnings;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("Estimate  {}\nTruth     {}\n{}", arguments.estimate, arguments.truth,
               to_text(evaluation, options));
  }
  if (!evaluation.has_figures())
    throw InputError(
        fmt::format("{}: there is nothing to measure: {}", arguments.estimate, evaluation.ate.why_none));
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compare an estimated trajectory with ground truth: ATE and RPE");
  command
      ->add_option(
          "GROUNDTRUTH", arguments->truth,
          "Trajectory (TUM, EuRoC's csv, KITTI, any table with a header), or a sequence that has ground "
          "truth")
      ->required();
  command
      ->add_option(
          "ESTIMATE", arguments->estimate,
          "Trajectory: timestamp tx ty tz qx qy qz qw, or another of these formats; or the folder of a run")
      ->required();
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_option("--max-difference", arguments->difference,
                      "Poses belong together when strictly closer in time than this [s]; otherwise 0.02");
  command->add_option(
      "--align", arguments->align,
      "How the estimate's world is laid over the truth's: none, origin (the first pose), first:N "
      "(by the first N), se3 (otherwise), sim3 (with scale, as monocular estimates need)");
  command->add_flag("--scale", arguments->scale, "The same as --align sim3")->excludes("--align");
  command->add_option("--delta", arguments->deltas,
                      "More relative errors: over seconds, frames or metres, as 2s,10f,5m");
  command->add_flag("--lengths", arguments->lengths,
                    "Errors of all parts of the path of a tenth to a half of its length, with box plots");
  command->add_flag("--interpolate", arguments->options.interpolate_truth,
                    "Take the truth at the estimate's own stamps, between its neighbours");
  command
      ->add_option("--protocol", arguments->protocol,
                   "Measure as others do: evo (evo_ape and evo_rpe without options), tum (the benchmark's "
                   "scripts without options)")
      ->check(CLI::IsMember({"evo", "tum"}));
  command
      ->add_option("--quaternion", arguments->quaternion,
                   "Order of the estimate's quaternions, where no header tells")
      ->check(CLI::IsMember({"xyzw", "wxyz"}));
  command->add_option(
      "--truth", arguments->truth_convention,
      "What the ground truth's poses mean: as-written, inverse, w-first, mirrored-x, mirrored-y, "
      "mirrored-z, opengl, bonn");
  command->add_option("--estimate", arguments->estimate_convention, "The same of the estimate's poses");
  command->add_option("--time-offset", arguments->time_offset,
                      "Added to the estimate's stamps [s]; `auto` finds it from the two paths, and tells it");
  command->add_option("--frame-rate", arguments->frame_rate, "Of stamps that are frame numbers [Hz]")
      ->check(number_between(0.01, 1000.0))
      ->capture_default_str();
  auto* frames = command
                     ->add_option("--frames", arguments->options.expected_frames,
                                  "Frames that should have a pose, for the coverage")
                     ->check(CLI::Range(1, 100'000'000));
  command
      ->add_option("--sequence", arguments->sequence,
                   "Sequence whose frames should have a pose, for the coverage")
      ->excludes(frames);
  command->callback([arguments] { evaluate(*arguments); });
}

}  // namespace stillpoint
