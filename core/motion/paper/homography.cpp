#include "core/motion/paper/homography.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "core/geometry/levenberg_marquardt.hpp"
#include "core/geometry/normal_equations.hpp"

namespace stillpoint {
namespace {

/// No frame-to-frame motion magnifies a part of the image's area by more than this, or shrinks it by more.
constexpr double kMaxAreaScale = 10.0;

/// Hartley's normalisation: the centroid in the origin, the mean distance from it sqrt(2).
struct Normalisation {
  cv::Matx33d matrix;  ///< normalised from pixels
  double scale = 1.0;  ///< normalised units a pixel
};

Normalisation normalisation(const std::vector<Track>& tracks, cv::Point2f Track::*end) {
  cv::Point2d centre;
  for (const Track& track : tracks) centre += cv::Point2d(track.*end);
  centre /= static_cast<double>(tracks.size());
  double distance = 0.0;
  for (const Track& track : tracks) distance += cv::norm(cv::Point2d(track.*end) - centre);
  const double scale = std::sqrt(2.0) * static_cast<double>(tracks.size()) / std::max(distance, 1e-9);
  return {{scale, 0, -scale * centre.x, 0, scale, -scale * centre.y, 0, 0, 1}, scale};
}

using Parameters = Eigen::Matrix<double, 8, 1>;  ///< row by row; the ninth is 1

/// Eq. (4) in Hartley-normalised coordinates, and its residuals in px.
class ReprojectionProblem {
 public:
  ReprojectionProblem(const std::vector<Track>& inliers, const Normalisation& source,
                      const Normalisation& destination)
      : px_per_unit_(1.0 / destination.scale) {
    pairs_.reserve(inliers.size());
    for (const Track& track : inliers)
      pairs_.push_back({carry(source.matrix, track.from), carry(destination.matrix, track.to)});
  }

  /// Half the sum of squared residuals, px²; not finite where a point lies on the horizon.
  [[nodiscard]] double cost(const Parameters& h) const {
    double sum = 0.0;
    for (const Pair& pair : pairs_) {
      const cv::Point2d off = carried(h, pair.from).at - pair.to;
      sum += off.dot(off);
    }
    return 0.5 * px_per_unit_ * px_per_unit_ * sum;
  }

  struct Normal {
    Eigen::Matrix<double, 8, 8> h = Eigen::Matrix<double, 8, 8>::Zero();  ///< JᵀJ
    Parameters g = Parameters::Zero();                                    ///< -Jᵀr
  };

  [[nodiscard]] Normal normal_equations(const Parameters& h) const {
    // A residual along u changes with the first three parameters by (x, y, 1), one along v with the next
    // three by the same, and both with the last two: all that is summed are products of these.
    Eigen::Matrix3d points = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> across_u = Eigen::Matrix<double, 3, 2>::Zero(), across_v = across_u;
    Eigen::Matrix2d depths = Eigen::Matrix2d::Zero();
    Normal normal;
    for (const Pair& pair : pairs_) {
      const Carried carried = this->carried(h, pair.from);
      const double weight = px_per_unit_ * carried.scale;
      const Eigen::Vector3d point = weight * Eigen::Vector3d(pair.from.x, pair.from.y, 1.0);
      const Eigen::Vector2d depth = -point.head<2>();
      const double u = carried.at.x, v = carried.at.y;
      points.noalias() += point * point.transpose();
      across_u.noalias() += (u * point) * depth.transpose();
      across_v.noalias() += (v * point) * depth.transpose();
      depths.noalias() += ((u * u + v * v) * depth) * depth.transpose();
      const cv::Point2d off = px_per_unit_ * (carried.at - pair.to);
      normal.g.head<3>() -= off.x * point;
      normal.g.segment<3>(3) -= off.y * point;
      normal.g.tail<2>() -= (off.x * u + off.y * v) * depth;
    }
    normal.h.topLeftCorner<3, 3>() = points;
    normal.h.block<3, 3>(3, 3) = points;
    normal.h.block<3, 2>(0, 6) = across_u;
    normal.h.block<3, 2>(3, 6) = across_v;
    normal.h.block<2, 3>(6, 0) = across_u.transpose();
    normal.h.block<2, 3>(6, 3) = across_v.transpose();
    normal.h.bottomRightCorner<2, 2>() = depths;
    return normal;
  }

