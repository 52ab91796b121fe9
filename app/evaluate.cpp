#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "core/evaluation/evaluation_json.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

struct EvaluateArguments {
  std::string truth, estimate, sequence;
  bool json = false;
  EvaluationOptions options;
};

bool is_sequence(const std::string& where) {
  std::error_code none;
  return where.starts_with("generated:") || std::filesystem::is_directory(where, none);
}

/// Tells what was mended without touching standard output, which may be JSON.
void tell(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
}

Trajectory read_truth(const EvaluateArguments& arguments, int& frames, std::vector<std::string>& warnings) {
  if (!is_sequence(arguments.truth)) return read_tum_trajectory(arguments.truth, &warnings);
  const auto source = open_sequence(arguments.truth);
  if (source->ground_truth().empty())
    throw InputError(
        fmt::format("{}: the sequence has no ground truth, expected a groundtruth.txt", arguments.truth));
  if (frames == 0) frames = source->size();
  return source->ground_truth();
}

std::string span_of(const Trajectory& trajectory) {
  return fmt::format("{:.3f} s to {:.3f} s", trajectory.front().timestamp, trajectory.back().timestamp);
}

void evaluate(EvaluateArguments arguments) {
  std::vector<std::string> warnings;
  EvaluationOptions& options = arguments.options;
  if (!arguments.sequence.empty()) options.expected_frames = open_sequence(arguments.sequence)->size();
  const Trajectory truth = read_truth(arguments, options.expected_frames, warnings);
  const Trajectory estimate = read_tum_trajectory(arguments.estimate, &warnings);
  const TrajectoryEvaluation evaluation = evaluate_trajectory(truth, estimate, options);
  if (evaluation.matched.empty())
    throw InputError(fmt::format("{}: none of its poses ({}) is closer than {} s to one of {} ({})",
                                 arguments.estimate, span_of(estimate), options.max_difference_s,
                                 arguments.truth, span_of(truth)));
  if (options.expected_frames > 0 && evaluation.estimated_poses > options.expected_frames)
    warnings.push_back(fmt::format("{}: holds {} poses, more than the {} frames", arguments.estimate,
                                   evaluation.estimated_poses, options.expected_frames));
  tell(warnings);
  if (arguments.json) {
    nlohmann::ordered_json json = nlohmann::json(evaluation);
    json["max_difference_s"] = options.max_difference_s;
    json["ground_truth"] = arguments.truth;
    json["estimate"] = arguments.estimate;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("Estimate  {}\nTruth     {}\n{}", arguments.estimate, arguments.truth,
               to_text(evaluation, options));
  }
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compare an estimated trajectory with ground truth: ATE and RPE");
  command->add_option("GROUNDTRUTH", arguments->truth, "TUM trajectory, or a sequence that has ground truth")
      ->required();
  command->add_option("ESTIMATE", arguments->estimate, "TUM trajectory: timestamp tx ty tz qx qy qz qw")
      ->required();
  command->add_flag("--json", arguments->json, "Print JSON");
  command
      ->add_option("--max-difference", arguments->options.max_difference_s,
                   "Poses belong together when strictly closer in time than this [s]")
      ->check(CLI::Range(1e-6, 10.0))
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
