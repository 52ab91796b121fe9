#!/usr/bin/env bash
# Lucas-Kanade in OpenCV takes half as long with a window of 16 as with one of 15
#
# One would swear: a smaller window is less work, so that winSize=(15, 15) is
#   quicker than (16, 16), and the usual (21, 21), OpenCV's own, than (24, 24).
# What happens: a window's rows are worked on eight pixels at a time, and what is
#   left over one by one, in sums that wait for each other: of a row of 15 seven
#   pixels, of 21 five. 16 takes about half the time of 15, 24 less than 21 and
#   than 23, 32 less than 31, on the same points to the same end.
# What follows: where flow is what takes time, its window is to be a multiple of
#   eight, even if that makes it larger; half the time may be had for nothing.
#   Centres move by half a pixel, as even windows have no middle pixel, which is
#   accounted for: the flow found is the same.
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
echo "expected: CPU time rises with the window: 15 before 16, 21 before 24, 31 before 32"
cat >"$tmp/t.py" <<'PY'
import sys
import time

import cv2
import numpy as np

cv2.setNumThreads(1)
noise = np.random.default_rng(1).integers(0, 256, (480, 640)).astype(np.uint8)
first = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
second = np.roll(first, (1, 2), (0, 1))
grid = np.stack(np.meshgrid(np.arange(40, 600, 16), np.arange(40, 440, 16)), -1)
points = grid.reshape(-1, 1, 2).astype(np.float32)

def follow(side):
    begun = time.process_time()
    there, found, _ = cv2.calcOpticalFlowPyrLK(first, second, points, None, winSize=(side, side), maxLevel=3)
    return time.process_time() - begun, np.median((there - points)[found == 1], axis=0)

sides = [15, 16, 21, 23, 24, 31, 32]
took, flow = {side: np.inf for side in sides}, {}
for _ in range(9):  # in turn, the least of each: a machine is seldom alone
    for side in sides:
        seconds, flow[side] = follow(side)
        took[side] = min(took[side], seconds)
print("seen, ms of CPU:", ", ".join(f"{side}: {1e3 * took[side]:.1f}" for side in sides))
print("seen, median flow:", ", ".join(f"{side}: ({flow[side][0]:.2f}, {flow[side][1]:.2f})" for side in (15, 16, 21, 24)))
same = all(np.allclose(flow[side], (2, 1), atol=0.05) for side in sides)
slower = took[16] < 0.8 * took[15] and took[24] < 0.9 * took[23] and took[24] < took[21] * 1.1 and took[32] < 0.9 * took[31]
sys.exit(0 if same and slower else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "changed: windows of eights are not the quicker ones"; exit 1; }
echo "as described: larger windows that are multiples of eight are quicker than smaller ones that are not"
