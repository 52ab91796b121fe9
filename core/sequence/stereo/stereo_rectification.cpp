#include "core/sequence/stereo/stereo_rectification.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"

namespace stillpoint {
namespace {

constexpr double kParallel = 1e-6;  // rad and relative: what rounding leaves of a rectified pair
constexpr double kLeastAside =
    0.70710;  // of the baseline, across the image: more lies above or below, not beside

cv::Mat distortion_of(const Camera& c) { return (cv::Mat_<double>(1, 5) << c.k1, c.k2, c.p1, c.p2, c.k3); }

bool is_like(const Camera& a, const Camera& b) {
  const auto same = [](double x, double y) { return std::abs(x - y) <= kParallel * std::abs(x); };
  return same(a.fx, b.fx) && same(a.fy, b.fy) && same(a.cx, b.cx) && same(a.cy, b.cy);
}

}  // namespace

StereoRectification::StereoRectification(const Camera& left, const Camera& right, const Pose& right_from_left,
                                         const std::string& where)
    : camera_(left) {
  if (left.width != right.width || left.height != right.height)
    throw InputError(fmt::format("{}: the left camera is of {}x{} px and the right one of {}x{} px", where,
                                 left.width, left.height, right.width, right.height));
  const Eigen::Vector3d right_in_left = right_from_left.inverse().translation();
  const double baseline = right_in_left.norm();
  if (!(baseline > 0) || !std::isfinite(baseline))
    throw InputError(fmt::format("{}: both cameras are said to be at one place", where));
  if (right_in_left.x() < kLeastAside * baseline)
    throw InputError(fmt::format(
        "{}: the second camera is said to lie {} the first one, expected a pair of left "
        "and right",
        where, right_in_left.x() < -kLeastAside * baseline ? "to the left of" : "above, below or before"));
  const bool is_rectified = !left.has_distortion() && !right.has_distortion() && is_like(left, right) &&
                            rotation_angle(right_from_left.linear()) <= kParallel &&
                            right_in_left.tail<2>().norm() <= kParallel * baseline;
  camera_.baseline_m = baseline;
  if (is_rectified) return;

  const cv::Size size(left.width, left.height);
  cv::Mat rotation, translation, turn[2], projection[2], q;
  cv::eigen2cv(Eigen::Matrix3d(right_from_left.linear()), rotation);
  cv::eigen2cv(Eigen::Vector3d(right_from_left.translation()), translation);
  cv::stereoRectify(left.matrix(), distortion_of(left), right.matrix(), distortion_of(right), size, rotation,
                    translation, turn[0], turn[1], projection[0], projection[1], q, cv::CALIB_ZERO_DISPARITY,
                    0.0);
  const Camera* cameras[] = {&left, &right};
  for (int side = 0; side < 2; ++side)
    cv::initUndistortRectifyMap(cameras[side]->matrix(), distortion_of(*cameras[side]), turn[side],
                                projection[side], size, CV_16SC2, maps_[2 * side], maps_[2 * side + 1]);
  const auto& p = projection[0];
  camera_.fx = p.at<double>(0, 0), camera_.fy = p.at<double>(1, 1);
  camera_.cx = p.at<double>(0, 2), camera_.cy = p.at<double>(1, 2);
  camera_.k1 = camera_.k2 = camera_.p1 = camera_.p2 = camera_.k3 = 0.0;
  camera_.baseline_m = -projection[1].at<double>(0, 3) / projection[1].at<double>(0, 0);
  Eigen::Matrix3d rectified_from_left;
  cv::cv2eigen(turn[0], rectified_from_left);
  left_from_rectified_.linear() = rectified_from_left.transpose();
}

cv::Mat StereoRectification::rectified(const cv::Mat& image, Side side) const {
  if (!resamples() || image.size() != maps_[2 * side].size()) return image;
  cv::Mat straight;
  cv::remap(image, straight, maps_[2 * side], maps_[2 * side + 1], cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return straight;
}

}  // namespace stillpoint
