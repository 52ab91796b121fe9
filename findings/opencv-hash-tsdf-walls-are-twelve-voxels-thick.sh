#!/usr/bin/env bash
# OpenCV's hashed TSDF hands out a wall as a slab of points, twelve voxels thick
#
# One would swear: fetchPointsNormals gives the points of the surface, from either kind of volume that
#   makeVolume makes; the hashed one is the same map in less memory, for larger rooms.
# What happens: the dense volume looks for the change of sign between voxels and gives one point to
#   each voxel of the wall's area, in one sheet. The hashed one gives every voxel that has been
#   seen within the truncation distance, in front of the wall and behind it: 12.4 to 12.9 points to a
#   voxel of the area, evenly from 82 mm before the wall to 59 mm behind it with voxels of 11.7 mm, and
#   twice as far with twice the voxels; 69 per cent are more than two voxels off. All have the right
#   normal, so that a picture of the cloud from the front, shaded, is a smooth wall.
# What follows: such a cloud is no map: its distance to ground truth, its size and ICP against it tell
#   about the truncation distance (seven voxels by default). From a hashed volume the surface is to
#   be cast by raycast from the poses of the run; the distance of a map's points to a plane,
#   looked at once along the wall, shows which kind it came from.
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
want libopencv-contrib-dev 4.6.0
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: points within a voxel of the wall, one to each voxel of its area or a few"
cat >t.cpp <<'CPP'
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <opencv2/rgbd.hpp>
#include <opencv2/rgbd/volume.hpp>

int main() {
  cv::setNumThreads(1);
  const cv::kinfu::Intr camera(525, 525, 319.5f, 239.5f);
  const cv::Affine3f volume(cv::Matx33f::eye(), cv::Vec3f(-1.5f, -1.5f, 0.3f));
  const double wall = 1.8;
  bool ok = true;
  for (const int voxels : {128, 256})
    for (const auto type : {cv::kinfu::VolumeType::TSDF, cv::kinfu::VolumeType::HASHTSDF}) {
      const bool hash = type == cv::kinfu::VolumeType::HASHTSDF;
      const float size = 3.f / voxels, cut = 7 * size;  // as in the default parameters
      const cv::Vec3i resolution = cv::Vec3i::all(hash ? 16 : voxels);
      const auto map = cv::kinfu::makeVolume(type, size, volume.matrix, 0.25f, cut, 64, hash ? 4.f : 0.f, resolution);
      for (int frame = 0; frame < 3; ++frame)
        map->integrate(cv::Mat_<float>(480, 640, float(5000 * wall)), 5000.f, cv::Matx44f::eye(), camera, frame);
      cv::Mat points, normals;
      map->fetchPointsNormals(points, normals);
      std::vector<double> off;
      int straight = 0;
      for (int i = 0; i < int(points.total()); ++i) {
        const cv::Vec4f p = points.at<cv::Vec4f>(i), n = normals.at<cv::Vec4f>(i);
        if (std::abs(p[0]) > 0.3 || std::abs(p[1]) > 0.3) continue;
        off.push_back(p[2] - wall), straight += std::abs(n[2]) > 0.99;
      }
      if (off.empty()) return 1;
      std::sort(off.begin(), off.end());
      const double area = 0.6 / size * 0.6 / size, low = off[off.size() / 20], high = off[off.size() * 19 / 20];
      int far = 0;
      for (const double d : off) far += std::abs(d) > 2 * size;
      std::printf("seen, %s, %.1f mm voxels: %zu points, %.1f to a voxel of the wall's area; nine in ten from %.0f to %.0f mm, all from %.0f to %.0f; %.0f %% are more than "
                  "two voxels off; %.0f %% have the wall's normal\n", hash ? "hashed" : "dense", 1000 * size, off.size(), off.size() / area, 1000 * low, 1000 * high,
                  1000 * off.front(), 1000 * off.back(), 100.0 * far / off.size(), 100.0 * straight / off.size());
      ok = ok && (hash ? off.size() / area > 8 && high - low > cut && 100.0 * far / off.size() > 60 : off.size() / area < 2 && far == 0);
    }
  return ok ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 -isystem /usr/include/opencv4 t.cpp -o t -lopencv_rgbd -lopencv_core >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: all voxels that were seen near the wall"
