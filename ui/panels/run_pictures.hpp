#pragma once

#include "ui/panels/panel.hpp"
#include "ui/session/shown_runs.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {

/// The colour a run has in every panel.
[[nodiscard]] Rgb run_colour(const ListedRun& run, ThemeName theme);

/// Whether a panel is drawn of other runs than the session's own, as UiFrame::runs says.
[[nodiscard]] bool is_by_runs(const UiFrame& frame, const SessionView& session, const Panel& panel);

/// Draws a panel of the runs that UiFrame::runs has pictures show: of the session's own alone, of another in
/// its place, or its pictures with each run in a strip of them. Panels that show no run are as they are.
void draw_by_runs(UiFrame& frame, const SessionView& session, Panel& panel, PanelActions& actions);

}  // namespace stillpoint
