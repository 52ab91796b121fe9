#!/usr/bin/env bash
# One NaN in a depth picture, blurred by cv::blur, is NaN in all rows below
#
# One would swear: a box of 5 x 5 sees 25 pixels; a NaN makes 25 pixels of the result NaN, as
#   it does with GaussianBlur, filter2D and sepFilter2D of the same picture.
# What happens: blur and boxFilter go down the picture with running sums, adding a row and
#   taking one off, and NaN less NaN is NaN: the column stays NaN down to the last row. From a
#   width of 7 on (3 and 5 are summed anew) it is the same along a row: everything below
#   and to the right is lost. Infinity does the same, and below a value of 1e17 two metres come
#   out as 1.68. SciPy's uniform_filter does it at any width, to the right and below. Nothing of
#   this happens in a picture whose missing pixels are 0.
# What follows: depth in which missing is NaN, the ROS and PCL custom, must not go through box
#   filters, nor through what is built of them (local mean and variance, guided filters, NCC by
#   boxes) before the NaN are taken out: sum zeros and a mask, and divide. A result that is
#   empty from some row on downwards has this.
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
want python3-scipy 1.10.1
echo "expected: as many NaN as the box has pixels"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np
from scipy import ndimage

rows, columns, row, column = 60, 80, 20, 30
depth = np.full((rows, columns), 2, np.float32)


def spoilt(blur, value):
    holed = depth.copy()
    holed[row, column] = value
    return ~(np.abs(blur(holed) - 2) < 1e-3)


def shape(spoilt, half):  # which of the expected shapes the spoilt pixels have
    square, down, both = (np.zeros_like(spoilt) for _ in range(3))
    square[row - half:row + half + 1, column - half:column + half + 1] = True
    down[row - half:, column - half:column + half + 1] = True
    both[row - half:, column - half:] = True
    both[row - half:row - half + 1] |= square[row - half:row - half + 1]
    for name, expected in (("box", square), ("all below", down), ("all below and right", both)):
        if np.array_equal(spoilt, expected):
            return name
    return "other"


seen = {}
for name, value in (("NaN", np.nan), ("inf", np.inf)):
    for width in (3, 5, 7, 9):
        seen[name, width] = shape(spoilt(lambda d: cv2.blur(d, (width, width)), value), width // 2)
        seen["SciPy", name, width] = shape(spoilt(lambda d: ndimage.uniform_filter(d, width), value), width // 2)
    print(f"seen, blur with one {name}:", ", ".join(f"{w} x {w}: {seen[name, w]}" for w in (3, 5, 7, 9)))
    print(f"seen, uniform_filter with one {name}:", ", ".join(f"{w} x {w}: {seen['SciPy', name, w]}" for w in (3, 5, 7, 9)))
kernel = np.full((7, 7), 1 / 49, np.float32)
others = [shape(spoilt(blur, np.nan), 3) for blur in (
    lambda d: cv2.GaussianBlur(d, (7, 7), 2), lambda d: cv2.filter2D(d, -1, kernel), lambda d: cv2.sepFilter2D(d, -1, 7 * kernel[0], 7 * kernel[0]))]
print("seen, NaN in GaussianBlur, filter2D and sepFilter2D of 7 x 7:", ", ".join(others))
far = spoilt(lambda d: cv2.blur(d, (5, 5)), 1e17)
print(f"seen, 1e17 in a blur of 5 x 5: {far.sum()} pixels are not 2, down to row {np.argwhere(far)[:, 0].max()}; "
      f"with 0 instead: {spoilt(lambda d: cv2.blur(d, (5, 5)), 0).sum()}")
ok = all(seen[n, w] == ("all below" if w < 7 else "all below and right") for n in ("NaN", "inf") for w in (3, 5, 7, 9))
ok = ok and all(seen["SciPy", n, w] == "all below and right" for n in ("NaN", "inf") for w in (3, 5, 7, 9))
ok = ok and others == ["box"] * 3 and far[-1].any() and spoilt(lambda d: cv2.blur(d, (5, 5)), 0).sum() == 25
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: what is NaN once stays NaN for the rest of the picture"
