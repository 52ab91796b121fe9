#pragma once

#include <optional>
#include <vector>

#include "ui/session/session_view.hpp"

namespace stillpoint {

// Places to go to from the frame shown: what keys, menus and panels' buttons lead to. Nothing where there is
// no such place.

/// Down the list of worst frames: on from where the list last led, if one still stands there; else to the
/// worst, though the frame shown may itself be in the list.
/// @param gone_to the frame the list was last gone to; nothing before that
[[nodiscard]] std::optional<int> next_worst(const std::vector<int>& worst, int frame,
                                            std::optional<int> gone_to);
/// Up the list again; nothing where one did not come by it.
[[nodiscard]] std::optional<int> previous_worst(const std::vector<int>& worst, int frame,
                                                std::optional<int> gone_to);

/// Frames at which an enabled breakpoint holds, ascending, each once.
[[nodiscard]] std::vector<int> hit_frames(const DebugView& debug);
/// Frames at which removal hurt, ascending.
[[nodiscard]] std::vector<int> hurt_frames(const DebugView& debug);
[[nodiscard]] std::vector<int> bookmarked_frames(const DebugView& debug);

/// The neighbours of a frame in an ascending list.
[[nodiscard]] std::optional<int> next_in(const std::vector<int>& frames, int frame);
[[nodiscard]] std::optional<int> previous_in(const std::vector<int>& frames, int frame);

/// The earliest frame at which a ghost parts from the run.
[[nodiscard]] std::optional<int> first_divergence(const DebugView& debug);

// Lists as they are asked for anew.

/// With the frame bookmarked; a note it has stays.
[[nodiscard]] std::vector<Bookmark> with_bookmark(std::vector<Bookmark> all, int frame);
[[nodiscard]] std::vector<Bookmark> without_bookmark(std::vector<Bookmark> all, int frame);
[[nodiscard]] const Bookmark* bookmark_at(const DebugView& debug, int frame);

/// The breakpoints without what was found out about them.
[[nodiscard]] std::vector<Breakpoint> breakpoints_of(const DebugView& debug);

/// From one frame to another, whichever comes first, cut to the sequence.
[[nodiscard]] FrameSpan span_between(int a, int b, int frame_count);

}  // namespace stillpoint
