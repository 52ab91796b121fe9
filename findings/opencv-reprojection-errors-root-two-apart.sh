#!/usr/bin/env bash
# OpenCV's two reprojection errors are a square root of two apart
#
# One would swear: the reprojection error in pixels of the same corners under the same
#   camera and poses is one number, whichever function of calib3d tells it; all
#   are called RMS, and solvePnPGeneric's description divides by the number of points.
# What happens: calibrateCamera, its per-view errors, stereoCalibrate and
#   fisheye::calibrate divide by the number of points; solvePnPGeneric by twice
#   that. Corners with half a pixel of noise in x and in y have 0.68 by the first
#   and 0.48 by the second, to five digits a factor of 1.41421.
# What follows: the sigma of a measurement, for weights, gates and chi-square, is
#   solvePnPGeneric's number; calibrateCamera's taken for it is 1.41 too large, and
#   makes an NEES or a chi-square half of what it should be. A camera is not worse than its
#   calibration because of 0.48 and 0.68. A debugger that prints such a figure
#   writes "per point" or "per coordinate" beside it.
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
want python3-numpy 1:1.24
echo "expected: one and the same reprojection error from all of them"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

cv2.setNumThreads(1)
random = np.random.default_rng(1)
board = np.zeros((48, 3), np.float32)
board[:, :2] = np.mgrid[0:8, 0:6].T.reshape(-1, 2) * 0.03
K = np.array([[525.0, 0, 319.5], [0, 525, 239.5], [0, 0, 1]])
boards, corners = [], []
for _ in range(12):
    turn, shift = random.normal(0, 0.3, 3), np.array([-0.1, -0.07, 0.5]) + random.normal(0, 0.03, 3)
    seen, _ = cv2.projectPoints(board, turn, shift, K, None)
    boards.append(board)
    corners.append((seen + random.normal(0, 0.5, seen.shape)).astype(np.float32))


def ours(project, turns, shifts, K, D, points, images):
    squares = sum(((project(p, r, t, K, D)[0].reshape(-1, 2) - i.reshape(-1, 2)) ** 2).sum()
                  for p, i, r, t in zip(points, images, turns, shifts))
    return (squares / (48 * 12)) ** 0.5, (squares / (2 * 48 * 12)) ** 0.5


size = (640, 480)
found = cv2.calibrateCameraExtended(boards, corners, size, None, None)
rms, K2, D2, turns, shifts, views = found[0], found[1], found[2], found[3], found[4], found[7]
point, coordinate = ours(cv2.projectPoints, turns, shifts, K2, D2, boards, corners)
view = float(np.sqrt(np.mean(np.square(views))))
stereo = cv2.stereoCalibrate(boards, corners, corners, K2, D2, K2, D2, size, flags=cv2.CALIB_FIX_INTRINSIC)[0]
pnp = float(np.sqrt(np.mean([float(e[3][0, 0]) ** 2 for e in
                             (cv2.solvePnPGeneric(b, c, K2, D2) for b, c in zip(boards, corners))])))
boards64 = [b.reshape(1, -1, 3).astype(float) for b in boards]
corners64 = [c.reshape(1, -1, 2).astype(float) for c in corners]
fish = cv2.fisheye.calibrate(boards64, corners64, size, None, None,
                             flags=cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC | cv2.fisheye.CALIB_FIX_SKEW)
fish_point, _ = ours(cv2.fisheye.projectPoints, fish[3], fish[4], fish[1], fish[2], boards64, corners64)
print(f"seen: by hand {point:.5f} per point, {coordinate:.5f} per coordinate")
print(f"seen: calibrateCamera {rms:.5f}, its views together {view:.5f}, stereoCalibrate (the camera with itself) {stereo:.5f}")
print(f"seen: solvePnPGeneric, views together {pnp:.5f}; calibrateCamera is {rms / pnp:.5f} times that")
print(f"seen: fisheye::calibrate {fish[0]:.5f}, by hand per point {fish_point:.5f}")
near = lambda a, b: abs(a - b) < 2e-4 * b
ok = (all(near(x, point) for x in (rms, view, stereo)) and near(pnp, coordinate) and near(fish[0], fish_point)
      and 0.4 < coordinate < 0.55)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
