#!/usr/bin/env bash
# GStreamer's grey does not know a video's range: YUY2 to GRAY8 is 16 to 235, by way of BGR 0 to 253
#
# One would swear: videoconvert heeds the colorimetry that stands in the caps: grey made of a camera's
#   YUY2 (luma 16 to 235) is the same straight away or by way of BGR; GRAY8 to I420 and on to RGB
#   gives back the grey.
# What happens: colours go by the range, grey does not. From YUY2, I420 and NV12 the luma is copied
#   into GRAY8, whose caps say 1:4:0:0, full range: black is 16 and white 235. By way of BGR the same
#   picture has 0 and 253. From GRAY8 to I420 it is copied too: a grey camera's 0 to 16 and 235 to 255
#   are one level each once that I420 is shown, encoded for a viewer or turned into RGB. RGB to GRAY8
#   and GRAY8 to RGB are right, so that a test of those two finds nothing.
# What follows: an application that takes GRAY8 from a pipeline sees another contrast (by a seventh)
#   and another black than one that takes BGR and makes it grey: direct methods and thresholds tuned
#   on one are off on the other. A grey camera on its way into I420 is to go by RGB first (4 levels
#   off at most). Where grey levels of two recordings of one scene lie on a straight line of slope
#   0.86, it is this.
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
echo "expected: black, white and both ways alike"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np

width, height = 256, 16
ramp = np.tile(np.arange(256, dtype=np.uint8), (height, 1))
bytes_of = {"yuy2": np.stack([ramp, np.full_like(ramp, 128)], 2).tobytes(), "gray8": ramp.tobytes(),
            "i420": ramp.tobytes() + b"\x80" * (ramp.size // 2), "nv12": ramp.tobytes() + b"\x80" * (ramp.size // 2)}


# The first row after the conversions named; of colours the green, of I420 the luma.
def through(first, *others):
    with open("in.raw", "wb") as file:
        file.write(bytes_of[first])
    steps = " ! ".join(f"videoconvert ! video/x-raw,format={name}" for name in others)
    command = (f"gst-launch-1.0 -q filesrc location=in.raw blocksize={len(bytes_of[first])} ! rawvideoparse format={first} "
               f"width={width} height={height} ! {steps} ! filesink location=out.raw")
    subprocess.run(command.split(), check=True, capture_output=True)
    out = np.fromfile("out.raw", np.uint8)
    row = (out[1:3 * width:3] if others[-1] in ("RGB", "BGR") else out[:width]).astype(int)
    print(f"seen, {first} to {' to '.join(others)}: luma 16, 128, 235 become {row[16]}, {row[128]}, {row[235]}; "
          f"{len(np.unique(row))} levels")
    return row


level = np.arange(256)
full = np.clip(np.round((level - 16) * 255 / 219), 0, 255)
ok = True
for camera in ("yuy2", "i420", "nv12"):
    straight, round_about = through(camera, "GRAY8"), through(camera, "BGR", "GRAY8")
    ok = ok and (straight == level).all() and np.abs(round_about - full).max() <= 3
    ok = ok and round_about[16] == 0 and round_about[235] >= 252
copied = through("gray8", "I420")
shown = through("gray8", "I420", "RGB")
ok = ok and (copied == level).all() and shown[:17].max() == 0 and np.abs(shown - full).max() <= 3
by_rgb = through("gray8", "RGB", "I420", "RGB")
print(f"seen: by way of RGB at most {np.abs(by_rgb - level).max()} off")
ok = ok and np.abs(by_rgb - level).max() <= 4
ok = ok and (through("gray8", "RGB") == level).all() and (through("gray8", "RGB", "GRAY8") == level).all()
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: grey has the camera's range, colours have the screen's"
