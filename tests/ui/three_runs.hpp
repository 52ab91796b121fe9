#pragma once

#include <memory>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/ui/session_example.hpp"

namespace stillpoint::testing {

/// A view of the same frame that removed a band across the whole picture, from row `top` on.
inline std::shared_ptr<const FrameView> with_band(const FrameView& view, int top) {
  auto current = std::make_shared<FrameView>(view);
  current->mask = cv::Mat(240, 320, CV_8UC1, cv::Scalar(0));
  current->mask.rowRange(top, top + 24) = 255;
  return current;
}

/// Three runs, each of which removed something in every strip, and each something else.
inline SessionView three_runs() {
  SessionView session = debug_example();
  session.current = with_band(*session.current, 70);
  session.debug.ghosts[0].current = with_band(*session.debug.ghosts[0].current, 105);
  session.debug.ghosts[1].current = with_band(*session.debug.ghosts[1].current, 140);
  return session;
}

}  // namespace stillpoint::testing
