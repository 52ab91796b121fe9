#!/usr/bin/env bash
# A depth picture as PGM has another unit in every second program
#
# One would swear: a 16-bit PGM holds millimetres; its third number (maxval) says
#   how far they go, and a reader hands out the numbers that are in the file.
# What happens: with a maxval of 10000 (ten metres) OpenCV gives what is stored,
#   while Pillow and FFmpeg stretch it to 65535 (1000 becomes 6554 and 6553), as
#   does Netpbm's own pnmtopng when it makes a PNG of it. No one says so, and the
#   ones that stretch differ by a unit in places. (By the format's own definition
#   a sample is a fraction of maxval, so they are not wrong.) With maxval
#   65535 all agree.
# What follows: a reader of PGM depth must use the stored numbers and take the
#   maxval for a limit, or ask; a writer must always write 65535. Depth
#   that comes out 6.55 times too far, with its farthest reading at exactly
#   65535, has been through this.
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
want python3-pil 9.4.0
want ffmpeg 7:5.1.
want netpbm 2:11.01
echo "expected: 0 1 500 1000 2345 4095 9999 10000 from each"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys
import cv2
import numpy as np
from PIL import Image

depth = np.tile(np.array([0, 1, 500, 1000, 2345, 4095, 9999, 10000], np.uint16), (8, 1))
stretched = np.round(depth * 65535.0 / 10000).astype(int)


def readings(maxval):
    with open("d.pgm", "wb") as out:
        out.write(b"P5\n8 8\n%d\n" % maxval + depth.astype(">u2").tobytes())
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", "d.pgm", "-f", "rawvideo", "-pix_fmt", "gray16le", "-"],
                         check=True, capture_output=True).stdout
    png = subprocess.run(["pnmtopng", "d.pgm"], check=True, capture_output=True).stdout
    return {"OpenCV": cv2.imread("d.pgm", cv2.IMREAD_UNCHANGED), "Pillow": np.array(Image.open("d.pgm")),
            "FFmpeg": np.frombuffer(raw, "<u2").reshape(8, 8),
            "pnmtopng": cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_UNCHANGED)}


small, full = readings(10000), readings(65535)
for name, values in small.items():
    print(f"seen: maxval 10000, {name:8} {values[0].tolist()}")
agree = all(np.array_equal(v, depth) for v in full.values())
print(f"seen: maxval 65535: all four give the stored numbers: {agree}")
ok = (agree and np.array_equal(small["OpenCV"], depth)
      and all(np.abs(small[n].astype(int) - stretched).max() <= 1 for n in ("Pillow", "FFmpeg", "pnmtopng"))
      and not np.array_equal(small["Pillow"], small["FFmpeg"]))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
