// What `ptam` does with a keyframe: new points, and the bundle adjustment about it.
#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>

#include "core/odometry/engines.hpp"
#include "core/odometry/ptam/ptam_tracker.hpp"

namespace stillpoint {
namespace {

/// A corner that may become a point.
struct Candidate {
  cv::Point at;  // px of the level
  double score = 0.0;
};

/// Maximal FAST corners with a score that suffices, off the places taken, the best first.
std::vector<Candidate> candidates_of(const cv::Mat& level, int threshold, const std::vector<cv::Point>& taken,
                                     const PtamConfig& config) {
  constexpr int kRim = kPatch / 2 + 6;  // px: half a patch, and room to find it again beside
  cv::Mat free(level.size(), CV_8UC1, cv::Scalar(255));
  const auto take = [&](const cv::Point& at) {
    const cv::Rect about(at.x - config.apart_px, at.y - config.apart_px, 2 * config.apart_px + 1,
                         2 * config.apart_px + 1);
    free(about & cv::Rect({0, 0}, free.size())) = 0;
  };
  for (const cv::Point& at : taken) take(at);
  std::vector<cv::KeyPoint> corners;
  cv::FAST(level, corners, threshold, true);
  std::vector<Candidate> found;
  for (const cv::KeyPoint& corner : corners) {
    const cv::Point at(cvRound(corner.pt.x), cvRound(corner.pt.y));
    if (at.x < kRim || at.y < kRim || at.x >= level.cols - kRim || at.y >= level.rows - kRim) continue;
    if (free.at<std::uint8_t>(at) == 0) continue;
    const double score = shi_tomasi(level, at);
    if (score >= config.corner_limit) found.push_back({at, score});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Candidate> kept;
  for (const Candidate& one : found) {
    if (static_cast<int>(kept.size()) >= config.new_points) break;
    if (free.at<std::uint8_t>(one.at) == 0) continue;
    kept.push_back(one);
    take(one.at);
  }
  return kept;
}

}  // namespace

void PtamTracker::add_keyframe(const TrackerFrame& frame, const Pose& camera_from_world, PtamTrace& trace) {
  const Camera& camera = rectifier_.pinhole();
  View view;
  view.image = std::static_pointer_cast<const PtamImage>(frame.prepared);
  FeatureSet features;
  std::vector<int> of_feature;
  const auto add_feature = [&](const Eigen::Vector2d& pixel, int level, double depth, double weight,
                               int point) {
    const cv::Point2f at(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    features.keypoints.emplace_back(rectifier_.to_image(at), static_cast<float>(kPatch << level), -1.0F, 0.0F,
                                    level);
    features.undistorted.push_back(at);
    features.depth.push_back(static_cast<float>(depth));
    features.static_weight.push_back(static_cast<float>(weight));
    of_feature.push_back(point);
  };
  const auto depth_of = [&](const Eigen::Vector2d& pixel) {
    const std::vector<cv::Point2f> at{{static_cast<float>(pixel.x()), static_cast<float>(pixel.y())}};
    return static_cast<double>(
        depth_at(at, at, frame.depth, camera, frame.velocity, frame.depth_lag).front());
  };

  // What was found here is measured by this keyframe too.
  std::array<std::vector<cv::Point>, PtamConfig::kLevels> taken;
  for (const PtamSeen& seen : trace.seen) {
    if (!seen.found || seen.weight <= 0.0 || !points_.contains(seen.point)) continue;
    const double depth = depth_of(seen.found_at);
    // A depth across an edge is another surface's.
    const double expected = (camera_from_world * seen.world).z();
    const bool agrees = std::abs(depth - expected) < 0.05 * expected;
    view.measurements.push_back(
        {seen.point, seen.level, seen.found_at - seen.rolled, agrees ? depth : 0.0, seen.static_weight});
    add_feature(seen.found_at, seen.level, depth, seen.static_weight, seen.point);
    for (int level = 0; level < PtamConfig::kLevels; ++level) {
      if (level != seen.level) continue;
      const Eigen::Vector2d at = to_level(seen.found_at, level);
      taken[static_cast<std::size_t>(level)].emplace_back(cvRound(at.x()), cvRound(at.y()));
    }
  }

  struct New {
    Point point;
    Measurement measurement;
    Eigen::Vector3d in_camera;
  };
  std::vector<New> made;
  for (int level = PtamConfig::kLevels - 1; level >= 0; --level) {
    const auto index = static_cast<std::size_t>(level);
    for (const Candidate& one :
         candidates_of(view.image->levels[index], config_.fast()[index], taken[index], config_)) {
      const Eigen::Vector2d pixel = from_level({one.at.x, one.at.y}, level);
      const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, camera.width - 1),
                y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, camera.height - 1);
      const double weight = static_cast<double>(frame.weight_at(x, y)), depth = depth_of(pixel);
      if (weight <= 0.0 || depth <= 0.0 || depth > config_.farthest_m) continue;
      New one_more;
      one_more.in_camera = camera.back_project(pixel, depth);
      // As the middle row's time has it.
      const double after = camera.row_time(pixel.y());
      one_more.in_camera -=
          after * (frame.velocity.head<3>() + frame.velocity.tail<3>().cross(one_more.in_camera));
      if (one_more.in_camera.z() < 0.1) continue;
      one_more.point = {kNone, level, one.at, depth};
      one_more.measurement = {kNone, level, camera.project(one_more.in_camera), one_more.in_camera.z(),
                              weight};
      made.push_back(one_more);
      add_feature(pixel, level, depth, weight, kNone);
      ++trace.made[index];
      trace.made_at.push_back(features.keypoints.back().pt);
    }
  }
  features.descriptors.resize(features.keypoints.size());

