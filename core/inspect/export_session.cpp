#include "core/inspect/export_session.hpp"

#include <fmt/format.h>

#include <numeric>
#include <optional>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/media/stored_depth.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/condition.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/excerpt.hpp"
#include "core/sequence/fingerprint.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

Marks marks_among(Marks marks, int frames) {
  std::erase_if(marks.bookmarks, [&](const Bookmark& mark) { return mark.frame >= frames; });
  std::erase_if(marks.pins, [&](const Pin& pin) { return pin.frame >= frames; });
  std::erase_if(marks.drawn, [&](const DrawnFrame& drawn) { return drawn.frame >= frames; });
  if (marks.span && marks.span->last >= frames) marks.span.reset();
  marks.loop = marks.loop && marks.span;
  return marks;
}

bool is_stopped(const ExportControl& control) { return control.stop != nullptr && *control.stop; }

std::function<void(int, int)> telling(const ExportControl& control, const char* what) {
  return [&control, what](int done, int total) {
    if (control.progress) control.progress(what, done, total);
  };
}

std::string stopped(const fs::path& folder) {
  return fmt::format("Stopped; nothing is left in {}.", folder.string());
}

/// What of the frames is not in the files, after a semicolon.
std::string told_missing(const ExportedFrames& exported) {
  std::string told;
  if (!exported.unreadable.empty())
    told =
        fmt::format("; cannot be read, and have places without images: {}", frames_text(exported.unreadable));
  if (exported.too_far > 0) told += "; " + too_far_told(exported.too_far, exported.depth_units);
  return told;
}

/// Runs over a sequence and leaves a run's folder. @returns the run's hash; nothing when it was stopped
std::optional<std::string> write_run_over(const FrameSource& source, const fs::path& where,
                                          const Config& config, const fs::path& folder,
                                          const ExportControl& control) {
  const SequenceOrigin origin = origin_of(source, where.string(), {});
  RecordsWriter records(folder, origin, config);
  RunOptions options;
  options.stop = control.stop;
  const auto tell = telling(control, "run");
  options.on_frame = [&](const FrameResult& frame) {
    records.add(frame);
    tell(frame.record.index + 1, source.size());
  };
  const RunResult run = run_sequence(source, config, options);
  if (run.interrupted) return std::nullopt;
  const RunReport report = report_on(run, source);
  write_run(folder, run, report, source, origin, records);
  return report.hash;
}

}  // namespace

std::string export_selection(const FrameSource& source, const std::vector<int>& frames,
                             const fs::path& folder, const ExportControl& control) {
  const ExportedFrames exported =
      export_frames(source, frames, folder, false, telling(control, "frames"), control.stop);
  if (is_stopped(control)) {
    remove_sequence(folder);
    return stopped(folder);
  }
  return fmt::format("{} written to {}{}", counted(exported.written, "frame"), folder.string(),
                     told_missing(exported));
}

std::string export_session(const SessionToExport& session, const fs::path& folder,
                           const ExportControl& control) {
  if (!session.source.has_depth())
    throw InputError(
        fmt::format("{}: has no depth, and without it there is no run to hand on", session.source.name()));
  prepare_run_folder(folder, false);
  const fs::path where = folder / "sequence";
  std::vector<int> frames(static_cast<std::size_t>(session.frames));
  std::iota(frames.begin(), frames.end(), 0);
  const ExportedFrames exported =
      export_frames(session.source, frames, where, false, telling(control, "frames"), control.stop);

  std::optional<std::string> hash;
  if (!is_stopped(control)) {
    const auto written = open_sequence(where.string());
    hash = write_run_over(*written, where, session.config, folder, control);
    const MarkedSequence marked{written->name(), sequence_fingerprint(*written), written->size()};
    if (hash) write_marks(folder / kSidecarName, marked, marks_among(session.marks, written->size()));
  }
  if (!hash) {
    std::error_code ignored;  // what others put there stays, and the folder with it
    remove_sequence(where);
    fs::remove(folder / kRecordsName, ignored);
    fs::remove(folder, ignored);
    return stopped(folder);
  }
  std::string told = fmt::format("{}, their run and the marks written to {}{}",
                                 counted(exported.written, "frame"), folder.string(), told_missing(exported));
  if (!session.run_hash.empty() && *hash != session.run_hash)
    told += fmt::format("; the run over them is another one: {} instead of {}", *hash, session.run_hash);
  return told;
}

}  // namespace stillpoint
