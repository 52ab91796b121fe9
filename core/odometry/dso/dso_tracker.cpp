#include "core/odometry/dso/dso_tracker.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/odometry/engines.hpp"

namespace stillpoint {
namespace {

/// Where points may be made: the method leaves the pixel in, with its neighbours, and depth was sensed.
cv::Mat usable_pixels(const TrackerFrame& frame, double farthest_m) {
  cv::Mat usable = frame.depth > 0.0F;
  usable.setTo(0, frame.depth > farthest_m);
  if (frame.weight.empty()) return usable;
  cv::Mat removed = frame.weight <= 0.0F;
  cv::dilate(removed, removed,
             cv::getStructuringElement(cv::MORPH_RECT, {2 * kDsoReach + 1, 2 * kDsoReach + 1}));
  usable.setTo(0, removed);
  return usable;
}

/// Depth of pixels at colour's time, m; 0 = none.
std::vector<float> depths_of(const TrackerFrame& frame, const std::vector<cv::Point2f>& pixels,
                             const Camera& camera) {
  return depth_at(pixels, pixels, frame.depth, camera, frame.velocity, frame.depth_lag);
}

}  // namespace

DsoTracker::DsoTracker(const Camera& camera, const Config& config)
    : rectifier_(camera), config_(config.of<DsoConfig>().for_camera(camera)) {}

bool DsoTracker::adopt(const Config& config) {
  const auto& wanted = config.of<DsoConfig>();
  const bool serves = wanted.levels == config_.levels;
  if (serves) config_ = wanted.for_camera(rectifier_.pinhole());
  return serves;
}

std::shared_ptr<const TrackerPreparation> DsoTracker::prepare(const cv::Mat& gray, const cv::Mat&) const {
  return make_dso_image(gray, rectifier_.pinhole(), config_.levels);
}

void DsoTracker::add_frame(const TrackerFrame& frame, const Pose& camera_from_world, const Affine& affine) {
  Keyframe keyframe;
  keyframe.frame_index = frame.image.index;
  keyframe.timestamp = frame.image.timestamp;
  keyframe.camera_from_world = camera_from_world;
  keyframe.features = std::make_shared<const FeatureSet>();
  DsoFrame added;
  added.keyframe = map_.add_keyframe(std::move(keyframe));
  added.frame_index = frame.image.index;
  added.camera_from_world = camera_from_world;
  added.affine = affine;
  added.velocity = frame.velocity;
  added.image = std::static_pointer_cast<const DsoImage>(frame.prepared);
  added.weight = frame.weight;
  const double bound = config_.outlier * config_.outlier * static_cast<double>(kDsoPattern.size());
  added.outlier_energy = bound;
  window_.frames.push_back(std::move(added));
}

std::vector<DsoCandidate> DsoTracker::add_points(const TrackerFrame& frame, DsoTrace::Keyframe& told) {
  DsoFrame& newest = window_.frames.back();
  const Camera& camera = rectifier_.pinhole();
  told.thresholds = gradient_thresholds(*newest.image, config_.gradient_margin);
  told.candidates = select_candidates(*newest.image, told.thresholds,
                                      usable_pixels(frame, config_.farthest_m), config_.candidates, cell_);
  // DSO's rule for how far new points keep off those there are, so that there are as many as wanted.
  const double share = static_cast<double>(window_.points.size()) / config_.active_points;
  apart_ += share < 0.66   ? -0.8
            : share < 0.8  ? -0.5
            : share < 0.9  ? -0.2
            : share < 1.0  ? -0.1
            : share > 1.5  ? 0.8
            : share > 1.3  ? 0.5
            : share > 1.15 ? 0.2
                           : 0.1;
  apart_ = std::clamp(apart_, 0.0, 4.0);
  cv::Mat free(newest.image->levels.front().rows / 2, newest.image->levels.front().cols / 2, CV_8UC1,
               cv::Scalar(255));
  const CoarseReference there_are = make_coarse_reference(window_, camera);
  for (const CoarsePoint& point : there_are.levels.front())
    free.at<std::uint8_t>(std::min(static_cast<int>(point.v) / 2, free.rows - 1),
                          std::min(static_cast<int>(point.u) / 2, free.cols - 1)) = 0;
  cv::Mat distance;
  cv::distanceTransform(free, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  std::vector<cv::Point2f> pixels;
  for (const DsoCandidate& one : told.candidates)
    pixels.emplace_back(static_cast<float>(one.x), static_cast<float>(one.y));
  const std::vector<float> depth = depths_of(frame, pixels, camera);

  std::vector<DsoCandidate> made;
  std::vector<DsoPoint> points;
  for (std::size_t i = 0; i < told.candidates.size(); ++i) {
    const DsoCandidate& one = told.candidates[i];
    if (depth[i] <= 0.0F || depth[i] > static_cast<float>(config_.farthest_m)) continue;
    if (static_cast<double>(distance.at<float>(std::min(one.y / 2, free.rows - 1),
                                               std::min(one.x / 2, free.cols - 1))) < apart_)
      continue;
    const auto point = make_dso_point(newest, one.x, one.y, static_cast<double>(depth[i]), config_);
    if (!point || point->static_weight <= 0.0F) continue;
    points.push_back(*point);
    made.push_back(one);
  }
  // No more than the window is to hold, but a keyframe's share at least: thinned evenly.
  const auto room =
      static_cast<std::size_t>(std::max(config_.active_points / config_.window,
                                        config_.active_points - static_cast<int>(window_.points.size())));
  if (points.size() > room) {
    const std::size_t count = points.size();
    std::vector<DsoPoint> fewer;
    std::vector<DsoCandidate> fewer_made;
    for (std::size_t i = 0; i < room; ++i) {
      fewer.push_back(points[i * count / room]);
      fewer_made.push_back(made[i * count / room]);
    }
    points = std::move(fewer);
    made = std::move(fewer_made);
  }
  newest.points_made = static_cast<int>(points.size());
  FeatureSet features;
  for (const DsoPoint& point : points) {
    features.keypoints.emplace_back(
        rectifier_.to_image(cv::Point2f(static_cast<float>(point.u), static_cast<float>(point.v))), 7.0F);
    features.undistorted.emplace_back(static_cast<float>(point.u), static_cast<float>(point.v));
    features.depth.push_back(static_cast<float>(1.0 / point.inverse_depth));
    features.static_weight.push_back(point.static_weight);
  }
  features.descriptors.resize(points.size());
  Keyframe& keyframe = map_.keyframe(newest.keyframe);
  keyframe.features = std::make_shared<const FeatureSet>(std::move(features));
  keyframe.points.assign(points.size(), kNone);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].id = map_.add_point({}, newest.keyframe, static_cast<int>(i));
    window_.points.push_back(points[i]);
  }
  return made;
}

