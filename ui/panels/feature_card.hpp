#pragma once

#include <string>

#include "core/inspect/feature_explanation.hpp"
#include "ui/panels/panel_kit.hpp"

namespace stillpoint {

struct ImageResponse;

// A feature's explanation as panels draw it.

/// "removed", "inlier", …, and the colour and sign it has in every panel.
[[nodiscard]] LegendEntry fate_look(FeatureFate fate, ThemeName theme);

/// Its trail over the last frames, and an arrow from where it would be had it stood still, on frame t's
/// picture.
void draw_explanation_marks(const UiFrame& frame, const ImageResponse& response,
                            const FeatureExplanation& explanation);

/// The explanation in a few lines beside the mouse.
void draw_explanation_tooltip(const UiFrame& frame, const FeatureExplanation& explanation);

/// A figure against its limit, as a bar: the limit stands in the middle. At ImGui's cursor.
void draw_margin(const UiFrame& frame, const Margin& margin);

}  // namespace stillpoint
