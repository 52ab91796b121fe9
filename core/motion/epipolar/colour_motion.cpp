#include "core/motion/epipolar/colour_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/geometry/se3.hpp"
#include "core/motion/epipolar/colour_outline.hpp"
#include "core/motion/epipolar/shared_evidence.hpp"
#include "core/motion/regions.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

// Followed points: a motion has five numbers, and most of the points may move.
constexpr int kFewestPairs = 40;
constexpr int kMinSide = 64;            // px: smaller frames hold too few cells
constexpr float kExpectedNoise = 0.3F;  // px, downsampled image: of a followed point
constexpr double kNowhere = 1e9;        // focal lengths behind infinity
constexpr float kGreyNoise = 8.0F;      // grey levels, in a window that is followed
constexpr float kEdge = 0.06F;          // smaller over larger eigenvalue, below which a point lies on an edge
constexpr double kFar = 2.0;  // longest ways within which what looks like a dynamic object is part of it
constexpr int kAbout = 10;  // quarter-size px: what lies so near is what a dynamic object is told apart from
constexpr double kSure = 3.0;      // standard deviations beyond which places lie behind infinity
constexpr double kPlainly = 4.0;   // so many times more must lie before the camera than behind infinity
constexpr double kRestless = 1.5;  // the rate's own change, measured on few frames, is taken so much larger
constexpr double kMostSay = 1.0;   // evidence of one frame
// Bounds, in px of the downsampled image, of the noise that is measured of followed points.
constexpr float kLeastNoise = 0.1F, kMostNoise = 0.4F;

Eigen::Vector3d bearing(const cv::Point2f& pixel, const Camera& camera) {
  return {(pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy, 1.0};
}

/// Each point's share of the image: many close together count for no more than few far apart, lest the most
/// textured thing be taken for the room.
std::vector<double> even_weights(const std::vector<cv::Point2f>& points, float reach) {
  std::vector<double> weights(points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const cv::Point2f apart = points[i] - points[j];
      const float squared = apart.dot(apart) / (reach * reach);
      if (squared > 9.0F) continue;
      const double near = i == j ? 0.5 : std::exp(-squared);
      weights[i] += near;
      weights[j] += near;
    }
  for (double& weight : weights) weight = 1.0 / weight;
  return weights;
}

double weighted_median(std::vector<std::pair<double, double>> value_and_weight) {
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double all = 0.0, below = 0.0;
  for (const auto& [value, weight] : value_and_weight) all += weight;
  for (const auto& [value, weight] : value_and_weight)
    if ((below += weight) >= 0.5 * all) return value;
  return 0.0;
}

/// Whether parallax plainly goes one way, so that where infinity lies is known. Before a plane, a turn of the
/// camera mistaken for its going sideways looks like places behind infinity.
bool lies_before_camera(const std::vector<BearingPair>& pairs, const RelativeOrientation& motion,
                        double sigma) {
  if (motion.rotation_only) return false;
  double before = 0.0, behind = 0.0;
  for (const BearingPair& pair : pairs) {
    if (std::abs(sampson_distance(motion, pair)) > kSure * sigma) continue;
    double unsure = 0.0;
    const double near = nearness(motion, pair, unsure), least = kSure * std::hypot(unsure, sigma);
    if (near > least) before += pair.weight;
    if (near < -least) behind += pair.weight;
  }
  return before > kPlainly * behind;
}

/// A residual by its own noise: that of all points, and what a point is free to slide where it has little
/// gradient, all the farther the longer it is followed.
float in_sigmas(const cv::Point2f& residual, double sigma, int gap, const cv::Matx22f& gradients) {
  const auto common = static_cast<float>(sigma * sigma);
  const float slide = kGreyNoise * kGreyNoise * static_cast<float>(gap);
  // (common I + slide G^-1)^-1 = (common G + slide I)^-1 G
  const cv::Matx22f sum = common * gradients + slide * cv::Matx22f::eye();
  const float determinant = sum(0, 0) * sum(1, 1) - sum(0, 1) * sum(1, 0);
  const cv::Matx22f inverse(sum(1, 1) / determinant, -sum(0, 1) / determinant, -sum(1, 0) / determinant,
                            sum(0, 0) / determinant);
  const cv::Vec2f r(residual.x, residual.y);
  return std::sqrt(std::max(0.0F, r.dot((inverse * gradients) * r)));
}

/// Gradient in one direction alone: where two outlines cross, or an edge ends, there is nothing to follow.
bool is_edge(const cv::Matx22f& gradients) {
  const float trace = gradients(0, 0) + gradients(1, 1);
  const float determinant = gradients(0, 0) * gradients(1, 1) - gradients(0, 1) * gradients(0, 1);
  return determinant < kEdge * trace * trace;  // nearly the ratio of the two eigenvalues
}

cv::Mat disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
}