 private:
  struct Pair {
    cv::Point2d from, to;
  };
  struct Carried {
    cv::Point2d at;
    double scale;  ///< 1 / depth
  };

  static Carried carried(const Parameters& h, const cv::Point2d& p) {
    const double scale = 1.0 / (h[6] * p.x + h[7] * p.y + 1.0);
    return {{(h[0] * p.x + h[1] * p.y + h[2]) * scale, (h[3] * p.x + h[4] * p.y + h[5]) * scale}, scale};
  }

  std::vector<Pair> pairs_;
  double px_per_unit_;  ///< of the destination
};

/// Parameters on their way to the least reprojection error.
class HomographyDescent {
 public:
  HomographyDescent(const ReprojectionProblem& problem, const Parameters& start)
      : problem_(problem), at_(start) {}

  double linearise() {
    normal_ = problem_.normal_equations(at_);
    return problem_.cost(at_);
  }
  double step(double damping) {
    before_ = at_, normal_before_ = normal_;
    Eigen::Matrix<double, 8, 8> damped = normal_.h;
    damped.diagonal() *= 1.0 + damping;
    change_ = solve_ldlt<8>(damped, normal_.g);
    const double foreseen = change_.dot(normal_.g - 0.5 * (normal_.h * change_));
    if (foreseen > 0) at_ += change_;
    return foreseen;
  }
  void undo() { at_ = before_, normal_ = normal_before_; }
  [[nodiscard]] bool converged(double cost, double next) const {
    return change_.norm() <= 1e-8 * (before_.norm() + 1e-8) || std::abs(cost - next) <= 1e-6 * cost;
  }
  [[nodiscard]] const Parameters& at() const { return at_; }

