#include "core/evaluation/pose_series.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/median.hpp"

namespace stillpoint {
namespace {

constexpr double kGap = 4.0;  // median steps, from which on poses are missing between
constexpr double kDegreesOfRadian = 180.0 / std::numbers::pi;  // degrees a radian

std::array<double, 3> angles_of(const Eigen::Matrix3d& r) {
  return {kDegreesOfRadian * std::atan2(r(2, 1), r(2, 2)),
          kDegreesOfRadian * std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
          kDegreesOfRadian * std::atan2(r(1, 0), r(0, 0))};
}

double usual_step(const Trajectory& trajectory) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    steps.push_back(trajectory[i].timestamp - trajectory[i - 1].timestamp);
  return steps.empty() ? 0.0 : median_of(steps);
}

void push_gap(PoseSeries& series, double time) {
  series.time.push_back(time);
  for (auto* of : {&series.position, &series.angle})
    for (std::vector<double>& values : *of) values.push_back(std::nan(""));
  series.speed.push_back(std::nan(""));
}

}  // namespace

PoseSeries pose_series(const Trajectory& trajectory, double start) {
  PoseSeries series;
  const double usual = usual_step(trajectory);
  std::array<double, 3> turned{};  // degrees, whole turns so far
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const StampedPose& pose = trajectory[i];
    const double step = i > 0 ? pose.timestamp - trajectory[i - 1].timestamp : 0.0;
    const bool missing = i > 0 && step > kGap * usual;
    if (missing) push_gap(series, pose.timestamp - 0.5 * step - start);
    series.time.push_back(pose.timestamp - start);
    for (std::size_t k = 0; k < 3; ++k)
      series.position[k].push_back(pose.world_from_camera.translation()[static_cast<Eigen::Index>(k)]);
    const std::array<double, 3> now = angles_of(pose.world_from_camera.linear());
    if (i > 0) {
      const std::array<double, 3> before = angles_of(trajectory[i - 1].world_from_camera.linear());
      for (std::size_t k = 0; k < 3; ++k) turned[k] -= 360.0 * std::round((now[k] - before[k]) / 360.0);
    }
    for (std::size_t k = 0; k < 3; ++k) series.angle[k].push_back(now[k] + turned[k]);
    const double way =
        i > 0 ? (pose.world_from_camera.translation() - trajectory[i - 1].world_from_camera.translation())
                    .norm()
              : 0.0;
    series.speed.push_back(step > 0.0 && !missing ? way / step : std::nan(""));
  }
  return series;
}

PoseSeries difference(const PoseSeries& series, const PoseSeries& reference) {
  PoseSeries result = series;
  for (std::size_t i = 0; i < result.time.size() && i < reference.time.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      result.position[k][i] -= reference.position[k][i];
      result.angle[k][i] = std::remainder(result.angle[k][i] - reference.angle[k][i], 360.0);
    }
    result.speed[i] -= reference.speed[i];
  }
  return result;
}

}  // namespace stillpoint
