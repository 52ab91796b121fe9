#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stillpoint {

/// METHOD.md §1: what moves between two frames.
struct MotionConfig {
  int max_corners = 600;             ///< Shi-Tomasi corners followed per direction
  double corner_quality = 0.01;      ///< least corner response, as a share of the best corner's
  double corner_distance_px = 12.0;  ///< least distance between corners
  int flow_window_px = 21;           ///< side of the Lucas-Kanade window
  int flow_levels = 3;               ///< pyramid levels above the full image
  double flow_max_residual = 20.0;   ///< mean absolute grey-level residual above which a track is dropped
  double ransac_threshold_px = 2.0;  ///< reprojection error that makes a track an inlier of the homography
  double ransac_confidence = 0.995;  ///< probability that RANSAC drew one outlier-free sample
  int ransac_iterations = 2000;      ///< most samples RANSAC draws
  int refine_iterations = 20;        ///< most Levenberg-Marquardt steps on eq. (4)
  int erode_kernel_px = 4;           ///< side of the square erosion kernel
  int erode_iterations = 2;          ///< times the erosion is applied
  int dilate_kernel_px = 16;         ///< side of the square dilation kernel
  int dilate_iterations = 1;         ///< times the dilation is applied
  int border_px = 3;                 ///< margin beside the warp's border that counts as having no data
  int max_rounds = 3;                ///< rounds of removal and a better homography
  double converged_shift_px = 0.1;  ///< rounds stop when no image corner moves more than this under the new H
  int min_tracks = 12;              ///< fewer static tracks than this and the round keeps the last homography
  int reference_gap = 1;            ///< frames between the reference and the target; 1 as in the paper
  bool operator==(const MotionConfig&) const = default;
};

/// Method `stillpoint`: what moves where there is depth.
struct DepthMotionConfig {
  int factor = 4;             ///< full-size pixels a side of a pixel in which motion is judged
  int use_depth = 1;          ///< 1: depth residuals are evidence
  int use_brightness = 1;     ///< 1: brightness residuals are evidence
  int near_reference = 2;     ///< frames back to the nearer reference
  int far_reference = 10;     ///< frames back to the far one of frames with an even index …
  int slow_reference = 24;    ///< … and with an odd one: for slow movers
  double depth_sigmas = 4.0;  ///< depth residual beyond which a pixel counts as moved, standard deviations
  double intensity_sigmas = 4.0;  ///< the same of brightness
  double gradient_share =
      0.75;  ///< of the local gradient that a brightness residual may reach for want of exact pixels
  double max_misplacement_px =
      1.0;  ///< small px by which surfaces may be taken to lie beside their place, where they are seen to
  double memory = 0.9;         ///< share of the log-odds carried to the next frame
  double max_log_odds = 6.0;   ///< evidence of motion saturates here, so that a change of mind stays possible
  double firm_log_odds = 3.0;  ///< above it a pixel is firmly known to move …
  double release = 0.015;      ///< … and takes this share of what speaks for standing still
  int find_receding = 1;       ///< 1: patches that go back, away from the camera, are looked for
  int inherit = 1;             ///< 1: what comes into view takes over what its surface is known to do
  double patch_share = 0.3;    ///< of the log-odds by a patch's shift that counts in one frame
  int segment_px = 10;         ///< side of a surface patch, small pixels
  double smoothing = 0.6;      ///< weight of neighbours on the same surface against a patch's own evidence
  double moving_log_odds = 0.35;   ///< above it a patch moves
  double min_area_share = 0.0015;  ///< smaller regions are noise, share of the image
  int margin_px = 0;               ///< added about the mask at the end
  bool operator==(const DepthMotionConfig&) const = default;
};