/// The window's keyframes and points as they stand.
void DsoTracker::write_map() {
  const Camera& camera = rectifier_.pinhole();
  for (const DsoFrame& frame : window_.frames)
    map_.keyframe(frame.keyframe).camera_from_world = frame.camera_from_world;
  for (const DsoPoint& point : window_.points) {
    const int host = window_.index_of(point.host);
    if (host < 0) continue;
    const DsoFrame& from = window_.frames[static_cast<std::size_t>(host)];
    const DsoTransfer here(camera, Pose::Identity(), from.velocity, Vector6d::Zero());
    if (const auto place = here(point.u, point.v, point.inverse_depth))
      map_.point(point.id).position = from.camera_from_world.inverse() * place->in_host;
  }
}

int DsoTracker::cull_dynamic(const TrackerFrame& frame, const Pose& camera_from_world) {
  if (!frame.cull_dynamic) return 0;
  const Camera& camera = rectifier_.pinhole();
  return static_cast<int>(std::erase_if(window_.points, [&](const DsoPoint& point) {
    const int host = window_.index_of(point.host);
    if (host < 0) return false;
    const DsoFrame& from = window_.frames[static_cast<std::size_t>(host)];
    const DsoTransfer transfer(camera, camera_from_world * from.camera_from_world.inverse(), from.velocity,
                               frame.velocity);
    const auto place = transfer(point.u, point.v, point.inverse_depth);
    if (!place || !frame.is_dynamic({place->x, place->y}, place->in_target.z())) return false;
    map_.remove_moving_point(point.id);
    return true;
  }));
}

