#!/usr/bin/env bash
# ViSP interpolates a depth picture of floats to whole metres
#
# One would swear: vpImage<float>::getValue(i, j) is bilinear interpolation "at sub-pixel position"
#   of a picture of floats; at the pixels themselves it gives the pixels; what it does for double it
#   does for float.
# What happens: there is one text for all kinds of pixels, which rounds its result to a whole number
#   before it is cast to the kind, and a second one for double, which does not. A wall at 1.4 m is
#   at 1, one at 1.6 at 2, asked for at whole pixels or between them, by two numbers or by a
#   vpImagePoint; 0.3 m are none. double is right, [i][j] is right for float. Bytes, for which there
#   is a third text, are cut instead of rounded: on average half a grey level is missing between
#   pixels.
# What follows: float is the kind in which ViSP's own vpKinect hands out depth, in metres. Depth
#   that is to be looked up between pixels is to be kept in vpImage<double>, or in 16-bit
#   millimetres, where it is rounded to one; a cloud in sheets a metre apart comes from this.
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
want libvisp-core-dev 3.5.0
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: 1.4 for a picture of 1.4"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>

#include <visp3/core/vpImage.h>

int main() {
  bool ok = true;
  for (const double depth : {0.3, 1.4, 1.6, 3.51}) {
    const vpImage<float> f(48, 64, float(depth));
    const vpImage<double> d(48, 64, depth);
    const vpImage<unsigned short> s(48, 64, static_cast<unsigned short>(std::round(1000 * depth)));
    const double whole = f.getValue(10.0, 20.0), between = f.getValue(10.5, 20.25), point = f.getValue(vpImagePoint(10.5, 20.25));
    std::printf("seen, depth %g: float %g at a pixel, %g between, %g by a point, %g by [][]; double %g between; 16-bit mm %d\n", depth, whole, between,
                point, f[10][20], d.getValue(10.5, 20.25), int(s.getValue(10.5, 20.25)));
    ok = ok && whole == std::round(depth) && between == whole && point == whole && std::abs(f[10][20] - depth) < 1e-6 &&
         std::abs(d.getValue(10.5, 20.25) - depth) < 1e-9 && s.getValue(10.5, 20.25) == std::round(1000 * depth);
  }
  vpImage<float> slope(48, 64);
  vpImage<unsigned char> grey(48, 64);
  for (unsigned i = 0; i < 48; ++i)
    for (unsigned j = 0; j < 64; ++j) slope[i][j] = 0.5f + 0.03125f * j, grey[i][j] = static_cast<unsigned char>(3 * j);
  double sum = 0, worst = 0;
  int n = 0;
  for (double j = 1.05; j < 62; j += 0.1, ++n) {
    sum += grey.getValue(10.0, j) - 3 * j;
    worst = std::fmax(worst, std::abs(slope.getValue(10.0, j) - (0.5 + 0.03125 * j)));
  }
  std::printf("seen: a slope from 0.5 to 2.5 m is up to %.2f m off; a slope of bytes by %.2f on average\n", worst, sum / n);
  return ok && worst > 0.45 && worst < 0.51 && sum / n < -0.4 && sum / n > -0.6 ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 -I"/usr/include/$(uname -m)-linux-gnu" t.cpp -o t -lvisp_core >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: whole numbers of metres"