/// What points near by say moves, its gaps closed; and farther off, and at its outline, what looks like it.
cv::Mat moving_pixels(const cv::Mat& image, const PropagatedEvidence& spread, const EpipolarConfig& config) {
  const cv::Mat moving = spread.evidence > config.moving_evidence;
  cv::Mat near = moving & (spread.way <= config.max_geodesic_distance);
  cv::Mat far = moving & (spread.way <= kFar * config.max_geodesic_distance);
  cv::morphologyEx(near, near, cv::MORPH_OPEN, cv::Mat());
  cv::morphologyEx(far, far, cv::MORPH_OPEN, cv::Mat());
  if (config.close_px > 0) cv::morphologyEx(near, near, cv::MORPH_CLOSE, disc(config.close_px));
  cv::Mat sure;  // an image of its own: what is near stays as it is
  cv::erode(near, sure, config.shave_px > 0 ? disc(config.shave_px) : cv::Mat::ones(1, 1, CV_8UC1));
  cv::Mat mask = settle_outline(image, sure, near | far, kAbout);
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, disc(2));
  return mask;
}

/// Regions large enough and with enough points that move, their holes filled.
cv::Mat moving_regions(const cv::Mat& mask, const std::vector<PointTrack>& tracks,
                       const std::vector<float>& shared, const EpipolarConfig& config) {
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
  std::vector<int> moving_points(static_cast<std::size_t>(count), 0);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].age < config.min_age || shared[i] <= static_cast<float>(config.moving_evidence)) continue;
    const cv::Point at(std::min(static_cast<int>(tracks[i].path.back().x / 2), mask.cols - 1),
                       std::min(static_cast<int>(tracks[i].path.back().y / 2), mask.rows - 1));
    ++moving_points[static_cast<std::size_t>(labels.at<int>(at))];
  }
  const double least = config.min_area_share * static_cast<double>(mask.total());
  cv::Mat kept = cv::Mat::zeros(mask.size(), CV_8UC1);
  for (int label = 1; label < count; ++label)
    if (stats.at<int>(label, cv::CC_STAT_AREA) >= least &&
        moving_points[static_cast<std::size_t>(label)] >= config.min_points)
      kept.setTo(255, labels == label);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(kept, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(kept, outlines, -1, cv::Scalar(255), cv::FILLED);
  return kept;
}

}  // namespace

ColourMotionDetector::ColourMotionDetector(const Camera& camera, const EpipolarConfig& config)
    : camera_(camera), config_(config) {}

/// Points seen both now and `gap` frames ago, each with its share of the image and the static_weight that it
/// stands still.
std::vector<BearingPair> ColourMotionDetector::pairs_with(int gap, bool level,
                                                          std::vector<int>& points) const {
  const std::vector<PointTrack>& tracks = tracks_.all();
  std::vector<cv::Point2f> then, now;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    if (const cv::Point2f* back = tracks[i].back(gap)) {
      points.push_back(static_cast<int>(i));
      then.push_back(*back);
      now.push_back(tracks[i].path.back());
    }
  if (points.empty()) return {};
  std::vector<cv::Point2f> straight_then = small_.undistort(then), straight_now = small_.undistort(now);
  if (level) {
    undo_shutter(small_, rates_.at(gap), then, straight_then);
    undo_shutter(small_, rates_.at(0), now, straight_now);
  }
  const std::vector<double> even = even_weights(now, static_cast<float>(4 * config_.cell_px));
  std::vector<BearingPair> pairs;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const float held = tracks[static_cast<std::size_t>(points[k])].evidence;
    const double static_weight = 0.02 + 1.0 / (1.0 + std::exp(2.0 * held));
    pairs.push_back({bearing(straight_now[k], small_), bearing(straight_then[k], small_),
                     even[k] * static_weight, after_middle(small_, now[k].y)});
  }
  return pairs;
}

