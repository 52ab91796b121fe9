// Points of DSO's window and who leaves it: what needs no solving.
#include <algorithm>
#include <cmath>

#include "core/odometry/dso/dso_window.hpp"

namespace stillpoint {
namespace {

constexpr double kNearest = 0.1;  // m: nearer, nothing is measured, and pixels run off to infinity

}  // namespace

DsoTransfer::DsoTransfer(const Camera& camera, const Pose& target_from_host, const Vector6d& host_velocity,
                         const Vector6d& target_velocity)
    : camera_(camera),
      target_from_host_(target_from_host),
      host_velocity_(host_velocity),
      target_velocity_(target_velocity),
      rolls_(camera.readout_s != 0.0 && !(host_velocity.isZero() && target_velocity.isZero())) {}

std::optional<DsoTransfer::Place> DsoTransfer::operator()(double u, double v, double inverse_depth) const {
  if (!(inverse_depth > 0.0)) return std::nullopt;
  Place place;
  place.in_host = camera_.back_project({u, v}, 1.0 / inverse_depth);
  if (rolls_)  // to where the host's middle row would have it
    place.in_host -=
        after_middle(v) * (host_velocity_.head<3>() + host_velocity_.tail<3>().cross(place.in_host));
  place.in_target = target_from_host_ * place.in_host;
  if (place.in_target.z() < kNearest) return std::nullopt;
  Eigen::Vector2d pixel = camera_.project(place.in_target);
  if (rolls_) {
    place.in_target += after_middle(pixel.y()) *
                       (target_velocity_.head<3>() + target_velocity_.tail<3>().cross(place.in_target));
    if (place.in_target.z() < kNearest) return std::nullopt;
    pixel = camera_.project(place.in_target);
  }
  place.x = pixel.x();
  place.y = pixel.y();
  return place;
}

int DsoWindow::index_of(int keyframe) const {
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i].keyframe == keyframe) return static_cast<int>(i);
  return -1;
}

int DsoWindow::drop_lost_points() {
  const int newest = frames.back().keyframe;
  const auto before = points.size();
  std::erase_if(points, [&](const DsoPoint& point) {
    return index_of(point.host) < 0 || (point.seen == 0 && point.host != newest);
  });
  return static_cast<int>(before - points.size());
}

std::vector<int> DsoWindow::to_leave(const DsoConfig& config) const {
  const int count = static_cast<int>(frames.size());
  const DsoFrame& newest = frames.back();
  std::vector<int> leaving;
  for (int i = 0; i + 1 < count; ++i) {
    const DsoFrame& frame = frames[static_cast<std::size_t>(i)];
    const auto left = std::count_if(points.begin(), points.end(), [&](const DsoPoint& point) {
      return point.host == frame.keyframe && point.seen > 0;
    });
    const bool spent = static_cast<double>(left) < config.least_left * frame.points_made;
    const bool other_light = std::abs(newest.affine.a - frame.affine.a) > config.max_gain_step;
    if ((spent || other_light) && count - static_cast<int>(leaving.size()) > config.least_window)
      leaving.push_back(i);
  }
  if (count - static_cast<int>(leaving.size()) <= config.window) return leaving;
  // The newest stay, the rest spread over the room: out goes who crowds the others and is far from the
  // newest.
  constexpr double kApart = 1e-5;
  const auto centre = [](const DsoFrame& frame) -> Eigen::Vector3d {
    return frame.camera_from_world.inverse().translation();
  };
  int worst = -1;
  double most = 0.0;
  for (int i = 0; i + 1 < count; ++i) {
    const DsoFrame& frame = frames[static_cast<std::size_t>(i)];
    if (frame.keyframe == 0 || std::find(leaving.begin(), leaving.end(), i) != leaving.end()) continue;
    double crowd = 0.0;
    for (const DsoFrame& other : frames)
      if (other.keyframe != frame.keyframe) crowd += 1.0 / (kApart + (centre(frame) - centre(other)).norm());
    const double score = std::sqrt((centre(frame) - centre(newest)).norm()) * crowd;
    if (worst < 0 || score > most) worst = i, most = score;
  }
  if (worst >= 0) leaving.push_back(worst);
  std::sort(leaving.begin(), leaving.end());
  return leaving;
}

void DsoWindow::drop_frame(int index) {
  const int keyframe = frames[static_cast<std::size_t>(index)].keyframe;
  std::erase_if(points, [keyframe](const DsoPoint& point) { return point.host == keyframe; });
  frames.erase(frames.begin() + index);
}

std::optional<DsoPoint> make_dso_point(const DsoFrame& host, int x, int y, double depth_m,
                                       const DsoConfig& config) {
  const cv::Mat& image = host.image->levels.front();
  if (!inside(image, x, y, kDsoReach)) return std::nullopt;
  DsoPoint point;
  point.host = host.keyframe;
  point.u = x;
  point.v = y;
  point.inverse_depth = point.sensed_inverse_depth = 1.0 / depth_m;
  for (std::size_t i = 0; i < kDsoPattern.size(); ++i) {
    const cv::Vec3f& pixel = image.at<cv::Vec3f>(y + kDsoPattern[i][1], x + kDsoPattern[i][0]);
    point.brightness[i] = pixel[0];
    point.softness[i] = static_cast<float>(gradient_weight(
        static_cast<double>(pixel[1]), static_cast<double>(pixel[2]), config.gradient_softness));
  }
  point.static_weight = host.weight.empty() ? 1.0F : host.weight.at<float>(y, x);
  return point;
}

}  // namespace stillpoint
