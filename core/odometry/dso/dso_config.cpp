#include "core/odometry/dso/dso_config.hpp"

namespace stillpoint {

void DsoConfig::list(ParameterTable& table) {
  table.number("levels", levels, 5, 1, 8, "levels", "pyramid levels of tracking");
  table.number("candidates", candidates, 1500, 50, 20000, "points", "wanted a keyframe");
  table.number("active_points", active_points, 2000, 50, 20000, "points", "wanted in the window");
  table.number("gradient_margin", gradient_margin, 7.0, 0, 100, "grey levels",
               "a candidate's gradient lies so much above its block's median");
  table.number("gradient_softness", gradient_softness, 50.0, 1, 1000, "grey levels",
               "c of a pixel's weight c² / (c² + gradient²)");
  table.number("huber", huber, 9.0, 0.5, 255, "grey levels", "bound of Huber's loss");
  table.number("outlier", outlier, 12.0, 1, 255, "grey levels",
               "a point whose pixels are off by more on average begins as an outlier");
  table.number("cutoff", cutoff, 20.0, 1, 255, "grey levels", "tracking leaves out larger residuals");
  table.number("cutoff_share", cutoff_share, 0.6, 0, 1, "", "… twice as large ones when it leaves out more");
  table.number("max_gain", max_gain, 1.2, 0.01, 10, "", "largest change of log brightness that is believed");
  table.number("max_bias", max_bias, 200.0, 1, 1000, "grey levels", "largest change of offset that is");
  table.number("turn", turn, 0.02, 0.001, 0.5, "rad", "of the 26 small turns that tracking begins from");
  table.number("good_enough", good_enough, 1.5, 1, 100, "",
               "times the last frame's residual: a start that reaches it is the last one tried");
  table.number("keyframe_shift", keyframe_shift, 0.04, 0, 10, "1/px",
               "a keyframe is made when this times the flow by translation alone …");
  table.number("keyframe_flow", keyframe_flow, 0.02, 0, 10, "1/px", "… and this times the whole flow …");
  table.number("keyframe_gain", keyframe_gain, 2.0, 0, 100, "",
               "… and this times the change of log brightness add up to more than 1 …");
  table.number("keyframe_error", keyframe_error, 2.0, 1, 100, "",
               "… or the residual exceeds so many times that of the first frame after the last keyframe");
  table.number("window", window, 7, 2, 20, "frames", "keyframes optimised together");
  table.number("iterations", iterations, 6, 1, 50, "steps", "Gauss-Newton steps a keyframe");
  table.number("least_left", least_left, 0.05, 0, 1, "",
               "a keyframe with a smaller share of its points left goes");
  table.number("max_gain_step", max_gain_step, 0.7, 0.01, 10, "",
               "one whose log brightness differs more from the newest's goes too");
  table.number("least_window", least_window, 5, 2, 20, "frames", "… while more than so many are left");
  table.number("depth_sigma", depth_sigma, 1.425e-3, 1e-5, 1, "1/m", "of a sensed inverse depth");
  table.number("noise", noise, 5.0, 0.1, 100, "grey levels",
               "of a residual: what the sensed depth is weighed against");
  table.number("farthest_m", farthest_m, 8.0, 0.5, 100, "m", "farther depth makes no point");
  table.number("min_points", min_points, 100, 10, 10000, "points", "with fewer in view the frame is lost");
}

DsoConfig DsoConfig::for_camera(const Camera& camera) const {
  DsoConfig fitted = *this;
  // Of an inverse depth: sigma_z / z², the same at any depth.
  if (camera.is_stereo()) fitted.depth_sigma = camera.depth_sigma_per_m2;
  fitted.farthest_m = camera.depth_limit(farthest_m);
  return fitted;
}

}  // namespace stillpoint
