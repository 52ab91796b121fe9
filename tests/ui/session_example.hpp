#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/sequence/source.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint::testing {

/// Everything panels show of some frames of a sequence that were truly run, without a session around it.
struct SessionExample {
  std::unique_ptr<FrameSource> source;
  SessionView view;
};

/// Runs method `stillpoint`, and `none` as the baseline, over the first `frames` frames and shows the last
/// one.
/// @param rpe_delta_s span of the error over time: short sequences have no second
[[nodiscard]] SessionExample run_example(std::unique_ptr<FrameSource> source, int frames, double rpe_delta_s);

/// A session put together by hand, nothing of which was computed by the method: for golden images, which only
/// a change of the panels is to change.
[[nodiscard]] SessionView handmade_example();

/// The same with all that debugging adds: bookmarks, breakpoints, a range, two ghosts, removal's errors.
[[nodiscard]] SessionView debug_example();

/// A run of as many frames as wanted, its figures going up and down; worst at `worst`.
[[nodiscard]] SessionView long_example(int frames, int worst);

/// One of a run's records, to be shown: it stays where it is until a record of the run is changed.
[[nodiscard]] const FrameRecord* record_in(const RunView& run, std::size_t row);

/// The names of all panels, in the order in which they are made.
[[nodiscard]] std::vector<std::string> panel_names();

/// 14 frames of generated:walking_static, run once a program.
[[nodiscard]] const SessionView& generated_example();

}  // namespace stillpoint::testing
