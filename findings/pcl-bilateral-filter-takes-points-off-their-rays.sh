#!/usr/bin/env bash
# PCL's FastBilateralFilter smooths z alone: the points leave their pixels
#
# One would swear: a filter "for smoothing depth information in organized point clouds" moves a
#   point along the ray of its pixel, so that the cloud is still a picture: point (u, v) projects to
#   pixel (u, v), and it is what one gets from filtering the depth first.
# What happens: only z is written; x and y stay those of the depth that was measured. Of a wall at
#   2 m with 1 cm of noise, points project half a pixel from where they were taken in the median, 2
#   pixels for one in twenty, most at the margins, where x and y are large. And a part of the noise
#   stays: 1.6 mm for that wall, which is slanted, where the same depths laid on their rays leave
#   0.9. FastBilateralFilterOMP is the same, and MedianFilter does likewise.
# What follows: after this filter x and y are to be computed anew from u, v and z, or depth is to
#   be filtered as a picture before the cloud is made. Projective association (KinectFusion's, and
#   OrganizedNeighbor's) and colours looked up by projection are off by pixels otherwise, and an
#   evaluation of reprojection sees an error that no camera made.
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
want libpcl-filters1.13 1.13.0
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
echo "expected: every filtered point projects into its own pixel, to 0.01 px"
cat >t.cpp <<'CPP'
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include <pcl/filters/fast_bilateral.h>
#include <pcl/filters/fast_bilateral_omp.h>
#include <pcl/filters/median_filter.h>
#include <pcl/point_types.h>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
constexpr double kFocal = 525, kSlope = 0.5;

double at(std::vector<double> v, double share) {
  std::nth_element(v.begin(), v.begin() + int(share * (v.size() - 1)), v.end());
  return v[int(share * (v.size() - 1))];
}

double wall(double x, double z) { return (z - kSlope * x - 2) / std::sqrt(1 + kSlope * kSlope); }  // m from it

template <class Filter>
bool look(const char* name, const Cloud::Ptr& cloud, Filter& filter) {
  filter.setInputCloud(cloud);
  Cloud out;
  filter.filter(out);
  std::vector<double> pixels, before;
  double as_is = 0, on_ray = 0;
  int same_xy = 0;
  for (int v = 20; v < 460; ++v)
    for (int u = 20; u < 620; ++u) {
      const pcl::PointXYZ &p = out(u, v), &q = (*cloud)(u, v);
      const double x = (u - 319.5) / kFocal;
      pixels.push_back(kFocal * std::hypot(p.x / p.z - x, p.y / p.z - (v - 239.5) / kFocal));
      before.push_back(kFocal * std::hypot(q.x / q.z - x, q.y / q.z - (v - 239.5) / kFocal));
      same_xy += p.x == q.x && p.y == q.y;
      as_is += std::pow(wall(p.x, p.z), 2);
      on_ray += std::pow(wall(x * p.z, p.z), 2);
    }
  as_is = 1e3 * std::sqrt(as_is / pixels.size());
  on_ray = 1e3 * std::sqrt(on_ray / pixels.size());
  std::printf("seen, %s: x and y are those of before for %.0f of 100 points; points project %.2f px from their pixels in the "
              "median, %.1f for one in twenty (%.4f before); %.2f mm from the wall (rms), laid on their rays %.2f\n", name,
              100.0 * same_xy / pixels.size(), at(pixels, 0.5), at(pixels, 0.95), at(before, 1), as_is, on_ray);
  return same_xy == int(pixels.size()) && at(before, 1) < 0.01 && at(pixels, 0.5) > 0.3 && at(pixels, 0.95) > 1.2 &&
         as_is > 1.3 * on_ray;
}

int main() {
  Cloud::Ptr cloud(new Cloud(640, 480));
  std::mt19937 random(1);
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      double noise = -6;  // twelve even numbers for a normal one: the same with any standard library
      for (int i = 0; i < 12; ++i) noise += random() / 4294967296.0;
      const double x = (u - 319.5) / kFocal, y = (v - 239.5) / kFocal, z = 2 / (1 - kSlope * x) + 0.01 * noise;
      (*cloud)(u, v) = pcl::PointXYZ(x * z, y * z, z);
    }
  pcl::FastBilateralFilter<pcl::PointXYZ> plain;
  pcl::FastBilateralFilterOMP<pcl::PointXYZ> threads(1);
  plain.setSigmaS(5), threads.setSigmaS(5);
  plain.setSigmaR(0.05f), threads.setSigmaR(0.05f);
  pcl::MedianFilter<pcl::PointXYZ> median;
  median.setWindowSize(7);
  median.setMaxAllowedMovement(1);
  bool ok = look("FastBilateralFilter", cloud, plain);
  ok = look("FastBilateralFilterOMP", cloud, threads) && ok;
  return look("MedianFilter", cloud, median) && ok ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -O1 -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t \
  "$lib/libpcl_filters.so.1.13" "$lib/libpcl_common.so.1.13" -Wl,-rpath-link,"$lib" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: only z is smoothed, and points leave their rays"
