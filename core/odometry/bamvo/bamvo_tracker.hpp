#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "core/odometry/bamvo/background_model.hpp"
#include "core/odometry/bamvo/dense_alignment.hpp"
#include "core/odometry/masked_engine.hpp"

namespace stillpoint {

/// What `bamvo` saw of a frame. Images are of the frame before, whose pixels are aligned.
struct BamvoTrace final : EngineTrace {
  BamvoTrace(const Rectifier& rectified, int frame_before) : rectifier(rectified), reference(frame_before) {}
  [[nodiscard]] std::vector<Stage> describe(const Frame& frame) const override;

  Rectifier rectifier;
  int reference;  ///< index of the frame aligned with
  cv::Mat gray;   ///< CV_8UC1, rectified: that frame
  BackgroundModel model;
  int past_depths = 0;  ///< depth images the model was made from
  double foreground_change_m = 0.0;
  DenseAlignment alignment;
};

/// Kim & Kim 2016: dense alignment with the frame before, each pixel weighed by how well its past depths
/// agree. The motion method's mask and weights count in both frames.
class BamvoTracker final : public FrameTracker {
 public:
  BamvoTracker(const Camera& camera, const Config& config);
  [[nodiscard]] std::unique_ptr<FrameTracker> clone() const override {
    return std::make_unique<BamvoTracker>(*this);
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
  using Levels = std::vector<DenseView>;  // finest first
  struct Prepared;
  [[nodiscard]] Levels levels_of(const TrackerFrame& frame) const;
  /// The frame becomes what the next one is aligned with, and its depth the newest of the model.
  void remember(const TrackerFrame& frame, Levels levels, const Pose& camera_from_world);
  [[nodiscard]] std::vector<FeatureRecord> sampled(const Levels& target,
                                                   const DenseAlignment& alignment) const;

  Rectifier rectifier_;
  BamvoConfig config_;
  LocalMap map_;                // one keyframe, where the world begins
  std::deque<PastDepth> past_;  // oldest first, of the model's size
  BackgroundModel model_;       // of the last frame
  Levels last_;                 // the last frame, weighed by the model
  cv::Mat last_gray_;
  int last_index_ = kNone;
  int lost_ = 0;  // frames in a row
};

}  // namespace stillpoint
