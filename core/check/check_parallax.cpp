#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/check/findings.hpp"
#include "core/geometry/camera.hpp"
#include "core/median.hpp"
#include "core/sequence/frame.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

constexpr int kPairs = 16;           // spread over the sequence
constexpr int kFewestFitting = 6;    // pairs that one reading of the depth images fits, to tell which
constexpr int kFewestPairs = 12;     // pairs with parallax, to tell that none fits
constexpr int kMostAhead = 24;       // frames between a pair's two
constexpr int kFewestPoints = 80;    // a pair, triangulated and measured
constexpr double kParallax = 0.04;   // rad: the median between a pair's rays, the camera's turn taken out
constexpr double kStillPx = 0.75;    // px: what RANSAC takes for a point that stands still
constexpr double kFits = 0.10;       // of the depth: the spread of a reading that explains a pair
constexpr double kSpreadLeft = 0.9;  // of the spread as it is, at most, that a better reading leaves
constexpr double kSurely = 2.0;      // standard errors over the pairs
constexpr double kUnrelated = 0.4;   // correlation of ranks below which depth does not go with the images

/// Points of one frame that the camera's motion to another tells the depth of, but for one common factor.
struct Triangulated {
  std::vector<double> depth;     // along the optical axis, the way between both frames being 1
  std::vector<double> measured;  // m, by the depth image
  std::vector<double> cosine;    // of the angle between the point's ray and the optical axis
};

using Points = std::vector<cv::Point2f>;

/// Corners followed from the frame at hand to a later one: in the first and in the later.
struct Followed {
  Points first, later;
};

/// Follows corners one frame on, and back as a check; those that are lost go.
void follow(const cv::Mat& from, const cv::Mat& to, Followed& corners) {
  if (corners.later.empty()) return;
  constexpr float kReturnsPx = 0.7F;  // px: what is followed well returns to a fraction of a pixel
  Points there, back;
  std::vector<unsigned char> found, found_back;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(from, to, corners.later, there, found, error);
  cv::calcOpticalFlowPyrLK(to, from, there, back, found_back, error);
  Followed kept;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const cv::Point2f off = back[i] - corners.later[i];
    if (!found[i] || !found_back[i] || std::hypot(off.x, off.y) > kReturnsPx) continue;
    kept.first.push_back(corners.first[i]);
    kept.later.push_back(there[i]);
  }
  corners = std::move(kept);
}

/// A pinhole's rays of unit depth.
std::vector<cv::Point2d> rays_of(const Camera& camera, const Points& pixels) {
  std::vector<cv::Point2d> rays;
  for (const cv::Point2f& p : camera.undistort(pixels))
    rays.emplace_back((static_cast<double>(p.x) - camera.cx) / camera.fx,
                      (static_cast<double>(p.y) - camera.cy) / camera.fy);
  return rays;
}

/// Triangulates what stands still between two frames; nothing where the camera went too little, or too few
/// points have a measured depth.
std::optional<Triangulated> triangulate(const Camera& camera, const Frame& frame, const Followed& corners) {
  if (static_cast<int>(corners.first.size()) < kFewestPoints) return std::nullopt;
  const auto here = rays_of(camera, corners.first), there = rays_of(camera, corners.later);
  cv::Mat still, rotation, translation;
  const cv::Mat essential =
      cv::findEssentialMat(here, there, 1.0, {0, 0}, cv::USAC_ACCURATE, 0.999, kStillPx / camera.fx, still);
  if (essential.rows != 3) return std::nullopt;
  cv::recoverPose(essential, here, there, rotation, translation, 1.0, {0, 0}, still);
  const cv::Matx33d turn = rotation;
  const cv::Vec3d way(translation.at<double>(0), translation.at<double>(1), translation.at<double>(2));
  Triangulated result;
  std::vector<double> angles;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const cv::Point pixel(cvRound(corners.first[i].x), cvRound(corners.first[i].y));
    if (still.at<unsigned char>(static_cast<int>(i)) == 0 ||
        !cv::Rect({}, frame.depth.size()).contains(pixel) || frame.depth.at<float>(pixel) <= 0)
      continue;
    const cv::Vec3d a = turn * cv::Vec3d(here[i].x, here[i].y, 1.0), b(there[i].x, there[i].y, 1.0);
    // Where z a + way and w b meet: crossed with b, the second goes.
    const cv::Vec3d across = a.cross(b), moved = way.cross(b);
    const double angle = std::asin(std::min(1.0, cv::norm(across) / (cv::norm(a) * cv::norm(b))));
    const double depth = -moved.dot(across) / across.dot(across);
    angles.push_back(angle);
    if (angle < kParallax / 2 || !(depth > 0)) continue;
    result.depth.push_back(depth);
    result.measured.push_back(static_cast<double>(frame.depth.at<float>(pixel)));
    result.cosine.push_back(1.0 / std::sqrt(1.0 + here[i].dot(here[i])));
  }
  if (static_cast<int>(result.depth.size()) < kFewestPoints || median_of(angles) < kParallax)
    return std::nullopt;
  return result;
}

