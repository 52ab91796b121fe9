#!/usr/bin/env bash
# OpenCV's BRISK draws its coarse points together: five pixels at the edge of KITTI's pictures, none at 768 x 480
#
# One would swear: a detector of blobs in a pyramid gives the place of a blob in the full picture;
#   what is off by rounding is off by a fraction of a pixel of the level, the same everywhere, and
#   is as much to the left as to the right.
# What happens: levels are halves and two thirds of the picture, cut to whole pixels (106 columns
#   where 106.67 were right), the picture is squeezed into them, and points are brought back by 1.5,
#   2, 3, 4 and 6 all the same. They lie too near to the upper left corner, in proportion to where
#   they are: of 640 x 480 pictures, octave 5, by 0 on the left and 4 pixels on the right, and not
#   at all in y, since 480 can be divided; octave 1 by half a pixel. Of KITTI's 1241 x 376 by 5
#   pixels at the right and 5 at the bottom, 1.2 per cent of y; octaves 0 to 4, which are
#   interpolated between levels, by up to 1.5. At 768 x 480, which divides by all of them, nothing
#   is off by more than 0.3.
# What follows: that is no offset which differences take out: the picture has another focal length
#   in each octave, and in x another one than in y. Pictures are to be cut or padded to multiples of
#   24 before BRISK sees them, or its coarse points are not to be used for poses.
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
echo "expected: blobs found where they are, to some tenths of a pixel, at every picture size"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

cv2.setNumThreads(1)


def edges(width, height):  # pixels off in x at the right edge and in y at the lower one, by octave, from straight lines
    rng = np.random.default_rng(3)
    v, u = np.mgrid[0:height, 0:width].astype(np.float32)
    found = {}
    for sigma in (1.5, 2, 3, 4.5, 6, 9):
        gap = int(16 * sigma)
        for _ in range(3):
            picture, at = np.full((height, width), 60, np.float32), []
            for cy in np.arange(gap / 2, height - gap / 2 + 1, gap):
                for cx in np.arange(gap / 2, width - gap / 2 + 1, gap):
                    x, y = cx + rng.uniform(-2, 2), cy + rng.uniform(-2, 2)
                    left, top, reach = int(x - 6 * sigma), int(y - 6 * sigma), int(12 * sigma) + 2
                    there = np.s_[max(top, 0):top + reach, max(left, 0):left + reach]
                    picture[there] += 150 * np.exp(-((u[there] - x) ** 2 + (v[there] - y) ** 2) / 2 / sigma**2)
                    at.append((x, y))
            at = np.array(at)
            for key in cv2.BRISK_create(30, 3).detect(np.clip(np.round(picture), 0, 255).astype(np.uint8)):
                off = np.array(key.pt) - at
                i = np.hypot(*off.T).argmin()
                if np.hypot(*off[i]) < max(6, sigma):
                    found.setdefault(key.octave, []).append((*at[i], *off[i]))
    out = {}
    for octave, rows in sorted(found.items()):
        x, y, dx, dy = np.array(rows).T
        at_end = lambda p, d, end: np.polyval(np.polyfit(p, d, 1), [0, end])
        out[octave] = [*at_end(x, dx, width), *at_end(y, dy, height)]
    return out


off = {}
for width, height in ((768, 480), (640, 480), (1241, 376)):
    off[width] = np.array(list(edges(width, height).values()))
    print(f"seen, {width} x {height}: x off at the left", ", ".join(f"{o:.1f}" for o in off[width][:, 0]), "and at the right",
          ", ".join(f"{o:.1f}" for o in off[width][:, 1]), "; y off at the top", ", ".join(f"{o:.1f}" for o in off[width][:, 2]), "and at the bottom",
          ", ".join(f"{o:.1f}" for o in off[width][:, 3]), "in octaves 0 to 5")
ok = all(len(o) == 6 for o in off.values()) and np.abs(off[768]).max() < 0.5
ok = ok and off[640][5, 1] < -3 and abs(off[640][5, 0]) < 1 and np.abs(off[640][:, 3]).max() < 0.6 and -0.8 < off[640][1, 1] < -0.3
sys.exit(0 if ok and off[1241][5, 1] < -4 and off[1241][5, 3] < -3.5 and off[1241][1:5, 1].max() < -0.8 else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: the farther from the corner the farther off, unless the size divides"