 private:
  const ReprojectionProblem& problem_;
  Parameters at_, before_ = at_, change_ = Parameters::Zero();
  ReprojectionProblem::Normal normal_, normal_before_;
};

std::vector<Track> inliers_of(const std::vector<Track>& tracks) {
  std::vector<Track> inliers;
  std::copy_if(tracks.begin(), tracks.end(), std::back_inserter(inliers),
               [](const Track& track) { return track.inlier; });
  return inliers;
}

/// Marks the tracks within `threshold_px` of where the homography carries them.
void mark_inliers(std::vector<Track>& tracks, const cv::Matx33d& homography, double threshold_px) {
  for (Track& track : tracks)
    track.inlier =
        !track.removed && cv::norm(carry(homography, track.from) - cv::Point2d(track.to)) <= threshold_px;
}

}  // namespace

double corner_shift_px(const cv::Matx33d& before, const cv::Matx33d& after, const cv::Size& size) {
  const double right = size.width - 1, bottom = size.height - 1;
  double furthest = 0.0;
  for (const cv::Point2d corner : {cv::Point2d(0, 0), {right, 0}, {0, bottom}, {right, bottom}})
    furthest = std::max(furthest, cv::norm(carry(before, corner) - carry(after, corner)));
  return furthest;
}

double reprojection_error_px(const cv::Matx33d& homography, const std::vector<Track>& tracks) {
  if (tracks.empty()) return 0.0;
  double sum = 0.0;
  for (const Track& track : tracks) {
    const cv::Point2d off = carry(homography, track.from) - cv::Point2d(track.to);
    sum += off.dot(off);
  }
  return std::sqrt(sum / static_cast<double>(tracks.size()));
}

bool is_plausible(const cv::Matx33d& homography, const cv::Size& image) {
  for (const double value : homography.val)
    if (!std::isfinite(value)) return false;
  const double right = image.width - 1, bottom = image.height - 1;
  const auto depth_at = [&homography](double x, double y) {
    return homography(2, 0) * x + homography(2, 1) * y + homography(2, 2);
  };
  const double centre_depth = depth_at(right / 2, bottom / 2);
  if (std::abs(centre_depth) < 1e-12) return false;
  // The map's area scale at a point is det(H) / depth³; its sign tells a fold, and the depth's a horizon.
  const double determinant = cv::determinant(homography) / std::pow(centre_depth, 3);
  for (const cv::Point2d corner : {cv::Point2d(0, 0), {right, 0}, {0, bottom}, {right, bottom}}) {
    const double depth = depth_at(corner.x, corner.y) / centre_depth;
    if (depth <= 1e-3) return false;
    const double area_scale = determinant / (depth * depth * depth);
    if (area_scale < 1.0 / kMaxAreaScale || area_scale > kMaxAreaScale) return false;
  }
  return true;
}

std::optional<cv::Matx33d> ransac_homography(const std::vector<Track>& tracks, const PaperConfig& config) {
  std::vector<cv::Point2f> from, to;
  for (const Track& track : tracks) {
    if (track.removed) continue;
    from.push_back(track.from);
    to.push_back(track.to);
  }
  if (from.size() < 4) return std::nullopt;
  cv::UsacParams ransac;
  ransac.confidence = config.ransac_confidence;
  ransac.isParallel = false;
  ransac.loMethod = cv::LOCAL_OPTIM_NULL;
  ransac.maxIterations = config.ransac_iterations;
  ransac.randomGeneratorState = 0;
  ransac.sampler = cv::SAMPLING_UNIFORM;
  ransac.score = cv::SCORE_METHOD_RANSAC;
  ransac.threshold = config.ransac_threshold_px;
  const cv::Mat found = cv::findHomography(from, to, cv::noArray(), ransac);
  if (found.empty()) return std::nullopt;
  return cv::Matx33d(found);
}

RefinedHomography refine_homography(const cv::Matx33d& start, const std::vector<Track>& inliers,
                                    int max_iterations) {
  if (inliers.size() < 4 || max_iterations == 0) return {start, 0};
  const Normalisation source = normalisation(inliers, &Track::from);
  const Normalisation destination = normalisation(inliers, &Track::to);
  cv::Matx33d normalised = destination.matrix * start * source.matrix.inv();
  if (std::abs(normalised(2, 2)) < 1e-12) return {start, 0};
  normalised *= 1.0 / normalised(2, 2);

  const ReprojectionProblem problem(inliers, source, destination);
  HomographyDescent descent(problem, Eigen::Map<const Parameters>(normalised.val));
  const int steps = levenberg_marquardt(descent, max_iterations).tried;
  if (!descent.at().allFinite()) return {start, 0};
  std::copy_n(descent.at().data(), 8, normalised.val);
  cv::Matx33d refined = destination.matrix.inv() * normalised * source.matrix;
  refined *= 1.0 / refined(2, 2);
  return {refined, steps};
}

HomographyEstimate estimate_homography(std::vector<Track>& tracks, const cv::Size& image,
                                       const PaperConfig& config, const cv::Matx33d& fall_back) {
  HomographyEstimate estimate;
  estimate.matrix = fall_back;
  for (Track& track : tracks) track.inlier = false;
  const auto usable = std::count_if(tracks.begin(), tracks.end(), [](const Track& t) { return !t.removed; });
  if (usable < config.min_tracks) return estimate;
  const std::optional<cv::Matx33d> robust = ransac_homography(tracks, config);
  if (!robust || !is_plausible(*robust, image)) return estimate;

  mark_inliers(tracks, *robust, config.ransac_threshold_px);
  const std::vector<Track> inliers = inliers_of(tracks);
  estimate.ransac_inliers = static_cast<int>(inliers.size());
  if (estimate.ransac_inliers < config.min_tracks) return estimate;
  const RefinedHomography refined = refine_homography(*robust, inliers, config.refine_iterations);
  if (!is_plausible(refined.matrix, image)) return estimate;

  estimate.matrix = refined.matrix;
  estimate.valid = true;
  estimate.ransac_error_px = reprojection_error_px(*robust, inliers);
  estimate.refined_error_px = reprojection_error_px(refined.matrix, inliers);
  estimate.refine_iterations = refined.iterations;
  mark_inliers(tracks, refined.matrix, config.ransac_threshold_px);
  return estimate;
}

}  // namespace stillpoint
