#!/usr/bin/env bash
# PCL's compression of organized clouds gives back one long row, farther away and half a pixel aside
#
# One would swear: OrganizedPointCloudCompression, which is for the clouds of depth cameras, gives
#   back an organized cloud, 640 x 480, its points where they were but for the rounding of the
#   disparity, as often too near as too far.
# What happens: 307200 x 1 comes back. The points are in their order, but width and height are those
#   of a heap, and what looks at neighbours in the picture has none. The disparities are cut, not
#   rounded: no point comes back nearer, all come back farther by 0 to z^2 / 525 m, half of that on
#   average: 4 mm at 2 m, 15 mm at 4 m. And the rays are drawn from the column width / 2: of a camera
#   whose middle is 319.5, as it is for most, all points lie half a pixel to the left and above.
# What follows: width and height are to be set by hand, half a step is to be taken off the inverse
#   depth and half a pixel added before clouds that went through it are measured or registered;
#   two frames of it agree with each other, and with no others.
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
want libpcl-io1.13 1.13.0
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
echo "expected: 640 x 480, errors of depth to both sides, none in the direction"
cat >t.cpp <<'CPP'
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <vector>

#include <pcl/point_types.h>
#include <pcl/compression/organized_pointcloud_compression.h>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

int main() {
  const double f = 525, cx = 319.5, cy = 239.5;
  Cloud::Ptr cloud(new Cloud(640, 480)), back(new Cloud);
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      pcl::PointXYZ& p = (*cloud)(u, v);
      p.z = 1.5 + 0.5 * std::sin(u / 70.0) + 0.004 * v;
      p.x = (u - cx) * p.z / f, p.y = (v - cy) * p.z / f;
    }
  (*cloud)(5, 7).x = (*cloud)(5, 7).y = (*cloud)(5, 7).z = NAN;
  std::stringstream stream;
  pcl::io::OrganizedPointCloudCompression<pcl::PointXYZ> coder;
  coder.encodePointCloud(cloud, stream, false, false, false);
  const std::size_t bytes = stream.str().size();
  bool ok = coder.decodePointCloud(stream, back, false) && back->size() == cloud->size();
  std::printf("seen: %u x %u went in as %zu bytes, %u x %u came out\n", cloud->width, cloud->height, bytes, back->width, back->height);
  ok = ok && back->width == 307200 && back->height == 1 && std::isnan((*back)[7 * 640 + 5].z);

  std::vector<double> steps, beside, above, mended;  // in z^2 / f, and in pixels
  double at2 = 0, at4 = 0, n2 = 0, n4 = 0;
  for (std::size_t i = 0; ok && i < cloud->size(); ++i) {
    const pcl::PointXYZ &a = (*cloud)[i], &b = (*back)[i];
    if (std::isnan(a.z)) continue;
    steps.push_back((1 / double(a.z) - 1 / double(b.z)) * f);
    mended.push_back(1 / double(a.z) - 1 / double(b.z) - 0.5 / f);
    beside.push_back((double(b.x) / b.z - double(a.x) / a.z) * f), above.push_back((double(b.y) / b.z - double(a.y) / a.z) * f);
    if (std::fabs(a.z - 2) < 0.1) at2 += b.z - a.z, ++n2;
    if (a.z > 3.8) at4 += b.z - a.z, ++n4;
  }
  if (!ok) return 1;
  for (auto* v : {&steps, &beside, &above, &mended}) std::sort(v->begin(), v->end());
  const std::size_t half = steps.size() / 2;
  std::printf("seen: inverse depth less by %.3f to %.3f steps of 1/525, %.3f in the median: %.1f mm farther at 2 m, %.1f at 3.8 m and more\n",
              steps.front(), steps.back(), steps[half], 1e3 * at2 / n2, 1e3 * at4 / n4);
  std::printf("seen: rays %.2f px to the right (%.2f to %.2f) and %.2f down; with half a step taken off, inverse depth errs by %.1e in the "
              "median and %.4f at most\n", beside[half], beside.front(), beside.back(), above[half], mended[half], mended.back());
  ok = steps.front() > -1e-3 && steps.back() > 0.95 && steps.back() < 1.02 && std::fabs(steps[half] - 0.5) < 0.03;
  ok = ok && 1e3 * at2 / n2 > 3 && 1e3 * at4 / n4 > 12 && std::fabs(mended[half]) < 1e-4;
  return ok && std::fabs(beside[half] + 0.5) < 0.02 && std::fabs(above[half] + 0.5) < 0.02 ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -O1 -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t "$lib/libpcl_io.so.1.13" "$lib/libpcl_common.so.1.13" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: one row, farther away, half a pixel aside"
