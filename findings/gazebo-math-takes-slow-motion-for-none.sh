#!/usr/bin/env bash
# Gazebo's maths takes slow motion for none: no angle below 0.11 degrees, one pose within a millimetre
#
# One would swear: Quaterniond::ToAxis gives the angle of a rotation, down to what a double can
#   tell; and a pose is == another when all of its numbers are.
# What happens: ToAxis asks whether the square of the vector part is 0, and its "equal" has a
#   tolerance of 1e-6: squared, so that everything up to 0.002 rad, 0.1146 degrees, has the angle 0
#   about x. A camera that turns by 3 degrees a second at 30 pictures a second does not turn at all
#   from frame to frame: of 90 degrees in half a minute nothing is left in the sum. Quaternions and
#   poses are == within 0.001 in each number: poses 0.9 mm and 0.1 degrees apart are equal, their
#   pages say "true if equal", and A == B with B == C does not make A == C. Euler angles, Log and
#   Slerp of the same quaternions are right to the last digits.
# What follows: angles between poses of a simulated run (a truth from Gazebo) come from 2
#   atan2(|vector|, |w|); "has it moved" is a difference and a threshold of one's own. Relative
#   rotations that are all exactly 0 below a tenth of a degree and right above are this.
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
want libignition-math-dev 6.10.0
want g++ 4:12
echo "expected: the angles that the rotations were made with; no pose equal to one that differs"
cat >"$tmp/t.cpp" <<'CPP'
#include <cmath>
#include <cstdio>

#include <ignition/math/Pose3.hh>
#include <ignition/math/Quaternion.hh>

using ignition::math::Pose3d;
using ignition::math::Quaterniond;
using ignition::math::Vector3d;

double axis_angle(const Quaterniond& q) {
  Vector3d axis;
  double angle = 0;
  q.ToAxis(axis, angle);
  return angle * 180 / M_PI;
}

double by_tangent(const Quaterniond& q) {
  return 2 * std::atan2(Vector3d(q.X(), q.Y(), q.Z()).Length(), std::fabs(q.W())) * 180 / M_PI;
}

int main() {
  bool ok = true;
  for (const double degrees : {0.01, 0.1, 0.114, 0.115, 1.0}) {
    const Quaterniond q(Vector3d(0, 0, 1), degrees * M_PI / 180);
    const double log = 2 * q.Log().Z() * 180 / M_PI;
    std::printf("seen: %.3f degrees: ToAxis %.4f, arc tangent %.4f, Yaw %.4f, Log %.4f\n", degrees, axis_angle(q), by_tangent(q),
                q.Yaw() * 180 / M_PI, log);
    ok = ok && std::fabs(axis_angle(q) - (degrees < 0.1146 ? 0 : degrees)) < 1e-6 && std::fabs(by_tangent(q) - degrees) < 1e-9 &&
         std::fabs(log - degrees) < 1e-6;
  }

  double sum = 0, tangents = 0;
  for (int frame = 0; frame < 900; ++frame) {  // 3 degrees a second
    const Quaterniond from(0, 0, 0.1 * frame * M_PI / 180), to(0, 0, 0.1 * (frame + 1) * M_PI / 180);
    sum += axis_angle(from.Inverse() * to);
    tangents += by_tangent(from.Inverse() * to);
  }
  std::printf("seen: 900 steps of 0.1 degrees add up to %.2f degrees by ToAxis, %.2f by arc tangent\n", sum, tangents);
  ok = ok && sum == 0 && std::fabs(tangents - 90) < 1e-6;

  const Pose3d a(0, 0, 0, 0, 0, 0), b(0.0009, 0, 0, 0, 0, 0.1 * M_PI / 180), c(0.0018, 0, 0, 0, 0, 0.2 * M_PI / 180);
  std::printf("seen: A == B, 0.9 mm and 0.1 degrees away: %d; B == C, as far again: %d; A == C: %d; A != B: %d\n", a == b, b == c,
              a == c, a != b);
  ok = ok && a == b && b == c && !(a == c) && !(a != b) && a.Rot() == b.Rot();
  return ok ? 0 : 1;
}
CPP
g++ -w -std=c++17 -I/usr/include/ignition/math6 "$tmp/t.cpp" -o "$tmp/t" -lignition-math6 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: small rotations have no angle, and near poses are equal"
