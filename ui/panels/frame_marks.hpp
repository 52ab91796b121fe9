#pragma once

#include <optional>

#include "core/motion/stage_log.hpp"

namespace stillpoint {

struct ImageResponse;
struct PanelActions;
struct PanelsShared;
struct SessionView;
struct UiFrame;

// What is marked in every image of a frame: the scene point under the mouse, pins, the chosen feature.

/// Which pixels an image has, and what its panel draws for.
struct FramePlace {
  const SessionView& session;
  PanelActions& actions;
  FrameSpace space = FrameSpace::kTarget;
};

/// Makes the point under the mouse the cursor of all panels, and offers a menu on a right click.
void take_mouse(const char* id, const ImageResponse& response, PanelsShared& shared, const FramePlace& place);

/// Draws crosshair, pins and the chosen feature where the image shows them.
void draw_marks(const UiFrame& frame, const ImageResponse& response, PanelsShared& shared,
                const FramePlace& place);

/// Asks for a pin at the cursor, or for the one there to go.
void toggle_pin_at_cursor(const SessionView& session, const PanelsShared& shared, PanelActions& actions);

/// The chosen feature among those of the frame shown; keeps the choice up to date from frame to frame.
[[nodiscard]] std::optional<int> chosen_feature(const SessionView& session, PanelsShared& shared);

/// Chooses a feature of the frame shown.
void choose_feature(const SessionView& session, PanelsShared& shared, int index);

}  // namespace stillpoint
