#pragma once

#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/motion_stage.hpp"
#include "core/odometry/bundle_adjustment.hpp"
#include "core/odometry/direct_alignment.hpp"
#include "core/odometry/frame_preparer.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/hindsight.hpp"
#include "core/odometry/local_map.hpp"
#include "core/odometry/matching.hpp"
#include "core/odometry/pose_solver.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// What a frame gives: the record that is kept, and the motion stage's images, which can be computed again.
struct FrameResult {
  FrameRecord record;
  MotionResult motion;  ///< the method's judgement, as far as it came to one
  cv::Mat mask;         ///< what was removed, CV_8UC1, 255 = dynamic; empty when nothing was
};

/// RGB-D visual odometry against a local map (METHOD.md §2), with the features that config.run.method finds
/// moving taken out first. Frames go in, in order; poses come out. World coordinates are the first tracked
/// frame's camera.
///
/// A value: a copy goes on from where the original stood, and gives the same bytes from the same frames.
class Odometry {
 public:
  Odometry(const Camera& camera, const Config& config);

  /// Takes the next frame. Nothing about the frame makes it throw: what cannot be tracked is marked lost.
  /// @param known_mask what truly moves, CV_8UC1; empty where it is not known. Method `oracle` alone goes by
  /// it; to the others it serves for RemovalCheck.
  [[nodiscard]] FrameResult process(const Frame& frame, const cv::Mat& known_mask = {});

  /// The same of a frame that a FramePreparer of the same camera and config prepared, frame by frame in
  /// order.
  [[nodiscard]] FrameResult process_prepared(const Frame& frame, PreparedFrame prepared,
                                             const cv::Mat& known_mask = {});

  /// The same map and the same place, but the next frames are processed with another config. What the new
  /// method needs of earlier frames is made from `before`, the last frames_wanted(config) of them, newest
  /// last. With an equal config it goes on bit for bit as it would have.
  /// @returns nothing where the map's features would not fit the new ones (another features.levels or
  /// features.scale_factor)
  [[nodiscard]] std::optional<Odometry> continued_with(const Config& config,
                                                       const std::vector<PastFrame>& before) const;

  /// How many earlier frames continued_with() needs; 0 where it has all that the new config asks for.
  [[nodiscard]] int frames_wanted(const Config& config) const;

  /// Lets go of images kept of earlier frames: what a copy that is put by need not carry.
  void drop_images();
  /// Has them again, as they were, before it goes on. @param next index of the frame it processes next
  void restore_images(int next, const std::function<Frame(int)>& read);

  /// Lets a pending bundle adjustment enter the map and looks back at the last poses: after the last frame.
  void finish();

  [[nodiscard]] const LocalMap& map() const { return map_; }
  /// By frame index: the poses of earlier frames that were solved once more, by the map as it was later.
  [[nodiscard]] const std::map<int, HangingPose>& revised_poses() const { return hindsight_.revised(); }
  [[nodiscard]] const Config& config() const { return config_; }
  /// The motion method's state, as the next frame will find it.
  [[nodiscard]] const MotionStage& motion() const { return motion_; }

 private:
  /// The frame being tracked.
  struct Current {
    std::shared_ptr<const FeatureSet> features;  // static ones
    std::vector<int> points;                     // map point a feature, inliers of the pose only
    Pose camera_from_world = Pose::Identity();
    Pose start = Pose::Identity();       // camera_from_world, as tracking began
    std::vector<FeatureRecord> records;  // of all features, removed ones too
    std::vector<int> record_of;          // feature -> index into records
    cv::Mat mask;                        // what was removed; empty when nothing was
    bool seek_consensus =
        false;                  // movers may be among the features: least squares alone is not to be trusted
    std::uint32_t seed = 0;     // of the samples consensus is sought with
    bool agreed = false;        // camera_from_world is a consensus of most matches
    bool start_agreed = false;  // the start is a consensus: what is far from it is not to draw the pose away
    std::vector<int> points_in_view, points_found;  // map points that should be seen, and those that were
  };
  /// The frame before, as the next one needs it.
  struct Last {
    std::shared_ptr<const FeatureSet> features;
    std::vector<int> points;
    int reference_keyframe = kNone;
    Pose camera_from_reference = Pose::Identity();
  };
  /// Where patches say the camera stands, and how well they know (DirectAlignment::information).
  struct DirectPose {
    Pose camera_from_world = Pose::Identity();
    Matrix6d information = Matrix6d::Zero();
  };
  struct PendingBundle {
    std::shared_future<BundleSolution> solution;
    int keyframe = kNone;
    int due = 0;  // frame index at which it enters the map
  };

