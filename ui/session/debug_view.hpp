#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/config.hpp"
#include "core/inspect/marks.hpp"
#include "core/parameter.hpp"
#include "core/shared_value.hpp"

namespace stillpoint {

struct Finding;
struct FrameView;
struct RemovalError;
struct RunView;
struct SweepPoint;

// What debugging adds to the session: its part of the snapshot panels draw, and what panels may ask for.

/// The frame shown as a run beside the session's own has it; null where that has not come so far.
struct BesideFrame {
  std::shared_ptr<const FrameView> current;
  std::shared_ptr<const FrameView> other;  ///< the frame that stands beside it, as DebugView::other has it
};

/// A second run beside the session's own, with another configuration.
struct GhostView {
  std::string name;  ///< "difference.threshold 12": what differs, or its preset's name
  Config config;
  int from = 0;                        ///< frame it branched off at; before it, it is the session's own run
  bool busy = false;                   ///< still processing
  std::shared_ptr<const RunView> run;  ///< never null
  std::shared_ptr<const FrameView> current;  ///< its view of the frame shown; null while not processed
  std::shared_ptr<const FrameView> other{};  ///< … and of the frame beside it, as DebugView::other has it
  std::optional<int> diverged;        ///< first frame whose record, or of another program's run whose motion,
                                      ///< differs from the session's own run
  bool outside = false;               ///< another program's, in a world of its own
  std::optional<std::size_t> look{};  ///< which of the looks of ghosts it has; nothing: that of its place
};

/// A ghost that begins at a frame the session's run has not come to yet.
struct WaitingGhost {
  std::string name;
  Config config;
  int from = 0;
};

/// Something being written.
struct ExportView {
  std::string folder;
  std::string what;         ///< "frames", then "run"; empty at first
  int done = 0, total = 0;  ///< of that
};

/// Which frame stands beside the one shown.
enum class OtherFrame { before, keyframe, kept };

/// What the sequence was questioned by.
struct CheckView {
  bool asking = false;  ///< it is being questioned now
  bool looked = false;  ///< at its lists and a sample of its images
  bool whole = false;   ///< by all there is, not by a look at its lists and images alone
  std::vector<Finding> findings;
  std::vector<std::string> times;  ///< the camera's times as its frames tell them, a line each
};

/// Runs of the sequence's first frames at several values of one parameter.
struct SweepView {
  SweepRange range;
  std::vector<double> values;      ///< all that are asked for, ascending
  std::vector<SweepPoint> points;  ///< those done, in their order
  int frames = 0;                  ///< so many are run each time
  Config base;                     ///< what every other parameter is
  bool busy = false;
  std::string problem{};  ///< why it ended early, one sentence; empty mostly
};

/// The debugger's part of SessionView.
struct DebugView {
  std::vector<Bookmark> bookmarks;  ///< by frame
  std::vector<Pin> pins;
  std::vector<DrawnFrame> drawn;  ///< truth by hand, by frame
  std::vector<BreakpointView> breakpoints;
  std::optional<int> stopped_by;  ///< breakpoint at which play stopped last, index into breakpoints
  std::optional<FrameSpan> span;  ///< the frames selected
  bool loop = false;              ///< play goes round in the span
  std::vector<GhostView> ghosts;
  std::vector<WaitingGhost> waiting;               ///< ghosts to come, once the run is where they begin
  SharedValue<std::vector<RemovalError>> removal;  ///< by frame; empty where there is no truth
  std::optional<Config> preview_config;            ///< what the sliders say while it is not run with
  std::shared_ptr<const FrameView> preview;        ///< the frame shown, motion stages under preview_config
  std::optional<Config> previewed;                 ///< the config `preview` was made with
  bool preview_whole = false;              ///< false: its features' matches and its pose are the run's still
  double preview_ms = 0.0;                 ///< what computing it took
  std::optional<OtherFrame> other_is;      ///< nothing until it is asked for (request::StandBeside)
  std::optional<int> kept_frame;           ///< the frame that was kept to stand beside others
  std::shared_ptr<const FrameView> other;  ///< its images and record alone; null where there is none
  CheckView check;
  std::optional<SweepView> sweep;       ///< the last one asked for
  std::optional<ExportView> exporting;  ///< what is being written now
  std::string notice;                   ///< what was written last, one sentence
  int undo_steps = 0, redo_steps = 0;   ///< changes of marks that can be taken back, and made again
  bool masks_written = false;           ///< true masks were written into the sequence since it was opened
  std::string run_hash;                 ///< of all records so far, as `stillpoint run` prints it
  std::string sequence_hash;            ///< of the sequence, as sidecar and run folder keep it
};

// Requests. Frames beyond the ends mean the nearest there is.
namespace request {
struct GoTo {
  int frame = 0;
};
/// From the frame that was asked for last, which may not be shown yet: none of several quick steps is lost.
struct Step {
  int by = 1;  ///< frames
};
struct Play {
  bool play = true;
};
struct Bookmarks {
  std::vector<Bookmark> all;
};  ///< replaces them
struct Pins {
  std::vector<Pin> all;
};  ///< replaces them
struct Drawn {
  std::vector<DrawnFrame> all;
};  ///< replaces them
/// What is drawn, carried to all frames, as the true masks in the sequence's folder.
struct WriteTruth {};
struct Breakpoints {
  std::vector<Breakpoint> all;
};  ///< replaces them
struct Span {
  std::optional<FrameSpan> span;
  bool loop = false;
};
struct Preview {
  std::optional<Config> config;
};  ///< none ends it
struct RunAll {
  Config config;
};  ///< the session's own run begins anew with it
/// A ghost with this config: from frame `from` on, or from the first.
struct AddGhost {
  Config config;
  std::string name;
  int from = 0;
  /// Where that frame has not been processed: the run goes there, and the ghost begins then. Otherwise it
  /// begins at the last that has.
  bool waits = false;
};
struct RemoveGhost {
  int index = 0;
};
/// Frames of the span, or the one shown, as a small TUM folder.
struct ExportFrames {
  std::string folder;
};
/// Records, sidecar and frames as one folder that opens elsewhere: from the first frame to the span's last,
/// or all that are processed.
struct ExportSession {
  std::string folder;
};
/// The sequence is questioned by all there is (check_sequence), beside the session.
struct CheckSequence {};
/// The sequence's first frames (0 = all) under `base`, once for each value of a parameter, beside the
/// session.
struct Sweep {
  Config base;
  SweepRange range;
  int frames = 0;
};
/// The sweep ends with what it has.
struct StopSweep {};
/// What is being written ends, and is taken away.
struct StopExport {};
/// Another method's stages of each frame shown, beside the run's own; an empty name ends it.
struct StagesBeside {
  std::string method;
};
/// The frame that stands beside the one shown: the one before, the keyframe it shares most with, or one that
/// is kept, from now on.
struct StandBeside {
  OtherFrame which = OtherFrame::before;
  std::optional<int> keep{};  ///< … this one; nothing: the one kept so far
};
/// The last change of bookmarks, pins, breakpoints, outlines or the range is taken back, or made again.
struct Undo {};
struct Redo {};
struct SavePreset {
  Config config;
  std::string file;
};
}  // namespace request

using SessionRequest =
    std::variant<request::GoTo, request::Step, request::Play, request::Bookmarks, request::Pins,
                 request::Drawn, request::WriteTruth, request::Breakpoints, request::Span, request::Preview,
                 request::RunAll, request::AddGhost, request::RemoveGhost, request::ExportFrames,
                 request::ExportSession, request::CheckSequence, request::Sweep, request::StopSweep,
                 request::StopExport, request::StagesBeside, request::StandBeside, request::Undo,
                 request::Redo, request::SavePreset>;

}  // namespace stillpoint
