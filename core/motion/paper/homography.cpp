#include "core/motion/paper/homography.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>

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

/// One inlier's residual of eq. (4), px: where H carries `from`, less `to`; both Hartley-normalised on the
/// way.
struct ReprojectionResidual final : ceres::SizedCostFunction<2, 8> {
  ReprojectionResidual(const cv::Point2d& from, const cv::Point2d& to, double px_per_unit)
      : from_(from), to_(to), px_per_unit_(px_per_unit) {}

  static ceres::CostFunction* create(const cv::Point2d& from, const cv::Point2d& to, double px_per_unit) {
    return new ReprojectionResidual(from, to, px_per_unit);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const double* h = parameters[0];
    const double x = from_.x, y = from_.y;
    const double scale = 1.0 / (h[6] * x + h[7] * y + 1.0);
    const double u = (h[0] * x + h[1] * y + h[2]) * scale;
    const double v = (h[3] * x + h[4] * y + h[5]) * scale;
    residuals[0] = px_per_unit_ * (u - to_.x);
    residuals[1] = px_per_unit_ * (v - to_.y);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      const double g = px_per_unit_ * scale;
      const std::array<double, 16> rows = {g * x, g * y, g, 0,     0,     0, -g * x * u, -g * y * u,
                                           0,     0,     0, g * x, g * y, g, -g * x * v, -g * y * v};
      std::copy(rows.begin(), rows.end(), jacobians[0]);
    }
    return std::isfinite(residuals[0]) && std::isfinite(residuals[1]);
  }

 private:
  cv::Point2d from_, to_;  // normalised
  double px_per_unit_;     // of the destination
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

  std::array<double, 8> h{};
  std::copy_n(normalised.val, 8, h.begin());
  ceres::Problem problem;
  for (const Track& track : inliers)
    problem.AddResidualBlock(
        ReprojectionResidual::create(carry(source.matrix, track.from), carry(destination.matrix, track.to),
                                     1 / destination.scale),
        nullptr, h.data());
  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return {start, 0};

  std::copy(h.begin(), h.end(), normalised.val);
  cv::Matx33d refined = destination.matrix.inv() * normalised * source.matrix;
  refined *= 1.0 / refined(2, 2);
  return {refined, summary.num_successful_steps + summary.num_unsuccessful_steps};
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
