#include "ui/panels/scene_of_session.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/saved_map.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/run_difference.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"

namespace stillpoint {
namespace {

constexpr std::size_t kMostErrorLines = 400;  // lines: more cover each other
constexpr double kMostRoom = 0.5;             // … but no more than so many times the extent of the paths
constexpr double kLeastSight = 0.1;           // m, along each axis
constexpr double kRoomShare = 0.3;            // of the way from the paths out to the map points
constexpr double kTruthBreak = 0.5;           // s without ground truth that breaks its line

Eigen::Vector3f broken() { return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()); }

/// The part of the ground truth the run has come by.
ScenePath truth_path(const SessionView& session) {
  ScenePath path{.name = "ground truth", .role = Role::kGroundTruth, .width_px = 2.0F};
  const FrameOutlines& frames = session.run->records.outlines();
  if (frames.empty()) return path;
  const double from = frames.front().timestamp, to = frames.back().timestamp;
  double before = -1.0;
  for (const StampedPose& pose : *session.ground_truth) {
    if (pose.timestamp < from - 0.05 || pose.timestamp > to + 0.05) continue;
    if (before >= 0.0 && pose.timestamp - before > kTruthBreak) path.positions.push_back(broken());
    path.positions.push_back(pose.world_from_camera.translation().cast<float>());
    before = pose.timestamp;
  }
  return path;
}

/// A run's estimated poses, each a frame of its records; lost frames break the line.
void add_run(const SessionView& session, const RunView& run, const Pose& world_from_estimate, ScenePath path,
             SessionScene& scene) {
  std::vector<PathFrame> frames;
  const double start = series_start(session);
  std::size_t error = 0;
  const auto& errors = run.evaluation.ate.errors;
  std::optional<PathFrame> before;
  for (const FrameOutline& one : run.records.outlines()) {
    if (!one.estimated) continue;
    if (before && one.index != before->index + 1) {
      path.positions.push_back(broken());
      frames.push_back(*before);
    }
    before = PathFrame{one.index, one.timestamp - start, {}};
    const Eigen::Vector3d position(one.position.data());
    path.positions.push_back((world_from_estimate * position).cast<float>());
    PathFrame frame = *before;
    while (error < errors.size() && errors[error].timestamp < one.timestamp - 1e-6) ++error;
    if (error < errors.size() && std::abs(errors[error].timestamp - one.timestamp) < 1e-6)
      frame.error_m = errors[error].translation_m;
    frames.push_back(frame);
  }
  scene.data.paths.push_back(std::move(path));
  scene.frames_of_path.push_back(std::move(frames));
}

/// Another program's world over the one shown: by the truth, or where there is none by the session's own run.
Pose world_of_outside(const SessionView& session, const RunView& run, const Pose& world_from_estimate) {
  if (!session.run->evaluation.matched.empty()) return run.evaluation.ate.alignment.truth_from_estimate;
  const auto matched = match_trajectories(session.run->trajectory, run.trajectory);
  return world_from_estimate * absolute_error(matched).alignment.truth_from_estimate;
}

/// Ghosts lie in the run's own world, by its alignment: up to where one parts both ways are the same. Where
/// either is another program's, each has its own.
void add_ghosts(const SessionView& session, const Pose& world_from_estimate, SessionScene& scene) {
  for (std::size_t i = 0; i < session.debug.ghosts.size(); ++i) {
    const GhostView& ghost = session.debug.ghosts[i];
    // In either theme the looks differ in colour alone, and dashes are all that is wanted here.
    const Pose world = in_worlds_of_their_own(session, ghost)
                           ? world_of_outside(session, *ghost.run, world_from_estimate)
                           : world_from_estimate;
    add_run(session, *ghost.run, world,
            {.name = "ghost: " + shortened(ghost.name),
             .width_px = 2.2F,
             .pickable = true,
             .named_elsewhere = true},
            scene);
    ScenePath& path = scene.data.paths.back();
    SceneData alone;
    alone.paths.push_back(path);
    const SceneBounds box = bounds(alone);
    path.dash_m = ghost_look(session.debug.ghosts, i, ThemeName::kDark).dash * (box.high - box.low).norm();
    scene.ghost_paths.push_back(scene.data.paths.size() - 1);
  }
}

void add_errors(const TrajectoryEvaluation& evaluation, const Pose& world_from_estimate, SceneData& data) {
  const std::size_t step = 1 + evaluation.matched.size() / kMostErrorLines;
  std::vector<float> sizes;
  for (std::size_t i = 0; i < evaluation.matched.size(); i += step) {
    const MatchedPose& pair = evaluation.matched[i];
    const Eigen::Vector3d estimate = world_from_estimate * pair.estimate.translation();
    const auto size = static_cast<float>((estimate - pair.truth.translation()).norm());
    data.errors.push_back({pair.truth.translation().cast<float>(), estimate.cast<float>(), size});
    sizes.push_back(size);
  }
  if (sizes.empty()) return;
  const float most = *std::max_element(sizes.begin(), sizes.end());
  // The scale ends at a round number: 1, 2 or 5 times a power of ten.
  float round = 0.001F;
  for (const float factor : {2.0F, 2.5F, 2.0F, 2.0F, 2.5F, 2.0F, 2.0F, 2.5F, 2.0F, 2.0F, 2.5F, 2.0F}) {
    if (round >= most) break;
    round *= factor;
  }
  data.error_scale_m = round;
}

/// Where the frame's position may lie, by its covariance: the three ellipses through the axes of its
/// ellipsoid.
void add_uncertainty(const FrameRecord& record, const Pose& world_from_camera, SceneData& data) {
  constexpr int kSteps = 48;        // corners of an ellipse: it looks round
  constexpr double kSigmas = 20.0;  // one would be thinner than a line: a millimetre, in a room
  const Eigen::Matrix3d covariance = record.pose_covariance.topLeftCorner<3, 3>();
  if (covariance.isZero(0.0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const Eigen::Matrix3d world_axes = world_from_camera.linear() * axes.eigenvectors() *
                                     axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * kSigmas;
  ScenePath path{.name = "position, 20 σ", .role = Role::kCursor, .width_px = 1.4F};
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 2)}) {
    for (int i = 0; i <= kSteps; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSteps;
      path.positions.push_back((world_from_camera.translation() + std::cos(angle) * world_axes.col(a) +
                                std::sin(angle) * world_axes.col(b))
                                   .cast<float>());
    }
    path.positions.push_back(broken());
  }
  data.paths.push_back(std::move(path));
}