/// The first frame from `index` on that the camera moves away from far enough.
std::optional<Triangulated> triangulated_from(const FrameSource& source, int index) {
  const Frame first = source.read(index);
  if (!first.readable() || !first.has_depth()) return std::nullopt;
  // Many corners well apart, and few frames, so that they are found again.
  constexpr int kCorners = 400, kApartPx = 8, kStep = 4;  // corners, px, frames
  constexpr double kQuality = 0.01;  // of the best corner's score, as OpenCV's examples have it
  Followed corners;
  cv::goodFeaturesToTrack(first.gray, corners.first, kCorners, kQuality, kApartPx);
  corners.later = corners.first;
  cv::Mat last = first.gray;
  for (int ahead = kStep; ahead <= kMostAhead && index + ahead < source.size(); ahead += kStep) {
    const Frame next = source.read(index + ahead);
    if (!next.readable() || next.gray.size() != last.size()) return std::nullopt;
    follow(last, next.gray, corners);
    last = next.gray;
    if (auto found = triangulate(source.camera(), first, corners)) return found;
  }
  return std::nullopt;
}

/// What depth images may hold: how the logarithm of the depth along the axis comes of what was read.
enum class Meaning { depth, range, inverse };

double log_depth(Meaning meaning, double measured, double cosine) {
  if (meaning == Meaning::inverse) return -std::log(measured);
  return std::log(measured) + (meaning == Meaning::range ? std::log(cosine) : 0.0);
}

/// By how much (robust σ, as a share of the depth) both depths differ once one common factor is allowed.
double spread_under(Meaning meaning, const Triangulated& points) {
  std::vector<double> off;
  for (std::size_t i = 0; i < points.depth.size(); ++i)
    off.push_back(log_depth(meaning, points.measured[i], points.cosine[i]) - std::log(points.depth[i]));
  const double middle = median_of(off);
  for (double& value : off) value = std::abs(value - middle);
  // Standard deviations of a normal distribution a median absolute deviation.
  constexpr double kSigmaOfMad = 1.4826;
  return kSigmaOfMad * median_of(off);
}

/// Spearman's correlation of ranks.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto ranks = [](const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](auto i, auto j) { return values[i] < values[j]; });
    std::vector<double> rank(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
    return rank;
  };
  const auto x = ranks(a), y = ranks(b);
  const double middle = 0.5 * static_cast<double>(x.size() - 1);
  double both = 0, own = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    both += (x[i] - middle) * (y[i] - middle), own += (x[i] - middle) * (x[i] - middle);
  return both / own;
}

double middle_of(std::vector<double> values) { return median_of(values); }

/// A mean over the pairs, and its standard error.
struct Mean {
  double value = 0, error = 0;
};

Mean mean_of(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  Mean mean;
  for (const double value : values) mean.value += value / count;
  for (const double value : values) mean.error += (value - mean.value) * (value - mean.value);
  mean.error = std::sqrt(mean.error / (count * (count - 1)));
  return mean;
}

/// What pairs say of the depth images, each pair by itself.
struct Evidence {
  std::vector<double> correlation;  // of ranks
  // Of pairs that one of the readings fits; of others the camera's motion was not found.
  std::vector<double> as_read;         // spread
  std::vector<double> range, inverse;  // log of the spread under another reading by that
};

Evidence gather_evidence(const FrameSource& source) {
  Evidence evidence;
  for (int i = 0; i < kPairs; ++i) {
    const auto points =
        triangulated_from(source, static_cast<int>(static_cast<long>(i) * source.size() / kPairs));
    if (!points) continue;
    evidence.correlation.push_back(rank_correlation(points->depth, points->measured));
    const double depth = spread_under(Meaning::depth, *points), range = spread_under(Meaning::range, *points),
                 inverse = spread_under(Meaning::inverse, *points);
    if (std::min({depth, range, inverse}) > kFits) continue;
    evidence.as_read.push_back(depth);
    evidence.range.push_back(std::log(range / depth));
    evidence.inverse.push_back(std::log(inverse / depth));
  }
  return evidence;
}

bool is_surely_better(const std::vector<double>& log_ratios) {
  const Mean mean = mean_of(log_ratios);
  return mean.value < std::log(kSpreadLeft) && mean.value + kSurely * mean.error < 0;
}

Finding misread(const char* what, const Evidence& evidence, const std::vector<double>& log_ratios,
                const char* remedy) {
  return {"depth",
          fmt::format("depth images hold {}: read so, parallax between {} pairs of frames agrees with "
                      "them {:.1f} times as well as now, when they are off by {:.1f} %; {}",
                      what, log_ratios.size(), std::exp(-mean_of(log_ratios).value),
                      100 * middle_of(evidence.as_read), remedy)};
}

}  // namespace

std::vector<Finding> check_parallax(const FrameSource& source) {
  if (!source.has_depth() || source.camera().is_stereo()) return {};
  const Evidence evidence = gather_evidence(source);
  const auto pairs = static_cast<int>(evidence.correlation.size()),
             fitting = static_cast<int>(evidence.as_read.size());
  if (fitting >= kFewestFitting && is_surely_better(evidence.inverse))
    return {misread("disparity or the inverse of depth, large where things are near", evidence,
                    evidence.inverse, "convert them to depth")};
  if (fitting >= kFewestFitting && is_surely_better(evidence.range))
    return {misread("the distance from the camera's centre, not the depth along its axis", evidence,
                    evidence.range,
                    "divide each value by the length of its pixel's ray, sqrt(1 + x² + y²) with "
                    "x = (u - cx) / fx and y = (v - cy) / fy")};
  if (pairs >= kFewestPairs && fitting < kFewestFitting && middle_of(evidence.correlation) < kUnrelated)
    return {
        {"depth", fmt::format("depth does not go with the images: it agrees with parallax in {} of {} pairs "
                              "of frames (correlation of ranks {:.2f}); it is of other frames, mirrored, "
                              "or of another scene",
                              fitting, pairs, middle_of(evidence.correlation))}};
  return {};
}

}  // namespace stillpoint
