#!/usr/bin/env bash
# PCL's depth picture of a cloud begins anew at 6.55 m: a wall at 7 m is written as one at 45 cm
#
# One would swear: the extractor of the field z, which pcl_pcd2png uses too, makes a 16-bit picture of
#   a cloud in metres; what does not go in becomes 0 or 65535.
# What happens: it multiplies by 10000, not by the 1000 or 5000 of other depth pictures, and what is
#   more than 65535 is taken modulo 65536. A floor that runs from 1 to 10 m comes out as a saw tooth:
#   6.5 m is 65000, 6.6 m is 464, 7 m is 4464. A near thing is written before all that is far, with
#   nothing to tell it from a real one; NaN becomes 0, as it should. With setScalingFactor(1000) all
#   is right to 65 m.
# What follows: the factor is to be given, and written down beside the pictures. A depth picture whose
#   largest values lie close to 65535 next to very small ones has been through this, and to an
#   occlusion test each such patch is something that stepped before the wall.
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
echo "expected: depth that grows with depth"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include <pcl/point_types.h>
#include <pcl/io/point_cloud_image_extractors.h>

using Extractor = pcl::io::PointCloudImageExtractorFromZField<pcl::PointXYZ>;

std::vector<std::uint16_t> picture(const pcl::PointCloud<pcl::PointXYZ>& cloud, bool thousand) {
  Extractor extractor;
  pcl::PCLImage image;
  if (thousand) extractor.setScalingFactor(1000);
  if (!extractor.extract(cloud, image) || image.encoding != "mono16") return {};
  std::vector<std::uint16_t> values(cloud.size());
  if (image.data.size() == 2 * values.size()) std::memcpy(values.data(), image.data.data(), image.data.size());
  return values;
}

int main() {
  pcl::PointCloud<pcl::PointXYZ> floor(100, 90);
  for (int v = 0; v < 90; ++v)
    for (int u = 0; u < 100; ++u) {
      floor(u, v).z = 1 + 0.1f * v;
      floor(u, v).x = (u - 50) * 0.01f * floor(u, v).z, floor(u, v).y = 1;
    }
  floor(0, 0).z = NAN;
  const auto usual = picture(floor, false), right = picture(floor, true);
  if (usual.empty() || right.empty()) return 1;
  int folded = 0, below = 0, wrong = 0;
  for (std::size_t i = 1; i < floor.size(); ++i) {
    const double z = floor[i].z;
    if (z < 6.5536) below += std::fabs(usual[i] - 1e4 * z) < 1.5;
    else folded += std::fabs(usual[i] - (1e4 * z - 65536)) < 1.5;
    wrong += std::fabs(right[i] - 1e3 * z) > 1.5;
  }
  for (const int v : {10, 55, 56, 60, 89})
    std::printf("seen: %.1f m is written as %d, with a factor of 1000 as %d\n", floor(5, v).z, usual[100 * v + 5], right[100 * v + 5]);
  std::printf("seen: %d points are 10000 z, %d are 10000 z - 65536, of %zu; NaN is %d; with 1000 %d are wrong\n", below, folded,
              floor.size() - 1, usual[0], wrong);
  return below == 5599 && folded == 3400 && usual[0] == 0 && wrong == 0 ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t "/usr/lib/$(uname -m)-linux-gnu/libpcl_common.so.1.13" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: beyond 6.55 m depth begins anew"