  Keyframe keyframe;
  keyframe.frame_index = frame.image.index;
  keyframe.timestamp = frame.image.timestamp;
  keyframe.camera_from_world = camera_from_world;
  keyframe.points = of_feature;
  keyframe.features = std::make_shared<const FeatureSet>(std::move(features));
  const int id = map_.add_keyframe(std::move(keyframe));
  const Pose world_from_camera = camera_from_world.inverse();
  const int first_new = static_cast<int>(of_feature.size() - made.size());
  double depth_sum = 0.0;
  for (std::size_t i = 0; i < made.size(); ++i) {
    const int point =
        map_.add_point(world_from_camera * made[i].in_camera, id, first_new + static_cast<int>(i));
    made[i].point.keyframe = id;
    made[i].measurement.point = point;
    points_.emplace(point, made[i].point);
    view.measurements.push_back(made[i].measurement);
  }
  for (const Measurement& one : view.measurements)
    depth_sum += (camera_from_world * map_.point(one.point).position).z();
  if (!view.measurements.empty()) view.mean_depth = depth_sum / static_cast<double>(view.measurements.size());
  scene_depth_ = view.mean_depth;
  views_.emplace(id, std::move(view));
  last_keyframe_frame_ = frame.image.index;
  trace.keyframe = true;
}

void PtamTracker::drop_point(int point, bool dynamic) {
  for (auto& [id, view] : views_)
    std::erase_if(view.measurements, [point](const Measurement& one) { return one.point == point; });
  points_.erase(point);
  if (!map_.has_point(point)) return;
  if (dynamic)
    map_.remove_moving_point(point);
  else
    map_.remove_point(point);
}

void PtamTracker::adjust(int keyframe, PtamTrace& trace) {
  const auto centre = [&](int id) -> Eigen::Vector3d {
    return map_.keyframe(id).camera_from_world.inverse().translation();
  };
  std::vector<std::pair<double, int>> by_distance;
  for (const auto& [id, view] : views_)
    if (id != keyframe) by_distance.emplace_back((centre(id) - centre(keyframe)).norm(), id);
  std::sort(by_distance.begin(), by_distance.end());
  PtamBundle bundle;
  std::map<int, int> view_at, point_at;
  const auto add_view = [&](int id, bool fixed) {
    view_at[id] = static_cast<int>(bundle.views.size());
    bundle.views.push_back({id, map_.keyframe(id).camera_from_world, fixed});
  };
  const int first = views_.begin()->first;
  add_view(keyframe, keyframe == first);
  for (const auto& [distance, id] : by_distance) {
    if (static_cast<int>(bundle.views.size()) > config_.bundle_keyframes) break;
    add_view(id, id == first);
  }
  for (const auto& view : bundle.views)
    for (const Measurement& one : views_.at(view.keyframe).measurements)
      if (point_at.emplace(one.point, static_cast<int>(bundle.points.size())).second)
        bundle.points.push_back({one.point, map_.point(one.point).position});
  for (const auto& [id, view] : views_) {
    const bool sees = std::any_of(view.measurements.begin(), view.measurements.end(),
                                  [&](const Measurement& one) { return point_at.contains(one.point); });
    if (sees && !view_at.contains(id)) add_view(id, true);
  }
  for (const auto& [id, at] : view_at)
    for (const Measurement& one : views_.at(id).measurements)
      if (const auto point = point_at.find(one.point); point != point_at.end())
        bundle.measurements.push_back(
            {at, point->second, one.pixel, one.depth, one.level, one.static_weight});
  solve_ptam_bundle(bundle, rectifier_.pinhole(), config_);

  for (const auto& view : bundle.views)
    if (!view.fixed) map_.keyframe(view.keyframe).camera_from_world = view.camera_from_world;
  for (const auto& point : bundle.points) map_.point(point.id).position = point.world;
  for (const auto& one : bundle.measurements) {
    if (!one.outlier) continue;
    const int point = bundle.points[static_cast<std::size_t>(one.point)].id;
    const int id = bundle.views[static_cast<std::size_t>(one.view)].keyframe;
    if (!points_.contains(point)) continue;
    // A point that its own keyframe does not fit is none.
    if (points_.at(point).keyframe == id) {
      drop_point(point);
      ++trace.dropped;
      continue;
    }
    std::erase_if(views_.at(id).measurements, [point](const Measurement& own) { return own.point == point; });
    map_.remove_observation(point, id);
  }
  trace.bundle = std::move(bundle);
}

EngineInfo ptam_engine() {
  EngineInfo info;
  info.name = "ptam";
  info.title = "PTAM, RGB-D";
  info.summary = "Patches of keyframes found at corners, coarse then fine, with depth from the sensor.";
  info.citation =
      "Klein G., Murray D.: Parallel Tracking and Mapping for Small AR Workspaces. ISMAR 2007; with sensed "
      "depth";
  info.offers_matches = true;
  info.has_stages = true;
  info.measures.direct = info.measures.fused_points = info.measures.culled_keyframes = false;
  info.parameters = AnySection(PtamConfig());
  info.figures = {{"ptam_searched", FigureUnit::plain, "patches looked for", 0},
                  {"ptam_found", FigureUnit::share, "of these that were found"},
                  {"ptam_quality", FigureUnit::plain, "0 bad, 1 dodgy, 2 good", 0},
                  {"ptam_coarse", FigureUnit::truth, "a coarse search came first", 0},
                  {"ptam_points", FigureUnit::plain, "points in the map", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<OdometryEngine> {
    return std::make_unique<MaskedEngine>(camera, config, std::make_unique<PtamTracker>(camera, config));
  };
  return info;
}

}  // namespace stillpoint
