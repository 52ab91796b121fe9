#!/usr/bin/env bash
# Corners that are handed from goodFeaturesToTrack to OpenCV's RLOF come back as they were, status 1
#
# One would swear: calcOpticalFlowSparseRLOF takes points as calcOpticalFlowPyrLK does, whose
#   signature it has: what goodFeaturesToTrack returns is tracked, and status 1 means tracked.
# What happens: it tracks them, into a row of points of its own; if the points came as a column
#   (N, 1, 2), which is the shape that goodFeaturesToTrack returns, or as (N, 2), that row is not
#   copied out. Points given as nextPts come back bit for bit as they were given; without them comes
#   back what the memory held, which may be the right answer of a PyrLK called just before. Status
#   is 1 for all, and the error 0. As (1, N, 2) the same points are found to a hundredth of a pixel.
# What follows: hand over points.reshape(1, -1, 2). A camera that stands still by all of its
#   points while the picture moves, with a perfect record of tracking, is this; a tracker is to be
#   asked for the difference in grey values at the points it returns, not for its status.
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
echo "expected: corners move by (2, 1) in any of the three shapes"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

cv2.setNumThreads(1)
noise = np.random.default_rng(1).integers(0, 256, (240, 320)).astype(np.uint8)
first = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
second = np.roll(first, (1, 2), (0, 1))
inner = np.zeros_like(first)
inner[40:200, 40:280] = 255
corners = cv2.goodFeaturesToTrack(first, 100, 0.01, 10, mask=inner)
one, two = (cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR) for picture in (first, second))
print(f"seen: goodFeaturesToTrack returns {len(corners)} corners in an array of {corners.shape}")


def moved(found):
    return np.median(found.reshape(-1, 2) - corners.reshape(-1, 2), axis=0)


found, status, _ = cv2.calcOpticalFlowPyrLK(first, second, corners, None)
print(f"seen: PyrLK: moved by ({moved(found)[0]:.2f}, {moved(found)[1]:.2f}), {int(status.sum())} tracked")
ok = np.allclose(moved(found), (2, 1), atol=0.02)
for shape in ((-1, 1, 2), (-1, 2), (1, -1, 2)):
    points = corners.reshape(shape)
    given = points + np.float32(7)
    found, status, error = cv2.optflow.calcOpticalFlowSparseRLOF(one, two, points, given.copy())
    same = np.array_equal(found, given)
    print(f"seen: RLOF, {points.shape}: {int(status.sum())} tracked, error {error.max():.0f} at most; "
          + ("nextPts comes back as given" if same else f"moved by ({moved(found)[0]:.2f}, {moved(found)[1]:.2f})"))
    row = shape[0] == 1
    ok = ok and status.all() and error.max() == 0 and found.shape == points.shape and same != row
    ok = ok and (not row or np.allclose(moved(found), (2, 1), atol=0.02))
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: points in a column are not moved, and count as tracked"
