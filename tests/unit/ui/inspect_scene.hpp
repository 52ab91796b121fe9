#pragma once

#include <iterator>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/epipolar/epipolar_stages.hpp"
#include "core/motion/paper/paper_stages.hpp"
#include "core/motion/stillpoint/stillpoint_stages.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"
#include "core/run/frame_scores.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint::testing {

/// A pair of frames put together by hand: a wall at 2 m, the camera 0.1 m further right in frame 5 than in
/// frame 4, and a square mask of two rounds. What panels and explanations say of it can be told on paper.
struct InspectScene {
  static constexpr int kWidth = 160, kHeight = 120;
  static constexpr double kFocal = 100.0, kDepth = 2.0, kStep = 0.1;
  /// px that the wall moves to the left from frame 4 to frame 5.
  static constexpr double kShift = kFocal * kStep / kDepth;

  InspectScene() {
    camera.width = kWidth, camera.height = kHeight;
    camera.fx = camera.fy = kFocal;
    camera.cx = 79.5, camera.cy = 59.5;
    config.run.method = "paper";
    for (int i = 0; i < 6; ++i) {
      FrameRecord record;
      record.index = i;
      record.timestamp = i / 30.0;
      record.status = FrameStatus::tracked;
      record.estimated = true;
      record.world_from_camera.translation().x() = kStep * i;
      run.records.push_back(record);
    }
    view.index = 5;
    view.frame = frame(5);
    view.reference = frame(4);
    paper.reference = 4;
    paper.reference_gray = view.reference.gray;
    for (int i = 0; i < 2; ++i) paper.pair.rounds.push_back(round(i));
    view.mask = paper.pair.mask();
    change([](FrameRecord&) {});
    describe();
  }
  InspectScene(const InspectScene&) = delete;
  InspectScene& operator=(const InspectScene&) = delete;

  const FrameRecord& record() const { return *view.record; }
  /// Changes the frame's record, as `change(record)` does.
  template <typename Change>
  void change(const Change& change) {
    run.records.change(run.records.size() - 1, change);
    view.record = &*std::prev(run.records.end());
  }

  int add_feature(cv::Point2f pixel, FeatureFate fate, int map_point = kNone, float residual_px = 0.0F) {
    change([&](FrameRecord& record) {
      record.features.push_back(
          {pixel, static_cast<float>(kDepth), residual_px, map_point, std::uint8_t{0}, fate});
    });
    return static_cast<int>(record().features.size()) - 1;
  }

  /// Works the stages of the scene's method out anew.
  void describe() {
    const std::string& method = config.run.method;
    StageLog log;
    if (method == "paper") log = describe_paper(view.frame, &paper);
    if (method == "stillpoint" && view.frame.has_depth()) {
      own.view = std::make_shared<RgbdView>(make_rgbd_view(view.frame.gray, view.frame.depth, camera, 4));
      log = describe_stillpoint(view.frame, own, config.of<StillpointConfig>());
    }
    if (method == "stillpoint" && !view.frame.has_depth())
      log = describe_epipolar(view.frame, colour, config.of<EpipolarConfig>());
    log.method = method;
    view.motion = std::make_shared<const StageLog>(std::move(log));
  }

  /// What panels take, sharing nothing with this.
  [[nodiscard]] SessionView session() const {
    SessionView session;
    session.camera = camera;
    session.config = config;
    session.frame_count = 6;
    session.processed = 6;
    session.run = std::make_shared<RunView>(run);
    auto current = std::make_shared<FrameView>(view);
    current->record = &*std::prev(session.run->records.end());
    session.current = current;
    return session;
  }

  Camera camera;
  Config config;
  RunView run;
  FrameView view;
  PaperMotionTrace paper;
  StillpointMotionTrace own;
  EpipolarTrace colour;

 private:
  static Frame frame(int index) {
    Frame frame;
    frame.index = index;
    frame.timestamp = index / 30.0;
    frame.gray = cv::Mat(kHeight, kWidth, CV_8UC1);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        frame.gray.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(40 + (x + 5 * index) % 100);
    frame.depth = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(kDepth));
    return frame;
  }

  /// Round 1 finds a square, round 2 the same and a second one.
  [[nodiscard]] MotionRound round(int index) const {
    MotionRound round;
    const cv::Matx33d forward(1, 0, -kShift, 0, 1, 0, 0, 0, 1);
    for (DirectionTrace* direction : {&round.forward, &round.backward}) {
      const bool is_forward = direction == &round.forward;
      direction->homography.valid = true;
      direction->homography.matrix = is_forward ? forward : forward.inv();
      direction->homography.ransac_inliers = 40 + 10 * index;
      direction->compensated = view.frame.gray.clone();
      direction->valid = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
      direction->threshold = 20;
      direction->difference = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
      direction->raw_mask = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
      direction->mask = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
      direction->tracks = {{{105.0F, 60.0F}, {100.0F, 60.0F}, 1.0F, false, true},
                           {{45.0F, 40.0F}, {52.0F, 40.0F}, 1.0F, index > 0, index == 0}};
    }
    draw(round.forward, {40, 30, 20, 20}, 50);
    if (index > 0) draw(round.forward, {110, 80, 10, 10}, 50);
    round.backward_mask_in_target = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
    round.mask = round.forward.mask.clone();
    round.mask_share = static_cast<double>(cv::countNonZero(round.mask)) / (kWidth * kHeight);
    return round;
  }

  /// A square above the threshold, and the cleaned mask 3 px larger on each side.
  static void draw(DirectionTrace& direction, const cv::Rect& square, int difference) {
    cv::rectangle(direction.difference, square, difference, cv::FILLED);
    cv::rectangle(direction.raw_mask, square, 255, cv::FILLED);
    cv::rectangle(direction.mask, {square.x - 3, square.y - 3, square.width + 6, square.height + 6}, 255,
                  cv::FILLED);
  }
};

/// A frame without depth: a point that moves, one that does not, and one too young to have a say.
inline void without_depth(InspectScene& scene) {
  scene.config.run.method = "stillpoint";
  scene.view.frame.depth.release();
  EpipolarTrace& trace = scene.colour;
  trace.points = {{{50.0F, 40.0F}, 9, 0.2F, 0.8F}, {{120.0F, 90.0F}, 12, -0.4F, -0.4F}, {{10.0F, 10.0F}, 1}};
  ColourReference reference;
  reference.gap = 6;
  reference.points = {0, 1};
  reference.shifts = reference.residuals = {{2.0F, 0.0F}, {0.0F, 0.0F}};
  reference.sigmas = {4.0F, 0.5F};
  reference.sigma = 0.25;
  trace.references = {reference};
  trace.evidence = cv::Mat::zeros(30, 40, CV_32FC1);
  trace.evidence(cv::Rect(8, 6, 10, 10)).setTo(0.5);
  trace.mask = cv::Mat::zeros(120, 160, CV_8UC1);
  trace.mask(cv::Rect(30, 25, 40, 40)).setTo(255);
  trace.regions = {{{30, 25, 40, 40}, {}, 1600}};
  trace.mask_share = 1600.0 / (160 * 120);
  scene.view.mask = trace.mask;
  scene.describe();
}

}  // namespace stillpoint::testing
