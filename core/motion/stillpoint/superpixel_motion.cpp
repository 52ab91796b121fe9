#include "core/motion/stillpoint/superpixel_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>

#include "core/geometry/normal_equations.hpp"
#include "core/median.hpp"
#include "core/motion/stillpoint/axial_motion.hpp"
#include "core/motion/stillpoint/depth_warp.hpp"
#include "core/motion/stillpoint/superpixels.hpp"

namespace stillpoint {
namespace {

constexpr int kMinPixels = 12;          // of a superpixel that meet the reference
constexpr int kMinPatches = 16;         // fewer cannot tell the camera's motion
constexpr double kNoiseSpread = 4.0;    // variance a pixel, over what independent pixels would have
constexpr double kMinNoise = 1.0;       // grey levels: interpolation alone makes as much
constexpr double kShiftPrior = 3.0;     // px: no superpixel is shifted farther than the step can follow
constexpr double kRegistration = 0.09;  // px: what is static is found within this
constexpr double kTypicalShift = 0.8;   // px: how far slow dynamic objects go
constexpr double kTypicalStep = 0.04;   // m a frame: a walker's, 1.2 m/s at 30 Hz
constexpr double kDepthReach = 5.0;     // standard deviations: beyond, it is another surface

struct Sums {
  double n = 0, gx = 0, gy = 0, b = 0, gxx = 0, gxy = 0, gyy = 0, gxb = 0, gyb = 0, bb = 0;
  double depth_step = 0;
};

/// A superpixel's shift and how well it is known.
struct Measured {
  bool valid = false;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();           // px
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  // of the measurement alone
  double step = 0.0, step_variance = 1e6;                    // m, m²
  Eigen::Vector3d place = Eigen::Vector3d::Zero();           // m, in the reference's camera
};

/// The sums of the few pixels of a superpixel that lie side by side, in single precision and several at once.
class RunSums {
 public:
  /// @param gx, gy grey levels a pixel, mean slope of both views; @param b grey levels, their difference
  void add(float gx, float gy, float b, float depth_step) {
    const cv::v_float32x4 all(gx, gy, b, 1.0F);
    by_gx_ = by_gx_ + cv::v_setall_f32(gx) * all;
    by_gy_ = by_gy_ + cv::v_setall_f32(gy) * all;
    by_b_ = by_b_ + cv::v_setall_f32(b) * all;
    sum_ = sum_ + all;
    step_ += depth_step;
  }

  void give_to(Sums& sums) {
    std::array<float, cv::v_float32x4::nlanes> gx, gy, b, one;
    cv::v_store(gx.data(), by_gx_), cv::v_store(gy.data(), by_gy_), cv::v_store(b.data(), by_b_);
    cv::v_store(one.data(), sum_);
    sums.gxx += gx[0], sums.gxy += gx[1], sums.gxb += gx[2];
    sums.gyy += gy[1], sums.gyb += gy[2], sums.bb += b[2];
    sums.gx += one[0], sums.gy += one[1], sums.b += one[2], sums.n += one[3];
    sums.depth_step += step_;
    *this = {};
  }

