#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/odometry/odometry_engine.hpp"

namespace stillpoint {

/// RGB-D visual odometry with the features that config.run.method finds moving taken out first. Frames go in,
/// in order; poses come out. World coordinates are the first tracked frame's camera.
///
/// A value, whatever engine is behind it: a copy goes on from where the original stood, and gives the same
/// bytes from the same frames.
class Odometry {
 public:
  Odometry(const Camera& camera, const Config& config) : engine_(make_odometry_engine(camera, config)) {}
  Odometry(const Odometry& other) : engine_(other.engine_->clone()) {}
  Odometry& operator=(const Odometry& other) {
    if (this != &other) engine_ = other.engine_->clone();
    return *this;
  }
  Odometry(Odometry&&) = default;
  Odometry& operator=(Odometry&&) = default;
  ~Odometry() = default;

  /// Takes the next frame. Nothing about the frame makes it throw: what cannot be tracked is marked lost.
  /// @param known_mask what is truly dynamic, CV_8UC1; empty where it is not known. Only methods that need
  /// the true mask go by it; to the others it serves for RemovalCheck.
  [[nodiscard]] FrameResult process(const Frame& frame, const cv::Mat& known_mask = {}) {
    return engine_->process(frame, known_mask);
  }

  /// The same of a frame that a FramePreparer of the same camera and config prepared, frame by frame in
  /// order.
  [[nodiscard]] FrameResult process_prepared(const Frame& frame, PreparedFrame prepared,
                                             const cv::Mat& known_mask = {}) {
    return engine_->process_prepared(frame, std::move(prepared), known_mask);
  }

  /// Looks back at the last poses: after the last frame.
  void finish() { engine_->finish(); }

  /// The same map and the same place, but the next frames are processed with another config. What the new
  /// method needs of earlier frames is made from `before`, the last frames_wanted(config) of them, newest
  /// last. With an equal config it goes on bit for bit as it would have.
  /// @returns nothing where the map's features would not fit the new ones (another features.levels or
  /// features.scale_factor)
  [[nodiscard]] std::optional<Odometry> continued_with(const Config& config,
                                                       const std::vector<PastFrame>& before) const {
    if (auto next = engine_->continued_with(config, before)) return Odometry(std::move(next));
    return std::nullopt;
  }
  /// How many earlier frames continued_with() needs; 0 where it has all that the new config asks for.
  [[nodiscard]] int frames_wanted(const Config& config) const { return engine_->frames_wanted(config); }

  /// Puts by what copies that drop images would hold longer than this one does: the features of keyframes.
  void shelve_features(ByteStore& store) { engine_->shelve_features(store); }
  /// Lets go of images kept of earlier frames, and of features that were put by: what a copy that is put by
  /// need not carry. Its map is not to be asked then.
  void drop_images() { engine_->drop_images(); }
  /// Has them again, as they were, before it goes on. @param next index of the frame it processes next
  void restore_images(int next, const std::function<Frame(int)>& read) {
    engine_->restore_images(next, read);
  }

  [[nodiscard]] const LocalMap& map() const { return engine_->map(); }
  /// The poses of earlier frames that were solved once more, by the map as it was later.
  [[nodiscard]] const RevisedPoses& revised_poses() const { return engine_->revised_poses(); }
  [[nodiscard]] const Config& config() const { return engine_->config(); }
  /// The motion method's state, as the next frame will find it.
  [[nodiscard]] const MotionStage& motion() const { return engine_->motion(); }

 private:
  explicit Odometry(std::unique_ptr<OdometryEngine> engine) : engine_(std::move(engine)) {}

  std::unique_ptr<OdometryEngine> engine_;
};

}  // namespace stillpoint
