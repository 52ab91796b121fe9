// Sessions put together by hand.
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/paper/paper_config.hpp"
#include "core/motion/paper/paper_stages.hpp"
#include "core/motion/stillpoint/stillpoint_stages.hpp"
#include "core/run/ablation.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"
#include "tests/ui/session_example.hpp"

namespace stillpoint::testing {
namespace {

/// A room of blocks, CV_8UC3, with a disc that moves.
cv::Mat handmade_picture(int disc_x) {
  cv::Mat picture(240, 320, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      picture.at<cv::Vec3b>(y, x) =
          cv::Vec3b::all(static_cast<std::uint8_t>(70 + 50 * ((x / 40 + y / 40) % 3) + y / 4));
  cv::circle(picture, {disc_x, 120}, 45, {90, 60, 170}, cv::FILLED);
  return picture;
}

/// Depth that falls from 3 m on the left to 1.5 m on the right, the disc at 1.2 m, a hole without any.
cv::Mat handmade_depth(int disc_x) {
  cv::Mat depth(240, 320, CV_32FC1);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) depth.at<float>(y, x) = 3.0F - 1.5F * static_cast<float>(x) / 320.0F;
  cv::circle(depth, {disc_x, 120}, 45, cv::Scalar(1.2), cv::FILLED);
  cv::rectangle(depth, {20, 20, 40, 30}, cv::Scalar(0.0), cv::FILLED);
  return depth;
}

Frame handmade_frame(int index) {
  Frame frame;
  frame.index = index;
  frame.timestamp = index / 30.0;
  frame.colour = handmade_picture(100 + 4 * index);
  frame.depth = handmade_depth(100 + 4 * index);
  cv::cvtColor(frame.colour, frame.gray, cv::COLOR_BGR2GRAY);
  return frame;
}

/// A quarter of a circle about a table; `drift_m` away from it at the end.
Pose handmade_pose(int index, double drift_m) {
  const double angle = 1.6 * index / 40.0, share = index / 40.0;
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(1.5 * std::cos(angle), 1.5 * std::sin(angle), 1.2) +
                       drift_m * Eigen::Vector3d(share * share, 0.4 * std::sin(5.0 * share), 0.3 * share);
  const Eigen::Vector3d forward = (Eigen::Vector3d(0.0, 0.0, 0.8) - pose.translation()).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d world_from_camera;
  world_from_camera << right, forward.cross(right), forward;
  pose.linear() = world_from_camera;
  return pose;
}

FrameRecord handmade_record(int index, double drift_m) {
  FrameRecord record;
  record.index = index;
  record.timestamp = index / 30.0;
  record.status = index == 0    ? FrameStatus::initialised
                  : index == 18 ? FrameStatus::lost
                                : FrameStatus::tracked;
  if (index == 18) record.note = "too few inliers.";
  record.estimated = index != 18;
  record.world_from_camera = handmade_pose(index, drift_m);
  record.keyframe = index % 9 == 0;
  record.mask_share = 0.08 + 0.004 * (index % 7);
  record.inliers = 260 - 6 * (index % 11);
  record.features_found = 300;
  record.features_removed = 60;
  record.features_kept = 240;
  record.map_points = 900 + 5 * index;
  record.map_keyframes = 1 + index / 9;
  record.ms = {.motion = 8.0 + index % 5,
               .features = 6.0 + index % 3,
               .matching = 2.0,
               .pose = 1.5,
               .mapping = record.keyframe ? 5.0 : 0.0,
               .bundle = record.keyframe ? 9.0 : 0.0,
               .total = 14.0 + index % 5 + (record.keyframe ? 14.0 : 0.0)};
  for (int i = 0; i < record.features_found; ++i) {
    FeatureRecord feature;
    feature.pixel = {static_cast<float>(10 + 37 * i % 300), static_cast<float>(8 + 53 * i % 220)};
    feature.depth = 1.5F + 0.005F * static_cast<float>(i);
    feature.residual_px = 0.1F * static_cast<float>(i % 20);
    feature.fate = i % 5 == 0 ? FeatureFate::removed : static_cast<FeatureFate>(i % 3);
    if (feature.fate == FeatureFate::inlier || feature.fate == FeatureFate::outlier) feature.map_point = i;
    record.features.push_back(feature);
  }
  return record;
}

std::shared_ptr<RunView> handmade_run(const std::string& name, double millimetres) {
  auto run = std::make_shared<RunView>();
  run->name = name;
  const double drift_m = 0.01 * millimetres;
  for (int i = 0; i < 40; ++i) {
    run->records.push_back(handmade_record(i, drift_m));
    const double time = i / 30.0, size = 0.001 * millimetres * (2 + i * 5 % 8);
    if (i != 18) run->trajectory.push_back({time, handmade_pose(i, drift_m)});
    run->evaluation.matched.push_back({time, time, handmade_pose(i, drift_m), handmade_pose(i, 0.0)});
    run->evaluation.ate.errors.push_back({time, size, 0.1});
    if (i > 0) run->evaluation.rpe_frame.errors.push_back({time - 1.0 / 30.0, time, 0.3 * size, 0.1});
    if (i > 14) run->evaluation.rpe_time.errors.push_back({time - 0.5, time, size, 0.2});
  }
  run->evaluation.rpe_frame.delta = "1 frame";
  run->evaluation.rpe_time.delta = "0.5 s";
  run->evaluation.rpe_time.translation_m.count = run->evaluation.rpe_frame.translation_m.count = 25;
  run->evaluation.ate.translation_m.rmse = 0.004 * millimetres;
  run->evaluation.rpe_time.translation_m.rmse = 0.005 * millimetres;
  run->evaluation.rpe_frame.translation_m.rmse = 0.0015 * millimetres;
  return run;
}

/// One direction: the picture moved by four pixels, what differs, and the tracks that told so.
DirectionTrace handmade_direction(const cv::Mat& from, const cv::Mat& to) {
  DirectionTrace direction;
  direction.homography.valid = true;
  direction.homography.matrix = cv::Matx33d(1, 0.01, -1, 0, 1, 0.5, 0, 0, 1);
  direction.homography.ransac_inliers = 80;
  direction.homography.refined_error_px = 0.31;
  direction.compensated = from.clone();
  direction.valid = cv::Mat(240, 320, CV_8UC1, cv::Scalar(255));
  direction.valid.colRange(0, 6) = 0;
  cv::absdiff(from, to, direction.difference);
  direction.difference.setTo(0, direction.valid == 0);
  direction.threshold = 31;
  direction.raw_mask = direction.difference > 31;
  cv::dilate(direction.raw_mask, direction.mask, cv::Mat::ones(5, 5, CV_8UC1));
  for (int i = 0; i < 120; ++i) {
    const cv::Point2f at{static_cast<float>(12 + 53 * i % 296), static_cast<float>(10 + 37 * i % 220)};
    const bool moves = cv::norm(at - cv::Point2f(190, 120)) < 45.0;
    direction.tracks.push_back({at, at + (moves ? cv::Point2f(4, 0) : cv::Point2f(-1, 0.5F)),
                                static_cast<float>(i % 9), i % 17 == 0, !moves});
  }
  return direction;
}

/// Method `stillpoint`'s stages, downsampled images of a disc that moves.
StillpointTrace handmade_depth_motion() {
  StillpointTrace trace;
  const cv::Size small{160, 120};
  cv::Mat disc(small, CV_32FC1, cv::Scalar(-1.0));
  cv::circle(disc, {96, 60}, 22, cv::Scalar(4.0), cv::FILLED);
  for (int i = 0; i < 2; ++i) {
    ReferenceEvidence evidence;
    evidence.depth_residual = disc * (0.6 + 0.2 * i);
    evidence.depth_residual(cv::Rect(10, 10, 20, 15)) = std::numeric_limits<float>::quiet_NaN();
    evidence.intensity_residual = disc * 6.0;
    evidence.log_odds = disc * 0.8;
    evidence.intensity_sigma = 4.0;
    evidence.reference.frames_back = i == 0 ? 2 : 10;
    trace.references.push_back(evidence);
  }
  trace.prior = disc * 0.5;
  trace.log_odds = disc * 1.3;
  trace.labels = cv::Mat(small, CV_32SC1, cv::Scalar(0));
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) trace.labels.at<int>(y, x) = x / 20 + 8 * (y / 20);
  for (int i = 0; i < 48; ++i) {
    const cv::Point2f centre{static_cast<float>(10 + 20 * (i % 8)), static_cast<float>(10 + 20 * (i / 8))};
    const bool moving = cv::norm(centre - cv::Point2f(96, 60)) < 26.0;
    trace.superpixels.push_back({centre, 2.0F, 400, moving ? 2.1F : -0.8F, moving ? 3.0F : -1.2F, moving});
  }
  trace.small_mask = disc > 0.0;
  trace.mask = cv::Mat::zeros(240, 320, CV_8UC1);
  cv::circle(trace.mask, {192, 120}, 46, 255, cv::FILLED);
  trace.mask_share = 6650.0 / (320.0 * 240.0);
  return trace;
}

}  // namespace

