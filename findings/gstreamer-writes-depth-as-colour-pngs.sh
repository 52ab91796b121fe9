#!/usr/bin/env bash
# GStreamer writes a depth camera's GRAY16_LE as 8-bit RGBA PNGs, though its encoder takes 16-bit grey
#
# One would swear: ... ! videoconvert ! pngenc picks the format that loses least: for 16-bit grey it
#   is the encoder's GRAY16_BE, which is a swap of two bytes; GRAY8 is picked for GRAY8.
# What happens: GRAY8 stays grey and GRAY16_BE stays as it is, but GRAY16_LE, the order in which
#   cameras and programs on common machines hand out depth, becomes RGBA: four bytes a pixel, each
#   colour the high byte of the depth or, by dithering, one more or less: 255 mm is (1, 0, 1), 1000
#   and 1023 mm are (4, 3, 3) and (4, 3, 4). Nothing is said. With video/x-raw,format=GRAY16_BE named
#   between the two elements the file has 16 bits and every value; pngdec reads it back without loss.
# What follows: name the format before pngenc, and look at the first file's header before a recording
#   of an hour. A depth PNG with an alpha channel that is full everywhere and three channels that
#   differ by two at most was written so, and its low byte is not in the file: a reader should say
#   that.
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
want gstreamer1.0-plugins-good 1.22.0
want python3-pil 9.4.0
want python3-numpy 1:1.24
echo "expected: PNGs of one channel with 16 bits, holding what went in"
cat >"$tmp/t.py" <<'PY'
import struct
import subprocess
import sys

import numpy as np
from PIL import Image

width, height = 64, 48
rng = np.random.default_rng(1)
depth = rng.integers(500, 10000, (height, width)).astype(np.uint16)
depth[0, :4] = [0, 255, 1000, 1023]


# Writes one picture of the format by videoconvert and pngenc; returns bits and colour type from the PNG's header.
def write(name, data, caps=""):
    with open("in.raw", "wb") as file:
        file.write(data)
    named = f"! video/x-raw,format={caps}" if caps else ""
    command = (f"gst-launch-1.0 -q filesrc location=in.raw blocksize={len(data)} ! rawvideoparse format={name} width={width} "
               f"height={height} ! videoconvert {named} ! pngenc ! filesink location=out.png")
    said = subprocess.run(command.split(), check=True, capture_output=True).stderr.decode().strip()
    with open("out.png", "rb") as file:
        bits, kind = struct.unpack("BB", file.read(26)[24:26])
    found = np.array(Image.open("out.png"))
    print(f"seen, {name}{', ' + caps + ' named' if caps else ''}: {bits} bits, "
          f"{ {0: 'grey', 2: 'RGB', 6: 'RGBA'}[kind]}; 0, 255, 1000, 1023 mm are {found[0, :4].tolist()}; "
          f"said: {said or 'nothing'}")
    return bits, kind, found, said


little, big = depth.astype("<u2").tobytes(), depth.astype(">u2").tobytes()
bits, kind, found, said = write("gray16-le", little)
found = found if found.ndim == 3 else np.dstack([found] * 4)
up = found[..., :3].astype(int) - (depth >> 8)[..., None]
print(f"seen: each colour less the high byte: {sorted(set(up.ravel().tolist()))}")
ok = (bits, kind, said) == (8, 6, "") and set(up.ravel().tolist()) <= {-1, 0, 1} and (found[..., 3] == 255).all()
bits, kind, found, said = write("gray16-be", big)
ok = ok and (bits, kind) == (16, 0) and (found == depth).all()
bits, kind, found, said = write("gray16-le", little, "GRAY16_BE")
ok = ok and (bits, kind) == (16, 0) and (found == depth).all()
read = ("gst-launch-1.0 -q filesrc location=out.png ! pngdec ! videoconvert ! video/x-raw,format=GRAY16_LE "
        "! filesink location=back.raw")
subprocess.run(read.split(), check=True, capture_output=True)
ok = ok and (np.fromfile("back.raw", "<u2").reshape(depth.shape) == depth).all()
bits, kind, found, said = write("gray8", (depth >> 8).astype(np.uint8).tobytes())
ok = ok and (bits, kind) == (8, 0) and (found == depth >> 8).all()
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: little-endian depth loses its low byte on the way to PNG"
