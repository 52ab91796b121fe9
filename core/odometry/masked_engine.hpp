#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/odometry/camera_path.hpp"
#include "core/odometry/odometry_engine.hpp"
#include "core/odometry/rectifier.hpp"

namespace stillpoint {

/// What a tracker makes of a frame's images, once however often it is tracked: its own type.
struct TrackerPreparation {
  virtual ~TrackerPreparation() = default;
};

/// A frame as a FrameTracker gets it: rectified, and with what the motion method says of its pixels.
struct TrackerFrame {
  const Frame& image;
  cv::Mat gray;    ///< CV_8UC1, as a pinhole would see it
  cv::Mat depth;   ///< CV_32FC1, m, 0 = none; empty where the frame has none
  cv::Mat weight;  ///< CV_32FC1: 0 = removed or not seen by the camera, to 1; empty: all count whole
  /// Of map points that the method judged one by one; those not in it count whole.
  std::unordered_map<int, float> point_weight{};
  bool cull_dynamic = false;  ///< map points on what the method removes are to leave the map
  std::optional<double>
      depth_lag{};  ///< s, from the frame's time to depth's stamp; nothing: not to be corrected
  Vector6d velocity = Vector6d::Zero();  ///< of the camera, a second, as far as known before the frame
  std::function<Vector6d(const Pose&)> velocity_to{};  ///< … as it is when the frame was taken from a pose
  double stereo_per_m2 = 0.0;                          ///< 1/m: Camera::depth_sigma_per_m2
  bool start_estimated = false;  ///< the pose it is tracked from was estimated from this very frame
  int threads = 1;               ///< any number gives the same bytes
  std::shared_ptr<const TrackerPreparation> prepared{};  ///< what prepare() made of its images

  [[nodiscard]] float weight_at(int x, int y) const { return weight.empty() ? 1.0F : weight.at<float>(y, x); }
  /// Whether a point that lies at a depth in this frame is of what the method removes there: on it, or before
  /// it, where nothing is now. @param pixel rectified
  [[nodiscard]] bool is_dynamic(const Eigen::Vector2d& pixel, double z) const;
};

/// Where a tracker found a frame to be.
struct TrackerResult {
  std::string why_lost;  ///< empty when there is a pose
  Pose camera_from_world = Pose::Identity();
  std::optional<Pose> held{};  ///< lost: where the camera is taken to stand; nothing: where it was predicted
  int matches = 0, inliers = 0, iterations = 0;  ///< as in FrameRecord
  double rms_px = 0.0;                           ///< as in FrameRecord
  PoseStart start = PoseStart::motion_model;
  std::vector<FeatureRecord> features{};  ///< what it looked at, in the camera's own pixels
  std::vector<double> figures{};          ///< one for each of EngineInfo::figures; empty where there are none
  std::shared_ptr<EngineTrace> trace{};   ///< keep() may add to it
  [[nodiscard]] bool found() const { return why_lost.empty(); }
};

/// What tells one engine behind a MaskedEngine from another. A value behind a pointer: a clone goes on as the
/// original would, with the same bytes.
class FrameTracker {
 public:
  virtual ~FrameTracker() = default;
  [[nodiscard]] virtual std::unique_ptr<FrameTracker> clone() const = 0;

  /// What is had of a frame's images whatever its mask. @param gray, depth as in TrackerFrame
  [[nodiscard]] virtual std::shared_ptr<const TrackerPreparation> prepare(const cv::Mat& gray,
                                                                          const cv::Mat& depth) const = 0;

  /// The world begins at this frame, at the identity, with a keyframe of map(); or why it cannot, in
  /// why_lost.
  [[nodiscard]] virtual TrackerResult begin(const TrackerFrame& frame, FrameRecord& record) = 0;

  /// Finds a frame's pose from a predicted one, and changes nothing: a frame may be tracked several times,
  /// with other pixels taken out.
  [[nodiscard]] virtual TrackerResult track(const TrackerFrame& frame, const Pose& predicted) const = 0;