SessionView handmade_example() {
  SessionView view;
  auto run = handmade_run("stillpoint", 1.0);
  auto current = std::make_shared<FrameView>();
  current->index = 24;
  current->frame = handmade_frame(24);
  current->reference = handmade_frame(23);
  MotionRound round;
  round.forward = handmade_direction(current->reference.gray, current->frame.gray);
  round.backward = handmade_direction(current->frame.gray, current->reference.gray);
  round.mask = cv::Mat::zeros(240, 320, CV_8UC1);
  cv::circle(round.mask, {190, 110}, 40, 255, cv::FILLED);
  cv::rectangle(round.mask, {30, 180, 50, 24}, 255, cv::FILLED);
  round.backward_mask_in_target = round.mask;
  round.mask_share = 6225.0 / (320.0 * 240.0);
  PaperMotionTrace paper;
  paper.reference = 23;
  paper.reference_gray = current->reference.gray;
  paper.pair.rounds.push_back(round);
  StageLog beside = describe_paper(current->frame, &paper);
  beside.method = "paper";
  current->motion_beside = std::make_shared<const StageLog>(std::move(beside));
  StillpointMotionTrace own;
  own.judged = handmade_depth_motion();
  Camera small;
  small.width = 320, small.height = 240, small.fx = small.fy = 260.0, small.cx = 159.5, small.cy = 119.5;
  own.view =
      std::make_shared<const RgbdView>(make_rgbd_view(current->frame.gray, current->frame.depth, small, 2));
  StageLog log = describe_stillpoint(current->frame, own, StillpointConfig());
  log.method = "stillpoint";
  current->motion = std::make_shared<const StageLog>(std::move(log));
  current->mask = own.judged.mask;
  current->truth.moving = cv::Mat::zeros(240, 320, CV_8UC1);
  cv::circle(current->truth.moving, {196, 120}, 45, 255, cv::FILLED);
  current->record = record_in(*run, 24);
  view.title = "by hand";
  view.camera.width = 320;
  view.camera.height = 240;
  view.camera.fx = view.camera.fy = 260.0;
  view.camera.cx = 159.5;
  view.camera.cy = 119.5;
  view.config.run.method = "stillpoint";
  view.frame_count = 60;
  view.processed = 40;
  view.current = current;
  Trajectory truth;
  for (int i = 0; i < 60; ++i) truth.push_back({i / 30.0, handmade_pose(i, 0.0)});
  view.ground_truth = std::move(truth);
  std::vector<SavedKeyframe> keyframes;
  for (int i = 0; i < 40; i += 9) keyframes.push_back({i / 9, i, {i / 30.0, handmade_pose(i, 0.01)}});
  view.keyframes = std::move(keyframes);
  std::vector<SavedPoint> points;
  for (int i = 0; i < 400; ++i)
    points.push_back({i, {0.05 * (i % 20) - 0.5, 0.05 * (i / 20 % 20) - 0.5, i % 3 == 0 ? 0.0 : 0.8}, 3});
  view.map_points = std::move(points);
  auto other = std::make_shared<FrameView>();
  other->index = 22;
  other->frame = handmade_frame(22);
  other->record = record_in(*run, 22);
  view.debug.other_is = OtherFrame::kept, view.debug.kept_frame = 22;
  view.debug.other = std::move(other);
  SweepView sweep{.range = {"paper.border_px", 1, 9, 5},
                  .values = {1, 3, 5, 7, 9},
                  .points = {},
                  .frames = 60,
                  .base = view.config};
  for (int i = 0; i < 4; ++i) {
    AblationCell cell;
    cell.rpe_m = 0.004 + 0.001 * std::abs(i - 2), cell.mask_iou = 0.5 + 0.1 * i, cell.coverage = 1.0;
    sweep.points.push_back({1.0 + 2.0 * i, cell});
  }
  sweep.busy = true;
  view.debug.sweep = std::move(sweep);
  view.run = run;
  view.baseline = handmade_run("none", 4.0);
  view.revision = 1;
  return view;
}

