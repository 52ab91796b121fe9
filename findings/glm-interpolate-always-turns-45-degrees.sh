#!/usr/bin/env bash
# glm::interpolate turns by 45 degrees, whatever lies between the two poses
#
# One would swear: interpolate(a, b, 1) is b, and half way is half the rotation; axisAngle of a
#   rotation matrix gives back the angle that it was made with.
# What happens: axisAngle of gtx/matrix_interpolation asks whether cos(angle) - 1 is below 0.01,
#   where its size was meant, and as no cosine is above 1 that is always so: every rotation gets
#   the angle of the exception, pi/4, with the right axis. Two cameras 10 degrees apart are
#   overshot by 35, two 170 apart stop at 45. Only within some 0.3 degrees of none and of half
#   a turn it is otherwise: there it is 0 and 180. Quaternions (quat_cast, slerp) are right.
#   This is 0.9.9.8, of 2020, after which there was no release for more than three years.
# What follows: replayed cameras and ghosts between two poses are to be interpolated by slerp and
#   a translation; a view that swings about before each key pose and jumps back has this. A test
#   of such code must look at the end point, not only at a middle that looks plausible.
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
want libglm-dev 0.9.9.8
want g++ 4:12
cat >"$tmp/t.cpp" <<'CPP'
#define GLM_ENABLE_EXPERIMENTAL
#include <cmath>
#include <cstdio>
#include <initializer_list>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/matrix_interpolation.hpp>

double degrees_of(const glm::dmat4& m) { return glm::degrees(2 * std::acos(std::fmin(1, std::fabs(glm::quat_cast(m).w)))); }

int main() {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, 3));
  const glm::dmat4 from = glm::rotate(glm::dmat4(1), 0.4, glm::dvec3(0, 1, 0));
  bool ok = true;
  for (const double angle : {0.3, 1.0, 10.0, 45.0, 90.0, 170.0, 179.8}) {
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(angle), axis);
    const glm::dmat4 to = glm::translate(glm::dmat4(1), glm::dvec3(1, 0, 0)) * turn * from;
    glm::dvec3 found_axis;
    double found = 0;
    glm::axisAngle(turn, found_axis, found);
    const glm::dmat4 half = glm::interpolate(from, to, 0.5), end = glm::interpolate(from, to, 1.0);
    const double turned_half = degrees_of(half * glm::transpose(glm::dmat4(glm::dmat3(from))));
    const double turned = degrees_of(end * glm::transpose(glm::dmat4(glm::dmat3(from))));
    const glm::dquat slerped = glm::slerp(glm::quat_cast(from), glm::quat_cast(to), 1.0);
    const double missed = glm::degrees(2 * std::acos(std::fmin(1, std::fabs(glm::dot(slerped, glm::quat_cast(to))))));
    std::printf("seen, %.1f degrees: axisAngle %.2f, half way %.2f, end %.2f, shift at the end %.1f; slerp misses the end by %.1g\n",
                angle, glm::degrees(found), turned_half, turned, end[3].x, missed);
    const double expected = angle < 0.31 ? 0 : angle > 179.4 ? 180 : 45;
    ok = ok && std::fabs(glm::degrees(found) - expected) < 0.01 && end[3].x == 1 && missed < 1e-5;
    if (expected == 45) ok = ok && std::fabs(turned - 45) < 0.01 && std::fabs(turned_half - 22.5) < 0.01 && glm::dot(found_axis, axis) > 0.999;
  }
  return ok ? 0 : 1;
}
CPP
g++ -O1 "$tmp/t.cpp" -o "$tmp/t" 2>"$tmp/errors" || { tail -3 "$tmp/errors"; echo "does not compile: not looked at"; exit 2; }
echo "expected: the angle itself, half of it half way, and all of it at the end"
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: 45 degrees from every pose to every other"