 private:
  cv::v_float32x4 by_gx_ = cv::v_setzero_f32(), by_gy_ = by_gx_, by_b_ = by_gx_, sum_ = by_gx_;
  float step_ = 0.0F;
};

/// Sums over the pixels of each superpixel that lie within their surface here and in the reference. Across an
/// outline the gradient is of two things that parallax parts.
std::vector<Sums> gather(const RgbdView& current, const RgbdView& reference, DepthWarp& warped,
                         const cv::Mat& labels, std::size_t superpixels) {
  std::vector<Sums> sums(superpixels);
  const auto* seen = reference.surface.ptr<cv::Vec4f>();
  const DepthNoise noise = depth_noise(current);
  std::vector<float> brightness;  // of a row, where it is warped to
  for (int y = 1; y + 1 < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* here = current.surface.ptr<cv::Vec4f>(y);
    warped.warp_row(y, current.depth.ptr<float>(y));
    warped.sample_row(reference.gray, brightness);
    RunSums run;  // of the superpixel the row passes through
    int of = -1;
    for (int x = 1; x + 1 < labels.cols; ++x) {
      if (here[x][3] <= 0 || label[x] < 0 || !warped.inside(x)) continue;
      const float expected = warped.z(x);
      const cv::Vec4f& there = warped.at(seen, x);
      const float step = there[3] - expected;
      if (there[3] <= 0 || std::abs(step) > static_cast<float>(kDepthReach) * noise.sigma(expected)) continue;
      if (label[x] != of) {
        if (of >= 0) run.give_to(sums[static_cast<std::size_t>(of)]);
        of = label[x];
      }
      run.add(here[x][0] + there[0], here[x][1] + there[1],
              here[x][2] - brightness[static_cast<std::size_t>(x)], step);
    }
    if (of >= 0) run.give_to(sums[static_cast<std::size_t>(of)]);
  }
  return sums;
}

/// Sums about their means.
Sums centred(Sums s) {
  s.gxx -= s.gx * s.gx / s.n, s.gxy -= s.gx * s.gy / s.n, s.gyy -= s.gy * s.gy / s.n;
  s.gxb -= s.gx * s.b / s.n, s.gyb -= s.gy * s.b / s.n, s.bb -= s.b * s.b / s.n;
  return s;
}

std::vector<Measured> measure(const RgbdView& current, const std::vector<Superpixel>& superpixels,
                              const std::vector<Sums>& sums, const Pose& reference_from_current) {
  std::vector<double> spreads;
  for (const Sums& s : sums)
    if (s.n >= kMinPixels) spreads.push_back(std::max(0.0, centred(s).bb / s.n));
  double noise = kMinNoise * kMinNoise;
  if (!spreads.empty()) {
    const auto low = spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 3);
    std::nth_element(spreads.begin(), low, spreads.end());
    noise = std::max(noise, *low);
  }
  const DepthNoise depth_noise = stillpoint::depth_noise(current);
  const double shared = depth_noise.shared_per_m2;  // m at one metre, or nearer
  std::vector<Measured> result(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i].n < kMinPixels) continue;
    const Sums s = centred(sums[i]);
    Measured& m = result[i];
    m.valid = true;
    Eigen::Matrix2d information;
    information << s.gxx, s.gxy, s.gxy, s.gyy;
    information /= kNoiseSpread * noise;
    information.diagonal().array() += 1.0 / (kShiftPrior * kShiftPrior);
    m.covariance = information.inverse();
    m.shift = m.covariance * Eigen::Vector2d(s.gxb, s.gyb) / (kNoiseSpread * noise);
    const double z = superpixels[i].depth, sigma = depth_noise.sigma(static_cast<float>(z));
    m.step = s.depth_step / s.n;
    m.step_variance = 9.0 * sigma * sigma / s.n + std::pow(shared * std::max(1.0, z * z), 2);
    m.place = reference_from_current *
              current.camera.back_project({superpixels[i].centre.x, superpixels[i].centre.y}, z);
  }
  return result;
}

/// What a twist of the camera (translation first) does to a superpixel's shift and depth.
Eigen::Matrix<double, 3, 6> by_twist(const Camera& camera, const Eigen::Vector3d& p) {
  Eigen::Matrix3d by_point;
  by_point << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0, camera.fy / p.z(),
      -camera.fy * p.y() / (p.z() * p.z()), 0, 0, 1;
  Eigen::Matrix<double, 3, 6> j;
  j.leftCols<3>() = by_point;
  j.rightCols<3>() = -by_point * hat(p);
  return j;
}

Eigen::Vector3d residual_of(const Measured& m, const Eigen::Matrix<double, 3, 6>& j, const Vector6d& twist) {
  return Eigen::Vector3d(m.shift.x(), m.shift.y(), m.step) - j * twist;
}

