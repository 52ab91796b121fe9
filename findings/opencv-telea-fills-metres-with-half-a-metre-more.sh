#!/usr/bin/env bash
# OpenCV's inpainting by Telea fills a hole in a wall at 2 m with 2.5 m, if depth is in metres
#
# One would swear: what fills a hole is a weighted mean of what is around it; in a wall of constant
#   depth that is the depth of the wall, and metres or millimetres are the same picture times 1000.
# What happens: INPAINT_TELEA takes pictures of floats and has the sums of the bytes it was made
#   for. To each mean it adds a half, for rounding, though nothing is cut off afterwards, and a
#   gradient of length one, whatever the unit: never more than some grey levels, but here they are
#   metres. One missing pixel at 2 m becomes 2.5, at -3 it becomes -2.5, at 0 it is 0.5. In a
#   slanted wall at 1.8 to 3.9 m single pixels come out 1.8 m too far, and holes of 10 x 10 between
#   0.8 m too near and more than a metre too far. The same picture in millimetres, as floats or 16
#   bits, is right to 14 mm, and INPAINT_NS is right in metres too.
# What follows: depth is to be inpainted in millimetres, disparity and flow in sixteenths or less,
#   or by INPAINT_NS. Points that hang half a metre behind the edges of all holes come from this.
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
echo "expected: holes filled to some millimetres, in any unit"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

cv2.setNumThreads(1)
v, u = np.mgrid[0:480, 0:640]
wall = 1 / (0.4 + 0.0003 * (u - 320) + 0.0002 * (v - 240))  # a plane, in metres
holes = np.zeros(wall.shape, np.uint8)
holes[100:110, 100:110] = holes[200:230, 300:304] = holes[400, 500] = holes[50, 60] = 1


def filled(method, kind, unit):  # what is off, in metres
    depth = np.where(holes > 0, 0, wall * unit).astype(kind)
    return (cv2.inpaint(depth, holes, 3, method) / unit - wall)[holes > 0], cv2.inpaint(depth, holes, 3, method)


def alone(value):  # one missing pixel
    picture, hole = np.full((31, 31), value, np.float32), np.zeros((31, 31), np.uint8)
    hole[15, 15] = 1
    return float(cv2.inpaint(picture, hole, 3, cv2.INPAINT_TELEA)[15, 15])


flat = {value: alone(value) for value in (2.0, -3.0, 0.0)}
print("seen, one pixel missing in a wall:", ", ".join(f"{value:g} m becomes {got:.2f}" for value, got in flat.items()))
worst = {}
for name, method, kind, unit in (("Telea, metres", cv2.INPAINT_TELEA, np.float32, 1), ("Telea, float mm", cv2.INPAINT_TELEA, np.float32, 1000),
                                 ("Telea, 16-bit mm", cv2.INPAINT_TELEA, np.uint16, 1000), ("Navier-Stokes, metres", cv2.INPAINT_NS, np.float32, 1)):
    off, picture = filled(method, kind, unit)
    worst[name] = off
    print(f"seen, {name}: from {off.min():.3f} to {off.max():.3f} m off, mean {off.mean():.3f}; "
          f"single pixels {picture[50, 60] / unit - wall[50, 60]:.3f} and {picture[400, 500] / unit - wall[400, 500]:.3f}")
ok = all(abs(got - value - 0.5) < 0.001 for value, got in flat.items())
metres = worst.pop("Telea, metres")
ok = ok and metres.max() > 1.5 and metres.min() < -0.5 and metres.mean() > 0.2
sys.exit(0 if ok and all(np.abs(off).max() < 0.02 for off in worst.values()) else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: Telea's filling counts in grey levels"
