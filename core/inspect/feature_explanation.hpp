#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/odometry/frame_record.hpp"

namespace stillpoint {

struct Camera;
struct FrameView;
struct RunView;
struct SavedPoint;

// Why a feature was removed, or was not: what its frame's stages say of it, and where it came from. Plain
// data from plain data, without GL or ImGui.

/// By what a feature was found again in the frame before.
enum class TrailLink {
  kItself,    ///< the feature asked about
  kMapPoint,  ///< the same map point
  kFlow,      ///< the optical flow beside it leads there
  kNearby,    ///< the nearest of its scale and depth to where its last step leads
};

/// A feature in one of the last frames.
struct TrailPoint {
  int frame = 0;
  FeatureRecord feature;
  TrailLink link = TrailLink::kItself;
};

/// A figure against the limit that decided.
struct Margin {
  std::string name;    ///< "Forward difference"
  double value = 0.0;  ///< above `limit` it speaks for moving
  double limit = 0.0;  ///< same unit
  std::string unit;    ///< "grey levels", "σ", "log-odds"
  [[nodiscard]] double margin() const { return value - limit; }
};

/// All that is known about one feature of the frame shown.
struct FeatureExplanation {
  int index = 0;  ///< among the record's features
  FeatureRecord feature;
  RecordParts measured{};              ///< what is known of the frame that it is of
  std::string verdict;                 ///< one sentence: what became of it and why
  std::vector<std::string> because;    ///< further sentences, the method's own
  std::vector<Margin> margins;         ///< at its pixel
  std::optional<int> region;           ///< from 1, of the mask that removed it
  std::optional<double> mask_edge_px;  ///< to the removing mask's edge: above 0 inside it, below 0 outside
  std::vector<TrailPoint> trail;    ///< itself first, then frame by frame back, as far as it was found again
  std::optional<int> observations;  ///< keyframes that see its map point
  std::optional<Eigen::Vector3d> in_camera, in_world;  ///< m
  std::optional<Eigen::Vector2d> if_static;  ///< px: where this frame would show it, had it stood still
  std::string static_by;                     ///< what `if_static` was told by

  /// px between where it is and where it would be if static.
  [[nodiscard]] std::optional<double> own_motion_px() const;
};

/// @param view a frame of `run` with a record; `index` is one of its record's features
/// @param map_points of the run, for where its map point lies
[[nodiscard]] FeatureExplanation explain_feature(const FrameView& view, const RunView& run,
                                                 const Camera& camera,
                                                 const std::vector<SavedPoint>& map_points, int index);

/// px from a pixel to the edge of a mask: above 0 inside it, below 0 outside, up to `reach`; nothing when
/// there is no edge within reach.
[[nodiscard]] std::optional<double> distance_to_edge(const cv::Mat& mask, const cv::Point2f& pixel,
                                                     int reach = 80);

}  // namespace stillpoint
