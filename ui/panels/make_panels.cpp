#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/panels/panels_shared.hpp"

namespace stillpoint {

std::vector<PanelCommand> Panel::commands() { return {}; }

std::vector<std::unique_ptr<Panel>> make_panels() {
  const auto shared = std::make_shared<PanelsShared>();
  std::vector<std::unique_ptr<Panel>> panels;
  panels.push_back(make_input_panel(shared));
  panels.push_back(make_disparity_panel(shared));
  panels.push_back(make_stereo_holes_panel(shared));
  panels.push_back(make_compensated_panel(shared));
  panels.push_back(make_difference_panel(shared));
  panels.push_back(make_mask_panel({"forward_mask", "Forward mask", Role::kForward, false, "forward_mask",
                                    "raw_forward_mask", "", "difference"},
                                   shared));
  panels.push_back(make_mask_panel({"backward_mask", "Backward mask", Role::kBackward, false, "backward_mask",
                                    "raw_backward_mask", "warped_backward_mask", "difference_backward"},
                                   shared));
  panels.push_back(make_mask_panel({"union_mask", "Union mask", Role::kUnion, true, "union_mask"}, shared));
  panels.push_back(make_flow_tracks_panel(shared));
  panels.push_back(make_features_panel(FeatureMoment::kBefore, shared));
  panels.push_back(make_features_panel(FeatureMoment::kAfter, shared));
  panels.push_back(make_feature_panel(shared));
  panels.push_back(make_stages_panel(shared));
  panels.push_back(make_mask_panel({"mask", "Mask", Role::kUnion, true}, shared));
  panels.push_back(make_motion_panel(shared));
  panels.push_back(make_trajectory_panel(shared));
  panels.push_back(make_errors_panel(shared));
  panels.push_back(make_timeline_panel(shared));
  panels.push_back(make_removal_panel(shared));
  panels.push_back(make_compare_panel(shared));
  panels.push_back(make_breakpoints_panel(shared));
  panels.push_back(make_bookmarks_panel(shared));
  panels.push_back(make_timings_panel(shared));
  panels.push_back(make_parameters_panel(shared));
  panels.push_back(make_inspector_panel(shared));
  panels.push_back(make_pose_panel(shared));
  panels.push_back(make_outline_panel(shared));
  panels.push_back(make_check_panel(shared));
  panels.push_back(make_two_frames_panel(shared));
  panels.push_back(make_sweep_panel(shared));
  panels.push_back(make_figures_panel(shared));
  panels.push_back(make_log_panel(shared));
  return panels;
}

}  // namespace stillpoint
