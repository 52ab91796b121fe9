#!/usr/bin/env bash
# skimage's nearest-neighbour resize renumbers a label picture
#
# One would swear: resize(labels, shape, order=0, preserve_range=True) picks pixels: what
#   comes out was in it, and the inside of a region keeps its number.
# What happens: before it picks, it smooths: anti_aliasing is on unless it is told otherwise
#   (the page says so, for all pictures but those of bool), with order 0 as well. From 640 x
#   480 to 320 x 240 the edges between 0, 2 and 7 are of 1 and 6, which were not there. And
#   whole numbers are smoothed as such, cut off after each axis: where a kernel's weights add
#   up to a hair less than 1 (1e-16), as they do for some sizes, the insides of regions fall too.
#   From KITTI's 1241 x 376 to the usual 416 x 128, 2 becomes 1 and 7 becomes 6 in the whole
#   region, and a depth of 3000 mm 2999. A picture of one number alone shows nothing of it, as
#   results are clipped to the range of the input. With anti_aliasing=False all is right.
# What follows: masks of moving objects, and depth, must not be made smaller by skimage without
#   anti_aliasing=False. Whoever reads masks should say which numbers they hold, and a size
#   that worked proves nothing for the next.
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
want python3-skimage 0.19.3
want python3-scipy 1.10.1
echo "expected: 0, 2 and 7 where they were, and 3000 mm"
cat >"$tmp/t.py" <<'PY'
import sys

import numpy as np
from scipy import ndimage
from skimage.transform import resize


def labels(rows, columns):
    out = np.zeros((rows, columns), np.uint8)
    out[:, columns // 3:] = 2
    out[rows // 2:] = 7
    return out


def small(picture, shape, **more):
    return resize(picture, shape, order=0, preserve_range=True, **more)


def middles(out):  # of the three regions
    rows, columns = out.shape
    return [int(out[r, c]) for r, c in ((rows // 4, columns // 6), (rows // 4, columns * 2 // 3), (rows * 3 // 4, columns // 2))]


vga, kitti = labels(480, 640), labels(376, 1241)
halved, third = small(vga, (240, 320)), small(kitti, (128, 416))
for name, out in (("640 x 480 to 320 x 240", halved), ("1241 x 376 to 416 x 128", third)):
    print(f"seen, {name}: numbers {np.unique(out).tolist()}, in the middles of regions 0, 2 and 7: {middles(out)}")
right = [np.unique(small(vga, (240, 320), anti_aliasing=False)).tolist(), np.unique(small(kitti, (128, 416), anti_aliasing=False)).tolist()]
print("seen, with anti_aliasing=False:", right)
alone = np.unique(small(np.full_like(kitti, 7), (128, 416))).tolist()
print("seen, a picture of 7 alone:", alone)
depth = np.full((376, 1241), 1000, np.uint16)
depth[188:] = 3000
wall = int(small(depth, (128, 416))[96, 208])
print("seen, the middle of a wall at 3000 mm, with another at 1000 in the picture:", wall)
sigma = [(376 / 128 - 1) / 2, (1241 / 416 - 1) / 2]
whole = ndimage.gaussian_filter(kitti, sigma, mode="mirror")
short = [7 - ndimage.gaussian_filter1d(kitti.astype(float), sigma[axis], axis=axis, mode="mirror")[282, 620] for axis in (0, 1)]
print(f"seen, SciPy's gaussian_filter with the same sigma, same places: {middles(whole)}; one axis alone in doubles, 7 less:",
      ", ".join(f"{s:.1e}" for s in short))
ok = np.unique(halved).tolist() == [0, 1, 2, 6, 7] and middles(halved) == [0, 2, 7] and np.unique(third).tolist() == [0, 1, 2, 6]
ok = ok and middles(third) == [0, 1, 6] and right == [[0, 2, 7]] * 2 and alone == [7] and wall == 2999
sys.exit(0 if ok and middles(whole) == [0, 1, 6] and 0 < max(short) < 1e-12 else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: nearest neighbours of a smoothed picture"
