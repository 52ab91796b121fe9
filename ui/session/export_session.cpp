#include "ui/session/export_session.hpp"

#include <fmt/format.h>

#include <numeric>

#include "core/error.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/excerpt.hpp"
#include "core/sequence/fingerprint.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

Marks marks_among(Marks marks, int frames) {
  std::erase_if(marks.bookmarks, [&](const Bookmark& mark) { return mark.frame >= frames; });
  std::erase_if(marks.pins, [&](const Pin& pin) { return pin.frame >= frames; });
  if (marks.span && marks.span->last >= frames) marks.span.reset();
  marks.loop = marks.loop && marks.span;
  return marks;
}

/// Runs over a sequence and leaves a run's folder. @returns the run's hash
std::string write_run_over(const FrameSource& source, const fs::path& where, const Config& config,
                           const fs::path& folder, const std::atomic<bool>* stop) {
  const SequenceOrigin origin = origin_of(source, where.string(), {});
  RecordsWriter records(folder, origin, config);
  RunOptions options;
  options.stop = stop;
  options.on_frame = [&records](const FrameResult& frame) { records.add(frame); };
  const RunResult run = run_sequence(source, config, options);
  const RunReport report = report_on(run, source);
  write_run(folder, run, report, source, origin);
  records.finish(run, source.ground_truth());
  return report.hash;
}

}  // namespace

std::string export_session(const SessionToExport& session, const fs::path& folder) {
  if (!session.source.has_depth())
    throw InputError(
        fmt::format("{}: has no depth, and without it there is no run to hand on", session.source.name()));
  prepare_run_folder(folder, false);
  const fs::path where = folder / "sequence";
  std::vector<int> frames(static_cast<std::size_t>(session.frames));
  std::iota(frames.begin(), frames.end(), 0);
  const ExportedFrames exported = export_frames(session.source, frames, where, false, {}, session.stop);

  const auto written = open_sequence(where.string());
  const std::string hash = write_run_over(*written, where, session.config, folder, session.stop);
  const MarkedSequence marked{written->name(), sequence_fingerprint(*written), written->size()};
  write_marks(folder / kSidecarName, marked, marks_among(session.marks, written->size()));

  std::string told =
      fmt::format("{} frames, their run and the marks written to {}", exported.written, folder.string());
  if (!exported.unreadable.empty())
    told += fmt::format("; {} frames that cannot be read were left out", exported.unreadable.size());
  if (!session.run_hash.empty() && hash != session.run_hash)
    told += fmt::format("; the run over them is another one: {} instead of {}", hash, session.run_hash);
  return told;
}

}  // namespace stillpoint
