#!/usr/bin/env bash
# OpenCV's KNN background model takes each byte of a 16-bit picture for a pixel
#
# One would swear: BackgroundSubtractorKNN takes what its sibling MOG2 takes, which models 16-bit
#   depth and floats as they are; and if it does not, it says so, as MOG, CNT and GSOC do.
# What happens: it reads rows as bytes. Of a 16-bit picture of 160 columns it sees the first 80,
#   each as two pixels, low byte and high byte. Something that comes 0.8 m nearer in the right half
#   of the picture is not seen at all; in the left half it appears as stripes, every second column
#   set, at twice its column and of twice its width. Of floats it sees the first quarter, and a
#   third of the mask is set from noise alone, wherever it is. The mask has the size of the picture,
#   and nothing is reported. 8 bits are right, as are 16 bits and floats in MOG2.
# What follows: movers are to be found in depth by MOG2, or by KNN in a depth that was brought to
#   8 bits. A mask with stripes of one column, or with nothing in its right half ever, is this. A
#   test of a mask needs something that moves on either side.
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
echo "expected: the box is found where it is, in 8 bits, 16 bits and floats"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

cv2.setNumThreads(1)
models = {"KNN": cv2.createBackgroundSubtractorKNN, "MOG2": cv2.createBackgroundSubtractorMOG2}
kinds = {"8 bits": (np.uint8, 1 / 16), "16 bits": (np.uint16, 1), "floats": (np.float32, 1)}


def look(model, kind, begin, end):
    """A wall at 2000 mm with 3 mm of noise; a box at 1200 mm in rows 40 to 79 of the last 5 frames."""
    rng, (dtype, scale) = np.random.default_rng(1), kinds[kind]
    subtractor = models[model](detectShadows=False)
    for frame in range(100):
        depth = 2000 + rng.normal(0, 3, (120, 160))
        if frame >= 95:
            depth[40:80, begin:end] -= 800
        mask = subtractor.apply((depth * scale).astype(dtype))
    columns = (mask[42:78] > 0).mean(0)
    return (mask[42:78, begin:end] > 0).mean(), (mask[:35] > 0).mean(), columns, mask.shape


ok = True
for model in models:
    for kind in kinds:
        for side, begin, end in (("left", 20, 50), ("right", 100, 140)):
            found, beside, columns, shape = look(model, kind, begin, end)
            where = np.flatnonzero(columns > 0.5)
            print(f"seen: {model}, {kind}: a box in columns {begin} to {end - 1} is found to {found:.0%}, {beside:.0%} of the wall is "
                  f"marked; columns marked:", f"{where[0]} to {where[-1]}, {len(where)} of them" if len(where) else "none")
            ok = ok and shape == (120, 160)
            if model == "MOG2" or kind == "8 bits":
                ok = ok and found > 0.95 and beside < 0.01
            elif kind == "floats":
                ok = ok and found < 0.6 and beside > 0.2
            elif side == "right":
                ok = ok and found < 0.01 and beside < 0.01
            else:
                ok = ok and np.array_equal(where, np.arange(40, 100, 2)) and beside < 0.01
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: KNN sees the left half of 16 bits, twice as wide"
