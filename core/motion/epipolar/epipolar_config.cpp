#include "core/motion/epipolar/epipolar_config.hpp"

namespace stillpoint {

void EpipolarConfig::list(ParameterTable& table) {
  table.number("cell_px", cell_px, 8, 4, 64, "small px", "a cell of this side holds one followed point");
  table.number("flow_window_px", flow_window_px, 9, 5, 51, "small px", "side of the Lucas-Kanade window");
  table.number("corner_response", corner_response, 1e-4, 1e-6, 1, "",
               "least eigenvalue of the gradient matrix that makes a point");
  table.number("near_reference", near_reference, 3, 1, 30, "frames",
               "how far back the nearest of three references lies");
  table.number("far_reference", far_reference, 12, 1, 60, "frames",
               "how far back the farthest reference lies");
  table.number("sigmas", sigmas, 1.5, 0.5, 20, "sigma", "residual at which evidence changes sign");
  table
      .number("evidence_per_sigma", evidence_per_sigma, 0.4, 0.01, 10, "",
              "evidence for every standard deviation beyond that")
      .formerly("evidence_a_sigma");
  table
      .number("prior_share", prior_share, 0.92, 0, 1, "",
              "share of a point's evidence carried to the next frame")
      .formerly("memory");
  table.number("max_evidence", max_evidence, 3.0, 0.5, 100, "", "where evidence saturates");
  table.number("max_static_evidence", max_static_evidence, 0.5, 0, 100, "",
               "where evidence of being static saturates");
  table.number("close_px", close_px, 8, 0, 50, "quarter px", "gaps in the mask up to twice this are closed");
  table.number("shave_px", shave_px, 3, 0, 20, "quarter px",
               "so far within its outline the mask goes with its colours");
  table.number("min_age", min_age, 2, 1, 60, "frames", "so long a point is followed before it has a say");
  table.number("same_motion_px", same_motion_px, 0.5, 0.05, 20, "small px",
               "difference of two points' paths that sets them apart");
  table
      .number("smoothing", smoothing, 2.0, 0, 100, "",
              "weight of a neighbour that moves alike against a point's own evidence")
      .formerly("sharing");
  table
      .number("colour_cost", colour_cost, 0.15, 0, 10, "quarter px",
              "what a grey level of change costs evidence on its way")
      .formerly("colour_price");
  table
      .number("max_geodesic_distance", max_geodesic_distance, 8.0, 1, 1000, "quarter px",
              "way over which evidence ends")
      .formerly("longest_way");
  table.number("moving_evidence", moving_evidence, 0.3, 0.01, 10, "", "evidence above which a pixel moves");
  table.number("min_area_share", min_area_share, 0.008, 0, 0.5, "",
               "share of the image below which a region is noise");
  table.number("min_points", min_points, 8, 1, 1000, "points", "a region with fewer moving points is noise");
}

}  // namespace stillpoint
