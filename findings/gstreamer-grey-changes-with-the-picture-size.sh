#!/usr/bin/env bash
# GStreamer's grey of a camera is 16 to 235 at 640 x 480, and 0 to 253 at 1280 x 720
#
# One would swear: videoconvert makes of a camera's YUY2 (luma 16 to 235) the same GRAY8 whatever the
#   size of the picture, and the same straight away as by way of BGR; GRAY8 to I420 and on to RGB
#   gives back the grey.
# What happens: where nothing is said, YUY2, I420 and NV12 of up to 576 lines count as BT.601, as
#   GRAY8 does, and as the matrix is the same the luma is copied, range or no range: black is 16,
#   white is 235. From 720 lines on they count as BT.709, so that there is something to convert, and
#   black is 0, white 253. By way of BGR both have 0 and 253. GRAY8 to I420 is the same: at 640 x 480
#   it is copied, and 0 to 16 and 235 to 255 are one level each once that I420 is shown or made RGB;
#   at 1280 x 720 it is squeezed, and they are not. Naming colorimetry bt601 for the camera and
#   1:4:0:0 for the grey changes nothing.
# What follows: a camera whose size is changed has another contrast, by a seventh, and another black:
#   direct methods, vignettes and thresholds tuned on one are off on the other, and tests with small
#   pictures prove nothing for large ones. Take BGR or RGB and make grey of it, in both directions (4
#   levels off at most). Grey levels of two recordings on a line of slope 0.86 are this.
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
want gstreamer1.0-tools 1.22.0
want gstreamer1.0-plugins-base 1.22.0
want python3-numpy 1:1.24
echo "expected: black 0 and white 253 to 255, at both sizes and both ways"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np


# A ramp of all luma values, or grey levels, in each format.
def picture(form, width, height):
    ramp = np.tile(np.arange(width) * 256 // width, (height, 1)).astype(np.uint8)
    if form == "yuy2":
        return np.stack([ramp, np.full_like(ramp, 128)], 2).tobytes()
    return ramp.tobytes() + (b"" if form == "gray8" else b"\x80" * (ramp.size // 2))


# What each of the 256 levels becomes by the conversions named; of colours the green, of I420 the luma.
def through(first, size, *others):
    width, height = size
    data = picture(first, width, height)
    with open("in.raw", "wb") as file:
        file.write(data)
    steps = " ! ".join(f"videoconvert ! video/x-raw,format={name}" for name in others)
    command = (f"gst-launch-1.0 -q filesrc location=in.raw blocksize={len(data)} ! rawvideoparse format={first} "
               f"width={width} height={height} ! {steps} ! filesink location=out.raw")
    subprocess.run(command.split(), check=True, capture_output=True)
    out = np.fromfile("out.raw", np.uint8)
    row = (out[1:3 * width:3] if others[-1] in ("RGB", "BGR") else out[:width]).astype(int)
    levels = np.array([row[-(-level * width // 256)] for level in range(256)])
    print(f"seen, {width} x {height}, {first} to {' to '.join(others)}: 16, 128, 235 become {levels[16]}, {levels[128]}, {levels[235]}; "
          f"{len(np.unique(levels))} levels")
    return levels


level = np.arange(256)
full = np.clip(np.round((level - 16) * 255 / 219), 0, 255)
squeezed = 16 + level * 219 / 255
small, large = (640, 480), (1280, 720)
ok = True
for camera in ("yuy2", "i420", "nv12"):
    ok = ok and (through(camera, small, "GRAY8") == level).all()
    ok = ok and np.abs(through(camera, large, "GRAY8") - full).max() <= 3
    for size in (small, large):
        ok = ok and np.abs(through(camera, size, "BGR", "GRAY8") - full).max() <= 3
ok = ok and (through("gray8", small, "I420") == level).all()
ok = ok and np.abs(through("gray8", large, "I420") - squeezed).max() <= 4
ok = ok and np.abs(through("gray8", small, "I420", "RGB") - full).max() <= 3
for size in (small, large):
    ok = ok and np.abs(through("gray8", size, "RGB", "I420", "RGB") - level).max() <= 5
    ok = ok and (through("gray8", size, "RGB", "GRAY8") == level).all()
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: grey has another range at another size"
