#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/evaluation/alignment.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/shared_value.hpp"
#include "ui/session/debug_view.hpp"

namespace stillpoint {

struct SavedKeyframe;
struct SavedPoint;

/// What panels draw: a snapshot of the session, plain data, made by the session once a frame of the interface
/// at most. What grows with a sequence is shared by the snapshots, not copied.
struct SessionView {
  std::string title;  ///< the sequence's name
  Camera camera;
  Config config;
  bool own_run = true;                       ///< false where another run stands in its place (as_run())
  int frame_count = 0;                       ///< of the sequence
  int processed = 0;                         ///< frames with a record
  bool playing = false, busy = false;        ///< playing; the worker has something to do
  std::string message;                       ///< the last error, one sentence; empty when all is well
  std::shared_ptr<const FrameView> current;  ///< the frame shown; never null
  std::shared_ptr<const RunView> run;        ///< never null
  std::string outside;                       ///< what another program's run is called, where `run` is one
  std::shared_ptr<const RunView> baseline;   ///< null where none is run
  Config baseline_config;                    ///< … what it is run with
  BesideFrame baseline_frame;                ///< … and its frame, where its pictures are wanted
  SharedValue<Trajectory> ground_truth;      ///< empty where there is none
  Alignment alignment;  ///< truth_from_estimate over the poses so far, stated in the trajectory panel
  SharedValue<std::vector<SavedKeyframe>> keyframes;
  SharedValue<std::vector<SavedPoint>> map_points;  ///< then those that left the map because they moved
  DebugView debug;                                  ///< bookmarks, breakpoints, ghost runs, …
  std::uint64_t revision = 0;  ///< grows when run, keyframes or points change: what caches go by
};

/// Whether the sliders' config, not the run's, made the motion stages that are shown.
[[nodiscard]] bool shows_preview(const SessionView& session);

/// What panels of the frame shown draw while there is a preview of it: the same session, whose frame, config
/// and nothing else are the preview's. @pre shows_preview(session)
[[nodiscard]] SessionView with_preview(const SessionView& session);

/// What the baseline is called, wherever it stands beside other runs. @pre session.baseline
[[nodiscard]] std::string baseline_name(const SessionView& session);

/// Whose work the run is: its method's name, or that of another program's run.
[[nodiscard]] const std::string& maker_of(const SessionView& session);

/// The method that judged the frame shown: the run's, or the one that stands in for it where there is no
/// depth.
[[nodiscard]] const std::string& judge_of(const SessionView& session);

/// Whose work the run is as words: "method paper", "another program's run orb3", and for a frame without
/// depth, which another method judges, "method epipolar in stillpoint's place".
[[nodiscard]] std::string run_words(const SessionView& session);

}  // namespace stillpoint