  /// Takes a tracked frame into its state and map; may move its pose.
  virtual void keep(const TrackerFrame& frame, TrackerResult& result, FrameRecord& record) = 0;
  /// Takes note that a frame was lost.
  virtual void lose(const TrackerFrame& frame, const TrackerResult& result) { (void)frame, (void)result; }

  [[nodiscard]] virtual const LocalMap& map() const = 0;

  /// Goes on with other constants. @returns whether its state serves them
  [[nodiscard]] virtual bool adopt(const Config& config) = 0;
};

/// An odometry engine behind any motion method: what engines that bring their own tracking share. It has
/// frames judged, before or under a first pose, hands the tracker what is left of them, keeps the camera's
/// path, and says of each frame what FeatureOdometry says of it.
class MaskedEngine final : public OdometryEngine {
 public:
  MaskedEngine(const Camera& camera, const Config& config, std::unique_ptr<FrameTracker> tracker);
  MaskedEngine(const MaskedEngine& other);
  MaskedEngine& operator=(const MaskedEngine&) = delete;
  [[nodiscard]] std::unique_ptr<OdometryEngine> clone() const override {
    return std::make_unique<MaskedEngine>(*this);
  }

  [[nodiscard]] FrameResult process(const Frame& frame, const cv::Mat& known_mask) override;
  [[nodiscard]] FrameResult process_prepared(const Frame& frame, PreparedFrame prepared,
                                             const cv::Mat& known_mask) override;
  void finish() override {}

  [[nodiscard]] std::unique_ptr<OdometryEngine> continued_with(
      const Config& config, const std::vector<PastFrame>& before) const override;
  [[nodiscard]] int frames_wanted(const Config& config) const override {
    return motion_.frames_wanted(config);
  }
  void drop_images() override;
  void restore_images(int next, const std::function<Frame(int)>& read) override;

  [[nodiscard]] const LocalMap& map() const override { return tracker_->map(); }
  [[nodiscard]] const RevisedPoses& revised_poses() const override { return revised_; }
  [[nodiscard]] const Config& config() const override { return config_; }
  [[nodiscard]] const MotionStage& motion() const override { return motion_; }

 private:
  /// A frame on its way: rectified once, looked at with several masks.
  struct Rectified {
    cv::Mat gray, depth;
    std::shared_ptr<const TrackerPreparation> prepared;
  };
  [[nodiscard]] FrameResult run_frame(const Frame& frame, const PreparedFrame& prepared,
                                      const cv::Mat& known_mask);
  [[nodiscard]] TrackerFrame looked_at(const Frame& frame, const Rectified& rectified, const cv::Mat& mask,
                                       const MotionResult& motion) const;
  [[nodiscard]] TrackerResult track_frame(MotionInput input, const Rectified& rectified, FrameResult& result);
  [[nodiscard]] RemovalCheck check(const Frame& frame, const Rectified& rectified, const MotionResult& motion,
                                   const cv::Mat& known_mask) const;
  void keep(const TrackerFrame& frame, TrackerResult& tracked, FrameRecord& record);
  void lose(const Frame& frame, FrameStatus status, const std::string& why, const std::optional<Pose>& held,
            FrameRecord& record);
  void write_pose(const Pose& camera_from_world, FrameRecord& record) const;
  void write_result(TrackerResult& tracked, FrameResult& result) const;

  Camera camera_;
  Config config_;
  FramePreparer preparer_;
  MotionStage motion_;  // what is classified as dynamic
  Rectifier rectifier_;
  std::unique_ptr<FrameTracker> tracker_;
  CameraPath path_;
  std::unordered_map<int, float> point_weight_;  // of the frame at hand, by the method
  RevisedPoses revised_;                         // none: no pose is solved once more
};

}  // namespace stillpoint
