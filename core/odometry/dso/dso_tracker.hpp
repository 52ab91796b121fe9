#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/odometry/dso/coarse_tracker.hpp"
#include "core/odometry/dso/dso_window.hpp"
#include "core/odometry/dso/point_selection.hpp"
#include "core/odometry/masked_engine.hpp"

namespace stillpoint {

/// What `dso` saw of a frame.
struct DsoTrace final : EngineTrace {
  DsoTrace(const Rectifier& rectified, const DsoConfig& of) : rectifier(rectified), config(of) {}
  [[nodiscard]] std::vector<Stage> describe(const Frame& frame) const override;

  Rectifier rectifier;
  DsoConfig config;
  int reference_frame = -1;  ///< index of the newest keyframe's frame
  Affine reference_affine;
  CoarseAlignment tracking;

  /// Why the frame is a keyframe, or is none.
  struct Decision {
    double shift = 0.0, flow = 0.0, gain = 0.0, error = 0.0;  ///< each against 1
    bool keyframe = false;
    [[nodiscard]] double sum() const { return shift + flow + gain; }
  };
  std::optional<Decision> decision;

  /// Of a keyframe alone.
  struct Keyframe {
    DsoOptimisation optimised;
    DsoWindow window;  ///< as it was solved, before keyframes left it
    std::vector<DsoResidual> residuals;
    std::vector<int> left;  ///< keyframes that left, by frame index
    int lost_points = 0;    ///< that no keyframe shows well any more
    cv::Mat thresholds;     ///< gradient a candidate exceeds, a block of 32 px
    std::vector<DsoCandidate> candidates, made;
  };
  std::shared_ptr<const Keyframe> keyframe;
};

/// DSO with depth from the sensor: frames are tracked directly against the newest of a window of keyframes,
/// whose poses, brightness and points are solved together when one is added.
class DsoTracker final : public FrameTracker {
 public:
  DsoTracker(const Camera& camera, const Config& config);
  [[nodiscard]] std::unique_ptr<FrameTracker> clone() const override {
    return std::make_unique<DsoTracker>(*this);
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
  void add_frame(const TrackerFrame& frame, const Pose& camera_from_world, const Affine& affine);
  /// Points of the newest keyframe where the window has few. @returns those made
  std::vector<DsoCandidate> add_points(const TrackerFrame& frame, DsoTrace::Keyframe& told);
  void write_map();
  /// Points on what the method removes leave window and map. @returns how many
  int cull_dynamic(const TrackerFrame& frame, const Pose& camera_from_world);
  [[nodiscard]] DsoTrace::Decision decide(const CoarseAlignment& tracking) const;
  [[nodiscard]] std::vector<FeatureRecord> seen_points(const TrackerFrame& frame,
                                                       const CoarseAlignment& tracking) const;

  Rectifier rectifier_;
  DsoConfig config_;
  LocalMap map_;  // all keyframes and points there ever were, for whoever looks
  DsoWindow window_;
  CoarseReference reference_;
  Pose last_ = Pose::Identity();  // camera_from_world of the last frame tracked
  Affine last_affine_;
  double usual_rmse_ = 0.0;           // of the last frame; 0: none yet
  std::optional<double> first_rmse_;  // of the first frame after the newest keyframe
  int cell_ = 6;                      // px: d of point selection
  double apart_ = 2.0;                // px at half size: how far new points keep off others
  int lost_ = 0;                      // frames in a row
};

}  // namespace stillpoint
