#!/usr/bin/env bash
# PCL's normals by AVERAGE_DEPTH_CHANGE lean over: a wall turned by 45 degrees comes out 20 wrong
#
# One would swear: of a plane without noise every method of IntegralImageNormalEstimation gives
#   the plane's normal; the four differ in how they smooth noise and treat edges.
# What happens: the other three are within 0.1 degrees. AVERAGE_DEPTH_CHANGE takes as the points
#   above and below a pixel those some rows up and down, and a column to the left and right, where a
#   row was meant (beside the pixel, a column is right). A wall turned to one side so gets normals
#   that lean down, at the usual size of 10 by half as much: 8 degrees of error for a turn of 17, 20
#   for one of 45. And the difference of mean depths is not taken over the length that it is divided
#   by: a floor is 10 degrees off in its tilt; at a size of 5 that wall's normals are off by 32
#   degrees, at 20 still by 8. A wall that is faced is right at all sizes, and at 10 so is one that
#   falls off along the picture's diagonal.
# What follows: point-to-plane ICP, plane segmentation and shading of depth pictures use one of
#   the others (AVERAGE_3D_GRADIENT needs no more time). A test of normals needs planes turned about
#   each axis alone: the faced one and the diagonal one pass.
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
want libpcl-features1.13 1.13.0
want libeigen3-dev 3.4.0
want libboost-dev 1.74
want libflann-dev 1.9
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
echo "expected: errors below 0.1 degrees by every method"
cat >t.cpp <<'CPP'
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <pcl/features/integral_image_normal.h>
#include <pcl/point_types.h>

using Method = pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal>;

struct Seen {
  double median;  // degrees
  pcl::Normal middle;
};

// The plane z = 2 m + a x + b y in a picture of 320 x 240 with a focal length of 262.5.
Seen look(double a, double b, float size, Method::NormalEstimationMethod method) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>(320, 240));
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      const double x = (u - 159.5) / 262.5, y = (v - 119.5) / 262.5, z = 2 / (1 - a * x - b * y);
      (*cloud)(u, v) = pcl::PointXYZ(x * z, y * z, z);
    }
  Method normals;
  normals.setNormalEstimationMethod(method);
  normals.setMaxDepthChangeFactor(0.02f);
  normals.setNormalSmoothingSize(size);
  normals.setInputCloud(cloud);
  pcl::PointCloud<pcl::Normal> found;
  normals.compute(found);
  const double length = std::sqrt(1 + a * a + b * b);
  std::vector<double> errors;
  for (const pcl::Normal& n : found)
    if (std::isfinite(n.normal_x))
      errors.push_back(std::acos(std::min(1.0, (a * n.normal_x + b * n.normal_y - n.normal_z) / length)) * 180 / M_PI);
  if (errors.empty()) return {-1, {}};
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  return {errors[errors.size() / 2], found(160, 120)};
}

int main() {
  bool ok = true;
  const struct { const char* name; double a, b, at5, at10, at20; } walls[] = {
      {"faced", 0, 0, 0, 0, 0},
      {"turned by 17 degrees", 0.3, 0, 13, 8.2, 3.3},
      {"turned by 45 degrees", 1, 0, 32.4, 19.7, 8.2},
      {"lying back by 27 degrees", 0, 0.5, 10.3, 10.3, 2.2},
      {"along the diagonal", 0.3, 0.3, 5.3, 0, 1.8}};
  for (const auto& wall : walls) {
    double others = 0;
    for (float size : {5.f, 10.f, 20.f})
      for (auto method : {Method::COVARIANCE_MATRIX, Method::AVERAGE_3D_GRADIENT, Method::SIMPLE_3D_GRADIENT}) {
        const double error = look(wall.a, wall.b, size, method).median;
        others = std::max(others, error < 0 ? 180 : error);
      }
    const Seen at5 = look(wall.a, wall.b, 5, Method::AVERAGE_DEPTH_CHANGE);
    const Seen at10 = look(wall.a, wall.b, 10, Method::AVERAGE_DEPTH_CHANGE);
    const Seen at20 = look(wall.a, wall.b, 20, Method::AVERAGE_DEPTH_CHANGE);
    std::printf("seen, a wall %s: %.1f, %.1f and %.1f degrees for sizes of 5, 10 and 20, the other methods %.2f at most; "
                "in the middle, at 10: (%.2f %.2f %.2f)\n", wall.name, at5.median, at10.median, at20.median, others,
                at10.middle.normal_x, at10.middle.normal_y, at10.middle.normal_z);
    const auto near = [](double is, double expected) { return std::fabs(is - expected) < 0.3; };
    ok = ok && near(at5.median, wall.at5) && near(at10.median, wall.at10) && near(at20.median, wall.at20) && others < 0.1;
    if (wall.b == 0) ok = ok && std::fabs(at10.middle.normal_y + 0.5 * at10.middle.normal_x) < 0.01;
  }
  return ok ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t \
  "$lib/libpcl_features.so.1.13" "$lib/libpcl_search.so.1.13" "$lib/libpcl_common.so.1.13" -Wl,-rpath-link,"$lib" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t 2>t.log || { echo "the behaviour has changed"; exit 1; }
echo "as described: normals by AVERAGE_DEPTH_CHANGE lean over, those of the other methods do not"
