#!/usr/bin/env bash
# The inverse of Eigen's EulerAngles is another rotation: (10, 20, 30) degrees come back 12 off
#
# One would swear: EulerAngles is a RotationBase like Quaternion and AngleAxis: a.inverse() * a is
#   no rotation; its page says "The Euler angles rotation inverse".
# What happens: inverse() negates the three angles and leaves their order, as the page goes on to
#   say ("which is as same as the negative"). That is the inverse only while two of the three are
#   zero: of Rx Ry Rz it is Rz^-1 Ry^-1 Rx^-1. The quaternion and the AngleAxis of the same angles
#   invert rightly. For angles of 1, 10 and 40 degrees each, a.inverse() * a is a turn by 0.03, 3
#   and 45 degrees: with a camera held nearly level tests pass, with one in the hand poses are off
#   by degrees.
# What follows: Euler angles are for printing; world_from_camera is inverted as a quaternion or
#   matrix. An error that grows with the square of the tilt, or a tolerance that had to be put into
#   a test of an inverse, is this.
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
want libeigen3-dev 3.4.0
want g++ 4:12
echo "expected: inverse() * rotation is no rotation, for each of the types"
cat >"$tmp/t.cpp" <<'CPP'
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <unsupported/Eigen/EulerAngles>

template <class Rotation>
double left_over(const Rotation& r) {  // degrees
  return Eigen::AngleAxisd(Eigen::Matrix3d(r.inverse().toRotationMatrix() * r.toRotationMatrix())).angle() * 180 / M_PI;
}

int main() {
  bool ok = true;
  const double to_rad = M_PI / 180;
  const struct { double a, b, c, off; } all[] = {{0, 0, 40, 0}, {1, 1, 1, 0.03}, {10, 10, 10, 3}, {10, 20, 30, 12}, {40, 40, 40, 44.9}};
  for (const auto& e : all) {
    const Eigen::EulerAnglesXYZd xyz(e.a * to_rad, e.b * to_rad, e.c * to_rad);
    const Eigen::EulerAnglesZYXd zyx(e.a * to_rad, e.b * to_rad, e.c * to_rad);
    const Eigen::Quaterniond q(xyz.toRotationMatrix());
    std::printf("seen, (%g, %g, %g) degrees: inverse() * rotation turns by %.3f degrees as EulerAnglesXYZ, %.3f as ZYX, "
                "%.0e as quaternion, %.0e as AngleAxis\n", e.a, e.b, e.c, left_over(xyz), left_over(zyx), left_over(q),
                left_over(Eigen::AngleAxisd(q)));
    const auto as_said = [&](double turn) { return std::fabs(turn - e.off) <= 0.05 * e.off + 1e-6; };
    ok = ok && as_said(left_over(xyz)) && left_over(q) < 1e-6 && left_over(Eigen::AngleAxisd(q)) < 1e-6;
  }
  return ok ? 0 : 1;
}
CPP
g++ -w -std=c++17 -I/usr/include/eigen3 "$tmp/t.cpp" -o "$tmp/t" 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: negated Euler angles are taken for the inverse"
