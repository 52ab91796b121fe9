#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/odometry/masked_engine.hpp"
#include "core/odometry/ptam/ptam_config.hpp"
#include "core/odometry/ptam/ptam_image.hpp"
#include "core/odometry/ptam/ptam_solver.hpp"

namespace stillpoint {

/// A map point's way through a frame.
struct PtamSeen {
  int point = kNone;
  int level = 0;  ///< at which its patch is searched
  Eigen::Vector3d world = Eigen::Vector3d::Zero();
  Eigen::Vector2d expected = Eigen::Vector2d::Zero();  ///< px, rectified, where its row shows it
  Eigen::Vector2d rolled = Eigen::Vector2d::Zero();    ///< px, what the rolling shutter adds to it
  Eigen::Vector2d found_at = Eigen::Vector2d::Zero();  ///< px, rectified, where it was found
  std::optional<PtamPatch> patch{};
  bool removed = false;  ///< by the motion method
  bool searched = false, found = false, coarse = false;
  double static_weight = 1.0;
  double weight = 0.0;    ///< Tukey's, as the pose ended
  double error_px = 0.0;  ///< of the full image
};

enum class PtamQuality { kBad, kDodgy, kGood };

/// What `ptam` saw of a frame.
struct PtamTrace final : EngineTrace {
  explicit PtamTrace(const Rectifier& rectified) : rectifier(rectified) {}
  [[nodiscard]] std::vector<Stage> describe(const Frame& frame) const override;

  Rectifier rectifier;
  bool begins = false;
  cv::Mat small_before, small_now;  ///< what the turn was found by
  double turn_deg = 0.0;
  double speed = 0.0;  ///< translation over depth, and rad, a frame
  bool coarse = false, relocalised = false;
  std::array<int, PtamConfig::kLevels> searched{}, found{};
  std::vector<PtamSeen> seen;
  PtamPose pose;
  double rms_px = 0.0;
  PtamQuality quality = PtamQuality::kBad;
  bool decided = false;                                  ///< whether the frame is to be a keyframe
  double keyframe_distance = 0.0, keyframe_limit = 0.0;  ///< over mean depth
  int frames_since = 0;                                  ///< the last keyframe
  bool keyframe = false;
  std::array<int, PtamConfig::kLevels> made{};  ///< new points by level
  std::vector<cv::Point2f> made_at;             ///< px, in the camera's own image
  std::optional<PtamBundle> bundle;
  int dropped = 0;  ///< points by votes, by bundle adjustment, and on what the method removes
};

/// PTAM with depth from the sensor: patches of keyframes are found at corners, coarse then fine, and the pose
/// follows from them; keyframes and points are adjusted when a keyframe is made.
class PtamTracker final : public FrameTracker {
 public:
  PtamTracker(const Camera& camera, const Config& config);
  [[nodiscard]] std::unique_ptr<FrameTracker> clone() const override {
    return std::make_unique<PtamTracker>(*this);
  }
  [[nodiscard]] std::shared_ptr<const TrackerPreparation> prepare(const cv::Mat& gray,
                                                                  const cv::Mat& depth) const override;
  [[nodiscard]] TrackerResult begin(const TrackerFrame& frame, FrameRecord& record) override;
  [[nodiscard]] TrackerResult track(const TrackerFrame& frame, const Pose& predicted) const override;
  void keep(const TrackerFrame& frame, TrackerResult& result, FrameRecord& record) override;
  void lose(const TrackerFrame& frame, const TrackerResult& result) override;
  [[nodiscard]] const LocalMap& map() const override { return map_; }
  [[nodiscard]] bool adopt(const Config& config) override;

 private:
  struct Point {
    int keyframe = kNone;  ///< its source
    int level = 0;
    cv::Point at;        ///< px of that level
    double depth = 0.0;  ///< m, in the source
    int inlier_votes = 0, outlier_votes = 0;
  };
  struct Measurement {
    int point = kNone, level = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px, rectified, as at the middle row's time
    double depth = 0.0;
    double static_weight = 1.0;
  };
  struct View {
    std::shared_ptr<const PtamImage> image;
    double mean_depth = 1.0;
    std::vector<Measurement> measurements;
  };

  [[nodiscard]] Pose start_of(const TrackerFrame& frame, const Pose& predicted, PtamTrace& trace) const;
  [[nodiscard]] std::vector<PtamSeen> project_points(const TrackerFrame& frame, const Vector6d& velocity,
                                                     const Pose& camera_from_world) const;
  void place(const Vector6d& velocity, const Pose& camera_from_world, PtamSeen& seen) const;
  void search(const TrackerFrame& frame, const PtamImage& image, std::vector<PtamSeen*>& wanted,
              double radius_px, int subpixel_steps, PtamTrace& trace) const;
  PtamPose solve(std::vector<PtamSeen*>& found, const Pose& start, double late_bound_squared) const;
  [[nodiscard]] std::vector<FeatureRecord> records_of(const TrackerFrame& frame,
                                                      const PtamTrace& trace) const;
  void judge_quality(PtamTrace& trace) const;
  void vote(PtamTrace& trace);
  void cull_dynamic(const TrackerFrame& frame, const Pose& camera_from_world, PtamTrace& trace);
  [[nodiscard]] bool wants_keyframe(const TrackerFrame& frame, const Pose& camera_from_world,
                                    PtamTrace& trace) const;
  void add_keyframe(const TrackerFrame& frame, const Pose& camera_from_world, PtamTrace& trace);
  void adjust(int keyframe, PtamTrace& trace);
  void drop_point(int point, bool dynamic = false);

  Rectifier rectifier_;
  PtamConfig config_;
  LocalMap map_;
  std::map<int, Point> points_;  // by map point
  std::map<int, View> views_;    // by keyframe
  Pose last_ = Pose::Identity();
  Vector6d velocity_ = Vector6d::Zero();  // a frame: PTAM's motion model
  cv::Mat last_small_;
  double scene_depth_ = 1.0;  // m, mean of the points last found
  int last_keyframe_frame_ = 0;
  int lost_ = 0;  // frames in a row
};

}  // namespace stillpoint
