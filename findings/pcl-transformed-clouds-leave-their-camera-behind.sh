#!/usr/bin/env bash
# PCL's transformPointCloud leaves the camera behind: normals then face the wrong side
#
# One would swear: a cloud knows where it was seen from (sensor_origin_, a point in its coordinates),
#   and transformPointCloud, which brings it from the camera's frame to the world's, brings that
#   point along; normals that are estimated in the world face the camera as they did before.
# What happens: sensor_origin_ and sensor_orientation_ are copied as they are. The cloud in the world
#   says it was seen from the world's origin, where the first frame was. NormalEstimation turns its
#   normals to sensor_origin_ unless told otherwise: for a room seen by a camera that has gone round
#   to its other end, two thirds and more of the normals face away from the camera, in the camera's
#   own frame none.
# What follows: after each transformation sensor_origin_ and sensor_orientation_ are to be multiplied
#   by hand, or normals to be estimated before, with transformPointCloudWithNormals afterwards. A
#   board seen from both sides, with both sides' normals alike, is this; a point-to-plane or
#   occlusion test with normals is right in the first frames and fails when the camera comes back.
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
echo "expected: no normal that faces away from the camera, in either frame"
cat >t.cpp <<'CPP'
#include <algorithm>
#include <cstdio>

#include <pcl/point_types.h>
#include <pcl/common/transforms.h>
#include <pcl/features/normal_3d.h>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

double facing_away(const Cloud& cloud, const Eigen::Vector3f& camera) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  pcl::PointCloud<pcl::Normal> normals;
  estimation.setInputCloud(cloud.makeShared());
  estimation.setKSearch(12);
  estimation.compute(normals);
  int away = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    away += normals[i].getNormalVector3fMap().dot(camera - cloud[i].getVector3fMap()) < 0;
  return double(away) / cloud.size();
}

int main() {
  Cloud seen(160, 120), world;  // a floor 1 m below the camera, a wall at 3 m and one to the right
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u) {
      const double x = (u - 79.5) / 131, y = (v - 59.5) / 131;
      const double z = std::min({3.0, 1 / std::max(y, 1e-9), 1.2 / std::max(x, 1e-9)});
      seen(u, v).x = x * z, seen(u, v).y = y * z, seen(u, v).z = z;
    }
  Eigen::Affine3f pose = Eigen::Affine3f::Identity();  // has gone round the wall and looks back
  pose.translation() << 0.5f, 0, 7;
  pose.rotate(Eigen::AngleAxisf(3.1f, Eigen::Vector3f::UnitY()));
  pcl::transformPointCloud(seen, world, pose);
  const Eigen::Vector3f camera = pose.translation(), said = world.sensor_origin_.head<3>();
  const double before = facing_away(seen, Eigen::Vector3f::Zero()), after = facing_away(world, camera);
  world.sensor_origin_.head<3>() = camera;
  const double mended = facing_away(world, camera);
  std::printf("seen: camera at %.1f %.1f %.1f, the cloud says %.1f %.1f %.1f\n", camera.x(), camera.y(), camera.z(), said.x(), said.y(), said.z());
  std::printf("seen: facing away from the camera: %.1f %% of the normals in the camera's frame, %.1f %% in the world's, %.1f %% with the origin "
              "set by hand\n", 100 * before, 100 * after, 100 * mended);
  const double moved = (world[5].getVector3fMap() - pose * seen[5].getVector3fMap()).norm();
  return said.norm() == 0 && before < 0.01 && after > 0.5 && mended < 0.01 && moved < 1e-5 ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -O1 -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t "$lib/libpcl_features.so.1.13" \
  "$lib/libpcl_search.so.1.13" "$lib/libpcl_common.so.1.13" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: the points have moved, the camera has not"
