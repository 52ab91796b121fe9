#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/chunked_list.hpp"
#include "core/geometry/se3.hpp"
#include "core/odometry/map_id.hpp"

namespace stillpoint {

enum class FrameStatus : std::uint8_t {
  initialised,  ///< the map began here
  tracked,      ///< the pose was estimated against the map
  relocalised,  ///< … for the first time after being lost
  lost,         ///< no pose could be estimated; the record's pose is a prediction
  unreadable,   ///< there was no image
};

[[nodiscard]] std::string_view to_string(FrameStatus status);

/// What became of a feature.
enum class FeatureFate : std::uint8_t {
  unmatched,  ///< kept, but no map point was found for it
  inlier,     ///< matched, and agrees with the pose
  outlier,    ///< matched, and does not
  removed,    ///< inside the motion mask
};

struct FeatureRecord {
  cv::Point2f pixel;         ///< px, in the image as it is
  float depth = 0.0F;        ///< m, 0 = none
  float residual_px = 0.0F;  ///< reprojection, final pose; 0 unmatched, NaN by engines that align brightness
  int map_point = kNone;     ///< id; kNone when unmatched or removed
  std::uint8_t octave = 0;
  FeatureFate fate = FeatureFate::unmatched;
  float static_weight = 1.0F;  ///< 0 to 1, of being static: its weight in the pose
};

/// A feature of less weight than this weighs little; its weight is shown then.
inline constexpr float kLowWeight = 0.5F;

/// How many inliers weigh little in the pose.
[[nodiscard]] int weighing_little(const std::vector<FeatureRecord>& features);

/// How the pose in a record was first come by.
enum class PoseStart : std::uint8_t { none, motion_model, wide_search, epnp, direct };

[[nodiscard]] std::string_view to_string(PoseStart start);

/// A patch that was aligned directly.
struct DirectPatch {
  cv::Point2f pixel;      ///< px, where the frame shows it as aligned
  float residual = 0.0F;  ///< grey levels, mean over its pixels at the finest level, signed
  float weight = 0.0F;    ///< 0 to 1
};

/// What direct alignment did in a frame whose corners starved.
struct DirectRecord {
  int reference_frame = kNone;  ///< the frame it was aligned with; kNone: it was not called for
  bool believed = false;        ///< it passed the checks: the pose, or the first one, goes by it
  int patches = 0;              ///< of the reference that lie in the frame's view
  int iterations = 0;           ///< Gauss-Newton steps over all levels
  double rms_before = 0.0,
         rms_after = 0.0;    ///< grey levels at the finest level, robust: as begun, as aligned
  double correlation = 0.0;  ///< of the patches' brightness with the frame's, -1 to 1
  double agreement = 0.0;    ///< share of patches at whose place the depth expected was measured, 0 to 1
  double share = 0.0;        ///< of the pose's information that is its own, 0 to 1: the rest is the corners'
  std::shared_ptr<const std::vector<DirectPatch>> seen;  ///< those in view; null where there are none
};

/// What each stage took, in milliseconds of wall time. For reading only: no result depends on it.
struct StageTimes {
  double motion = 0.0;    ///< finding what is dynamic, beside feature extraction where threads allow
  double features = 0.0;  ///< ORB
  double matching = 0.0;  ///< both searches against the map
  double pose = 0.0;      ///< EPnP, consensus and refinement
  double mapping = 0.0;   ///< keyframe, new points, fusion, culling
  double bundle = 0.0;    ///< bundle adjustment, solved and applied
  /// The whole frame. In a run of a whole sequence the next frame's features, and what needs no pose of its
  /// motion, are found while this one is tracked; of them total has what was waited for.
  double total = 0.0;
  // Parts of `pose`.
  double epnp = 0.0;       ///< EPnP in RANSAC
  double consensus = 0.0;  ///< the pose most of the image agrees on
  double refine = 0.0;     ///< eq. (5)
  double direct = 0.0;     ///< direct alignment
  /// Matching a stereo pair, which is reading, and no part of total; 0 for other frames.
  double stereo = 0.0;
};

/// A figure of the motion method, by its name in MethodInfo::figures.
struct MotionFigure {
  std::string name;
  double value = 0.0;
};

/// The frame's pose as it would have been with other features taken out (run.check_removal): solved from the
/// same map and the same prediction, by the same solver and with the same weights, so that what is removed is
/// the only difference. Nothing else depends on it.
struct RemovalCheck {
  std::optional<Pose> nothing_removed;  ///< world_from_camera; nothing where it was not or cannot be solved
  /// Standard deviation of that position in the direction least known, m; 0 where it is not told.
  double nothing_removed_sigma_m = 0.0;
  std::optional<Pose> truth_removed;  ///< … with the features that truly move taken out, where that is known
};

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

/// Everything a frame leaves behind but images: those can be computed again from the frames.
struct FrameRecord {
  int index = 0;
  double timestamp = 0.0;  ///< s
  FrameStatus status = FrameStatus::lost;
  std::string note;  ///< why it is lost, or what was wrong with its images; empty when all is well
  Pose world_from_camera = Pose::Identity();  ///< estimated, or predicted when lost
  bool estimated = false;                     ///< the pose was measured, not predicted
  RecordParts measured{};                     ///< what of all below is known; the rest has no value
  int reference_keyframe = kNone;             ///< the keyframe this frame shares most with
  Pose camera_from_reference = Pose::Identity();
  PoseStart pose_start = PoseStart::none;

