#!/usr/bin/env bash
# dlib's pyramids do not know where their own pixels came from: quarter pixels that add up to fifteen
#
# One would swear: pyramid_down's point_down and point_up say where a point of the picture lies in the
#   level below and where it came from; that is what they are for, and boxes that were found in
#   coarse levels are brought up by them.
# What happens: for pyramid_down<2>, the default, point_down divides by two and takes off 1.25 in x
#   and 0.75 in y, but the filter puts a pixel at half its place less 1 in both. A point found in one
#   level comes back 0.5 pixels too far right and 0.5 too high, after five levels 15.5: each doubles
#   and adds again. point_down and point_up agree with each other, so that going there and back
#   shows nothing. With pyramid_down<3> a point comes back 0.25 pixels too far right and too low.
#   Brightness is right.
# What follows: what was found in level n of pyramid_down<2> is to be brought up by 2 p + 2 a level,
#   or moved by half of 2^n - 1 left and down after point_up. Corners or boxes of coarse levels that lie
#   to the upper right of those of fine ones are no motion.
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
want libdlib-dev 19.24
want g++ 4:12
echo "expected: point_up brings a blob's middle back to where it was drawn, from any level"
cat >"$tmp/t.cpp" <<'CPP'
#include <cmath>
#include <cstdio>

#include <dlib/array2d.h>
#include <dlib/image_transforms.h>

using namespace dlib;
using Point = dlib::vector<double, 2>;

Point middle(const array2d<float>& picture) {
  double sum = 0, x = 0, y = 0;
  for (long r = 0; r < picture.nr(); ++r)
    for (long c = 0; c < picture.nc(); ++c) sum += picture[r][c], x += c * picture[r][c], y += r * picture[r][c];
  return Point(x / sum, y / sum);
}

array2d<float> blob(Point at, double size, long rows, long columns) {
  array2d<float> picture(rows, columns);
  for (long r = 0; r < rows; ++r)
    for (long c = 0; c < columns; ++c)
      picture[r][c] = 200 * std::exp(-(std::pow(c - at.x(), 2) + std::pow(r - at.y(), 2)) / (2 * size * size));
  return picture;
}

template <class Pyramid>
Point comes_back(const array2d<float>& picture, int levels, Point* right_for_two = nullptr) {
  array2d<float> level, next;
  assign_image(level, picture);
  for (int i = 0; i < levels; ++i) {
    Pyramid()(level, next);
    swap(level, next);
  }
  Point found = middle(level), up = found;
  for (int i = 0; i < levels; ++i) up = Pyramid().point_up(up), found = found * 2 + Point(2, 2);
  if (right_for_two) *right_for_two = found;
  return up;
}

int main() {
  bool ok = true;
  for (const Point at : {Point(700, 500), Point(611.3, 540.8)}) {
    const array2d<float> picture = blob(at, 60, 1000, 1400);
    for (int levels = 1; levels <= 5; ++levels) {
      Point mended;
      const Point e = comes_back<pyramid_down<2>>(picture, levels, &mended) - at;
      std::printf("seen: from level %d of pyramid_down<2> %.2f px right and %.2f down; by 2 p + 2 a level %.2f and %.2f\n", levels, e.x(),
                  e.y(), (mended - at).x(), (mended - at).y());
      const double want = 0.5 * ((1 << levels) - 1);
      ok = ok && std::fabs(e.x() - want) < 0.1 && std::fabs(e.y() + want) < 0.1 && (mended - at).length() < 0.1;
    }
    const Point there = pyramid_down<2>().point_up(pyramid_down<2>().point_down(at)) - at;
    const Point e3 = comes_back<pyramid_down<3>>(picture, 1) - at;
    std::printf("seen: from pyramid_down<3> %.2f right and %.2f down; down to level 1 and up again without a picture: %.0e\n", e3.x(),
                e3.y(), there.length());
    ok = ok && there.length() < 1e-9 && std::fabs(e3.x() - 0.25) < 0.02 && std::fabs(e3.y() - 0.25) < 0.02;
  }
  array2d<float> level;
  pyramid_down<2>()(blob(Point(700, 500), 60, 1000, 1400), level);
  std::printf("seen: the blob's middle is as bright as before to %.2f of 200\n", std::fabs(level[249][349] - 200));
  return ok && std::fabs(level[249][349] - 200) < 0.2 ? 0 : 1;
}
CPP
g++ -w -O2 -std=c++17 "$tmp/t.cpp" -o "$tmp/t" -ldlib >"$tmp/cc.log" 2>&1 ||
  { grep -m3 -E 'error|undefined' "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: up and to the right, doubled by each level"
