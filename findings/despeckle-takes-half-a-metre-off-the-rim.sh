#!/usr/bin/env bash
# ImageMagick's and GraphicsMagick's despeckle takes half a metre off the rim of 16-bit depth
#
# One would swear: -despeckle takes single odd pixels away; a flat picture has none and comes back as
#   it was, and what it puts in place of a speck is like the pixels around.
# What happens: it moves every pixel towards its neighbours by fixed steps of 257 (one grey level of
#   8-bit pictures), and takes what lies beyond the rim for black: a wall at 2003 mm has 1489 all
#   along its rim and 461 in its corners. A single 0 (no reading) in 2400 mm becomes 2056, and of a
#   hole of 3 x 10 the middle becomes 514: readings that nobody made, half a metre from the camera.
#   The edge between 2.5 and 4 m has 2747 and 3486 in it. A mask of 0 and 255 comes out with nine
#   values. A ramp of 10 mm a pixel, away from all that, is as it was. Both programs give the same
#   numbers.
# What follows: never on depth or labels; a median (-statistic median 3x3, -median 1) leaves the rim
#   and invents no values. A frame of nearer points around every cloud is this.
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
want imagemagick-6.q16 8:6.9.11
want graphicsmagick 1.4+really1.3.40
want python3-pil 9.4.0
want python3-numpy 1:1.24
echo "expected: 2003 everywhere; 2400 in place of the speck"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np
from PIL import Image

flat = np.full((64, 64), 2003, np.uint16)
room = (2000 + 10 * np.arange(64) * np.ones((64, 1))).astype(np.uint16)  # a ramp with a speck, a hole and an edge
room[40, 40], room[20:23, 30:40], room[:, 50:] = 0, 0, 4000
mask = np.zeros((64, 64), np.uint8)
mask[10:30, 10:40] = mask[40, 40] = 255


def through(program, picture, *how):
    Image.fromarray(picture).save("in.png")
    subprocess.run([*program, "in.png", *how, "out.png"], check=True)
    return np.array(Image.open("out.png")).astype(int)


ok = True
for name, program, median in (("ImageMagick", ["convert-im6.q16"], ("-statistic", "median", "3x3")), ("GraphicsMagick", ["gm", "convert"], ("-median", "1"))):
    f, r, m = (through(program, p, "-despeckle") for p in (flat, room, mask))
    clean, calm, binary = (through(program, p, *median) for p in (flat, room, mask))
    rim = np.concatenate([f[0, 3:-3], f[-1, 3:-3], f[3:-3, 0], f[3:-3, -1]])
    print(f"seen, {name}: of 2003 everywhere the rim is {sorted(set(rim.tolist()))}, the corners {f[0, 0]} to {f[-1, 0]}, inside {f[20, 20]}; "
          f"a speck of 0 becomes {r[40, 40]}, the middle of a hole {r[21, 35]}, the edge {r[10, 48:51].tolist()}; a mask has {len(set(m.ravel().tolist()))} values; "
          f"the ramp inside is the same: {np.array_equal(r[5:15, 5:45], room[5:15, 5:45])}")
    print(f"beside it, by a median: rim {clean[0, 5]}, the speck {calm[40, 40]}, the hole {calm[21, 35]}, a mask has {len(set(binary.ravel().tolist()))} values")
    ok = ok and set(rim.tolist()) == {1489} and f[0, 0] == 461 and f[20, 20] == 2003 and r[40, 40] == 2056 and r[21, 35] == 514
    ok = ok and r[10, 49] == 3486 - 739 and r[10, 50] == 3486 and len(set(m.ravel().tolist())) > 5 and np.array_equal(r[5:15, 5:45], room[5:15, 5:45])
    ok = ok and clean[0, 5] == 2003 and calm[40, 40] in (2390, 2400, 2410) and calm[21, 35] == 0 and len(set(binary.ravel().tolist())) == 2
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: the rim comes nearer"
