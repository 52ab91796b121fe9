#pragma once

#include "ui/panels/panel_kit.hpp"

namespace stillpoint {

// Each panel's factory, defined in the panel's file.

using Shared = std::shared_ptr<PanelsShared>;

[[nodiscard]] std::unique_ptr<Panel> make_input_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_compensated_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_difference_panel(Shared shared);

enum class MaskKind { kForward, kBackward, kUnion };
[[nodiscard]] std::unique_ptr<Panel> make_mask_panel(MaskKind kind, Shared shared);

[[nodiscard]] std::unique_ptr<Panel> make_flow_tracks_panel(Shared shared);

enum class FeatureMoment { kBefore, kAfter };
[[nodiscard]] std::unique_ptr<Panel> make_features_panel(FeatureMoment moment, Shared shared);

[[nodiscard]] std::unique_ptr<Panel> make_stages_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_feature_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_depth_motion_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_colour_motion_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_trajectory_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_errors_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_timeline_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_timings_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_parameters_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_breakpoints_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_bookmarks_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_compare_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_removal_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_inspector_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_log_panel(Shared shared);

}  // namespace stillpoint
