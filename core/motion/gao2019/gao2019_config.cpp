#include "core/motion/gao2019/gao2019_config.hpp"

namespace stillpoint {

void Gao2019Config::list(ParameterTable& table) {
  table.choice("first_pose", first_pose, "alignment", {"alignment", "odometry"},
               "pose that warps the model: sparse image alignment's, or the odometry's first one");
  table.number("cell_px", cell_px, 16, 4, 128, "px", "a cell of this side holds one patch to align");
  table.number("fast_threshold", fast_threshold, 12, 1, 100, "grey levels",
               "contrast of a corner that makes a patch");
  table.number("coarsest_level", coarsest_level, 4, 0, 6, "", "pyramid level at which alignment begins");
  table.number("finest_level", finest_level, 1, 0, 6, "", "pyramid level at which it ends");
  table.number("iterations", iterations, 10, 1, 100, "", "Gauss-Newton steps a level, at most");
  table.number("min_patches", min_patches, 30, 6, 10000, "patches",
               "with fewer in view the odometry's first pose stands in");
  table.number("median_radius_px", median_radius_px, 2, 0, 10, "px",
               "radius of the median filter before the model; 2 = 5x5");
  table.number("block_px", block_px, 4, 1, 32, "px", "side of a block of the background model");
  table.number("initial_sigma", initial_sigma, 20.0, 1, 128, "grey levels",
               "standard deviation of a Gaussian that begins");
  table.number("least_sigma", least_sigma, 5.0, 0.5, 128, "grey levels",
               "a Gaussian's standard deviation is at least this");
  table.number("max_age", max_age, 30.0, 2, 1000, "frames", "so many frames a Gaussian stands for, at most");
  table.number("decay", decay, 0.001, 0, 1, "per squared grey level",
               "how fast age falls where warping mixes unlike blocks");
  table.number("decay_above_sigma", decay_above_sigma, 50.0, 0, 255, "grey levels",
               "standard deviation above which age falls");
  table.flag("follow_exposure", follow_exposure, true,
             "the model's brightness follows the whole image's, by the median ratio of its blocks");
  table.flag("second_model", second_model, true,
             "a candidate background beside the first, as method 7 has it, takes up what does not match");
  table.number(
      "match_limit", match_limit, 2.0, 0.1, 100, "",
      "with a second model: a block belongs to one up to this many variances from its mean, squared");
  table.number(
      "moving_limit", moving_limit, 4.0, 0.1, 100, "",
      "a block is dynamic when its farthest pixel is beyond so many variances from the mean, squared");
  table.number("settled_age", settled_age, 1.0, 0, 1000, "frames",
               "a Gaussian up to this age judges no block");
  table.flag("drop_isolated", drop_isolated, true, "a dynamic block without a dynamic neighbour is static");
  table.number("fill_neighbours", fill_neighbours, 5, 1, 9, "blocks",
               "a static block with so many dynamic neighbours of 8 is dynamic; 9 = none is filled");
}

Yi2013Config Gao2019Config::model() const {
  Yi2013Config config;
  config.median_radius_px = median_radius_px;
  config.block_px = block_px;
  config.initial_sigma = initial_sigma;
  config.least_sigma = least_sigma;
  config.max_age = max_age;
  config.decay = decay;
  config.decay_above_sigma = decay_above_sigma;
  config.match_limit = match_limit;
  config.moving_limit = moving_limit;
  config.settled_age = settled_age;
  return config;
}

}  // namespace stillpoint
