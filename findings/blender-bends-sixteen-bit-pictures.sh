#!/usr/bin/env bash
# Blender hands out 16-bit depth bent by the sRGB curve, and the 8-bit version of it straight
#
# One would swear: image.pixels is what the file holds, divided by the largest value, for 8 and for 16
#   bits alike: times 65535 it is the millimetres of a depth picture.
# What happens: both are taken for sRGB. An 8-bit picture keeps its bytes, and pixels gives them
#   divided by 255; one of 16 bits is made floats, and those are turned into linear light on loading:
#   a grey of a half is 0.502 in 8 bits and 0.216 in 16. Depth times 65535 is 77 for 1000 mm and 155
#   for 2000 (a thirteenth: the curve's straight part, up to 2.65 m, in which a wall stays flat and
#   all ratios are right), 441 for 5000, 1324 for 10000. Only when the picture is called "Non-Color"
#   are the numbers those of the file, exactly; that can be done after loading. Rows come bottom up.
# What follows: set colorspace_settings.name before reading pixels, for masks and depth above all;
#   check a known depth, not black and white, which are right anyway. A scene built from depth that is
#   right up to a scale of a thirteenth near by, and too deep beyond, is this.
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
want blender 3.4.1
want python3-numpy 1:1.24
echo "expected: the numbers of the file over its largest, in 8 and in 16 bits"
cat >"$tmp/t.py" <<'PY'
import os
import struct
import sys
import zlib

import bpy
import numpy as np

folder = sys.argv[-1]


# A grey PNG by hand, of 8 or 16 bits.
def write(name, picture):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    big = picture.astype(picture.dtype.newbyteorder(">"))
    rows = b"".join(b"\0" + row.tobytes() for row in big)
    head = struct.pack(">IIBBBBB", picture.shape[1], picture.shape[0], 8 * picture.dtype.itemsize, 0, 0, 0, 0)
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    return path


# Its pixels from above, one channel, as they come and as Non-Color.
def read(path):
    image = bpy.data.images.load(path)
    seen = []
    for space in (None, "Non-Color"):
        if space:
            image.colorspace_settings.name = space
        seen.append(np.array(image.pixels[:]).reshape(image.size[1], image.size[0], image.channels)[::-1, :, 0])
    return seen


def linear(v):
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


ramp = np.tile(np.arange(256, dtype=np.uint8), (4, 1))
small, _ = read(write("eight.png", ramp))
wide, wide_named = read(write("sixteen.png", ramp.astype(np.uint16) * 257))
some = [16, 128, 255]
print(f"seen: 16, 128, 255 of 255 in 8 bits {small[0, some].round(4)}, the same greys in 16 bits {wide[0, some].round(4)}, "
      f"called Non-Color {wide_named[0, some].round(4)}")
depth = np.array([[0, 500, 1000, 2000, 5000, 10000, 65535]], dtype=np.uint16).repeat(4, 0)
came, named = (65535 * rows[0] for rows in read(write("depth.png", depth)))
print(f"seen: depths {depth[0].tolist()} times 65535: {came.round().astype(int).tolist()}; "
      f"as Non-Color {named.round().astype(int).tolist()}")
straight = ramp / 255
ok = np.allclose(small, straight, atol=1e-6) and np.allclose(wide, linear(straight), atol=1e-4)
ok = ok and np.allclose(wide_named, straight, atol=1e-5)
ok = ok and np.allclose(came, 65535 * linear(depth[0] / 65535), atol=5) and (named.round() == depth[0]).all()
ok = ok and abs(came[4] - 441) < 5 and abs(came[2] / came[1] - 2) < 0.05
print("judged:", "as described" if ok else "changed")
PY
nice blender -b --factory-startup --python "$tmp/t.py" -- "$tmp" >"$tmp/out" 2>&1
grep '^seen' "$tmp/out"
grep -q '^judged: as described' "$tmp/out" || { tail -3 "$tmp/out"; echo "the behaviour has changed"; exit 1; }
echo "as described: sixteen bits are bent, eight are not"