Eigen::Matrix3d information_of(const Measured& m) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const Eigen::Matrix2d covariance =
      m.covariance + kRegistration * kRegistration * Eigen::Matrix2d::Identity();
  information.topLeftCorner<2, 2>() = covariance.inverse();
  information(2, 2) = 1.0 / m.step_variance;
  return information;
}

/// A superpixel's part of the normal equations.
struct TwistTerm {
  double vote = 0.0;
  Eigen::Matrix<double, 3, 6> j;
  Eigen::Vector3d off;  // shift and step
  Eigen::Matrix3d information;
  Matrix6d h;
  Vector6d g;
};
using TwistTerms = std::vector<TwistTerm>;

TwistTerms twist_terms(const Camera& camera, const std::vector<Measured>& measured,
                       const std::vector<double>& votes) {
  TwistTerms terms;
  terms.reserve(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Measured& m = measured[i];
    if (!m.valid || votes[i] <= 0) continue;
    TwistTerm& term = terms.emplace_back();
    term.vote = votes[i];
    term.j = by_twist(camera, m.place);
    term.information = information_of(m);
    const Eigen::Matrix<double, 6, 3> weighted = term.j.transpose() * term.information;
    term.h = weighted * term.j;
    term.off = {m.shift.x(), m.shift.y(), m.step};
    term.g = weighted * term.off;
  }
  return terms;
}

/// The twist most superpixels share: iteratively reweighted least squares (Geman-McClure), from the pose
/// given. Strict from the first round: all superpixels together may be met by a slide and a turn that belong
/// to none of them.
Vector6d common_twist(const TwistTerms& terms) {
  Vector6d twist = Vector6d::Zero();
  for (const double strictness : {12.0, 8.0, 6.0, 6.0, 6.0}) {
    Matrix6d h = Matrix6d::Zero();
    h.diagonal() << 2500, 2500, 2500, 1e4, 1e4, 1e4;  // the pose given is right to centimetres
    Vector6d g = Vector6d::Zero();
    for (const TwistTerm& term : terms) {
      const Eigen::Vector3d r = term.off - term.j * twist;
      const double off = 1.0 + r.dot(term.information * r) / strictness;
      const double weight = term.vote / (off * off);
      h += weight * term.h;
      g += weight * term.g;
    }
    twist = solve_ldlt(h, g);
  }
  return twist;
}

/// What registration leaves of most superpixels' shift and step beyond what measuring explains: depth and
/// colour taken at different moments, rows read one after the other, a pose that is not exact.
struct NoiseFloor {
  double shift = kRegistration;  // px
  double step = 0.0;             // m
};

NoiseFloor noise_floor_of(const std::vector<Measured>& measured,
                          const std::vector<Eigen::Vector3d>& residuals, const std::vector<double>& votes) {
  constexpr double kMedianOfTwo = 1.386, kMedianOfOne = 0.455;  // of chi-square variables
  std::vector<double> shifts, steps;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i].valid || votes[i] < 1.0 || measured[i].covariance.trace() > 0.1) continue;
    shifts.push_back(residuals[i].head<2>().squaredNorm() / kMedianOfTwo -
                     0.5 * measured[i].covariance.trace());
    steps.push_back(residuals[i].z() * residuals[i].z() / kMedianOfOne - measured[i].step_variance);
  }
  NoiseFloor noise_floor;
  if (shifts.size() < kMinPatches) return noise_floor;
  // The worse registration is, the longer its tails are.
  constexpr double kTail = 1.6, kNoTail = 0.06;
  const double usual = std::sqrt(std::max(0.0, median_of(shifts)));
  noise_floor.shift = std::max(kRegistration, kTail * usual - kNoTail);
  noise_floor.step = std::sqrt(std::max(0.0, median_of(steps)));
  return noise_floor;
}