namespace {

/// The run again, parted from it at a frame by a mask, counts and a pose of its own.
GhostView handmade_ghost(const SessionView& session, const std::string& name, int parts, double millimetres) {
  GhostView ghost;
  ghost.name = name;
  ghost.config.of<PaperConfig>().border_px = 7;
  auto run = handmade_run("stillpoint", millimetres);
  run->records = session.run->records;
  for (std::size_t i = 0; i < run->records.size(); ++i)
    run->records.change(i, [parts](FrameRecord& record) {
      if (record.index < parts) return;
      record.world_from_camera.translation().z() += 0.002 * (record.index - parts + 1);
      record.inliers -= 40;
      record.mask_share *= 0.5;
    });
  auto current = std::make_shared<FrameView>(*session.current);
  current->mask = cv::Mat(240, 320, CV_8UC1, cv::Scalar(0));
  cv::circle(current->mask, {220, 120}, 40, 255, cv::FILLED);
  current->record = record_in(*run, static_cast<std::size_t>(current->index));
  ghost.current = current;
  ghost.diverged = parts;
  ghost.run = run;
  return ghost;
}

}  // namespace

SessionView debug_example() {
  SessionView view = handmade_example();
  DebugView& debug = view.debug;
  debug.bookmarks = {{5, "the walker comes in"}, {24, ""}, {31, "lost soon after"}};
  debug.breakpoints = {
      {{"inliers < 215", true}, "", 0, {8, 9, 10, 19, 20, 21, 30, 31, 32}},
      {{"lost", true}, "", 0, {18}},
      {{"rpee > 2 cm", true}, "column 1: there is no figure 'rpee'; perhaps rpe is meant", 0, {}},
      {{"keyframe", false}, "", 0, {0, 9, 18, 27, 36}}};
  debug.stopped_by = 0;
  debug.span = FrameSpan{10, 20};
  debug.ghosts.push_back(handmade_ghost(view, "motion.border_px 7", 12, 2.5));
  debug.ghosts.push_back(handmade_ghost(view, "method none", 20, 3.5));
  debug.ghosts.back().busy = true;
  std::vector<RemovalError> removal;
  for (int i = 1; i < 40; ++i) {
    if (i == 18) continue;
    RemovalError error{.frame = i,
                       .with_removal_m = 0.001 * (2 + i % 5),
                       .without_removal_m = 0.001 * (2 + i % 5) + 0.004 * (i % 3),
                       .oracle_m = 0.0015};
    error.helped = i % 3 != 0;
    if (i % 13 == 0) {
      error.with_removal_m = error.without_removal_m + 0.006;
      error.helped = false;
      error.hurt = true;
    }
    removal.push_back(error);
  }
  debug.removal = std::move(removal);
  return view;
}

SessionView long_example(int frames, int worst) {
  SessionView view = handmade_example();
  auto run = std::make_shared<RunView>();
  run->name = "paper";
  for (int i = 0; i < frames; ++i) {
    FrameRecord record;
    record.index = i;
    record.timestamp = i / 30.0;
    record.status = i == 0 ? FrameStatus::initialised : FrameStatus::tracked;
    record.estimated = true;
    record.inliers = i == worst ? 12 : 200 + 37 * i % 60;
    record.mask_share = 0.001 * (i % 70);
    record.features_kept = 400;
    record.keyframe = i % 20 == 0;
    run->records.push_back(record);
  }
  auto current = std::make_shared<FrameView>(*view.current);
  current->record = record_in(*run, 24);
  view.current = current;
  view.run = run;
  view.baseline = nullptr;
  view.frame_count = view.processed = frames;
  return view;
}

}  // namespace stillpoint::testing
