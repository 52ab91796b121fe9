#include "app/benchmark_repeats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/progress.hpp"
#include "core/evaluation/spread.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"
#include "core/run/repeats.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint {
namespace {

constexpr const char* kWhat = "RPE 1 s, RMSE [m]";

/// The figure of one run; nothing where it gave none.
/// @returns nothing at all where the run was interrupted
std::optional<std::optional<double>> measure(const FrameSource& source, const Config& config, int first,
                                             int frames, const std::string& label) {
  RunOptions options;
  options.first = std::min(first, source.size() - 1);
  options.count = frames;
  options.stop = &stop_requested();
  const int left = source.size() - options.first;
  Progress progress(label, frames > 0 ? std::min(frames, left) : left);
  options.on_frame = [&progress](const FrameResult& frame) {
    progress.advance(std::string(to_string(frame.record.status)));
  };
  const RunResult run = run_sequence(source, config, options);
  if (run.interrupted) return std::nullopt;
  const auto evaluation = evaluate_trajectory(source.ground_truth(), run.trajectory);
  // Half of its frames without a pose, and a run's error is no figure to be compared.
  const bool lost = 2 * run.tracked() < static_cast<int>(run.records.size());
  if (lost || evaluation.rpe_time.translation_m.count == 0) return std::optional<double>();
  return std::optional(evaluation.rpe_time.translation_m.rmse);
}

/// The plan's cells, sequence by sequence.
class Repeats {
 public:
  explicit Repeats(const RepeatPlan& plan) : plan_(plan) {
    for (const std::string& engine : plan.engines)
      for (const std::string& method : plan.methods) {
        Config config = plan.config;
        set_parameter(config, "run.odometry=" + engine);
        set_parameter(config, "run.method=" + method);
        names_.push_back(run_label(config));
        configs_.push_back(std::move(config));
      }
  }

  /// @returns whether it came to its end
  bool run(const FrameSource& source) {
    SpreadRow row{source.name(), {}};
    for (std::size_t i = 0; i < configs_.size(); ++i) {
      std::vector<std::optional<double>> values;
      for (int k = 0; k < plan_.repeats; ++k) {
        const Perturbation by = perturbation(k);
        const auto value =
            measure(source, perturbed(configs_[i], by), by.first_frame, plan_.frames,
                    fmt::format("{} ({}, {} of {})", source.name(), names_[i], k + 1, plan_.repeats));
        if (!value) return false;
        values.push_back(*value);
      }
      row.cells.push_back(spread_of(values));
    }
    rows_.push_back(std::move(row));
    return true;
  }

  void write() const {
    if (plan_.out.empty()) return;
    const std::filesystem::path folder = plan_.out;
    write_text_file(folder / "repeats.md", text(TableMarkup::markdown));
    write_text_file(folder / "repeats.csv", text(TableMarkup::csv));
    write_text_file(folder / "repeats.tex", text(TableMarkup::latex));
    write_text_file(folder / "repeats.json", spread_json(rows_, names_).dump(2) + "\n");
  }
  [[nodiscard]] std::string text(TableMarkup markup) const {
    return spread_text(rows_, names_, kWhat, markup);
  }

 private:
  const RepeatPlan& plan_;
  std::vector<std::string> names_;
  std::vector<Config> configs_;
  std::vector<SpreadRow> rows_;
};

}  // namespace

void benchmark_repeats(const RepeatPlan& plan) {
  Repeats repeats(plan);
  for (const FrameSource* source : plan.sources) {
    const bool whole = repeats.run(*source);
    repeats.write();
    if (!whole) break;
  }
  fmt::print(
      "Translational RPE over 1 s, RMSE in m: median of {} runs and half the distance of their quartiles;\n"
      "runs differ by a few features, the seed and the first frame. Best and second are marked only where "
      "the\n"
      "quartiles do not overlap.\n\n{}",
      plan.repeats, repeats.text(TableMarkup::markdown));
  if (stop_requested()) fmt::print("\nstopped early; the table holds what was finished\n");
  throw_if_interrupted();
}

}  // namespace stillpoint
