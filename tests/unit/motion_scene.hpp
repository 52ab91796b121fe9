#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace stillpoint::motion_test {

/// A richly textured grey image: noise of several grains over one another, from its own generator, so that
/// the same seed gives the same bytes everywhere.
inline cv::Mat textured_image(const cv::Size& size, unsigned seed) {
  cv::RNG random(seed);
  cv::Mat sum = cv::Mat::zeros(size, CV_32FC1);
  for (const int grain : {4, 9, 24}) {
    cv::Mat coarse(size.height / grain + 2, size.width / grain + 2, CV_32FC1), fine;
    random.fill(coarse, cv::RNG::UNIFORM, -60.0, 60.0);
    cv::resize(coarse, fine, size, 0, 0, cv::INTER_CUBIC);
    sum += fine;
  }
  cv::Mat image;
  sum.convertTo(image, CV_8UC1, 1.0, 128.0);
  return image;
}

/// A slight camera turn and a step: corners of a 640x480 image move by some 5 to 9 px.
inline cv::Matx33d slight_motion() {
  const double turn = 0.01;
  return {std::cos(turn), -std::sin(turn), 6.0, std::sin(turn), std::cos(turn), -4.0, 4e-6, -3e-6, 1.0};
}

/// A plane seen twice, and a patch on it that moves otherwise.
struct PlaneAndPatch {
  cv::Mat reference, target;
  cv::Matx33d target_from_reference;  ///< of the plane
  cv::Rect patch;                     ///< where the patch is in the target
};

/// Upright stripes of two grey levels under a faint texture: moved by one stripe's width they differ
/// everywhere.
inline cv::Mat striped_image(const cv::Size& size, int stripe_px) {
  cv::Mat image = textured_image(size, 99) * 0.25;
  for (int x = 0; x < size.width; ++x) image.col(x) += x / stripe_px % 2 == 0 ? 30 : 170;
  return image;
}

/// @param shift how the patch moves from the reference to the target, px
/// @param stripe_px width of the patch's stripes
inline PlaneAndPatch plane_and_patch(const cv::Size& size, const cv::Rect& patch_in_target,
                                     const cv::Point& shift, int stripe_px) {
  PlaneAndPatch scene;
  scene.target_from_reference = slight_motion();
  scene.patch = patch_in_target;
  // The plane reaches beyond the reference, so that the target has no empty border.
  const int margin = 40;
  const cv::Mat plane = textured_image({size.width + 2 * margin, size.height + 2 * margin}, 7);
  plane(cv::Rect({margin, margin}, size)).copyTo(scene.reference);
  const cv::Matx33d reference_from_plane(1, 0, -margin, 0, 1, -margin, 0, 0, 1);
  cv::warpPerspective(plane, scene.target, scene.target_from_reference * reference_from_plane, size);
  const cv::Mat patch = striped_image(patch_in_target.size(), stripe_px);
  patch.copyTo(scene.target(patch_in_target));
  patch.copyTo(scene.reference(patch_in_target - shift));
  return scene;
}

}  // namespace stillpoint::motion_test
