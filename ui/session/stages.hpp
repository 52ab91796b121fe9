#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ui/session/session_view.hpp"

namespace stillpoint {

// A frame's way through its method, stage by stage: plain data made of a FrameView, without GL or ImGui.

enum class StageKind {
  // The paper's, §1.
  kTracks,
  kHomography,
  kCompensation,
  kDifference,
  kThreshold,
  kCleanUp,
  kUnion,
  kTrackRemoval,
  // Method `stillpoint`'s.
  kSmallView,
  kFirstPose,
  kWarp,
  kDepthResidual,
  kBrightnessResidual,
  kEvidence,
  kPatchShifts,
  kMemory,
  kSegments,
  kMotionMask,
  // … of frames without depth.
  kFollowedPoints,
  kCameraTurn,
  kUnexplained,
  kPointEvidence,
  kSpread,
  kColourMask,
  // Method `oracle`'s.
  kTrueMask,
  // The odometry's, §2, which all methods share.
  kFeatures,
  kFeatureRemoval,
  kMatching,
  kInitialPose,
  kRefinement,
  kDirectRefinement,
  kMapping,
  kBundle,
};

/// Whether it belongs to what all methods share.
[[nodiscard]] constexpr bool of_odometry(StageKind kind) { return kind >= StageKind::kFeatures; }

/// Whether it belongs to method `stillpoint`'s way with frames without depth.
[[nodiscard]] constexpr bool of_colour(StageKind kind) {
  return kind >= StageKind::kFollowedPoints && kind <= StageKind::kColourMask;
}

/// A number a stage ends with.
struct StageFigure {
  std::string name;
  double value = 0.0;
  std::string unit;                                  ///< "px", "%", "" for counts
  int digits = 0;                                    ///< after the point
  std::optional<double> round_before, frame_before;  ///< the same figure there
};

struct StageInfo {
  StageKind kind = StageKind::kTracks;
  int round = -1;      ///< from 0; below 0 where the stage has no rounds
  int reference = -1;  ///< from 0: which of method `stillpoint`'s earlier frames; below 0 where it has none
  std::string name;    ///< "Threshold"
  std::string group;   ///< "Round 2", "Odometry": what it stands under in a list
  std::string what;    ///< one sentence: what it does, with the paper's equation
  double ms = 0.0;     ///< of wall time; 0 where times are not kept
  bool timed = true;   ///< false: it has no time of its own
  bool two_ways = false;  ///< it has a forward and a backward side
  std::vector<StageFigure> figures;
  std::string note;  ///< why it has nothing to show, or what is odd about it; empty when all is well

  /// Whether two stages are the same one of different frames.
  [[nodiscard]] bool same_place(const StageInfo& other) const {
    return kind == other.kind && round == other.round && reference == other.reference;
  }
};

/// The stages the frame went through by its method, in order, with figures held against the round before, and
/// against FrameView::before where there is one.
[[nodiscard]] std::vector<StageInfo> stages_of(const FrameView& view, const Config& config);

/// "12.3 px"
[[nodiscard]] std::string figure_text(const StageFigure& figure);
/// "+3.1 px" against an earlier value; "±0" where nothing changed.
[[nodiscard]] std::string change_text(const StageFigure& figure, double before);

/// The index of the stage that is the same as `wanted`, or of the nearest of its kind, or 0.
[[nodiscard]] std::size_t find_stage(const std::vector<StageInfo>& stages, const StageInfo& wanted);

/// For making stages: adds one to a list and gives it back.
StageInfo& add_stage(std::vector<StageInfo>& stages, StageKind kind, std::string group, std::string name,
                     std::string what);
void add_figure(StageInfo& stage, std::string name, double value, std::string unit = "", int digits = 0);

/// The motion stages of each method.
void add_paper_stages(const FrameView& view, std::vector<StageInfo>& stages);
void add_stillpoint_stages(const FrameView& view, const Config& config, std::vector<StageInfo>& stages);
/// … of a frame without depth.
void add_colour_stages(const FrameView& view, const Config& config, std::vector<StageInfo>& stages);

}  // namespace stillpoint
