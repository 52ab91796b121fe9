#!/usr/bin/env bash
# PCL's PointCloudDepthAndRGBtoXYZRGBA has its camera look along the upper left corner
#
# One would swear: a function that makes a cloud of a depth and a colour picture and asks for the
#   focal length alone takes the middle of the picture for the principal point, or says that it
#   wants to have it.
# What happens: it takes pixel (0, 0). x is u z / f: all points lie to the right of and below the
#   camera, and as what is missing is cx z / f, it grows with the depth: of two poles one behind the
#   other in the middle of a 640 x 480 picture (f = 525), at 1 and 3 m, the far one stands 1.2 m to
#   the right of the near one. The cloud is sheared, not shifted: no rigid transform mends it,
#   though each wall at one depth by itself looks right. Depth is taken for millimetres and 0
#   becomes NaN, as one would expect.
# What follows: clouds of such pictures are to be made with cx and cy from the calibration, or
#   mended: subtract (cx, cy) z / f. No pose fits two such clouds of a camera that turned, and ICP
#   is not to blame.
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
want libpcl-common1.13 1.13.0
want libeigen3-dev 3.4.0
want libboost-dev 1.74
want g++ 4:12
# Of libpcl-dev the headers are enough, and installing it would bring two hundred packages.
chmod 755 "$tmp" && cd "$tmp" || exit 2
{ apt-get download -qq libpcl-dev || { apt-get update -qq && apt-get download -qq libpcl-dev; }; } >apt.log 2>&1
dpkg-deb -x libpcl-dev_*.deb pcl 2>>apt.log
pcl=$(dpkg-deb -f "$tmp"/libpcl-dev_*.deb Version 2>/dev/null)
case $pcl in
  1.13.0*) echo "version: libpcl-dev $pcl" ;;
  *) echo "libpcl-dev '$pcl', wanted 1.13.0: not looked at"; exit 2 ;;
esac
echo "expected: what is in the middle of the picture has x = y = 0 within a pixel, at any depth"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>

#include <pcl/point_types.h>
#include <pcl/point_types_conversion.h>

int main() {
  constexpr int kWidth = 640, kHeight = 480;
  constexpr float kFocal = 525;
  pcl::PointCloud<pcl::Intensity> depth(kWidth, kHeight);
  pcl::PointCloud<pcl::RGB> colour(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v)  // a near pole in the middle, below it a far one, in front of a wall at 5 m
    for (int u = 0; u < kWidth; ++u) depth(u, v).intensity = std::abs(u - 320) > 10 ? 5000 : v < 240 ? 1000 : 3000;
  depth(0, 0).intensity = 0;
  pcl::PointCloud<pcl::PointXYZRGBA> cloud;
  pcl::PointCloudDepthAndRGBtoXYZRGBA(depth, colour, kFocal, cloud);

  const auto &near = cloud(320, 239), &far = cloud(320, 241), &left = cloud(1, 239), &none = cloud(0, 0);
  std::printf("seen: in the middle of the picture: (%.2f %.2f %.2f) m and (%.2f %.2f %.2f) m; at its left margin x = %.2f m; "
              "depth 0 is %g\n", near.x, near.y, near.z, far.x, far.y, far.z, left.x, none.z);
  double worst = 0, mended = 0;  // against a principal point of (319.5, 239.5), and of (0, 0)
  for (int v = 0; v < kHeight; ++v)
    for (int u = 1; u < kWidth; ++u) {
      const auto& p = cloud(u, v);
      worst = std::fmax(worst, std::hypot(p.x - (u - 319.5) * p.z / kFocal, p.y - (v - 239.5) * p.z / kFocal));
      mended = std::fmax(mended, std::hypot(p.x - u * p.z / kFocal, p.y - v * p.z / kFocal));
    }
  std::printf("seen: points are up to %.2f m from where the middle as principal point has them, %.0e m from where (0, 0) has "
              "them\n", worst, mended);
  const bool corner = mended < 1e-5 && worst > 3, shear = std::fabs(far.x - near.x - 1.22) < 0.01;
  return corner && shear && left.x > 0 && std::fabs(near.z - 1) < 1e-5 && std::fabs(far.z - 3) < 1e-5 && std::isnan(none.z) ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t "$lib/libpcl_common.so.1.13" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: the camera looks along the corner of its picture"
