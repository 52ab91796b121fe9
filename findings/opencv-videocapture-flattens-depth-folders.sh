#!/usr/bin/env bash
# cv::VideoCapture reads a numbered folder of 16-bit depth as 8-bit colour
#
# One would swear: VideoCapture("%03d.png") is imread in a loop: 16-bit depth comes as
#   16-bit (it has no flag that says otherwise), and CAP_IMAGES is just the
#   name of what is chosen for such a pattern anyway.
# What happens: the FFmpeg backend is asked first, takes the pattern, and hands out
#   three channels of 8 bits: 1300 mm is 5, 5, 5. Depths less than 257 mm apart
#   become one. With CAP_IMAGES the same folder gives the 16-bit numbers
#   untouched. What the same call on the same folder gives thus depends on which
#   backends a build has.
# What follows: never read depth through VideoCapture without naming CAP_IMAGES and
#   looking at the type of what came. A depth film with 256 steps at
#   most, equal in three channels, has been through this; a histogram in
#   steps of 257 mm is its mark.
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
echo "expected: the numbers 300 1300 2300 3300 in one channel of 16 bits by both"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

for i in range(4):
    cv2.imwrite(f"{i:03d}.png", np.full((16, 16), 1000 * i + 300, np.uint16))


def through(capture):
    out = []
    while (got := capture.read())[0]:
        out.append(got[1])
    return out


plain, images = through(cv2.VideoCapture("%03d.png")), through(cv2.VideoCapture("%03d.png", cv2.CAP_IMAGES))
backend = cv2.VideoCapture("%03d.png").getBackendName()
for name, frames in (("default, " + backend, plain), ("CAP_IMAGES", images)):
    print(f"seen: {name}: {frames[0].dtype}, shape {frames[0].shape}, values {[f[8, 8].tolist() for f in frames]}")
ok = (backend == "FFMPEG" and len(plain) == len(images) == 4
      and all(f.dtype == np.uint8 and f.shape == (16, 16, 3) for f in plain)
      and [int(f[8, 8, 0]) for f in plain] == [1, 5, 9, 13]
      and all(f.dtype == np.uint16 and f.ndim == 2 and (f == 1000 * i + 300).all() for i, f in enumerate(images)))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