void ColourMotionDetector::measure_rotation(double seconds) {
  std::vector<int> points;
  std::vector<BearingPair> pairs = pairs_with(1, false, points);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (static_cast<int>(pairs.size()) >= kFewestPairs)
    rotation = estimate_rotation(pairs, kExpectedNoise / small_.fx);
  rates_.add(so3_log(rotation), seconds, config_.far_reference);
}

void ColourMotionDetector::judge(ColourReference& reference) {
  const std::vector<PointTrack>& tracks = tracks_.all();
  const std::vector<BearingPair> pairs = pairs_with(reference.gap, true, reference.points);
  if (static_cast<int>(pairs.size()) < kFewestPairs) {
    reference.points.clear();
    return;
  }
  RelativeOrientationOptions options;
  options.sigma = kExpectedNoise / small_.fx;
  options.least_sigma = 1.2 * kLeastNoise / small_.fx;
  if (small_.readout_s != 0.0) options.rate_sigma = kRestless * rates_.sigma();
  reference.motion = estimate_relative_orientation(pairs, options);
  const bool sided = lies_before_camera(pairs, reference.motion, options.sigma);
  std::vector<std::pair<double, double>> noise;
  for (const BearingPair& pair : pairs) {
    double unsure = 0.0;
    (void)nearness(reference.motion, pair, unsure);
    const double tolerance = sided ? kSure * unsure : kNowhere;
    const Eigen::Vector2d off = epipolar_residual(reference.motion, pair, tolerance) * small_.fx;
    const Eigen::Vector2d shift = parallax(reference.motion, pair) * small_.fx;
    reference.residuals.emplace_back(static_cast<float>(off.x()), static_cast<float>(off.y()));
    reference.shifts.emplace_back(static_cast<float>(-shift.x()), static_cast<float>(-shift.y()));
    noise.emplace_back(off.norm(), pair.weight);
  }
  const double to_sigma =
      reference.motion.rotation_only ? 1.0 / 1.1774 : 1.4826;  // of Rayleigh's and of half a
                                                               // normal distribution's median
  reference.sigma = std::clamp(to_sigma * weighted_median(noise), double{kLeastNoise}, double{kMostNoise});
  for (std::size_t k = 0; k < pairs.size(); ++k)
    reference.sigmas.push_back(in_sigmas(reference.residuals[k], reference.sigma, reference.gap,
                                         tracks[static_cast<std::size_t>(reference.points[k])].gradients));
}

void ColourMotionDetector::gather_evidence(const std::vector<ColourReference>& references) {
  std::vector<PointTrack>& tracks = tracks_.all();
  std::vector<float> heard(tracks.size(), 0.0F), most(tracks.size(), -1.0F);
  std::vector<int> times(tracks.size(), 0);
  for (const ColourReference& reference : references) {
    // Over less time than to the nearest reference, what is dynamic may hardly have moved yet.
    const double still = -0.5 * std::min(1.0, static_cast<double>(reference.gap) / config_.near_reference);
    for (std::size_t k = 0; k < reference.sigmas.size(); ++k) {
      const auto i = static_cast<std::size_t>(reference.points[k]);
      if (is_edge(tracks[i].gradients)) continue;
      const double say = config_.evidence_per_sigma * (reference.sigmas[k] - config_.sigmas);
      const auto said = static_cast<float>(std::clamp(say, still, kMostSay));
      heard[i] += said;
      most[i] = std::max(most[i], said);
      ++times[i];
    }
  }
  const auto limit = static_cast<float>(config_.max_evidence);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (times[i] == 0) continue;
    // What is static in one comparison may move in another, but one alone may be wrong.
    const float now = 0.5F * (heard[i] / static_cast<float>(times[i]) + most[i]);
    tracks[i].evidence = std::clamp(static_cast<float>(config_.prior_share) * tracks[i].evidence + now,
                                    -static_cast<float>(config_.max_static_evidence), limit);
  }
}

