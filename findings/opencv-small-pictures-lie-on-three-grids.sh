#!/usr/bin/env bash
# OpenCV's ways to make a picture smaller put its pixels in three places
#
# One would swear: a picture of a quarter of the width lies where the large one does,
#   whichever way it is made, so colour made small by AREA and depth by NEAREST
#   (never mix depths) still match, and one camera matrix serves both.
# What happens: at a quarter of the size, the middle of small pixel i is, in the
#   large picture's pixels, 4i + 1.5 by INTER_AREA and INTER_LINEAR, 4i by
#   INTER_NEAREST, 4i + 1 by INTER_NEAREST_EXACT, and 4i by pyrDown twice. "Nearest"
#   takes the block's corner, farthest from its middle. Depth and colour made
#   small as above are 1.5 px apart, 3.5 px at an eighth; with pyrDown the
#   principal point is cx/4, with AREA it is (cx + 0.5)/4 - 0.5.
# What follows: intrinsics of a pyramid must say the grid. A debugger that shows
#   or tracks small depth must pick it by the grid of the small colour (pick the block's
#   middle, or a valid median), and a constant shift between depth edges and
#   colour edges that grows with the level is this.
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
echo "expected: the same place by every way"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

column = np.tile(np.arange(512, dtype=np.float32), (64, 1))  # each pixel holds where it is
ways = {"AREA": cv2.INTER_AREA, "LINEAR": cv2.INTER_LINEAR, "NEAREST": cv2.INTER_NEAREST,
        "NEAREST_EXACT": cv2.INTER_NEAREST_EXACT}
expected = {2: {"AREA": 0.5, "LINEAR": 0.5, "NEAREST": 0, "NEAREST_EXACT": 0, "pyrDown": 0},
            4: {"AREA": 1.5, "LINEAR": 1.5, "NEAREST": 0, "NEAREST_EXACT": 1, "pyrDown": 0},
            8: {"AREA": 3.5, "LINEAR": 3.5, "NEAREST": 0, "NEAREST_EXACT": 3, "pyrDown": 0}}
ok = True
down = column
for times in (2, 4, 8):
    down = cv2.pyrDown(down)
    at = {name: float(cv2.resize(column, None, fx=1 / times, fy=1 / times, interpolation=way)[4, 30]) - times * 30
          for name, way in ways.items()}
    at["pyrDown"] = float(down[4, 30]) - times * 30
    print(f"seen: 1/{times}: pixel i holds the place {times}i + " + ", ".join(f"{v:g} by {n}" for n, v in at.items()))
    ok = ok and all(abs(at[n] - e) < 1e-3 for n, e in expected[times].items())
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
