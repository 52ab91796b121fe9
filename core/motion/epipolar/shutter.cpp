#include "core/motion/epipolar/shutter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace stillpoint {

void AngularVelocities::add(const Eigen::Vector3d& turn, double seconds, int most) {
  if (static_cast<int>(turns_.size()) > most) turns_.erase(turns_.begin());
  turns_.push_back({-turn / seconds, seconds});
}

Eigen::Vector3d AngularVelocities::at(int back) const {
  const int count = static_cast<int>(turns_.size());
  if (count == 0) return Eigen::Vector3d::Zero();
  const int after = std::clamp(count - back, std::min(1, count - 1), count - 1);
  const Turn& b = turns_[static_cast<std::size_t>(after)];
  if (after == 0) return b.rate;
  const Turn& a = turns_[static_cast<std::size_t>(after - 1)];
  // Each mean holds in the middle of its time; seconds from the middle of `a` to the frame.
  double from_a = 0.5 * a.seconds;
  if (back == 0) from_a += b.seconds;
  if (back == count) from_a -= a.seconds;
  const double share = from_a / (0.5 * (a.seconds + b.seconds));
  return a.rate + share * (b.rate - a.rate);
}

double AngularVelocities::sigma() const {
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double sum = 0.0;
  int changes = 0;
  for (const Turn& turn : turns_) {
    if (changes > 0 || turns_.size() == 1) sum += (turn.rate - before).squaredNorm();
    before = turn.rate;
    ++changes;
  }
  return changes == 0 ? 0.0 : std::sqrt(sum / 3.0 / std::max(1, changes - 1));
}

void undo_shutter(const Camera& camera, const Eigen::Vector3d& rate, const std::vector<cv::Point2f>& rows,
                  std::vector<cv::Point2f>& straight) {
  if (camera.readout_s == 0.0 || rate.isZero()) return;
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const Eigen::Vector3d seen = camera.back_project({straight[i].x, straight[i].y}, 1.0);
    const Eigen::Vector2d at_middle =
        camera.project(seen - after_middle(camera, rows[i].y) * rate.cross(seen));
    straight[i] = {static_cast<float>(at_middle.x()), static_cast<float>(at_middle.y())};
  }
}

}  // namespace stillpoint
