#!/usr/bin/env bash
# cv::Quat of a rotation matrix goes the long way round, and millions of radians when it is small
#
# One would swear: Quatd::createFromRotMat(R).toRotVec() is what cv::Rodrigues gives; half the
#   power of it is half the rotation; the rotation vector of no rotation is 0.
# What happens: wherever the trace is positive, so for all rotations below 120 degrees, w comes
#   out as -cos of half the angle, and for some above. As a rotation it is the same, but getAngle,
#   toRotVec, log and power take it at its word: 10 degrees are 350 the other way, and half of them
#   is a half turn too much. Near no rotation w is -1 to the last bit, and toRotVec divides by the
#   sine of 180 degrees: 1e-8 rad become 250 million. Made otherwise (createFromAngleAxis) small
#   angles are right down to 1e-7, and below they are NaN, 0 included. A DualQuat made of a pose has
#   the same sign: half of a 1 m step ends metres away. slerp, spline and sclerp mind signs; squad,
#   with its interPoint, does not and leaves the path.
# What follows: w is to be made positive after createFromRotMat (if (q.w < 0) q = -q), and
#   rotation vectors are to come from cv::Rodrigues or atan2. An error of rotation near 360 degrees,
#   or one in the millions, for frames that hardly moved, is this.
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
want libopencv-core-dev 4.6.0
want g++ 4:12
echo "expected: rotation vectors of the angle that R was made with; half of it by power(0.5)"
cat >"$tmp/t.cpp" <<'CPP'
#include <cmath>
#include <cstdio>

#include <opencv2/core.hpp>
#include <opencv2/core/dualquaternion.hpp>
#include <opencv2/core/quaternion.hpp>

using cv::Quatd;

cv::Matx33d about(cv::Vec3d axis, double angle) {
  axis /= cv::norm(axis);
  const cv::Matx33d k(0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0);
  return cv::Matx33d::eye() + std::sin(angle) * k + (1 - std::cos(angle)) * k * k;
}

double turn(const Quatd& q) {  // about z, degrees
  const cv::Matx33d R = q.toRotMat3x3();
  return std::atan2(R(1, 0), R(0, 0)) * 180 / M_PI;
}

double off(const Quatd& q, double degrees) { return std::fabs(std::remainder(turn(q) - degrees, 360)); }

int main() {
  cv::RNG random(1);
  int below = 0, negative = 0, above = 0, negative_above = 0;
  double same = 0;
  for (int i = 0; i < 2000; ++i) {
    const cv::Matx33d R = about({random.gaussian(1), random.gaussian(1), random.gaussian(1)}, random.uniform(0.0, M_PI));
    const Quatd q = Quatd::createFromRotMat(R);
    same = std::fmax(same, cv::norm(R - q.toRotMat3x3()));
    (R(0, 0) + R(1, 1) + R(2, 2) > 0 ? below : above) += 1;
    (R(0, 0) + R(1, 1) + R(2, 2) > 0 ? negative : negative_above) += q.w < 0;
  }
  std::printf("seen: w is negative for %d of %d rotations below 120 degrees and %d of %d above; all are the rotation asked "
              "for to %.0e\n", negative, below, negative_above, above, same);
  bool ok = negative == below && negative_above > 0 && negative_above < above && same < 1e-12;

  const Quatd ten = Quatd::createFromRotMat(about({0, 0, 1}, M_PI / 18));
  const double length = cv::norm(ten.toRotVec()) * 180 / M_PI, half = turn(ten.power(0.5));
  const double slerped = turn(Quatd::slerp(Quatd(1, 0, 0, 0), ten, 0.5));
  std::printf("seen: 10 degrees are a rotation vector of %.1f, half of them by power %.1f, by slerp %.1f\n", length, half, slerped);
  ok = ok && std::fabs(length - 350) < 1e-6 && std::fabs(half + 175) < 1e-6 && std::fabs(slerped - 5) < 1e-6;

  const double small = cv::norm(Quatd::createFromRotMat(about({0, 0, 1}, 1e-8)).toRotVec());
  const double made = Quatd::createFromAngleAxis(1e-7, {0, 0, 1}).toRotVec()[2];
  const double none = Quatd::createFromAngleAxis(0, {0, 0, 1}).toRotVec()[2];
  std::printf("seen: a rotation vector for 1e-8 rad: %.3g; from angle and axis for 1e-7: %.3g, for 0: %g\n", small, made, none);
  ok = ok && small > 1e7 && std::fabs(made - 1e-7) < 1e-9 && std::isnan(none);

  const cv::Affine3d pose(cv::Vec3d(0, 0, M_PI / 18), cv::Vec3d(1, 0, 0));
  const cv::DualQuatd dual = cv::DualQuatd::createFromAffine3(pose);
  const cv::Vec3d all = dual.getTranslation(), some = dual.power(0.5).getTranslation();
  const cv::Vec3d by = cv::DualQuatd::sclerp(cv::DualQuatd(1, 0, 0, 0, 0, 0, 0, 0), dual, 0.5).getTranslation();
  std::printf("seen: half of a step of (%.1f %.1f) by a DualQuat's power is (%.1f %.1f), by sclerp (%.1f %.1f)\n",
              all[0], all[1], some[0], some[1], by[0], by[1]);
  ok = ok && cv::norm(some) > 5 && cv::norm(by) < 0.6;

  double squad = 0, spline = 0;
  for (int first = 0; first < 5; ++first) {
    Quatd key[4];
    for (int i = 0; i < 4; ++i) key[i] = Quatd::createFromRotMat(about({0, 0, 1}, (30 + 20 * (first + i)) * M_PI / 180));
    const double middle = 30 + 20 * (first + 1.5);
    squad = std::fmax(squad, off(Quatd::squad(key[1], Quatd::interPoint(key[0], key[1], key[2]),
                                              Quatd::interPoint(key[1], key[2], key[3]), key[2], 0.5), middle));
    spline = std::fmax(spline, off(Quatd::spline(key[0], key[1], key[2], key[3], 0.5), middle));
  }
  std::printf("seen: between keys 20 degrees apart squad is off by up to %.1f degrees, spline by %.0e\n", squad, spline);
  ok = ok && squad > 15 && spline < 1e-6;
  return ok ? 0 : 1;
}
CPP
g++ -w -std=c++17 -I/usr/include/opencv4 "$tmp/t.cpp" -o "$tmp/t" -lopencv_core 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: a quaternion of a matrix has the sign of the long way round"