/// The features the current frame's mask removed, where depth says they are.
void add_removed(const SessionView& session, const Pose& world_from_camera, SceneData& data) {
  for (const FeatureRecord& feature : session.current->record->features) {
    if (feature.fate != FeatureFate::removed || feature.depth <= 0.0F) continue;
    const Eigen::Vector3d point = session.camera.back_project(
        {static_cast<double>(feature.pixel.x), static_cast<double>(feature.pixel.y)},
        static_cast<double>(feature.depth));
    data.points.push_back({(world_from_camera * point).cast<float>(), true});
  }
}

}  // namespace

SceneBounds sight_of(const SceneData& data) {
  SceneBounds box = bounds(data);
  // A camera that is static trembles by millimetres, which are not to fill the view.
  const Eigen::Vector3d middle = 0.5 * (box.low + box.high);
  box.low = box.low.cwiseMin(middle - Eigen::Vector3d::Constant(0.5 * kLeastSight));
  box.high = box.high.cwiseMax(middle + Eigen::Vector3d::Constant(0.5 * kLeastSight));
  if (data.points.size() < 20) return box;
  const double most = kMostRoom * std::max((box.high - box.low).norm(), 0.05);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const ScenePoint& point : data.points) along.push_back(static_cast<double>(point.position[axis]));
    std::sort(along.begin(), along.end());
    const double low = along[along.size() / 10], high = along[along.size() - 1 - along.size() / 10];
    box.low[axis] += std::max(-most, kRoomShare * std::min(0.0, low - box.low[axis]));
    box.high[axis] += std::min(most, kRoomShare * std::max(0.0, high - box.high[axis]));
  }
  return box;
}

SessionScene scene_of_session(const SessionView& session, const SceneLayers& layers) {
  SessionScene scene;
  SceneData& data = scene.data;
  const RunView& run = *session.run;
  const bool aligned = !run.evaluation.matched.empty();
  const Pose world = aligned ? session.alignment.truth_from_estimate : Pose::Identity();
  data.up = aligned ? Eigen::Vector3d(0.0, 0.0, 1.0) : Eigen::Vector3d(0.0, -1.0, 0.0);
  if (aligned) {
    data.paths.push_back(truth_path(session));
    scene.frames_of_path.emplace_back();
  }
  if (session.baseline && (!aligned || !session.baseline->evaluation.matched.empty())) {
    const Pose other =
        aligned ? session.baseline->evaluation.ate.alignment.truth_from_estimate : Pose::Identity();
    add_run(session, *session.baseline, other,
            {.name = baseline_name(session), .role = Role::kBaseline, .width_px = 1.6F, .pickable = true},
            scene);
  }
  add_ghosts(session, world, scene);
  add_run(session, run, world,
          {.name = "estimate: " + run.name, .role = Role::kEstimate, .width_px = 3.0F, .pickable = true},
          scene);
  if (layers.errors && aligned) add_errors(run.evaluation, world, data);
  if (layers.keyframes)
    for (const SavedKeyframe& keyframe : *session.keyframes)
      data.keyframes.push_back(world * keyframe.pose.world_from_camera);
  if (layers.points)
    for (const SavedPoint& point : *session.map_points)
      data.points.push_back({(world * point.position).cast<float>(), point.moved});
  const FrameRecord* record = session.current->record;
  if (record != nullptr && record->estimated) {
    data.current = world * record->world_from_camera;
    add_uncertainty(*record, *data.current, data);
    scene.frames_of_path.resize(data.paths.size());
    data.current_image = picture_of(session.current->frame);
    if (layers.points) add_removed(session, *data.current, data);
  }
  data.frustum.half_width = static_cast<float>(0.5 * session.camera.width / session.camera.fx);
  data.frustum.half_height = static_cast<float>(0.5 * session.camera.height / session.camera.fy);
  // Cameras are drawn in proportion to the way they went, so that neither hides the other.
  const SceneBounds box = bounds(data);
  const double extent = (box.high - box.low).norm();
  data.frustum.current_depth_m = static_cast<float>(std::clamp(0.2 * extent, 0.05, 0.6));
  data.frustum.keyframe_depth_m = 0.3F * data.frustum.current_depth_m;
  data.ground_m = aligned ? 0.0 : -1.0;
  return scene;
}

}  // namespace stillpoint
