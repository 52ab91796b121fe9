#!/usr/bin/env bash
# OpenImageIO's oiiotool makes EXR of 16-bit depth with 11 bits, and PGM with 8, though both hold 16
#
# One would swear: a file is copied into another format as exactly as that format can: 16-bit grey
#   becomes float in an EXR (which has it, and depth is what EXR is for), and stays 16 bits in a PGM.
# What happens: integers become halves, scaled to 0 to 1: of 65536 values 7169 are left, up to 16
#   units off. Depths in millimetres are up to 2 mm off below 5 m and 4 mm below 10 m; TUM's 5000 a
#   metre up to 4 units, 0.8 mm, below 3 m. What is near is exact (all up to 1000), so that a test on
#   a desk shows nothing. PGM gets 8 bits. Nothing is said, and TIFF, DPX, JPEG 2000 and SGI by the
#   same command have every value. With -d float the EXR is exact.
# What follows: say -d float (and uint16 on the way back) in every recipe with oiiotool, give it no
#   PGM to write, and look for "half" in --info of an EXR whose depth has steps. A reader of EXR depth
#   that finds half channels should say how coarse they are at the distance shown. Steps that double
#   with the distance, at 2, 4 and 8 m or so, are floats of 11 bits, and no sensor.
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
want openimageio-tools 2.4.7
want python3-pil 9.4.0
want python3-numpy 1:1.24
echo "expected: 65536 of 65536 values, 0 off, in every format that holds 16 bits"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np
from PIL import Image

depth = np.arange(65536, dtype=np.uint16).reshape(256, 256)
Image.fromarray(depth).save("depth.png")


def oiiotool(*arguments):
    run = subprocess.run(["oiiotool", *arguments], capture_output=True, text=True, check=True)
    return (run.stdout + run.stderr).strip()


# The largest error after PNG to the format and back, all of it, and up to each distance asked.
def through(name, *options):
    said = oiiotool("depth.png", *options, "-o", name)
    kind = oiiotool("--info", name).split(",")[-1].split()[0]
    oiiotool(name, "-d", "uint16", "-o", "back.png")
    back = np.array(Image.open("back.png")).astype(int)
    off = np.abs(back - depth)
    print(f"seen, {name} {' '.join(options)}: {kind}, {len(np.unique(back))} of 65536 values, up to {off.max()} off; "
          f"up to 1000: {off[depth <= 1000].max()}, 5000: {off[depth <= 5000].max()}, 10000: {off[depth <= 10000].max()}, "
          f"15000: {off[depth <= 15000].max()}; said: {said or 'nothing'}")
    return kind, len(np.unique(back)), int(off.max()), said


ok = through("a.exr") == ("half", 7169, 16, "")
ok = through("b.pgm") == ("uint8", 256, 128, "") and ok
for name, options in (("c.exr", ("-d", "float")), ("e.tif", ()), ("f.dpx", ()), ("g.jp2", ()), ("h.sgi", ())):
    kind, values, off, said = through(name, *options)
    ok = ok and (values, off) == (65536, 0)
# What rounding to a half of 11 bits does by itself.
halves = np.round((depth / 65535).astype(np.float16).astype(float) * 65535).astype(int)
print(f"beside it, NumPy's halves: {len(np.unique(halves))} values, up to {np.abs(halves - depth).max()} off")
ok = ok and np.abs(halves - depth).max() == 16
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: eleven bits of sixteen in an EXR, eight in a PGM"
