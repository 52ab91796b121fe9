#pragma once

namespace stillpoint {

/// Which parts of a frame's record somebody measured. What nobody measured has no value, whatever its field
/// holds: an engine without a map has no map points, which is not the same as a map of 0 points, and another
/// program's trajectory tells poses alone. Whoever makes a record says so here, once, and all that is shown
/// or written of it (core/run/figure_table.cpp) goes by it.
struct RecordParts {
  bool mask = true;              ///< FrameRecord::mask_share
  bool rounds = true;            ///< motion_rounds
  bool features = true;          ///< features_found, features_removed, features_kept
  bool matches = true;           ///< matches, inliers
  bool solving = true;           ///< pose_start, refine_iterations, rms_px
  bool direct = true;            ///< FrameRecord::direct: corners that starve are helped by patches
  bool keyframes = true;         ///< keyframe, map_keyframes
  bool culled_keyframes = true;  ///< culled_keyframes
  bool points = true;            ///< map_points, new_points, culled_points
  bool fused_points = true;      ///< fused_points
  bool bundle = true;            ///< bundle_rms_before_px, bundle_rms_px, bundle_iterations
  bool times = true;             ///< ms; a stage's 0 is that of one that did not run
};

/// Of a run that another program made, of which a trajectory is known: nothing but poses.
[[nodiscard]] constexpr RecordParts poses_alone() {
  return {.mask = false,
          .rounds = false,
          .features = false,
          .matches = false,
          .solving = false,
          .direct = false,
          .keyframes = false,
          .culled_keyframes = false,
          .points = false,
          .fused_points = false,
          .bundle = false,
          .times = false};
}

}  // namespace stillpoint
