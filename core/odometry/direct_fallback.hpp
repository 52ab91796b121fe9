#pragma once

#include <functional>
#include <optional>

#include "core/config.hpp"
#include "core/geometry/camera.hpp"
#include "core/odometry/direct_alignment.hpp"
#include "core/odometry/tracked_frame.hpp"
#include "core/odometry/tracker.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// Where matches starve, by blur or for want of corners, aligns the frame directly with an earlier one and
/// joins what patches and corners say: beyond METHOD.md §2 (§4 names the weakness), for methods that extend
/// the odometry. A value; its memory is the frames that may be aligned with, and how many matches are usual.
class DirectFallback {
 public:
  DirectFallback(const Camera& camera, const Config& config);

  void adopt(const Config& config);
  [[nodiscard]] bool enabled() const { return enabled_; }

  /// Whether a first pose has far fewer matches than first poses lately had, of which this is one.
  [[nodiscard]] bool starts_degraded(const TrackedFrame& frame);
  /// Whether a pose with so many inliers is to be helped.
  [[nodiscard]] bool is_degraded(int inliers) const;

  /// A first pose by patches alone. @returns whether there is one; the frame is at it then
  [[nodiscard]] bool begin(const Frame& image, const LocalMap& map, const CameraPath& path,
                           TrackedFrame& frame, FrameRecord& record) const;
  /// A pose by patches and matches. @param refined by matches alone; searched anew where those were too few
  /// @returns whether there is one; the frame is at it then
  [[nodiscard]] bool refine(const Frame& image, const LocalMap& map, const Tracker& tracker,
                            TrackedFrame& frame, PoseRefinement& refined, FrameRecord& record) const;

  /// Takes note of a tracked frame. @param directly whether patches had a say in it
  void count(int inliers, bool directly);
  /// Whether frames have gone by patches for so long that the map knows nothing of the view.
  [[nodiscard]] bool degraded_for_long() const;
  /// The map knows the view again, or the camera is lost.
  void end_degradation() { degraded_frames_ = 0; }

  /// Keeps the frame to align later ones with. @param mask what is dynamic in it; @param lag s, of its depth
  /// @param velocity of the camera in it, a second
  void remember(const Frame& image, const FrameRecord& record, const cv::Mat& mask, std::optional<double> lag,
                const Vector6d& velocity);
  void drop_images();
  /// @param next index of the frame that comes next
  void restore_images(int next, const std::function<Frame(int)>& read);

 private:
  /// Where patches say the camera stands, and how well they know (DirectAlignment::information).
  struct DirectPose {
    Pose camera_from_world = Pose::Identity();
    Matrix6d information = Matrix6d::Zero();
  };
  [[nodiscard]] std::optional<DirectPose> align(const Frame& image, const LocalMap& map,
                                                const CameraPath& path, const TrackedFrame& frame,
                                                FrameRecord& record) const;
  [[nodiscard]] double noise_of_corners(const LocalMap& map, const TrackedFrame& frame,
                                        const std::vector<double>& scales,
                                        const Pose& camera_from_world) const;

  Camera camera_;
  Config config_;
  bool enabled_ = false;
  std::optional<DirectReference> last_reference_;   // the newest frame with a pose and depth
  std::optional<DirectReference> sharp_reference_;  // … that had corners enough
  double usual_first_inliers_ = 0.0;                // of first poses, lately
  double usual_inliers_ = 0.0;                      // of whole frames, lately
  int degraded_frames_ = 0;                         // in a row
};

}  // namespace stillpoint
