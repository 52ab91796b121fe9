#!/usr/bin/env bash
# One far pixel makes cv::bilateralFilter blur the edges of the whole depth picture
#
# One would swear: the filter is local: a pixel changes what is within its radius, and one
#   that is kilometres off not even that, as its weight is nothing.
# What happens: for floats the weights are read, interpolated by straight lines, from a table
#   of 4096 steps between the smallest and the largest value of the picture. A single pixel of
#   10000 makes each step 2.4 m wide, and whatever the sigma, values up to 2.4 m apart count
#   as alike: an edge of 10 cm at 1 m, kept within 0.1 mm by sigma = 1 cm, is smeared over
#   eight pixels, 4 cm at the edge, all over the picture. At 1000 it is 3 cm; at 65.535 still
#   0.1 mm. 10000 is what cv::reprojectImageTo3D writes for missing disparities, and it writes
#   at least one in every picture: its smallest disparity.
# What follows: before this filter, missing depth must be set to 0 or NaN (NaN is left out
#   and stays out), and far values clipped, until sigma is not below a 4096th of the range that
#   is left. The smoothness of a picture otherwise depends on its farthest pixel, which
#   flickers from frame to frame. The same goes for weights, densities and all else that has
#   a long tail. Pictures of 8 bits are safe: they have an entry for each difference.
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
echo "expected: an edge 100 pixels from a pixel of 10000 is as sharp as without that pixel"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

noise = np.random.default_rng(1).normal(0, 0.002, (240, 320))
disparity = (60 / (np.where(np.arange(320) < 160, 1.0, 1.1) + noise)).astype(np.float32)  # f * baseline = 60
disparity[20, 20] = -1  # missing
q = np.array([[1, 0, 0, -160], [0, 1, 0, -120], [0, 0, 0, 500], [0, 0, 1 / 0.12, 0]])
depth = cv2.reprojectImageTo3D(disparity, q, handleMissingValues=True)[..., 2]
far = depth[20, 20]

def edge(missing):
    picture = depth.copy()
    picture[20, 20] = missing
    smooth = cv2.bilateralFilter(picture, 9, 0.01, 3)[100:200, 156:164].mean(0)
    return 1e3 * np.abs(smooth - np.repeat([1.0, 1.1], 4)).max()

off = {value: edge(value) for value in (far, 1000, 65.535, 0, np.nan)}
print(f"seen: {np.sum(depth == far)} pixel of {far:.0f}; the mean edge is off by",
      ", ".join(f"{mm:.1f} mm with {value:g}" for value, mm in off.items()))
sharp = max(off[65.535], off[0], off[np.nan])
sys.exit(0 if far == 10000 and off[far] > 30 and off[1000] > 20 and sharp < 0.5 else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "changed: the filter is local now, or never was"; exit 1; }
echo "as described: a pixel far away in value blurs edges far away in the picture"
