#include "tests/accuracy/runs.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/accuracy/rendered_sequence.hpp"

namespace stillpoint {
namespace {

/// The sequence, kept until another one is asked for: tests come sequence by sequence.
const RenderedSequence& rendered(const SequenceChoice& choice) {
  static std::string shown;
  static std::unique_ptr<RenderedSequence> sequence;
  const std::string name = name_of(choice);
  if (shown != name) {
    sequence = std::make_unique<RenderedSequence>(
        open_sequence("generated:" + choice.kind, {.camera = {}, .frames = kFrames, .seed = choice.seed}));
    shown = name;
  }
  return *sequence;
}

RunFigures run_over(const RenderedSequence& sequence, const std::string& method) {
  Config config;
  config.run.method = method;
  const RunResult run = run_sequence(sequence, config);
  const RunReport report = report_on(run, sequence);

  RunFigures figures;
  if (report.evaluation) {
    figures.rpe_m = report.evaluation->rpe_time.translation_m.rmse;
    figures.pairs = report.evaluation->rpe_time.translation_m.count;
  }
  figures.coverage = report.coverage;
  figures.iou = report.scores.mask.iou().value_or(-1.0);
  for (const FrameRecord& record : run.records) {
    figures.masked += record.mask_share / static_cast<double>(run.records.size());
    figures.masked_frames += record.mask_share > 0 ? 1 : 0;
  }
  figures.first_hash = run_hash(run.records.first(kHashedFrames));
  return figures;
}

}  // namespace

std::string name_of(const SequenceChoice& sequence) {
  return fmt::format("{}_{}", sequence.kind, sequence.seed);
}

const RunFigures& figures_of(const SequenceChoice& sequence, const std::string& method) {
  static std::map<std::string, RunFigures> runs;
  const std::string name = name_of(sequence) + "_" + method;
  const auto found = runs.find(name);
  if (found != runs.end()) return found->second;
  const RunFigures& figures = runs.emplace(name, run_over(rendered(sequence), method)).first->second;
  // What was measured is printed, so that bounds can be set from it.
  fmt::print(
      "measured {:<16} seed {} {:<10} rpe {:.5f} m over {} pairs, IoU {:.3f}, masked {:.3f} % in {} frames, "
      "{}\n",
      sequence.kind, sequence.seed, method, figures.rpe_m, figures.pairs, figures.iou, 100.0 * figures.masked,
      figures.masked_frames, figures.first_hash);
  return figures;
}

}  // namespace stillpoint
