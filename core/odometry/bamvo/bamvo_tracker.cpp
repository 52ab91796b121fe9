#include "core/odometry/bamvo/bamvo_tracker.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/geometry/pixel_conventions.hpp"
#include "core/odometry/engines.hpp"

namespace stillpoint {
namespace {

constexpr double kOutlierSigmas = 2.5;  // for counting alone: the t distribution weighs, and drops nothing

}  // namespace

BamvoTracker::BamvoTracker(const Camera& camera, const Config& config)
    : rectifier_(camera), config_(config.of<BamvoConfig>().for_camera(camera)) {}

bool BamvoTracker::adopt(const Config& config) {
  const auto& wanted = config.of<BamvoConfig>();
  const bool serves = wanted.image_factor == config_.image_factor;
  if (serves) config_ = wanted.for_camera(rectifier_.pinhole());
  return serves;
}

struct BamvoTracker::Prepared final : TrackerPreparation {
  Levels levels;  // without weights
};

std::shared_ptr<const TrackerPreparation> BamvoTracker::prepare(const cv::Mat& gray,
                                                                const cv::Mat& depth) const {
  auto prepared = std::make_shared<Prepared>();
  prepared->levels.push_back(make_dense_view(gray, depth, rectifier_.pinhole(), config_.image_factor));
  prepared->levels.push_back(halved(prepared->levels.front()));
  return prepared;
}

BamvoTracker::Levels BamvoTracker::levels_of(const TrackerFrame& frame) const {
  Levels levels = static_cast<const Prepared&>(*frame.prepared).levels;
  levels.front().weight = picked(frame.weight, config_.image_factor);
  levels.back().weight = picked(levels.front().weight, 2);
  return levels;
}

TrackerResult BamvoTracker::begin(const TrackerFrame& frame, FrameRecord&) {
  TrackerResult result;
  if (frame.depth.empty() || cv::countNonZero(frame.depth) < config_.min_pixels) {
    result.why_lost = "the frame has too little depth to begin with";
    return result;
  }
  Keyframe keyframe;
  keyframe.frame_index = frame.image.index;
  keyframe.timestamp = frame.image.timestamp;
  keyframe.features = std::make_shared<const FeatureSet>();
  map_.add_keyframe(std::move(keyframe));
  remember(frame, levels_of(frame), Pose::Identity());
  result.rms_px = std::numeric_limits<double>::quiet_NaN();
  return result;
}

TrackerResult BamvoTracker::track(const TrackerFrame& frame, const Pose& predicted) const {
  TrackerResult result;
  result.rms_px = std::numeric_limits<double>::quiet_NaN();
  if (frame.depth.empty()) {
    result.why_lost = "the frame has no depth";
    return result;
  }
  const Levels target = levels_of(frame);
  const Pose& last = past_.back().camera_from_world;
  auto trace = std::make_shared<BamvoTrace>(rectifier_, last_index_);
  trace->gray = last_gray_;
  trace->model = model_;
  trace->past_depths = static_cast<int>(past_.size());
  trace->foreground_change_m = config_.foreground_change_m;
  trace->alignment = align_dense(last_, target, predicted * last.inverse(), config_, frame.threads);
  const DenseAlignment& alignment = trace->alignment;
  result.why_lost = alignment.failure;
  if (const double motion = se3_log(alignment.target_from_reference).norm();
      result.found() && motion > config_.max_motion) {
    result.why_lost = fmt::format("a motion of {:.2f} since the last frame is no motion; at most {:.2f} is",
                                  motion, config_.max_motion);
    result.held = last;  // T = identity
  }
  result.camera_from_world = alignment.target_from_reference * last;
  result.iterations = alignment.iterations;
  result.matches = alignment.counted;
  if (!alignment.residual.empty()) {
    const double far = kOutlierSigmas * alignment.sigma;
    for (auto r = alignment.residual.begin<float>(); r != alignment.residual.end<float>(); ++r)
      if (std::abs(static_cast<double>(*r) - alignment.mean) <= far) ++result.inliers;
    result.features = sampled(target, alignment);
  }
  const auto pixels = static_cast<double>(last_.front().gray.total());
  result.figures = {static_cast<double>(alignment.counted) / pixels, 255.0 * alignment.sigma,
                    percent_set(model_.foreground) / 100.0};
  result.trace = std::move(trace);
  return result;
}

/// A sample of the pixels that were aligned, for whoever looks at features: where this frame shows them.
std::vector<FeatureRecord> BamvoTracker::sampled(const Levels& target,
                                                 const DenseAlignment& alignment) const {
  constexpr int kEvery = 8;  // pixels of the finest level
  const DenseView &from = last_.front(), &to = target.front();
  std::vector<FeatureRecord> features;
  for (int y = kEvery / 2; y < from.depth.rows; y += kEvery)
    for (int x = kEvery / 2; x < from.depth.cols; x += kEvery) {
      const float z = from.depth.at<float>(y, x);
      if (z < static_cast<float>(config_.nearest_m) || z > static_cast<float>(config_.farthest_m)) continue;
      const Eigen::Vector3d p =
          alignment.target_from_reference * from.camera.back_project({x, y}, static_cast<double>(z));
      if (p.z() <= 0.0) continue;
      const Eigen::Vector2d at = to.camera.project(p);
      const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
      if (u < 0 || v < 0 || u >= to.depth.cols || v >= to.depth.rows) continue;
      FeatureRecord feature;
      const Eigen::Vector2d full = upsampled(at, static_cast<double>(config_.image_factor));
      feature.pixel =
          rectifier_.to_image(cv::Point2f(static_cast<float>(full.x()), static_cast<float>(full.y())));
      const Camera& camera = rectifier_.pinhole();
      if (feature.pixel.x < 0 || feature.pixel.y < 0 ||
          feature.pixel.x > static_cast<float>(camera.width - 1) ||
          feature.pixel.y > static_cast<float>(camera.height - 1))
        continue;
      feature.residual_px = std::numeric_limits<float>::quiet_NaN();
      feature.depth = to.depth.at<float>(v, u);
      feature.static_weight = to.weight.empty() ? 1.0F : to.weight.at<float>(v, u);
      const float residual = alignment.residual.at<float>(y, x);
      if (feature.static_weight <= 0.0F)
        feature.fate = FeatureFate::removed;
      else if (!std::isnan(residual))
        feature.fate =
            std::abs(static_cast<double>(residual) - alignment.mean) <= kOutlierSigmas * alignment.sigma
                ? FeatureFate::inlier
                : FeatureFate::outlier;
      features.push_back(feature);
    }
  return features;
}

void BamvoTracker::remember(const TrackerFrame& frame, Levels levels, const Pose& camera_from_world) {
  past_.push_back({levels.back().depth, camera_from_world});
  while (static_cast<int>(past_.size()) > config_.history) past_.pop_front();
  model_ = model_background({past_.begin(), past_.end()}, levels.back().camera, config_);
  // The model has the coarse level's size.
  for (DenseView& level : levels) {
    cv::Mat background;
    cv::resize(model_.weight, background, level.gray.size(), 0, 0, cv::INTER_NEAREST);
    level.weight = level.weight.empty() ? background : cv::Mat(background.mul(level.weight));
  }
  last_ = std::move(levels);
  last_gray_ = frame.gray;
  last_index_ = frame.image.index;
  lost_ = 0;
}

void BamvoTracker::keep(const TrackerFrame& frame, TrackerResult& result, FrameRecord&) {
  remember(frame, levels_of(frame), result.camera_from_world);
}

void BamvoTracker::lose(const TrackerFrame& frame, const TrackerResult& result) {
  ++lost_;
  if (!result.held && lost_ <= config_.patience) return;
  if (frame.depth.empty()) return;
  const Pose held = result.held ? *result.held : past_.back().camera_from_world;
  past_.clear();
  remember(frame, levels_of(frame), held);
}

EngineInfo bamvo_engine() {
  EngineInfo info;
  info.name = "bamvo";
  info.title = "BaMVO";
  info.summary =
      "Dense alignment with the frame before, each pixel weighed by how well its past depths agree.";
  info.citation =
      "Kim D.-H., Kim J.-H.: Effective Background Model-Based RGB-D Dense Visual Odometry in a Dynamic "
      "Environment. IEEE T-RO 32(6), 2016";
  info.has_stages = true;
  // Frames are aligned with frames: there is no map of points, and nothing to adjust.
  info.measures.direct = info.measures.points = info.measures.fused_points = info.measures.bundle = false;
  info.measures.culled_keyframes = false;
  info.parameters = AnySection(BamvoConfig());
  info.figures = {
      {"bamvo_counted", FigureUnit::share, "of the pixels that counted in the alignment"},
      {"bamvo_sigma", FigureUnit::plain, "scale of the residuals, grey levels", 3},
      {"bamvo_foreground", FigureUnit::share, "of the frame before that its model calls foreground"}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<OdometryEngine> {
    return std::make_unique<MaskedEngine>(camera, config, std::make_unique<BamvoTracker>(camera, config));
  };
  return info;
}

}  // namespace stillpoint
