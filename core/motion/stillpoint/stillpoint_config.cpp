#include "core/motion/stillpoint/stillpoint_config.hpp"

namespace stillpoint {

void StillpointConfig::list(ParameterTable& table) {
  table.number("factor", factor, 4, 1, 16, "px", "side of the block of pixels in which motion is judged");
  table.flag("use_depth", use_depth, true, "takes depth residuals for evidence");
  table.flag("use_brightness", use_brightness, true, "takes brightness residuals for evidence");
  table.number("near_reference", near_reference, 2, 1, 30, "frames",
               "how far back the nearer reference lies");
  table.number("far_reference", far_reference, 10, 1, 100, "frames",
               "how far back the far reference lies, of frames with an even index");
  table.number("slow_reference", slow_reference, 24, 1, 100, "frames",
               "how far back the far reference lies, of frames with an odd index: for slow dynamic objects");
  table.number("depth_sigmas", depth_sigmas, 4.0, 1, 50, "sigma",
               "depth residual beyond which a pixel counts as moved");
  table.number("intensity_sigmas", intensity_sigmas, 4.0, 1, 50, "sigma",
               "brightness residual beyond which a pixel counts as moved");
  table.number("gradient_share", gradient_share, 0.75, 0, 5, "",
               "share of the local gradient a brightness residual may reach");
  table
      .number("max_registration_error_px", max_registration_error_px, 1.0, 0, 5, "px",
              "most that surfaces are taken to lie beside their place, in downsampled pixels")
      .formerly("max_misplacement_px");
  table.number("prior_share", prior_share, 0.9, 0, 1, "", "share of the log-odds warped to the next frame")
      .formerly("memory");
  table.number("max_log_odds", max_log_odds, 6.0, 0.5, 100, "", "where evidence saturates");
  table
      .number("confident_log_odds", confident_log_odds, 3.0, 0, 100, "",
              "above it a pixel is confidently dynamic")
      .formerly("firm_log_odds");
  table
      .number("hysteresis", hysteresis, 0.015, 0, 1, "",
              "share of evidence for being static that what confidently moves takes")
      .formerly("release");
  table
      .flag("find_axial_motion", find_axial_motion, true,
            "looks for superpixels that go back, away from the camera")
      .formerly("find_receding");
  table
      .flag("label_propagation", label_propagation, true,
            "lets what comes into view take over what its surface is known to do")
      .formerly("inherit");
  table
      .number("superpixel_share", superpixel_share, 0.3, 0, 1, "",
              "share of the log-odds by a superpixel's shift that counts in one frame")
      .formerly("patch_share");
  table.number("superpixel_px", superpixel_px, 10, 4, 100, "px", "side of a surface superpixel, in blocks")
      .formerly("segment_px");
  table.number("smoothing", smoothing, 0.6, 0, 100, "",
               "weight of neighbours on the same surface against a superpixel's own evidence");
  table.number("moving_log_odds", moving_log_odds, 0.35, 0.01, 10, "",
               "log-odds above which a superpixel moves");
  table.number("min_area_share", min_area_share, 0.0015, 0, 0.5, "",
               "share of the image below which a region is noise");
  table.number("margin_px", margin_px, 0, 0, 50, "px", "added about the mask at the end");
}

}  // namespace stillpoint