TrackerResult DsoTracker::begin(const TrackerFrame& frame, FrameRecord& record) {
  TrackerResult result;
  result.rms_px = std::numeric_limits<double>::quiet_NaN();
  if (frame.depth.empty()) {
    result.why_lost = "the frame has no depth to begin with";
    return result;
  }
  DsoTracker begun = *this;
  begun.add_frame(frame, Pose::Identity(), {});
  auto told = std::make_shared<DsoTrace::Keyframe>();
  told->made = begun.add_points(frame, *told);
  if (static_cast<int>(told->made.size()) < config_.min_points) {
    result.why_lost = "the frame has " + std::to_string(told->made.size()) +
                      " steep pixels with depth; a map begins with " + std::to_string(config_.min_points);
    return result;
  }
  *this = std::move(begun);
  write_map();
  reference_ = make_coarse_reference(window_, rectifier_.pinhole());
  told->window = window_;
  record.new_points = static_cast<int>(told->made.size());
  auto trace = std::make_shared<DsoTrace>(rectifier_, config_);
  trace->reference_frame = frame.image.index;
  trace->keyframe = std::move(told);
  result.trace = std::move(trace);
  return result;
}

TrackerResult DsoTracker::track(const TrackerFrame& frame, const Pose& predicted) const {
  TrackerResult result;
  result.rms_px = std::numeric_limits<double>::quiet_NaN();
  const auto& image = static_cast<const DsoImage&>(*frame.prepared);
  const double usual = usual_rmse_ > 0.0 ? usual_rmse_ : std::numeric_limits<double>::infinity();
  auto trace = std::make_shared<DsoTrace>(rectifier_, config_);
  trace->reference_frame = reference_.frame_index;
  trace->reference_affine = reference_.affine;
  trace->tracking = track_coarse(reference_, image, frame,
                                 dso_starts(predicted, last_, reference_.camera_from_world, config_.turn),
                                 last_affine_, usual, config_);
  if (rectifier_.pinhole().readout_s != 0.0 && frame.velocity_to && trace->tracking.failure.empty()) {
    // How the rows bend is known only by how fast the camera went in this very frame.
    TrackerFrame rolled = frame;
    rolled.velocity = frame.velocity_to(trace->tracking.frame_from_reference * reference_.camera_from_world);
    CoarseAlignment again = track_coarse(reference_, image, rolled, {trace->tracking.frame_from_reference},
                                         trace->tracking.affine, usual, config_);
    again.tries = trace->tracking.tries;
    if (again.failure.empty()) trace->tracking = std::move(again);
  }
  const CoarseAlignment& tracking = trace->tracking;
  result.why_lost = tracking.failure;
  result.camera_from_world = tracking.frame_from_reference * reference_.camera_from_world;
  result.matches = static_cast<int>(tracking.points.size());
  result.inliers = tracking.inliers;
  result.iterations = tracking.iterations;
  result.start = tracking.tries > 1 ? PoseStart::wide_search : PoseStart::motion_model;
  result.features = seen_points(frame, tracking);
  if (result.found())
    result.figures = {static_cast<double>(window_.points.size()),
                      static_cast<double>(window_.frames.size()),
                      tracking.rmse,
                      tracking.affine.a - reference_.affine.a,
                      tracking.affine.b - reference_.affine.b,
                      static_cast<double>(tracking.tries)};
  result.trace = std::move(trace);
  return result;
}

std::vector<FeatureRecord> DsoTracker::seen_points(const TrackerFrame& frame,
                                                   const CoarseAlignment& tracking) const {
  std::vector<FeatureRecord> features;
  features.reserve(tracking.points.size());
  for (std::size_t i = 0; i < tracking.points.size(); ++i) {
    const CoarsePoint& point = tracking.points[i];
    FeatureRecord feature;
    feature.pixel =
        rectifier_.to_image(cv::Point2f(static_cast<float>(point.u), static_cast<float>(point.v)));
    if (feature.pixel.x < 0 || feature.pixel.y < 0 ||
        feature.pixel.x > static_cast<float>(frame.image.gray.cols - 1) ||
        feature.pixel.y > static_cast<float>(frame.image.gray.rows - 1))
      continue;
    if (!frame.depth.empty())
      feature.depth = frame.depth.at<float>(static_cast<int>(std::lround(point.v)),
                                            static_cast<int>(std::lround(point.u)));
    feature.residual_px = std::numeric_limits<float>::quiet_NaN();
    feature.static_weight = point.weight;
    const float residual = tracking.residuals[i];
    feature.fate = std::isnan(residual)                                         ? FeatureFate::removed
                   : std::abs(static_cast<double>(residual)) <= tracking.cutoff ? FeatureFate::inlier
                                                                                : FeatureFate::outlier;
    if (feature.fate != FeatureFate::removed) feature.map_point = point.id;
    features.push_back(feature);
  }
  return features;
}

