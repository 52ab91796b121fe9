#!/usr/bin/env bash
# PCL's fitness score takes its range in square metres: 1 cm lets 10 cm pass
#
# One would swear: getFitnessScore(0.01) is the mean square of those distances that are below 1 cm, as
#   its page says of the range ("maximum allowable distance between a point and its correspondence"),
#   and setMaxRange(0.01) of TransformationValidationEuclidean is 1 cm, as the example in its header
#   has it in a comment.
# What happens: both compare the range with the squared distance that the tree gives. 0.01 means 10 cm,
#   0.04 means 20 cm, only 1 means 1 m. Of distances spread from 0 to 40 cm those up to 10 cm are
#   counted for "1 cm", and the score is some 700 times that of those below 1 cm.
#   setMaxCorrespondenceDistance of the same ICP is in metres: handed on to the score, as is usual,
#   it means something else.
# What follows: the range is to be squared by the caller. Thresholds on the score that were found by
#   trial with one range mean nothing with another; what was meant to leave out people who walked
#   through keeps all of them that are within the root.
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
echo "expected: scores over the points nearer than the range"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>

#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_validation_euclidean.h>

int main() {
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  Cloud::Ptr target(new Cloud), source(new Cloud);
  const auto distance = [](int i) { return i < 10 ? 0.0 : 0.01 * (i - 10) + 0.005; };  // ten lie right, forty 5 mm to 39.5 cm off
  for (int i = 0; i < 50; ++i) {
    target->push_back({float(i % 7), float(i / 7), 0});  // a metre apart
    source->push_back({float(i % 7), float(i / 7), float(distance(i))});
  }
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(source);
  icp.setInputTarget(target);
  icp.setMaxCorrespondenceDistance(0.004);  // in metres: the ten alone
  Cloud out;
  icp.align(out);
  bool ok = icp.hasConverged() && (icp.getFinalTransformation() - Eigen::Matrix4f::Identity()).norm() < 1e-6;
  pcl::registration::TransformationValidationEuclidean<pcl::PointXYZ, pcl::PointXYZ> validation;
  for (const double range : {0.01, 0.04, 0.1, 1.0}) {
    double sum[2] = {}, n[2] = {};
    for (int i = 0; i < 50; ++i)
      for (const int squared : {0, 1})
        if (distance(i) < (squared ? std::sqrt(range) : range)) sum[squared] += distance(i) * distance(i), ++n[squared];
    validation.setMaxRange(range);
    const double score = icp.getFitnessScore(range);
    const double valid = validation.validateTransformation(source, target, Eigen::Matrix4f::Identity());
    std::printf("seen: range %.2f: score %.6f, validation %.6f; those nearer than %.2f m: %.6f (%.0f points), than %.2f m: %.6f (%.0f)\n", range,
                score, valid, range, sum[0] / n[0], n[0], std::sqrt(range), sum[1] / n[1], n[1]);
    ok = ok && std::fabs(score - sum[1] / n[1]) < 1e-6 && std::fabs(valid - score) < 1e-6;
    if (range < 0.3) ok = ok && score > 4 * sum[0] / n[0];
    if (range == 1) ok = ok && std::fabs(score - sum[0] / n[0]) < 1e-6;
  }
  return ok ? 0 : 1;
}
CPP
lib=/usr/lib/$(uname -m)-linux-gnu
g++ -w -O1 -std=c++17 -Ipcl/usr/include/pcl-1.13 -I/usr/include/eigen3 t.cpp -o t "$lib/libpcl_registration.so.1.13" \
  "$lib/libpcl_search.so.1.13" "$lib/libpcl_kdtree.so.1.13" "$lib/libpcl_common.so.1.13" >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: ranges are compared with squares"
