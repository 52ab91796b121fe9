#pragma once

#include <memory>
#include <string>

#include "ui/theme/palette.hpp"

namespace stillpoint {

class Panel;
struct PanelsShared;

// Each panel's factory, defined in the panel's file.

using Shared = std::shared_ptr<PanelsShared>;

[[nodiscard]] std::unique_ptr<Panel> make_input_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_disparity_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_stereo_holes_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_compensated_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_difference_panel(Shared shared);

/// Which mask a mask panel shows: the one the run used, or a layer of the stages.
struct MaskPanelInfo {
  std::string name, title;
  Role role = Role::kUnion;
  bool numbered = false;       ///< its regions are numbered
  std::string layer{};         ///< id of the layer; empty: what the run removed
  std::string raw_layer{};     ///< … before it was cleaned up, where it is
  std::string warped_layer{};  ///< … in the target's camera, where it lies in another
  std::string values_layer{};  ///< … whose limit made it, where there is one
};
[[nodiscard]] std::unique_ptr<Panel> make_mask_panel(MaskPanelInfo info, Shared shared);

[[nodiscard]] std::unique_ptr<Panel> make_flow_tracks_panel(Shared shared);

enum class FeatureMoment { kBefore, kAfter };
[[nodiscard]] std::unique_ptr<Panel> make_features_panel(FeatureMoment moment, Shared shared);

[[nodiscard]] std::unique_ptr<Panel> make_outline_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_stages_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_feature_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_motion_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_trajectory_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_errors_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_pose_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_timeline_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_timings_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_parameters_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_breakpoints_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_bookmarks_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_compare_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_removal_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_inspector_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_check_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_two_frames_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_sweep_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_figures_panel(Shared shared);
[[nodiscard]] std::unique_ptr<Panel> make_log_panel(Shared shared);

}  // namespace stillpoint