DsoTrace::Decision DsoTracker::decide(const CoarseAlignment& tracking) const {
  DsoTrace::Decision decision;
  decision.shift = config_.keyframe_shift * tracking.shift_px;
  decision.flow = config_.keyframe_flow * tracking.flow_px;
  decision.gain = config_.keyframe_gain * std::abs(tracking.affine.a - reference_.affine.a);
  if (first_rmse_) decision.error = tracking.rmse / (config_.keyframe_error * *first_rmse_);
  decision.keyframe = decision.sum() > 1.0 || decision.error > 1.0;
  return decision;
}

void DsoTracker::keep(const TrackerFrame& frame, TrackerResult& result, FrameRecord& record) {
  auto& trace = static_cast<DsoTrace&>(*result.trace);
  const CoarseAlignment& tracking = trace.tracking;
  trace.decision = decide(tracking);
  usual_rmse_ = tracking.rmse;
  last_affine_ = tracking.affine;
  lost_ = 0;
  if (!first_rmse_) first_rmse_ = tracking.rmse;
  record.culled_points = cull_dynamic(frame, result.camera_from_world);
  if (record.culled_points > 0) reference_ = make_coarse_reference(window_, rectifier_.pinhole());
  // Without depth it can give no points to go on with.
  if (frame.depth.empty()) trace.decision->keyframe = false;
  if (trace.decision->keyframe) {
    auto told = std::make_shared<DsoTrace::Keyframe>();
    add_frame(frame, result.camera_from_world, tracking.affine);
    const Camera& camera = rectifier_.pinhole();
    told->optimised = window_.optimise(camera, config_, frame.threads);
    told->window = window_;
    told->residuals = window_.residuals(camera, config_);
    told->lost_points = window_.drop_lost_points();
    told->made = add_points(frame, *told);
    write_map();
    reference_ = make_coarse_reference(window_, camera);
    result.camera_from_world = window_.frames.back().camera_from_world;
    last_affine_ = window_.frames.back().affine;
    first_rmse_.reset();
    const std::vector<int> leaving = window_.to_leave(config_);
    for (auto index = leaving.rbegin(); index != leaving.rend(); ++index) {
      told->left.push_back(window_.frames[static_cast<std::size_t>(*index)].frame_index);
      window_.drop_frame(*index);
    }
    record.keyframe = true;
    record.new_points = static_cast<int>(told->made.size());
    record.culled_points += told->lost_points;
    record.culled_keyframes = static_cast<int>(leaving.size());
    trace.keyframe = std::move(told);
  }
  last_ = result.camera_from_world;
}

void DsoTracker::lose(const TrackerFrame&, const TrackerResult&) {
  ++lost_;
  usual_rmse_ = 0.0;  // any start may win now: the best of all is taken
}

EngineInfo dso_engine() {
  EngineInfo info;
  info.name = "dso";
  info.title = "DSO, RGB-D";
  info.summary =
      "Direct sparse odometry with depth from the sensor: a window of keyframes solved by brightness, "
      "without "
      "marginalisation.";
  info.citation =
      "Engel J., Koltun V., Cremers D.: Direct Sparse Odometry. IEEE TPAMI 40(3), 2018; with sensed depth "
      "after "
      "Yuan Z., Cheng K., Tang J., Yang X.: RGB-D DSO. IEEE T-Multimedia, 2021";
  info.offers_matches = true;
  info.has_stages = true;
  // All of it is direct, and its window is optimised by brightness: there is no reprojection to tell of.
  info.measures.direct = info.measures.fused_points = info.measures.bundle = false;
  info.parameters = AnySection(DsoConfig());
  info.figures = {{"dso_points", FigureUnit::plain, "points in the window", 0},
                  {"dso_window", FigureUnit::plain, "keyframes in the window", 0},
                  {"dso_rmse", FigureUnit::plain, "residual of tracking, grey levels", 3},
                  {"dso_gain", FigureUnit::plain, "log brightness against the keyframe"},
                  {"dso_bias", FigureUnit::plain, "brightness added, grey levels", 2},
                  {"dso_tries", FigureUnit::plain, "starts that tracking tried", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<OdometryEngine> {
    return std::make_unique<MaskedEngine>(camera, config, std::make_unique<DsoTracker>(camera, config));
  };
  return info;
}

}  // namespace stillpoint