  int features_found = 0, features_removed = 0, features_kept = 0;
  double mask_share = 0.0;   ///< of the frame's pixels, 0 to 1
  std::string mask_problem;  ///< why a mask that was to be given, true or outside, was not; empty otherwise
  int motion_rounds = 0;     ///< of an iterative motion method; 0 for others
  std::vector<MotionFigure> motion_figures;  ///< what method and engine measured (MethodInfo::figures, then
                                             ///< EngineInfo::figures)

  int matches = 0;      ///< features matched to map points
  int inliers = 0;      ///< … that agree with the pose
  double rms_px = 0.0;  ///< reprojection, inliers; NaN by an engine that measures brightness instead
  int refine_iterations = 0;
  /// Of a left perturbation of camera_from_world: m², rad², translation first, in camera coordinates; zero
  /// where no solver told it.
  Matrix6d pose_covariance = Matrix6d::Zero();

  bool keyframe = false;
  int new_points = 0, fused_points = 0, culled_points = 0, culled_keyframes = 0;
  int map_points = 0, map_keyframes = 0;  ///< after the frame
  double bundle_rms_before_px = 0.0,
         bundle_rms_px = 0.0;  ///< of the adjustment applied in this frame; 0 when none was
  int bundle_iterations = 0;

  std::optional<Pose> prior_pose;   ///< camera_from_world under which the motion method applied its prior
  std::optional<Pose> motion_pose;  ///< … and under which it then found it
  RemovalCheck removal_check;
  DirectRecord direct;
  StageTimes ms;
  std::vector<FeatureRecord> features;
};

/// "0.412 px"; a dash by an engine that measures no reprojection.
[[nodiscard]] std::string reprojection_text(const FrameRecord& record);

/// What there is to say of the frame: its note, and why a mask was missing.
[[nodiscard]] std::string remarks_on(const FrameRecord& record);

/// What everybody who goes over all of a run's frames asks of each: little enough to stay in memory where the
/// records are put by.
struct FrameOutline {
  double timestamp = 0.0;            ///< s
  std::array<double, 3> position{};  ///< m, of FrameRecord::world_from_camera
  int index = 0;
  FrameStatus status = FrameStatus::lost;
  bool estimated = false, keyframe = false;
  bool remarked = false;                 ///< remarks_on() the frame says something
  bool removal_checked = false;          ///< FrameRecord::removal_check holds a pose
  std::array<std::uint8_t, 7> unused{};  ///< so that no byte of what is put by was left unwritten
};
static_assert(sizeof(FrameOutline) == 48);
using FrameOutlines = ChunkedList<FrameOutline>;

[[nodiscard]] FrameOutline outline_of(const FrameRecord& record);

/// No pose could be estimated, or there was no image.
[[nodiscard]] constexpr bool is_lost(FrameStatus status) {
  return status == FrameStatus::lost || status == FrameStatus::unreadable;
}

/// The records of a run's frames, in order. Where they are put by, a walk over them reads all of them back:
/// what their outlines tell is asked of these.
class FrameRecords : public ChunkedList<FrameRecord> {
 public:
  FrameRecords() = default;
  /// Put by. @param outlines null where these stay in memory
  FrameRecords(std::shared_ptr<ChunkKeeper<FrameRecord>> records,
               std::shared_ptr<ChunkKeeper<FrameOutline>> outlines)
      : ChunkedList(std::move(records)), outlines_(std::move(outlines)) {}
  FrameRecords(std::vector<FrameRecord> all) {  // NOLINT(google-explicit-constructor)
    for (FrameRecord& one : all) push_back(std::move(one));
  }

  void push_back(FrameRecord one);
  [[nodiscard]] FrameRecords first(std::size_t count) const;
  void resize(std::size_t count);
  /// Changes one, as `change(record)` does.
  template <typename Change>
  void change(std::size_t i, const Change& change) {
    FrameRecord& record = ChunkedList::edit(i);
    change(record);
    outlines_.edit(i) = outline_of(record);
  }

  /// One a record.
  [[nodiscard]] const FrameOutlines& outlines() const { return outlines_; }

  [[nodiscard]] std::size_t held_bytes() const {
    return ChunkedList::held_bytes() + outlines_.held_bytes() - sizeof(outlines_);
  }

 private:
  using ChunkedList::edit;  // by change() alone, which sees to the outline

  FrameOutlines outlines_;
};

}  // namespace stillpoint
