#!/usr/bin/env bash
# PCL's projective matching cuts pixels off, and ICP walks away from the right pose
#
# One would swear: CorrespondenceEstimationOrganizedProjection finds for a point the pixel of the
#   other depth picture that it falls on, the nearest one. A cloud laid on itself has each point
#   matched with itself, and from the right pose ICP goes nowhere.
# What happens: u and v are cut, not rounded: matches lie half a pixel to the left and above on
#   average. Laid on itself, more than a third of a cloud is matched with a neighbour, those whose
#   pixel comes out as 99.99997. The half pixel is there at every pose, so that nothing stops: from
#   the right pose of two views of a hilly wall at 2 m point-to-point ICP is 4 mm away after one
#   iteration, 40 after ten and 71 after thirty, and it goes on. With cx and cy given half a
#   pixel larger, each point is matched with itself, and ICP stays within 3 mm.
# What follows: setCameraCenters is to be given cx + 0.5 and cy + 0.5, or u and v are to be rounded
#   by code of one's own. A drift to one side that grows with the number of iterations is this;
#   point-to-plane ICP is no proof against it, though a wall does not mind a shift along itself.
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
want libpcl-registration1.13 1.13.0
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
echo "expected: each point matched with itself, and ICP at rest"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>
#include <vector>

#include <pcl/point_types.h>
#include <pcl/common/transforms.h>
#include <pcl/registration/correspondence_estimation_organized_projection.h>
#include <pcl/registration/transformation_estimation_svd.h>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Projection = pcl::registration::CorrespondenceEstimationOrganizedProjection<pcl::PointXYZ, pcl::PointXYZ>;
const double f = 525, cx = 319.5, cy = 239.5;

// A hilly wall some 2 m away, seen by a camera at the pose T.
Cloud::Ptr view(const Eigen::Matrix4d& T) {
  Cloud::Ptr cloud(new Cloud(640, 480));
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      const Eigen::Vector3d o = T.block(0, 3, 3, 1), d = T.block<3, 3>(0, 0) * Eigen::Vector3d((u - cx) / f, (v - cy) / f, 1);
      double s = 2;
      for (int i = 0; i < 60; ++i) {
        const Eigen::Vector3d p = o + s * d;
        s += 0.8 * (2 + 0.15 * std::sin(5 * p.x()) + 0.12 * std::cos(6 * p.y()) + 0.1 * p.x() * p.y() - p.z());
      }
      pcl::PointXYZ& p = (*cloud)(u, v);
      p.x = s * (u - cx) / f, p.y = s * (v - cy) / f, p.z = s;
    }
  return cloud;
}

pcl::Correspondences matches(const Cloud::Ptr& source, const Cloud::Ptr& target, const Eigen::Matrix4f& pose, double more) {
  Projection projection;
  projection.setFocalLengths(f, f);
  projection.setCameraCenters(cx + more, cy + more);
  projection.setInputSource(source);
  projection.setInputTarget(target);
  projection.setSourceTransformation(pose);
  pcl::Correspondences found;
  projection.determineCorrespondences(found, 0.05);
  return found;
}

int main() {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  const Cloud::Ptr a = view(T);
  T.block<3, 3>(0, 0) = Eigen::AngleAxisd(0.02, Eigen::Vector3d(0.3, 1, 0.2).normalized()).toRotationMatrix();
  T.block(0, 3, 3, 1) << 0.03, -0.01, 0.02;
  const Cloud::Ptr b = view(T);
  bool ok = true;
  for (const double more : {0.0, 0.5}) {  // added to cx and cy
    int others = 0;
    for (const auto& m : matches(a, a, Eigen::Matrix4f::Identity(), more)) others += m.index_match != m.index_query;
    const auto found = matches(b, a, T.cast<float>(), more);
    double du = 0, dv = 0;
    for (const auto& m : found) {
      const Eigen::Vector4d p = T * (*b)[m.index_query].getVector4fMap().cast<double>();
      du += (m.index_match % 640 - f * p.x() / p.z() - cx) / found.size();
      dv += (m.index_match / 640 - f * p.y() / p.z() - cy) / found.size();
    }
    double away[31];  // mm from the right pose, from which it starts
    Eigen::Matrix4f pose = T.cast<float>();
    for (int i = 1; i <= 30; ++i) {
      Cloud moved;
      Eigen::Matrix4f step;
      pcl::transformPointCloud(*b, moved, pose);
      pcl::registration::TransformationEstimationSVD<pcl::PointXYZ, pcl::PointXYZ>().estimateRigidTransformation(
          moved, *a, matches(b, a, pose, more), step);
      pose = step * pose;
      away[i] = 1000 * (T.inverse() * pose.cast<double>()).block(0, 3, 3, 1).norm();
    }
    std::printf("seen, %.1f px added to cx and cy: laid on itself %d of %zu points matched with another; from the right pose matches lie "
                "%.2f px to the right and %.2f down; ICP is %.1f mm away after 1 iteration, %.1f after 10, %.1f after 30\n",
                more, others, a->size(), du, dv, away[1], away[10], away[30]);
    if (more == 0) ok = ok && others > 60000 && du < -0.4 && dv < -0.4 && away[1] > 2 && away[10] > 20 && away[30] > 40;
    if (more > 0) ok = ok && others == 0 && std::fabs(du) < 0.05 && std::fabs(dv) < 0.05 && away[1] < 1 && away[10] < 4 && away[30] < 6;
  }
  return ok ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -O2 -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t "$lib/libpcl_registration.so.1.13" \
  "$lib/libpcl_search.so.1.13" "$lib/libpcl_common.so.1.13" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: half a pixel to the left and above, and no end of walking"
