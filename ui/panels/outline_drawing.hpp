#pragma once

#include <imgui.h>

#include <vector>

#include "core/inspect/marks.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {

struct ImageResponse;
struct UiFrame;

// Outlines on a picture: where they are on the display, how near the mouse is, and how they are drawn.

/// Where a corner is drawn, px of the display.
[[nodiscard]] ImVec2 corner_on(const ImageResponse& response, const Corner& corner);

/// px of the display.
[[nodiscard]] float distance_between(ImVec2 a, ImVec2 b);
[[nodiscard]] float distance_to_edge(ImVec2 p, ImVec2 a, ImVec2 b);

/// Whether a place of the frame lies in an outline, or on it.
[[nodiscard]] bool encloses(const Outline& outline, const Corner& at);

/// A line that reads on any picture. @param points px of the display
void draw_outline(const UiFrame& frame, const std::vector<ImVec2>& points, bool closed, Rgb ink);
void draw_corners(const UiFrame& frame, const std::vector<ImVec2>& points, Rgb ink);

}  // namespace stillpoint