  void apply_due_bundle(FrameRecord& record, bool now);
  [[nodiscard]] FrameResult run_frame(const Frame& frame, PreparedFrame& prepared, const cv::Mat& known_mask);
  void judge(const MotionInput& input, FrameResult& result) const;
  [[nodiscard]] cv::Mat prior_mask(const MotionInput& input, FrameRecord& record) const;
  [[nodiscard]] std::vector<MotionFeature> motion_features(const PreparedFrame& prepared,
                                                           const Current& first) const;
  [[nodiscard]] Current remove_moving(const Frame& frame, const PreparedFrame& prepared, const cv::Mat& mask,
                                      const Vector6d& velocity, FrameRecord& record,
                                      const MotionResult& motion = {}) const;
  [[nodiscard]] Current track_frame(MotionInput input, const PreparedFrame& prepared, FrameResult& result);
  void purge_moving_points(const Frame& frame, const cv::Mat& mask, const Pose& camera_from_world);
  [[nodiscard]] Current initialise(const Frame& frame, const PreparedFrame& prepared, FrameResult& result);
  /// @returns why there is no pose; empty when there is one
  [[nodiscard]] std::string track(const Frame& frame, Current& current, FrameRecord& record);
  [[nodiscard]] bool leaves_too_little(const Current& current) const;
  [[nodiscard]] bool estimate(Current& current, FrameRecord& record) const;
  [[nodiscard]] bool estimate_from_last(Current& current, FrameRecord& record) const;
  [[nodiscard]] bool estimate_by_epnp(Current& current, FrameRecord& record) const;
  [[nodiscard]] std::vector<PoseObservation> observations_of(const Current& current,
                                                             const std::vector<Match>& matches) const;
  [[nodiscard]] PoseRefinement refine(const Current& current, const std::vector<Match>& matches,
                                      double start_looseness, FrameRecord& record) const;
  [[nodiscard]] PoseRefinement track_local_map(Current& current, FrameRecord& record) const;
  void count_sightings(const Current& current);
  [[nodiscard]] bool aligns_directly() const;
  [[nodiscard]] bool starves(int inliers) const;
  [[nodiscard]] std::optional<DirectPose> align(const Frame& frame, const Current& current,
                                                FrameRecord& record) const;
  [[nodiscard]] bool begins_starved(const Current& current);
  [[nodiscard]] double noise_of_corners(const Current& current, const Pose& camera_from_world) const;
  [[nodiscard]] bool begin_directly(const Frame& frame, Current& current, FrameRecord& record) const;
  [[nodiscard]] PoseRefinement search_again(Current& current, const Pose& camera_from_world,
                                            FrameRecord& record) const;
  [[nodiscard]] bool refine_directly(const Frame& frame, Current& current, PoseRefinement& refined,
                                     FrameRecord& record) const;
  void remember_reference(const Frame& frame, const FrameResult& result);
  [[nodiscard]] RemovalCheck check_removal(const Frame& frame, const PreparedFrame& prepared,
                                           const cv::Mat& known_mask) const;
  [[nodiscard]] std::optional<Pose> solve_with_mask(const Frame& frame, const PreparedFrame& prepared,
                                                    const cv::Mat& mask) const;
  [[nodiscard]] bool is_taken_at_once(const Frame& frame) const;
  [[nodiscard]] int inliers_needed() const;
  /// Points of the keyframes about those that see the matched ones; without any, about where the camera was.
  [[nodiscard]] std::vector<int> local_points(const std::vector<int>& matched = {}) const;
  [[nodiscard]] bool wants_keyframe(const Frame& frame, const Current& current,
                                    const FrameRecord& record) const;
  [[nodiscard]] bool is_starved_keyframe(const Frame& frame, const Current& current) const;
  void add_keyframe(const Frame& frame, Current& current, FrameRecord& record);
  [[nodiscard]] bool looks_back() const;
  void remember_sights(const Current& current, const FrameRecord& record);
  void look_back(int last);
  void remember(const Current& current, FrameRecord& record);
  void remember_pose(const Current& current, FrameRecord& record);
  void mark_lost(FrameRecord& record, FrameStatus status, const std::string& why);
  [[nodiscard]] double depth_lag(
      const Frame& frame) const;  // s, of depth after colour, as far as it is to be corrected
  [[nodiscard]] double elapsed() const;
  [[nodiscard]] Pose predicted_camera_from_world() const;
  [[nodiscard]] Pose last_camera_from_world() const;

  Camera camera_;
  Config config_;
  FramePreparer preparer_;
  MotionStage motion_;  // what is classified as dynamic
  std::vector<double> scales_;
  LocalMap map_;
  std::optional<Last> last_;  // empty until the map has begun
  Vector6d velocity_ =
      Vector6d::Zero();          // of the camera, a second: log(current_from_last) over the time between
  double last_timestamp_ = 0.0;  // s, of the frame last_ stands for
  double now_ = 0.0;             // s, of the frame at hand
  int lost_frames_ = 0;          // in a row
  int last_keyframe_frame_ = 0;  // frame index of the newest keyframe
  std::optional<PendingBundle> pending_;
  std::optional<DirectReference> last_reference_;   // the newest frame with a pose and depth
  std::optional<DirectReference> sharp_reference_;  // … that had corners enough
  double usual_first_inliers_ = 0.0;                // of first poses, lately
  double usual_inliers_ = 0.0;                      // of whole frames, lately
  static constexpr double kUsualFades = 0.98;       // a frame, of how many are usual
  int starved_frames_ = 0;                          // in a row
  Hindsight hindsight_;                             // of frames lately tracked
};

}  // namespace stillpoint
