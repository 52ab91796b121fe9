#include "core/motion/alcantarilla2012/alcantarilla2012_config.hpp"

namespace stillpoint {

void Alcantarilla2012Config::list(ParameterTable& table) {
  table.number("flow_sigma_px", flow_sigma_px, 0.5, 0.05, 10, "px",
               "standard deviation of where a pixel is, in each of the two frames and directions");
  table.number("depth_sigma_per_m2", depth_sigma_per_m2, 1.425e-3, 1e-5, 0.1, "1/m",
               "a depth z has standard deviation this times z squared");
  table.number("depth_floor_m", depth_floor_m, 0.002, 0.0, 1.0, "m",
               "part of a depth's standard deviation that does not grow: registration, shutter and lag");
  table.number("least_depth_m", least_depth_m, 0.5, 0.0, 10, "m", "nearer depths are not judged");
  table.number("most_depth_m", most_depth_m, 5.0, 0.5, 100, "m", "farther depths are not judged");
  table.number("forward_backward_px", forward_backward_px, 1.0, 0.05, 20, "px",
               "flow there and back again may miss by so much");
  table.number("chi_squared", chi_squared, 12.84, 0.1, 1000, "",
               "a pixel is dynamic when its squared Mahalanobis length is above this; 12.84 = 99.5 % of "
               "three degrees");
  table.number("vote_px", vote_px, 5, 1, 31, "small px", "side of the neighbourhood that votes; odd");
  table.number("vote_share", vote_share, 0.5, 0.0, 1.0, "",
               "a place is dynamic when more than this share of the valid pixels about it are");
  table.number(
      "most_moving", most_moving, 0.7, 0.0, 1.0, "",
      "the pose is doubted, and nothing dropped, where more than this share of the valid pixels moves …");
  table.number("most_contradicted", most_contradicted, 0.35, 0.0, 1.0, "",
               "… and with them more than this share of the features that agree with the pose");
  table.number("rounds", rounds, 2, 1, 2, "",
               "rounds of testing; before the second the pose is solved again without what moves");
}

Alcantarilla2012Config Alcantarilla2012Config::for_camera(const Camera& camera) const {
  Alcantarilla2012Config fitted = *this;
  if (camera.is_stereo()) fitted.depth_sigma_per_m2 = camera.depth_sigma_per_m2;
  fitted.most_depth_m = camera.depth_limit(most_depth_m);
  return fitted;
}

}  // namespace stillpoint
