#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/odometry/frame_solver.hpp"
#include "core/odometry/mapper.hpp"
#include "core/odometry/odometry_engine.hpp"
#include "core/odometry/removal_check.hpp"
#include "core/odometry/smoother.hpp"

namespace stillpoint {

/// METHOD.md §2: feature-based odometry against a local map. A value, and so is each of its parts.
class FeatureOdometry final : public OdometryEngine {
 public:
  FeatureOdometry(const Camera& camera, const Config& config);
  [[nodiscard]] std::unique_ptr<OdometryEngine> clone() const override {
    return std::make_unique<FeatureOdometry>(*this);
  }

  [[nodiscard]] FrameResult process(const Frame& frame, const cv::Mat& known_mask) override;
  [[nodiscard]] FrameResult process_prepared(const Frame& frame, PreparedFrame prepared,
                                             const cv::Mat& known_mask) override;
  void finish() override;

  [[nodiscard]] std::unique_ptr<OdometryEngine> continued_with(
      const Config& config, const std::vector<PastFrame>& before) const override;
  [[nodiscard]] int frames_wanted(const Config& config) const override;
  void shelve_features(ByteStore& store) override;
  void drop_images() override;
  void restore_images(int next, const std::function<Frame(int)>& read) override;

  [[nodiscard]] const LocalMap& map() const override { return mapper_.map(); }
  [[nodiscard]] const RevisedPoses& revised_poses() const override { return smoother_.revised(); }
  [[nodiscard]] const Config& config() const override { return config_; }
  [[nodiscard]] const MotionStage& motion() const override { return motion_; }

 private:
  [[nodiscard]] FrameResult run_frame(const Frame& frame, const PreparedFrame& prepared,
                                      const cv::Mat& known_mask);
  [[nodiscard]] TrackedFrame begin_map(const Frame& frame, const PreparedFrame& prepared,
                                       FrameResult& result);
  [[nodiscard]] TrackedFrame track_frame(MotionInput input, const PreparedFrame& prepared,
                                         const cv::Mat& known_mask, FrameResult& result);
  void check(const BeforeFrame& before, const Frame& frame, const PreparedFrame& prepared,
             const MotionResult& motion, const cv::Mat& known_mask, FrameRecord& record) const;
  void keep(const Frame& frame, FrameSolver::Solution& solution, FrameRecord& record);
  void lose(const Frame& frame, FrameStatus status, const std::string& why, FrameRecord& record);
  void write_pose(const Pose& camera_from_world, FrameRecord& record) const;
  [[nodiscard]] bool looks_back() const;

  Camera camera_;
  Config config_;
  FramePreparer preparer_;
  MotionStage motion_;  // what is classified as dynamic
  FrameSolver solver_;
  Mapper mapper_;
  FixedLagSmoother smoother_;  // of frames lately tracked
};

}  // namespace stillpoint
