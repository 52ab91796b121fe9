#!/usr/bin/env bash
# cv::imread's grey of a colour PNG depends on a 16-byte chunk
#
# One would swear: IMREAD_GRAYSCALE weighs the stored red, green and blue; a PNG
#   with an sRGB or gAMA chunk, which is what a colour PNG is anyhow, reads as one
#   without, and as cvtColor(imread(colour), BGR2GRAY) within a level.
# What happens: libpng does the conversion, and as soon as it knows the gamma it
#   weighs linear light. Pure red is 76 without the chunk and 147 with it, blue 29
#   and 95, green 149 and 200; cvtColor gives 76, 29, 150 for both. Reading in
#   colour is untouched. Saving a film anew with a program that writes the chunk
#   changes what a grey front end sees.
# What follows: never read grey by IMREAD_GRAYSCALE (nor IMREAD_ANYDEPTH without
#   ANYCOLOR, which does the same): read colour, convert by one's own weights, once,
#   and say the weights. Two runs on pictures that compare equal in colour can
#   have different grey pictures, hence features.
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
echo "expected: the same grey with and without the chunk"
cat >"$tmp/t.py" <<'PY'
import struct
import sys
import zlib
import cv2
import numpy as np


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def write(name, rgb, extra=b""):
    h, w = rgb.shape[:2]
    rows = b"".join(b"\0" + rgb[r].tobytes() for r in range(h))
    with open(name, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 2, 0, 0, 0)) + extra
                  + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


rgb = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [128, 128, 128], [200, 100, 50]]], np.uint8)
kinds = {"no chunk": b"", "sRGB": chunk(b"sRGB", b"\0"), "gAMA 45455": chunk(b"gAMA", struct.pack(">I", 45455)),
         "gAMA 100000": chunk(b"gAMA", struct.pack(">I", 100000))}
grey, byhand = {}, {}
for kind, extra in kinds.items():
    write("a.png", rgb, extra)
    grey[kind] = cv2.imread("a.png", cv2.IMREAD_GRAYSCALE).ravel().tolist()
    byhand[kind] = cv2.cvtColor(cv2.imread("a.png"), cv2.COLOR_BGR2GRAY).ravel().tolist()
    print(f"seen: {kind:12} red, green, blue, grey 128, brown: read grey {grey[kind]}, cvtColor {byhand[kind]}")
ok = (grey["no chunk"] == grey["gAMA 100000"] == [76, 149, 29, 128, 124]
      and grey["sRGB"] == grey["gAMA 45455"] == [147, 200, 95, 128, 137]
      and all(v == [76, 150, 29, 128, 124] for v in byhand.values()))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
