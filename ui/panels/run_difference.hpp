#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace stillpoint {

struct GhostView;
struct MeasuredFrames;
struct SessionView;

// How two runs differ in one frame. No ImGui.

/// A figure of a frame in both runs.
struct FigurePair {
  std::string name, run, ghost;  ///< values with their units; "–" for none
  bool differs = false;
};

/// A frame of the run against the same frame of a ghost.
struct FrameDifference {
  double translation_m = 0.0, rotation_deg = 0.0;  ///< of run_camera_from_ghost_camera; both worlds are one
  std::vector<FigurePair> figures;
};

/// Every figure people are shown that either run knows of the frame, times apart.
[[nodiscard]] FrameDifference difference_of(const MeasuredFrames& run, std::size_t row,
                                            const MeasuredFrames& ghost, std::size_t ghost_row);

/// Whether run and ghost have no world in common: one of them is another program's.
[[nodiscard]] bool in_worlds_of_their_own(const SessionView& session, const GhostView& ghost);

/// How far apart both poses are, in a sentence.
/// @param other the run of another program, if `apart`: its world is another, and no pose is told from here
[[nodiscard]] std::string pose_text(const FrameDifference& difference, const std::string& other, bool apart);

/// How two masks of one size share the image. A mask that is empty removes nothing.
struct MaskOverlap {
  int both = 0, only_run = 0, only_ghost = 0;  ///< px
  /// Shared part of all that either holds; nothing where neither holds anything.
  [[nodiscard]] std::optional<double> iou() const;
};
[[nodiscard]] MaskOverlap overlap_of(const cv::Mat& run, const cv::Mat& ghost);

}  // namespace stillpoint
