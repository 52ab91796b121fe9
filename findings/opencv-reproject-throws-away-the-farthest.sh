#!/usr/bin/env bash
# cv::reprojectImageTo3D takes the smallest disparity of each picture for missing
#
# One would swear: handleMissingValues marks pixels without a disparity, which are
#   those that the matcher set to minDisparity - 1; a picture in which all pixels
#   were matched is left as it is.
# What happens: the function does not know the matcher. It looks for the smallest
#   value in the picture that it is given and sends every pixel of that value
#   to z = 10000. In a full picture that is the farthest surface: a flat back wall
#   is gone, whole. It changes from frame to frame: as soon as one pixel is
#   really missing, the wall is back. And if two values mark what is missing (-1
#   from the matcher, -2 from a filter after it), only the lower is found; the
#   other becomes a point behind the camera.
# What follows: mask by the matcher's own rule and use handleMissingValues = false.
#   Counts of valid points over time that jump by a whole surface are this.
#   Cropping a picture changes which points exist.
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
echo "expected: the wall at 4 m stays in both pictures; -1 and -2 are both missing"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

f, baseline = 400.0, 0.1
Q = np.array([[1, 0, 0, -32], [0, 1, 0, -24], [0, 0, 0, f], [0, 0, 1 / baseline, 0]])
disparity = np.full((48, 64), 10.0, np.float32)  # a wall, 4 m off
disparity[10:30, 20:40] = 20.0  # a box, 2 m off


def depth(d):
    return cv2.reprojectImageTo3D(d, Q, handleMissingValues=True)[:, :, 2]


def told(name, z):
    values, counts = np.unique(z, return_counts=True)
    print(f"seen: {name}: " + ", ".join(f"{c} pixels at z = {v:g}" for v, c in zip(values, counts)))


full = depth(disparity)
told("every pixel matched", full)
one = disparity.copy()
one[0, 0] = -1
holed = depth(one)
told("one pixel missing", holed)
two = one.copy()
two[0, 1] = -2
both = depth(two)
told("one missing by -1, one by -2", both)
ok = ((full[disparity == 10] == 10000).all() and (full[disparity == 20] == 2).all()
      and holed[0, 0] == 10000 and (holed == 4).sum() == 48 * 64 - 401
      and both[0, 1] == 10000 and both[0, 0] == -40)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