void ColourMotionDetector::begin_anew(const cv::Size& size) {
  tracks_.clear();
  rates_.clear();
  timestamp_.reset();
  size_ = size;
  small_ = camera_.scaled_to(small_size().width, small_size().height);
}

cv::Size ColourMotionDetector::small_size() const { return size_ / kSmallerBy; }

void ColourMotionDetector::follow_points(const cv::Mat& image, std::optional<double> timestamp,
                                         ColourMotionTimes& ms) {
  Stopwatch watch;
  cv::Mat gray = image, small;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::resize(gray, small, small_size(), 0, 0, cv::INTER_AREA);
  tracks_.advance(small, config_);
  ms.points = watch.lap();
  if (small_.readout_s != 0.0 && timestamp && timestamp_ && *timestamp > *timestamp_)
    measure_rotation(*timestamp - *timestamp_);
  else
    rates_.clear();
  timestamp_ = timestamp;
}

std::vector<ColourReference> ColourMotionDetector::compare() {
  std::vector<ColourReference> references;
  Stopwatch watch;
  int last_gap = 0;
  for (const int wanted : {config_.near_reference, config_.far_reference / 2, config_.far_reference}) {
    const int gap = std::min(wanted, tracks_.frames() - 1);
    if (gap <= last_gap) continue;
    last_gap = gap;
    ColourReference reference;
    reference.gap = gap;
    judge(reference);
    reference.ms = watch.lap();
    if (!reference.residuals.empty()) references.push_back(std::move(reference));
  }
  return references;
}

void ColourMotionDetector::paint_mask(const cv::Mat& image, const std::vector<float>& shared,
                                      EpipolarTrace& trace) const {
  Stopwatch watch;
  cv::Mat smaller;
  cv::resize(image, smaller, small_size() / 2, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(smaller, smaller, {3, 3}, 0);
  const PropagatedEvidence spread = propagate_evidence(smaller, tracks_.all(), shared, config_);
  trace.evidence = spread.evidence.clone();
  trace.evidence.setTo(0.0F, spread.way > config_.max_geodesic_distance);
  trace.ms.spread = watch.lap();
  const cv::Mat small_mask =
      moving_regions(moving_pixels(smaller, spread, config_), tracks_.all(), shared, config_);
  cv::resize(small_mask, trace.mask, size_, 0, 0, cv::INTER_LINEAR);
  trace.mask = trace.mask > 127;
  LabelledRegions found = find_regions(trace.mask);
  trace.regions = std::move(found.regions);
  trace.mask_share = static_cast<double>(found.area) / static_cast<double>(trace.mask.total());
  trace.ms.mask = watch.lap();
}

EpipolarTrace ColourMotionDetector::next(const cv::Mat& image, std::optional<double> timestamp) {
  if (image.empty() || (image.type() != CV_8UC3 && image.type() != CV_8UC1))
    throw InputError("colour motion needs an 8-bit image of one or three channels");
  EpipolarTrace trace;
  if (image.size() != size_) begin_anew(image.size());
  if (std::min(size_.width, size_.height) < kMinSide) {
    trace.note = fmt::format("frames of {}x{} are too small to follow points in", size_.width, size_.height);
    return trace;
  }
  follow_points(image, timestamp, trace.ms);
  trace.references = compare();
  Stopwatch watch;
  gather_evidence(trace.references);
  const std::vector<float> shared = share_evidence(tracks_.all(), small_size(), config_);
  trace.ms.evidence = watch.lap();
  paint_mask(image, shared, trace);
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const PointTrack& track = tracks_.all()[i];
    trace.points.push_back({track.path.back() * kSmallerBy, track.age, track.evidence, shared[i]});
  }
  if (trace.references.empty())
    trace.note = tracks_.frames() < 2 ? "the first frame has none before it to be compared with"
                                      : "too few points could be followed";
  return trace;
}

}  // namespace stillpoint
