#!/usr/bin/env bash
# Points without disparity come out of OpenCV's triangulation at one unit's distance
#
# One would swear: two equal pixels of a rectified pair are a point at infinity, and come out
#   as inf, NaN or something absurdly large; or as (0, 0, 0), as the documentation of
#   convertPointsFromHomogeneous says; in any case as something that no range check lets
#   through.
# What happens: cv::triangulatePoints gives vectors of four of length one, and where the last
#   number is zero, or below some 1e-7, cv::convertPointsFromHomogeneous does not divide
#   by it but takes the other three as they are. These have length one: clouds, sky and
#   far houses stand on a sphere of radius 1 around the camera, and as their sign is chance,
#   which here fell to minus, nearly all of them behind it. With f = 500 and 12 cm a
#   disparity of one pixel is 60 m; of none, 1 m. Corners at whole pixels, as FAST finds them,
#   have a disparity of exactly none often. A pair of cameras that is turned does the same.
# What follows: w is to be looked at before it is divided by; with metres, w of a unit vector
#   below 1e-4 is farther than anybody measures. Who asks only for a range loses nothing and
#   has a shell of radius 1 in the cloud, one metre or one millimetre as the unit is; who
#   asks for positive depth throws the farthest points out as behind the camera, those
#   that know the rotation best.
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
want python3-opencv 4.6.0
echo "expected: disparity 1 at 60 m, disparity 0 much farther, not finite, or at (0, 0, 0)"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

k = np.array([[500, 0, 320], [0, 500, 240], [0, 0, 1.0]])


def triangulated(pixels, disparity, unit=1.0):
    right = k @ np.c_[np.eye(3), [-0.12 / unit, 0, 0]]
    four = cv2.triangulatePoints(k @ np.eye(3, 4), right, pixels.T, (pixels - [disparity, 0]).T)
    return four[3], cv2.convertPointsFromHomogeneous(four.T)[:, 0]


pixels = np.random.default_rng(1).integers([0, 0], [640, 480], (200, 2)).astype(float)
near, one, none = (triangulated(pixels, d) for d in (20, 1, 0))
radius = np.linalg.norm(none[1], axis=1)
behind = np.sum(none[1][:, 2] < 0)
print(f"seen: depth {near[1][:, 2].mean():.2f} at disparity 20, {one[1][:, 2].mean():.2f} at 1")
print(f"seen: at 0 distances of {radius.min():.4f} to {radius.max():.4f}, {behind} of 200 behind the camera, "
      f"w at most {np.abs(none[0]).max():.0e}, {np.sum(none[0] == 0)} times exactly 0")
small = cv2.convertPointsFromHomogeneous(np.array([[0.6, 0, 0.8, 1e-8], [0.6, 0, 0.8, 1e-6]]))[:, 0, 2]
print(f"seen: z = 0.8 with w = 1e-8 gives {small[0]:g}, with 1e-6 {small[1]:g}")
sys.exit(0 if np.allclose(near[1][:, 2], 3) and np.allclose(one[1][:, 2], 60) and np.allclose(radius, 1)
         and behind > 100 and small[0] == 0.8 and np.isclose(small[1], 8e5) else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "changed: points at infinity are farther than 1"; exit 1; }
echo "as described: what is infinitely far comes out at distance 1"
