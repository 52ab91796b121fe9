#include "tests/support/board_scene.hpp"

#include <cmath>

#include "core/config.hpp"
#include "core/motion/stillpoint/stillpoint_config.hpp"

namespace stillpoint {
namespace {

float texture(double x, double y, int salt) {
  // Smooth bumps of some centimetres, so that small errors of place stay small in brightness.
  return static_cast<float>(128 + 45 * std::sin(x * 37 + salt) * std::cos(y * 29 + salt) +
                            30 * std::sin(x * 61 - y * 53));
}

}  // namespace

const Camera& board_camera() {
  static const Camera camera = camera_by_name("generated");
  return camera;
}

void BoardScene::render(cv::Mat& gray, cv::Mat& depth, cv::Mat* truth) const {
  gray.create(480, 640, CV_8UC1);
  depth.create(480, 640, CV_32FC1);
  if (truth) truth->create(480, 640, CV_8UC1);
  cv::RNG noise(static_cast<std::uint64_t>(1000 + 1e4 * (camera_x + board_x + board_z)));
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      const double rx = (u - board_camera().cx) / board_camera().fx,
                   ry = (v - board_camera().cy) / board_camera().fy;
      const double bx = rx * board_z + camera_x - board_x, by = ry * board_z;
      const bool on_board = board && std::abs(bx) < 0.2 && std::abs(by) < 0.25;
      const double hills = relief ? 0.5 * std::sin(7 * rx) + 0.4 * std::sin(9 * ry) : 0.0;
      const double z = on_board ? board_z : 2.0 + hills;
      const float value =
          on_board ? texture(bx * board_pitch, by * board_pitch, 3) : texture(rx * z + camera_x, ry * z, 0);
      gray.at<uchar>(v, u) = cv::saturate_cast<uchar>(value + brightness + noise.gaussian(2.0));
      depth.at<float>(v, u) = static_cast<float>(z + noise.gaussian(0.0012 + 0.0019 * z * z));
      if (truth) truth->at<uchar>(v, u) = on_board ? 255 : 0;
    }
}

RgbdView BoardScene::view() const {
  cv::Mat gray, depth;
  render(gray, depth);
  return make_rgbd_view(gray, depth, board_camera(), StillpointConfig{}.factor);
}

}  // namespace stillpoint
