#!/usr/bin/env bash
# With KITTI's own distortion, points 55 to 61 degrees to the side land in the picture
#
# One would swear: a point in front of the camera whose projection falls inside the
#   picture is in the field of view: that is the usual test before a map
#   point is looked for.
# What happens: the radial polynomial is a fit to what the camera sees (42 degrees to the
#   right) and turns back beyond. With the raw left grey camera of KITTI's
#   2011_09_26 the image moves outwards until 50 degrees, then back: a point at
#   60 degrees to the right lands at column 296, in the left half, and
#   cv::projectPoints says nothing, nor does any other user of the same
#   formula. (EuRoC's cam0 does not turn back.)
# What follows: a projection needs the largest radius up to which the polynomial
#   rises, worked out once by camera, and points beyond are outside whatever
#   their pixel is. A debugger should draw that radius, and count matches of
#   points that come from beyond it: they are wrong matches that pass every
#   test by pixels. Undistorting with a wide view makes ghosts of the
#   border by the same turn.
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
echo "expected: columns that grow with the angle; outside (1392 or more) from some angle on"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

cameras = {  # published calibrations: KITTI raw 2011_09_26, camera 00; EuRoC, cam0
    "KITTI": (1392, [984.2439, 980.8141, 690.0, 233.1966],
              [-0.3728755, 0.2037299, 0.002219027, 0.001383707, -0.07233722]),
    "EuRoC": (752, [458.654, 457.296, 367.215, 248.375], [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0]),
}
angles = np.arange(0, 80.5, 0.5)
seen = {}
for name, (width, (fx, fy, cx, cy), d) in cameras.items():
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    points = np.c_[np.tan(np.radians(angles)), np.zeros_like(angles), np.ones_like(angles)]
    u = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, np.array(d))[0][:, 0, 0]
    turn = angles[int(np.argmax(u))]
    # First angle outside, or beyond the turn, whose column is inside all the same.
    ghosts = angles[(angles > turn) & (u >= 0) & (u < width)]
    seen[name] = turn, ghosts, u
    print(f"seen: {name}: " + ", ".join(f"{a:g} degrees at {u[angles == a][0]:.0f}" for a in (30, 38, 50, 55, 60, 62)))
    print(f"seen: {name}: " + (f"turns back at {turn:g} degrees; points at {ghosts[0]:g} to {ghosts[-1]:g} degrees are in the "
          f"picture of {width} columns" if turn < 80 else "does not turn back"))
turn, ghosts, u = seen["KITTI"]
ok = (50 <= turn <= 51.5 and 60 in ghosts and abs(u[angles == 60][0] - 296.2) < 0.5 and ghosts[-1] in (60, 60.5, 61)
      and seen["EuRoC"][0] == 80)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
