#!/usr/bin/env bash
# image_geometry's ray of a right camera's pixel is right at one metre, and nowhere else
#
# One would swear: projectPixelTo3dRay gives a direction; depth times the ray (scaled to
#   z = 1) is the point that project3dToPixel would put into that pixel.
# What happens: for a left camera it is so. A rectified right camera has Tx = -fx * baseline
#   in its P. C++ takes Tx into the ray as it stands, undivided by the depth, so that the ray
#   ends on the right point for z = 1 and points elsewhere: with f = 500 and a baseline of
#   12 cm a point at 5 m lands 48 cm to the side, one at 20 m 2.28 m, and projecting the ray
#   itself gives the right pixel back, so that no such test sees it. Python
#   leaves Tx out: its ray is a true direction, but from the right camera's own centre,
#   while its project3dToPixel takes points from the left one's, so that projecting the ray
#   gives a pixel 60 to the left. Both say that they are the inverse of project3dToPixel.
# What follows: rays of a right camera are to be computed from fx, fy, cx, cy alone, and the
#   baseline is to be added as the ray's origin; where somebody's code multiplies that ray by
#   depth, objects seen by the right camera drift away by baseline * (z - 1). A test
#   of a camera model must take points at several depths there and back, not rays.
set -u
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
have() { dpkg-query -W -f '${Version}' "$1" 2>/dev/null; }
want() { # package, start of its version
  [ -n "$(have "$1")" ] || { apt-get update -qq && apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=300 "$1"; } >"$tmp/apt.log" 2>&1
  case $(have "$1") in
    "$2"*) echo "version: $1 $(have "$1")" ;;
    *) echo "$1 '$(have "$1")', wanted $2: not looked at"; exit 2 ;;
  esac
}
want libimage-geometry-dev 1.16.2
want python3-image-geometry 1.16.2
want g++ 4:12
echo "expected: depth times ray is the point, at every depth and in both languages"
cat >"$tmp/t.cpp" <<'CPP'
#include <cmath>
#include <cstdio>
#include <image_geometry/pinhole_camera_model.h>

int main() {
  sensor_msgs::CameraInfo info;
  info.width = 640, info.height = 480, info.distortion_model = "plumb_bob", info.D = {0, 0, 0, 0, 0};
  info.K = {500, 0, 320, 0, 500, 240, 0, 0, 1}, info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0};
  image_geometry::PinholeCameraModel left, right;
  left.fromCameraInfo(info);
  info.P[3] = -500 * 0.12;
  right.fromCameraInfo(info);
  bool as_described = true;
  std::printf("seen in C++, metres off: ");
  for (const double z : {0.5, 1.0, 2.0, 5.0, 20.0}) {
    const cv::Point3d point(0.3 * z, -0.2 * z, z);
    const cv::Point2d pixel = right.project3dToPixel(point);
    const cv::Point3d ray = right.projectPixelTo3dRay(pixel);
    const double off = ray.x * z - point.x, left_off = left.projectPixelTo3dRay(left.project3dToPixel(point)).x * z - point.x;
    std::printf("%.2f at %g m, ", off, z);
    as_described = as_described && ray.z == 1 && std::abs(off - 0.12 * (z - 1)) < 1e-9 && std::abs(left_off) < 1e-9 &&
                   std::abs(right.project3dToPixel(ray).x - pixel.x) < 1e-9;
  }
  std::puts("the left camera nowhere");
  return as_described ? 0 : 1;
}
CPP
g++ -std=c++17 -isystem /usr/include/opencv4 "$tmp/t.cpp" -o "$tmp/t" -limage_geometry -lopencv_core \
  || { echo "not compiled: not looked at"; exit 2; }
cat >"$tmp/t.py" <<'PY'
import sys

from image_geometry import PinholeCameraModel
from sensor_msgs.msg import CameraInfo

right = PinholeCameraModel()
right.fromCameraInfo(CameraInfo(width=640, height=480, distortion_model="plumb_bob", D=[0] * 5,
                                K=[500, 0, 320, 0, 500, 240, 0, 0, 1], R=[1, 0, 0, 0, 1, 0, 0, 0, 1],
                                P=[500, 0, 320, -500 * 0.12, 0, 500, 240, 0, 0, 0, 1, 0]))
off, pixels = [], []
for z in (0.5, 1, 2, 5, 20):
    pixel = right.project3dToPixel((0.3 * z, -0.2 * z, z))
    x, y, depth = right.projectPixelTo3dRay(pixel)
    off.append(x / depth * z - 0.3 * z)
    pixels.append(right.project3dToPixel((x / depth, y / depth, 1))[0] - pixel[0])
print("seen in Python, metres off:", ", ".join(f"{d:.2f}" for d in off), "at the same; the ray projected is off by",
      ", ".join(f"{d:.0f}" for d in pixels), "pixels")
sys.exit(0 if all(abs(d + 0.12) < 1e-9 for d in off) and all(abs(d + 60) < 1e-6 for d in pixels) else 1)
PY
"$tmp/t" && /usr/bin/python3 "$tmp/t.py" || { echo "changed: rays of right cameras are others now"; exit 1; }
echo "as described: C++ is off by the baseline times (depth - 1), Python by the baseline"
