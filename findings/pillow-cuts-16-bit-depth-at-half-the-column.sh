#!/usr/bin/env bash
# Pillow cuts a masked object out of 16-bit depth at half of its column
#
# One would swear: what Pillow does to a 16-bit picture (mode I;16, as which numpy's uint16 and
#   TIFF come; PNG and PGM come as I) it does in 16 bits, or it refuses, as it does for filters,
#   ImageChops and resize with BILINEAR: "image has wrong mode".
# What happens: some functions take the two bytes of a pixel for two pixels, and say nothing.
#   paste of a picture with a mask, and composite, change columns 10 to 24 where the mask is
#   set in columns 20 to 49, and never the right half. paste of the number 5000, whose low byte
#   is 136, writes 136 into both bytes: 34952. rotate with BILINEAR works on single bytes and
#   gives values from 0 to 255. getbbox finds nothing in columns 40 to 49 of 60. crop, flips,
#   NEAREST and paste without a mask are right, which is why one trusts the rest.
# What follows: moving objects are to be cut out of depth, and depth is to be rotated, in mode
#   I or F, where the same calls are right, or in numpy. Depth with holes to the left of the
#   objects, with many pixels of 34952 or another value of two equal bytes, or without a value
#   above 255 has been through this.
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
want python3-pil 9.4.0
want python3-numpy 1:1.24
echo "expected: changes in columns 20 to 49, the number 5000, and values from 3000 on"
cat >"$tmp/t.py" <<'PY'
import sys

import numpy as np
from PIL import Image, ImageFilter

depth = (3000 + 100 * np.arange(60) + np.arange(40)[:, None]).astype(np.uint16)
mask = np.zeros((40, 60), np.uint8)
mask[10:30, 20:50] = 255
cut = Image.fromarray(mask)


def columns(picture):  # the first and the last that is not as it was
    changed = np.flatnonzero((np.array(picture).astype(int) != depth).any(axis=0))
    return (int(changed[0]), int(changed[-1])) if changed.size else None


def tried(mode):
    whole = Image.fromarray(depth) if mode == "I;16" else Image.fromarray(depth.astype(np.int32))
    none = Image.new(mode, whole.size)
    pasted, filled, plain = whole.copy(), whole.copy(), whole.copy()
    pasted.paste(none, (0, 0), cut)
    filled.paste(5000, (20, 10, 50, 30))
    plain.paste(none.crop((0, 0, 30, 20)), (20, 10))
    some = np.zeros((40, 60), np.uint16 if mode == "I;16" else np.int32)
    some[5:10, 40:50] = 1000
    turned = np.array(whole.rotate(5, Image.BILINEAR))
    return {"paste by mask": columns(pasted), "composite": columns(Image.composite(none, whole, cut)), "paste without": columns(plain),
            "filled with": int(np.array(filled)[20, 30]), "rotated, at most": int(turned.max()),
            "rotated by NEAREST, at most": int(np.array(whole.rotate(5)).max()), "box": Image.fromarray(some).getbbox()}


def refused():
    try:
        Image.fromarray(depth).filter(ImageFilter.MedianFilter(3))
    except ValueError as why:
        return str(why)


short, long = tried("I;16"), tried("I")
for mode, found in (("I;16", short), ("I", long)):
    print(f"seen in mode {mode}:", ", ".join(f"{name} {value}" for name, value in found.items()))
print("seen, a filter of I;16 is refused:", refused())
ok = short["paste by mask"] == short["composite"] == (10, 24) and short["filled with"] == 0x8888 and short["rotated, at most"] <= 255
ok = ok and short["box"] is None and short["paste without"] == (20, 49) and short["rotated by NEAREST, at most"] > 8000
ok = ok and long["paste by mask"] == long["composite"] == long["paste without"] == (20, 49) and long["filled with"] == 5000
ok = ok and long["rotated, at most"] > 8000 and long["box"] == (40, 5, 50, 10) and refused() == "image has wrong mode"
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: bytes are taken for pixels"
