#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/motion_method.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint::motion_test {

/// A textured wall 3 m away and a board 1.5 m away before it, with depth, seen by a camera that goes sideways
/// without turning. The board may go its own way. World coordinates are the camera's of frame 0.
struct WallAndBoard {
  static constexpr double kWall = 3.0, kBoard = 1.5;  // m
  Camera camera;                                      // 640x480, focal length 525 px, no distortion
  double camera_step = 0.004;                         ///< m a frame, sideways
  double board_step = 0.03;                           ///< m a frame, sideways; 0 = it is static
  int board_from = 0;                                 ///< frame in which it begins to move
  int board_until = 1000;                             ///< frame in which it stands still again
  cv::Size board_px{140, 180};
  cv::Mat wall = textured_image({1000, 560}, 5) * 0.8, board = textured_image({140, 180}, 9) * 0.7 + 60;

  [[nodiscard]] Pose camera_from_world(int frame) const {
    Pose pose = Pose::Identity();
    pose.translation().x() = -camera_step * frame;
    return pose;
  }
  /// m: how far the board has come.
  [[nodiscard]] double board_way(int frame) const {
    return board_step * std::clamp(frame - board_from, 0, board_until - board_from);
  }
  /// px: its left upper corner.
  [[nodiscard]] cv::Point2d board_at(int frame) const {
    return {180.0 + camera.fx * (board_way(frame) - camera_step * frame) / kBoard, 150.0};
  }
  [[nodiscard]] cv::Rect board_box(int frame) const {
    const cv::Point2d at = board_at(frame);
    return cv::Rect(cvRound(at.x), cvRound(at.y), board_px.width, board_px.height) & cv::Rect(0, 0, 640, 480);
  }
  [[nodiscard]] cv::Mat truth(int frame) const {
    cv::Mat mask = cv::Mat::zeros(480, 640, CV_8UC1);
    mask(board_box(frame)).setTo(255);
    return mask;
  }
  [[nodiscard]] Frame frame(int index) const {
    Frame frame;
    frame.index = index;
    frame.timestamp = frame.depth_timestamp = index / 30.0;
    const double wall_x = camera.fx * camera_step * index / kWall + 100.0;
    const cv::Matx23d into_wall(1, 0, wall_x, 0, 1, 40);
    cv::warpAffine(wall, frame.gray, into_wall, {640, 480}, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REFLECT);
    frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(kWall));
    const cv::Point2d at = board_at(index);
    cv::Mat moved;
    cv::warpAffine(board, moved, cv::Matx23d(1, 0, at.x, 0, 1, at.y), {640, 480}, cv::INTER_CUBIC);
    const cv::Mat where = truth(index);
    moved.copyTo(frame.gray, where);
    frame.depth.setTo(kBoard, where);
    return frame;
  }
  /// Features on a grid, those on the wall with exact map points; the board's map points stay where it stood
  /// at first.
  [[nodiscard]] std::vector<MotionFeature> features(int index) const {
    std::vector<MotionFeature> all;
    const cv::Rect box = board_box(index);
    for (int y = 20; y < 470; y += 18)
      for (int x = 20; x < 630; x += 18) {
        MotionFeature feature;
        feature.pixel = cv::Point2f(static_cast<float>(x), static_cast<float>(y));
        const bool on_board = box.contains({x, y});
        feature.depth = static_cast<float>(on_board ? kBoard : kWall);
        feature.map_point = static_cast<int>(all.size());
        feature.world = camera_from_world(index).inverse() *
                        camera.back_project({static_cast<double>(x), static_cast<double>(y)},
                                            static_cast<double>(feature.depth));
        if (on_board) feature.world.x() -= board_way(index);
        all.push_back(feature);
      }
    return all;
  }
};

/// Runs a method over frames of a scene as the odometry does that knows its poses.
class SceneRun {
 public:
  SceneRun(const WallAndBoard& scene, const MotionMethod& method) : scene_(&scene), method_(method.clone()) {}
  SceneRun(const SceneRun& other)
      : scene_(other.scene_), method_(other.method_->clone()), past_(other.past_), next_(other.next_) {}
  SceneRun& operator=(const SceneRun&) = delete;
  SceneRun(SceneRun&&) = default;
  ~SceneRun() = default;

  MotionResult next(int threads = 1) {
    const int index = next_++;
    const Frame frame = scene_->frame(index);
    auto prepared = method_->prepare(frame, past_, threads);
    MotionInput input{frame, prepared};
    const std::vector<MotionFeature> features = scene_->features(index);
    input.threads = threads;
    input.camera_from_world = scene_->camera_from_world(index);
    input.features = features;
    // The first frame begins the map: nothing is judged.
    MotionResult result;
    if (index > 0) result = method_->detect(input);
    method_->commit(input, result, {true, scene_->camera_from_world(index)});
    if (prepared) {
      const auto kept = prepared->for_later();
      past_.push_back(kept ? kept : prepared);
      while (static_cast<int>(past_.size()) > method_->frames_prepared_back()) past_.erase(past_.begin());
    }
    return result;
  }
  [[nodiscard]] int last_index() const { return next_ - 1; }
  [[nodiscard]] StageLog describe(const MotionResult& result) const {
    return method_->describe(scene_->frame(last_index()), result);
  }
  [[nodiscard]] const MotionMethod& method() const { return *method_; }

 private:
  const WallAndBoard* scene_;
  std::unique_ptr<MotionMethod> method_;
  std::vector<std::shared_ptr<const MotionPreparation>> past_;
  int next_ = 0;
};

/// Share of what is set in `truth` that is set in `mask`, and of what is set in `mask` that is in `truth`.
struct Overlap {
  double recall = 0.0, precision = 0.0;
};
inline Overlap overlap(const cv::Mat& mask, const cv::Mat& truth) {
  const double both = cv::countNonZero(mask & truth);
  return {both / cv::countNonZero(truth), both / std::max(1, cv::countNonZero(mask))};
}

inline bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y)
    if (std::memcmp(a.ptr(y), b.ptr(y), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0) return false;
  return true;
}

}  // namespace stillpoint::motion_test
