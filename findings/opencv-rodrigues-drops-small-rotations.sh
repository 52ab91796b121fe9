#!/usr/bin/env bash
# cv::Rodrigues turns every rotation below 1e-5 rad into none at all
#
# One would swear: matrix to vector and back is exact to some 1e-15, also near no
#   rotation: small angles are the easy case, and the numbers are doubles.
# What happens: if the sine is below 1e-5 the vector is exactly zero (near half a
#   turn, where the sine is as small, the angle is kept). A platform that
#   turns by half a degree a second, sampled a thousand times a second (8.7e-6 rad
#   between samples), loses all of its 30 degrees a minute when the relative
#   rotations are read off by Rodrigues and added. Going from vector to matrix
#   loses nothing. Eigen's AngleAxis keeps 1e-9.
# What follows: rotation errors, angular speeds and log maps must not be taken by
#   Rodrigues: the plot of a relative rotation error has a floor with a hole,
#   exact zeros next to 1e-5. An error plot that shows exact zeros on a moving
#   camera is a sign of this.
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
echo "expected: 9e-6 rad comes back as 9e-6 rad; 30 degrees after a minute"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np


def back(angle):
    return float(np.linalg.norm(cv2.Rodrigues(cv2.Rodrigues(np.array([0, angle, 0]))[0])[0]))


for angle in (1e-3, 1.1e-5, 9e-6, 1e-6):
    print(f"seen: {angle:g} rad comes back as {back(angle):.6g}")
near_half = np.pi - back(np.pi - 9e-6)
print(f"seen: half a turn less 9e-6 rad comes back as half a turn less {near_half:.6g}")
step = np.radians(0.5) / 1000
before, now, total = np.eye(3), np.eye(3), 0.0
turn = cv2.Rodrigues(np.array([0, 0, step]))[0]
for _ in range(60000):
    before, now = now, now @ turn
    total += cv2.Rodrigues(before.T @ now)[0][2, 0]
heading = np.degrees(np.arctan2(now[1, 0], now[0, 0]))
print(f"seen: after a minute at 0.5 degrees a second: the matrix says {heading:.4f} degrees, the sum of vectors {np.degrees(total):.4f}")
ok = (abs(back(1e-3) - 1e-3) < 1e-9 and abs(back(1.1e-5) - 1.1e-5) < 1e-9 and back(9e-6) == 0 and back(1e-6) == 0
      and abs(heading - 30) < 1e-3 and total == 0)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
