#!/usr/bin/env bash
# Clipping depth by cv::min or cv::threshold turns missing pixels into walls at the limit
#
# One would swear: of NaN and 5 the smaller is NaN, as numpy.minimum has it: clipping a depth
#   picture in metres at 5 leaves pixels without a reading without one; if it did not, it
#   would be so for all pixels alike, and min(a, b) be min(b, a).
# What happens: the processor's minimum of two numbers of which one is NaN is the second. So
#   cv::min(depth, 5) and threshold with THRESH_TRUNC make 5 m of every NaN, cv::max(depth, 0.5)
#   makes 0.5 m, and cv::min(limit, depth), the pictures exchanged, keeps NaN. What is left over
#   of a row, or of a picture whose rows lie end to end, after whole groups of four or more is
#   done one by one, and there it is just the other way: in a part of a picture its last columns
#   differ from the rest. THRESH_TOZERO gives 0 in all columns.
# What follows: depth in which missing is NaN is to be masked before it is clipped (depth ==
#   depth is false for NaN), and a clipped picture is to be asked for a heap at its limit. A
#   wall at exactly the far limit, and a fringe of holes at the right margin, are this.
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
case $(uname -m) in x86_64) ;; *) echo "another processor's minimum: not looked at"; exit 2 ;; esac
echo "expected: NaN stay NaN, in all columns and in both orders"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

whole = np.full((48, 100), 2, np.float32)
whole[:, ::2] = 9
whole[20] = np.nan  # a row without readings
part = whole[:, :83]  # its rows do not lie end to end
limit = np.full((48, 83), 5, np.float32)
ways = {"min(depth, 5)": lambda d: cv2.min(d, 5.0), "threshold TRUNC at 5": lambda d: cv2.threshold(d, 5, 0, cv2.THRESH_TRUNC)[1],
        "max(depth, 0.5)": lambda d: cv2.max(d, 0.5), "min(limit, depth)": lambda d: cv2.min(limit[:, :d.shape[1]], d),
        "numpy.minimum": lambda d: np.minimum(d, 5), "threshold TOZERO at 5": lambda d: cv2.threshold(d, 5, 0, cv2.THRESH_TOZERO)[1]}


def runs(row):  # equal values side by side, as text
    texts = [f"{v:g}" for v in row]
    starts = [i for i in range(len(texts)) if i == 0 or texts[i] != texts[i - 1]]
    return [(texts[a], b - a) for a, b in zip(starts, starts[1:] + [len(texts)])]


seen = {name: runs(way(part)[20]) for name, way in ways.items()}
for name, found in seen.items():
    print(f"seen, 83 NaN after {name}:", ", then ".join(f"{count} of {value}" for value, count in found))
joined = runs(cv2.min(whole, 5.0)[20])
print(f"seen, the whole picture's 100 NaN after min(depth, 5):", ", then ".join(f"{count} of {value}" for value, count in joined))
rest = all(np.array_equal(np.delete(cv2.min(p, 5.0), 20, 0), np.delete(np.minimum(p, 5), 20, 0)) for p in (whole, part))
print("seen, pixels with a reading clipped as expected:", rest)
ok = seen["min(depth, 5)"] == seen["threshold TRUNC at 5"] == [("5", 80), ("nan", 3)] and seen["max(depth, 0.5)"] == [("0.5", 80), ("nan", 3)]
ok = ok and seen["min(limit, depth)"] == [("nan", 80), ("5", 3)] and seen["numpy.minimum"] == [("nan", 83)]
sys.exit(0 if ok and seen["threshold TOZERO at 5"] == [("0", 83)] and joined == [("5", 100)] and rest else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: the order of two arguments decides what NaN is"