/// Method `stillpoint`: what moves where there is colour alone. Small pixels are two full-size ones a side.
struct ColourMotionConfig {
  int cell_px = 8;                ///< each cell of the small image holds one followed point at most, small px
  int flow_window_px = 9;         ///< side of the Lucas-Kanade window, small px
  double corner_response = 1e-4;  ///< least eigenvalue of the gradient matrix that makes a point
  int near_reference = 3;         ///< frames back to the nearest of three references
  int far_reference = 12;         ///< frames back to the farthest one; the third lies half as far
  double sigmas = 1.5;            ///< residual at which a point's evidence changes sign, standard deviations
  double evidence_a_sigma = 0.4;  ///< evidence for every standard deviation beyond that
  double memory = 0.92;           ///< share of a point's evidence carried to the next frame
  double max_evidence = 3.0;      ///< evidence of moving saturates here
  double max_static_evidence =
      0.5;          ///< … and of standing still here: a step along its epipolar line looks still
  int min_age = 2;  ///< frames a point is followed before it has a say
  double same_motion_px = 0.5;   ///< difference of two points' paths that sets them apart, small px
  double sharing = 2.0;          ///< weight of a neighbour that moves alike against a point's own evidence
  double colour_price = 0.15;    ///< what a grey level of change costs evidence on its way, quarter-size px
  double longest_way = 8.0;      ///< way after which evidence ends, or, up to twice it, colours must agree
  double moving_evidence = 0.3;  ///< above it a pixel moves
  int close_px = 8;              ///< gaps in the mask up to twice this are closed, quarter-size px
  int shave_px = 3;              ///< within the outline: so far pixels go with their colours, quarter-size px
  double min_area_share = 0.008;  ///< smaller regions are noise, share of the image
  int min_points = 8;             ///< regions with fewer moving points are noise

  bool operator==(const ColourMotionConfig&) const = default;
};

/// ORB features spread over the image.
struct FeatureConfig {
  int count = 1000;            ///< features wanted a frame
  int levels = 8;              ///< pyramid levels
  double scale_factor = 1.2;   ///< from level to level
  int fast_threshold = 20;     ///< FAST threshold, grey levels
  int fast_threshold_low = 7;  ///< where a cell has no corner at fast_threshold
  bool operator==(const FeatureConfig&) const = default;
};

/// Tracking against the local map.
struct TrackingConfig {
  double search_radius_px = 15.0;       ///< matching window at pyramid level 0, motion model predicted
  double search_radius_wide_px = 30.0;  ///< second attempt
  double map_radius_px = 4.0;           ///< matching window of local map points once the pose is known
  int match_max_distance = 100;         ///< largest ORB distance, bits of 256
  double match_ratio = 0.8;             ///< best over second-best distance, same level
  int min_inliers = 20;                 ///< fewer inliers than this and the frame is lost
  int min_initial_matches = 15;         ///< fewer and the motion model has failed
  int pnp_iterations = 200;             ///< RANSAC samples for EPnP
  double pnp_threshold_px = 4.0;        ///< inlier threshold for EPnP at level 0
  int refine_iterations = 10;           ///< Levenberg-Marquardt steps a round of eq. (5)
  int refine_rounds = 4;                ///< rounds, outliers reclassified after each
  int correct_rolling_shutter =
      1;                      ///< 1: features are carried to where their frame's middle row would show them
  int correct_depth_lag = 1;  ///< 1: depth taken at another time than colour is carried to colour's time
  int seek_consensus = 1;     ///< 1: method `stillpoint` takes its first pose from where most samples agree
  double start_looseness = 2.0;  ///< matches that are off by more than this many times their χ² bound under
                                 ///< the consensus do not begin the pose that follows it; 0 = all do
  int soft_weights = 1;          ///< 1: method `stillpoint` weighs features by how likely they stand still
  double half_trust_log_odds = -2.0;  ///< log-odds of moving at which a feature counts half
  int look_back_frames = 60;  ///< methods `stillpoint` and `oracle` solve each pose once more, by the map so
                              ///< many frames later; 0 = never
  double depth_weight =
      1.0;  ///< weight of the depth residual beside the paper's two; 0 = the paper's eq. (5)
  bool operator==(const TrackingConfig&) const = default;
};

/// Sparse direct alignment where corners starve, in methods `stillpoint` and `oracle`: the paper's odometry,
/// which `paper` and `none` keep to, has none.
struct DirectConfig {
  int below_inliers = 50;    ///< frames with fewer inliers than this are aligned directly too; 0 = never any
  double below_share = 0.5;  ///< … and those with fewer than this share of what was usual lately
  int cell_px = 16;          ///< each cell of the image holds one patch at most
  int coarsest_level = 4;    ///< pyramid level at which alignment begins
  int finest_level = 1;      ///< … and at which it ends
  int iterations = 10;       ///< most Gauss-Newton steps a level
  int min_patches = 80;      ///< patches in view below which nothing is believed
  double min_correlation = 0.6;  ///< least correlation of the patches' brightness with the frame's
  double min_agreement = 0.5;    ///< least share of patches at whose place the depth expected was measured
  int max_age = 10;              ///< frames back to what is aligned with, at most
  double pixel_share = 0.3;      ///< independent measurements a patch's pixel counts for when poses are fused
  bool operator==(const DirectConfig&) const = default;
};

