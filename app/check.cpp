#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "core/check/check_sequence.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/evaluation/clocks.hpp"
#include "core/evaluation/evaluation_json.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/inspect/openable.hpp"
#include "core/run/estimate_file.hpp"

namespace stillpoint {
namespace {

constexpr int kFindingsStatus = 3;  // the exit status, so that scripts tell findings from failures

struct CheckArguments {
  std::string sequence, estimate;
  bool json = false;
  SequenceArguments frames;
};

nlohmann::ordered_json to_json(const TimeCalibration& times) {
  nlohmann::ordered_json json;
  const auto add = [&json](const char* name, const std::optional<TimeEstimate>& estimate) {
    json[name] = estimate && estimate->told
                     ? nlohmann::ordered_json{{"seconds", estimate->seconds}, {"sigma", estimate->sigma_s}}
                     : nlohmann::ordered_json();
  };
  add("readout", times.readout), add("depth_readout", times.depth_readout);
  add("depth_delay", times.depth_delay), add("after_truth", times.after_truth);
  if (!times.why_not.empty()) json["why_not"] = times.why_not;
  return json;
}

/// An estimate beside the sequence's ground truth.
/// @returns its figures, where it meets the truth
std::optional<TrajectoryEvaluation> check_estimate(const CheckArguments& arguments, const FrameSource& source,
                                                   std::vector<Finding>& findings) {
  TrajectoryFile file = read_estimate_file(arguments.estimate);
  for (const std::string& warning : file.warnings) findings.push_back({"estimate", warning});
  if (source.ground_truth().empty()) {
    findings.push_back({"truth", "there is no ground truth of use to lay the estimate beside"});
    return std::nullopt;
  }
  ClockOptions clocks;
  clocks.truth_name = arguments.sequence, clocks.estimate_name = arguments.estimate;
  clocks.truth_in_seconds = true;
  clocks.frame_stamps = source.recorded_stamps();
  Trajectory truth = source.ground_truth();
  if (std::string laid = lay_rows_on_frames(file, clocks.frame_stamps, truth, arguments.estimate);
      !laid.empty())
    findings.push_back({"stamps", std::move(laid)});
  for (const std::string& note : settle_clocks(truth, file.poses, clocks))
    findings.push_back({"stamps", note});
  const auto matched = match_trajectories(truth, file.poses);
  if (matched.empty()) {
    findings.push_back({"estimate", fmt::format("{}: none of its {} poses meets the ground truth in time; {}",
                                                arguments.estimate, file.poses.size(),
                                                why_apart(truth, file.poses, clocks))});
    return std::nullopt;
  }
  if (2 * matched.size() < file.poses.size())
    findings.push_back({"estimate", fmt::format("{}: only {} of {} poses meet the ground truth in time",
                                                arguments.estimate, matched.size(), file.poses.size())});
  for (Finding& finding : check_truth(truth, file.poses, true)) findings.push_back(std::move(finding));
  return evaluate_trajectory(truth, file.poses);
}

/// "200 of 200 poses beside the ground truth: ATE 0.0032 m, RPE 1 s 0.0090 m, 0.468 deg"
std::string figures_line(const TrajectoryEvaluation& evaluation) {
  const auto rotation = [](const RelativePoseError& rpe) {
    return rpe.rotation_deg.count > 0 ? fmt::format(", {:.3f} deg", rpe.rotation_deg.rmse) : "";
  };
  const RelativePoseError &second = evaluation.rpe_time, &frame = evaluation.rpe_frame;
  const RelativePoseError& rpe = second.translation_m.count > 0 ? second : frame;
  return fmt::format("{} of {} beside the ground truth: ATE {} m, RPE {} {} m{}", evaluation.matched.size(),
                     counted(evaluation.estimated_poses, "pose"),
                     figure_text(evaluation.ate.translation_m, 4), rpe.delta,
                     figure_text(rpe.translation_m, 4), rotation(rpe));
}

void check(const CheckArguments& arguments) {
  if (arguments.frames.calibrate_time)
    warn_once("--calibrate-time is of no use here: `check` tells what it measures, others go by it");
  const SequenceArguments reading = arguments.frames.fixed(arguments.sequence, Config());
  const auto source = open_sequence(arguments.sequence, reading.options(Config()));
  const StopBySignal stop;
  auto [findings, times] = arguments.estimate.empty() ? check_sequence(*source, stop.token())
                                                      : SequenceCheck{check_frames(*source), {}};
  throw_if_interrupted("stopped before all was asked");
  std::optional<TrajectoryEvaluation> evaluation;
  if (!arguments.estimate.empty()) evaluation = check_estimate(arguments, *source, findings);
  const Camera& camera = source->camera();
  if (arguments.json) {
    nlohmann::ordered_json json;
    json["sequence"] = arguments.sequence;
    json["frames"] = source->size();
    json["camera"] = camera.name;
    json["depth_scale"] = camera.depth_scale;
    if (camera.is_stereo()) json["baseline_m"] = camera.baseline_m;
    if (!source->contents().empty()) json["topics"] = source->contents();
    if (arguments.estimate.empty()) json["time"] = to_json(times);
    if (evaluation) json["evaluation"] = nlohmann::json(*evaluation);
    json["findings"] = nlohmann::json(findings);
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    std::vector<std::string> facts;
    for (const SequenceFact& fact : sequence_facts(*source)) {
      std::string name = fact.name;
      name.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(name.front())));
      facts.push_back(facts.empty() ? fact.value : name + " " + fact.value);
    }
    fmt::print("{}: {}\n", source->name(), fmt::join(facts, ", "));
    for (const std::string& line : source->contents()) fmt::print("  topic     {}\n", line);
    if (arguments.estimate.empty())
      for (const std::string& line : to_lines(times, camera)) fmt::print("  time      {}\n", line);
    if (evaluation) fmt::print("  figures   {}\n", figures_line(*evaluation));
    for (const Finding& finding : findings) fmt::print("  {:<9} {}\n", finding.about, finding.sentence);
    fmt::print("{}\n", findings.empty() ? "no findings" : counted(findings.size(), "finding"));
  }
  if (!findings.empty()) throw ExitStatus{kFindingsStatus};
}

}  // namespace

void add_check_command(CLI::App& app) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = app.add_subcommand("check",
                                         "Question an input: stamps, depth, masks, camera, ground truth, an "
                                         "estimate; status 3 when there are findings");
  command->add_option("SEQUENCE", arguments->sequence, kSequenceHelp)->required();
  command->add_option("ESTIMATE", arguments->estimate,
                      "A trajectory to lay beside the ground truth in place of the odometry's own");
  command->add_flag("--json", arguments->json, "Print JSON");
  arguments->frames.add_to(*command);
  command->callback([arguments] { check(*arguments); });
}

}  // namespace stillpoint