/// log p(measured | moves) - log p(measured | is static), both Gaussian.
double log_odds_of(const Measured& m, const Eigen::Vector3d& r, const NoiseFloor& noise_floor) {
  const auto square = [](double s) { return Eigen::Matrix2d(s * s * Eigen::Matrix2d::Identity()); };
  const Eigen::Matrix2d still = m.covariance + square(noise_floor.shift),
                        moved = still + square(kTypicalShift);
  const Eigen::Vector2d shift = r.head<2>();
  const double by_shift = 0.5 * (shift.dot(still.inverse() * shift) - shift.dot(moved.inverse() * shift)) -
                          0.5 * std::log(moved.determinant() / still.determinant());
  return by_shift + step_log_odds(r.z(), m.step_variance + noise_floor.step * noise_floor.step, kTypicalStep);
}

/// Returns what registration leaves.
NoiseFloor judge(const Camera& camera, const std::vector<Measured>& measured, const Vector6d& twist,
                 const std::vector<double>& votes, std::vector<SuperpixelMotion>& superpixels) {
  std::vector<Eigen::Vector3d> residuals(measured.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < measured.size(); ++i)
    if (measured[i].valid)
      residuals[i] = residual_of(measured[i], by_twist(camera, measured[i].place), twist);
  const NoiseFloor noise_floor = noise_floor_of(measured, residuals, votes);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i].valid) continue;
    const Eigen::Vector3d& r = residuals[i];
    superpixels[i] = {{static_cast<float>(r.x()), static_cast<float>(r.y())},
                      static_cast<float>(r.z()),
                      static_cast<float>(log_odds_of(measured[i], r, noise_floor))};
  }
  return noise_floor;
}

}  // namespace

SuperpixelMotions measure_superpixels(const RgbdView& current, const ReferenceView& reference,
                                      const cv::Mat& labels, const std::vector<Superpixel>& superpixels,
                                      const cv::Mat& prior, const StillpointConfig& config) {
  constexpr int kRounds = 3;         // at most: pose and measurements, each by the other
  constexpr double kSettled = 5e-4;  // m and rad: a twentieth of a small pixel
  SuperpixelMotions result;
  result.motions.resize(superpixels.size());
  result.reference_from_current = reference.reference_from_current;
  std::vector<double> votes(superpixels.size(), 1.0);
  for (std::size_t i = 0; i < superpixels.size(); ++i) {
    const int x = std::clamp(cvRound(superpixels[i].centre.x), 0, prior.cols - 1),
              y = std::clamp(cvRound(superpixels[i].centre.y), 0, prior.rows - 1);
    if (prior.at<float>(y, x) > config.moving_log_odds) votes[i] = 0.05;
  }
  std::vector<Measured> measured;
  for (int round = 0; round < kRounds; ++round) {
    DepthWarp warp(current.camera, result.reference_from_current);
    measured =
        measure(current, superpixels, gather(current, *reference.view, warp, labels, superpixels.size()),
                result.reference_from_current);
    result.measured = static_cast<int>(std::count_if(measured.begin(), measured.end(), [](const Measured& m) {
      return m.valid && m.covariance.trace() < 2 * kTypicalShift * kTypicalShift;
    }));
    if (result.measured < kMinPatches) return result;
    const Vector6d twist = common_twist(twist_terms(current.camera, measured, votes));
    result.reference_from_current = se3_exp(twist) * result.reference_from_current;
    if (twist.norm() >= kSettled && round + 1 < kRounds) continue;
    // The last measurement is judged against what is left of the twist.
    const NoiseFloor noise_floor = judge(current.camera, measured, twist, votes, result.motions);
    if (config.find_axial_motion)
      measure_axial_motion(current, *reference.view, result.reference_from_current, labels, superpixels,
                           noise_floor.step, result.motions);
    break;
  }
  return result;
}

}  // namespace stillpoint
