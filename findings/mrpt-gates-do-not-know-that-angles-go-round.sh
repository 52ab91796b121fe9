#!/usr/bin/env bash
# MRPT's Mahalanobis distance of two 3-D poses 1.1 degrees apart is 1.41, or 443 where the yaw passes 180 degrees
#
# One would swear: a difference of poses with angles is taken round the circle; the 2-D class beside
#   it does it, and the 3-D one subtracts poses in all else that it does.
# What happens: CPose3DPDFGaussian::mahalanobisDistanceTo, and that of CPose3DPDFGaussianInf,
#   subtracts the six numbers as they are. With a sigma of 0.01 each, yaw 3.10 against 3.12 is 1.41,
#   3.13 against 3.15 is 442.9, as 3.15 is kept as -3.13; so it is for roll. CPosePDFGaussian gives
#   1.41 for both.
# What follows: a gate for loop closures or matches of 3-D poses that is made of this distance never
#   opens for those that look one way, against the first camera's direction, where yaw is 180
#   degrees, and a test that never turns that far is content. The mean of the second should be
#   brought within pi of the first by hand, or the distance taken from the logarithm of the
#   difference.
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
want libmrpt-poses-dev 1:2.5.8
want libmrpt-bayes-dev 1:2.5.8
want libeigen3-dev 3.4.0
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: 1.41 all round, in 2-D and in 3-D"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>

#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPose3DPDFGaussianInf.h>
#include <mrpt/poses/CPosePDFGaussian.h>

using namespace mrpt::poses;

int main() {
  bool ok = true;
  for (const double a : {0.0, 1.5, 3.10, 3.13, 3.141}) {
    const double b = a + 0.02;
    const auto flat = [](double yaw) {
      CPosePDFGaussian g;
      g.mean = CPose2D(0, 0, yaw);
      g.cov.setIdentity(), g.cov *= 1e-4;
      return g;
    };
    const auto solid = [](double yaw, double roll) {
      CPose3DPDFGaussian g;
      g.mean = CPose3D(0, 0, 0, yaw, 0, roll);
      g.cov.setIdentity(), g.cov *= 1e-4;
      return g;
    };
    CPose3DPDFGaussianInf p, q;
    p.copyFrom(solid(a, 0)), q.copyFrom(solid(b, 0));
    const double two = flat(a).mahalanobisDistanceTo(flat(b)), yaw = solid(a, 0).mahalanobisDistanceTo(solid(b, 0)),
                 roll = solid(0, a).mahalanobisDistanceTo(solid(0, b)), inf = p.mahalanobisDistanceTo(q);
    std::printf("seen, %.3f against %.3f: 2-D %.2f; 3-D yaw %.2f, roll %.2f, by information %.2f\n", a, b, two, yaw, roll, inf);
    const bool passes = b > 3.1416;
    ok = ok && std::abs(two - std::sqrt(2.0)) < 0.01;
    for (const double d : {yaw, roll, inf}) ok = ok && (passes ? std::abs(d - (2 * M_PI - 0.02) / std::sqrt(2e-4)) < 1 : std::abs(d - std::sqrt(2.0)) < 0.01);
  }
  return ok ? 0 : 1;
}
CPP
inc=$(printf -- '-I%s ' /usr/include/mrpt/*/include)
# shellcheck disable=SC2086
g++ -w -O1 -std=c++17 $inc -I/usr/include/eigen3 t.cpp -o t -lmrpt-poses -lmrpt-bayes -lmrpt-math -lmrpt-system -lmrpt-random -lmrpt-core \
  -lmrpt-serialization -lmrpt-rtti >cc.log 2>&1 || { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: a turn apart"