/// The local map and its keyframes.
struct MapConfig {
  double far_depth_m = 3.0;   ///< points are made from depth up to here, beyond only if few are near
  int min_new_points = 100;   ///< so many nearest points are made however far
  int min_cell_points = 5;    ///< … and so many in each part of the image of 80 px
  int keyframe_max_gap = 30;  ///< frames after which a keyframe may be made whatever else
  double keyframe_min_ratio =
      0.75;  ///< a keyframe is made when inliers fall below this share of the reference's
  int keyframe_min_near =
      100;  ///< … or fewer near features than this are tracked while `keyframe_new_near` wait
  int keyframe_new_near = 70;  ///< near features without a map point that make a keyframe worthwhile
  double cull_redundancy =
      0.9;  ///< a keyframe is culled when this share of its points is seen by three others
  double min_found_ratio = 0.25;  ///< a young point found in less than this share of its sightings is culled
  int max_local_keyframes = 20;   ///< covisible keyframes in the local map
  int purge_moving = 1;           ///< 1: method `stillpoint` takes points on what moves out of the map
  int max_keyframes = 100;        ///< beyond them the oldest retires: what keeps memory flat
  bool operator==(const MapConfig&) const = default;
};

/// Local bundle adjustment.
struct BundleConfig {
  int max_keyframes = 8;         ///< local keyframes refined
  int max_fixed_keyframes = 20;  ///< keyframes that share their points, held fixed
  int iterations = 5;            ///< most Levenberg-Marquardt steps; the robust ones before are half as many
  int apply_after_frames = 3;    ///< result enters the map this many frames after the keyframe; 0 = at once
  bool operator==(const BundleConfig&) const = default;
};

struct RunConfig {
  std::string method = "stillpoint";  ///< stillpoint, paper, none; or oracle, which is told what moves
  int threads = 2;                    ///< worker threads; any number gives the same bytes
  int seed = 1;                       ///< of generated sequences
  int check_removal = 0;  ///< 1: each pose is also solved without removal, and with the true mask where known
  bool operator==(const RunConfig&) const = default;
};

/// Every constant of a run. Plain data; for_each_parameter below lists it.
struct Config {
  RunConfig run;
  MotionConfig motion;
  DepthMotionConfig depth_motion;
  ColourMotionConfig colour_motion;
  FeatureConfig features;
  TrackingConfig tracking;
  DirectConfig direct;
  MapConfig map;
  BundleConfig bundle;
  bool operator==(const Config&) const = default;
};

/// One parameter of a config: where it lives, its range, unit and meaning. What TOML files, `--set`, and the
/// parameters panel are made from.
struct Parameter {
  std::string key;  ///< `section.name`, as in the TOML file
  std::variant<int*, double*, std::string*> value;
  double min = 0.0, max = 0.0;       ///< inclusive, numbers only
  std::vector<std::string> choices;  ///< strings only: the values allowed
  std::string unit;                  ///< "px", "m", "frames", "" for plain numbers
  std::string help;                  ///< one line
};

/// All parameters of `config`, pointing into it, in the order they are written.
[[nodiscard]] std::vector<Parameter> parameters(Config& config);

/// Reads TOML over the defaults; keys not given keep their default.
/// @throws InputError with file and line: unreadable, not TOML, an unknown key, a wrong type or a value out
/// of range.
[[nodiscard]] Config read_config(const std::string& path);

/// The same of a text. @param path named in errors as where it stands
[[nodiscard]] Config config_from_toml(const std::string& text, const std::string& path);

/// Names of the presets there are, in alphabetical order.
[[nodiscard]] std::vector<std::string> preset_names();

/// A preset by name (`assets/presets/NAME.toml`), or a TOML file by path.
/// @throws InputError naming the presets there are.
[[nodiscard]] Config load_config(const std::string& preset_or_path);

/// Sets one `section.name=value`.
/// @throws InputError for an unknown key, a wrong type or a value out of range.
void set_parameter(Config& config, std::string_view assignment);

/// The config as TOML, every key with its unit and meaning as a comment; read_config reads it back to the
/// same.
[[nodiscard]] std::string to_toml(const Config& config);

}  // namespace stillpoint
