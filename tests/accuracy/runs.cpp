#include "tests/accuracy/runs.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/accuracy/film.hpp"

namespace stillpoint {
namespace {

/// The film, kept until another one is asked for: tests come film by film.
const Film& film_of(const FilmChoice& choice) {
  static std::string shown;
  static std::unique_ptr<Film> film;
  const std::string name = name_of(choice);
  if (shown != name) {
    film = std::make_unique<Film>(
        open_sequence("generated:" + choice.kind, {.camera = {}, .frames = kFrames, .seed = choice.seed}));
    shown = name;
  }
  return *film;
}

RunFigures run_over(const Film& film, const std::string& method) {
  Config config;
  config.run.method = method;
  const RunResult run = run_sequence(film, config);
  const RunReport report = report_on(run, film);

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
  figures.first_hash = run_hash({run.records.begin(), run.records.begin() + kHashedFrames});
  return figures;
}

}  // namespace

std::string name_of(const FilmChoice& film) { return fmt::format("{}_{}", film.kind, film.seed); }

const RunFigures& figures_of(const FilmChoice& film, const std::string& method) {
  static std::map<std::string, RunFigures> runs;
  const std::string name = name_of(film) + "_" + method;
  const auto found = runs.find(name);
  if (found != runs.end()) return found->second;
  const RunFigures& figures = runs.emplace(name, run_over(film_of(film), method)).first->second;
  // What was measured is printed, so that bounds can be set from it.
  fmt::print(
      "measured {:<16} seed {} {:<10} rpe {:.5f} m over {} pairs, IoU {:.3f}, masked {:.3f} % in {} frames, "
      "{}\n",
      film.kind, film.seed, method, figures.rpe_m, figures.pairs, figures.iou, 100.0 * figures.masked,
      figures.masked_frames, figures.first_hash);
  return figures;
}

}  // namespace stillpoint
