#!/usr/bin/env bash
# FFmpeg's geq wraps depth that is too large round to near, and takes the last row from the one above
#
# One would swear: geq=lum='p(X,Y)' is the picture; 'p(X,Y)*5', from millimetres to TUM's 5000 a
#   metre, clips at 65535 what does not fit, as saturating arithmetic does everywhere in video; and
#   lut, the quick way to do the same, gives the same.
# What happens: geq takes what is too large modulo 65536: 13.2 m become 0.09 m, and what is below 0
#   becomes the farthest. And p(X,Y), which interpolates unless told otherwise, keeps one pixel away
#   from the right and lower margin: the last column and row are copies of those before them, also in
#   8 bits; with interpolation=nearest they are right. lut does clip, at 65280 (255 times 256): 65535
#   is 65280 even after lut=c0=val, and negval is 65280 less the value, where the negate filter has
#   65535. lutyuv=y=val, the same table by another name, is off by up to 16 anywhere, as it goes
#   through video range. All in 16-bit grey, without a word.
# What follows: depth is to be scaled in a program, or by geq with interpolation=nearest and
#   min(65535, ...) around the expression. In depth films a far background that lies in front of
#   everything is this; so is 65280 as the largest value of a film whose mark for "nothing" was 65535.
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
want ffmpeg 7:5.1.9
want python3-numpy 1:1.24
echo "expected: 0 pixels that differ from what clipped arithmetic gives"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np

width, height = 64, 48
depth = (500 + 4 * np.arange(width * height)).reshape(height, width).astype("<u2")
depth[10, 10:13] = [65535, 65300, 13200]
small = depth.astype(np.uint8)


def ffmpeg(picture, chain):
    grey = "gray" if picture.dtype == np.uint8 else "gray16le"
    kind = ["-f", "rawvideo", "-pix_fmt", grey]
    run = subprocess.run(["ffmpeg", "-v", "error", *kind, "-s", f"{width}x{height}", "-r", "30", "-i", "-", "-vf", chain, *kind, "-"],
                         input=picture.tobytes(), capture_output=True, check=True)
    return np.frombuffer(run.stdout, picture.dtype).reshape(height, width).astype(int)


# What differs from the right answer: where, and by how much.
def look(chain, right, picture=depth):
    found = ffmpeg(picture, chain)
    bad = found != right
    margin = np.zeros_like(bad)
    margin[-1] = margin[:, -1] = True
    print(f"seen, {chain} in {picture.dtype.itemsize * 8} bits: {bad.sum()} of {bad.size} pixels differ, "
          f"{int((bad & margin).sum())} of them in the last row and column; 65535, 65300, 13200 become {found[10, 10:13].tolist()}")
    return found, int(bad.sum()), int((bad & margin).sum())


whole, five = depth.astype(int), np.minimum(5 * depth.astype(int), 65535)
edge = width + height - 1
shifted = whole.copy()
shifted[:, -1], shifted[-1] = shifted[:, -2], shifted[-2]
shifted[-1, -1] = whole[-2, -2]
found, bad, margin = look("geq=lum='p(X,Y)'", whole)
ok = (bad, margin) == (edge, edge) and (found == shifted).all()
_, bad, margin = look("geq=lum='p(X,Y)'", small.astype(int), small)
ok = ok and bad > 40 and bad == margin
ok = ok and look("geq=lum='p(X,Y)':interpolation=nearest", whole)[1] == 0
found, bad, _ = look("geq=lum='p(X,Y)*5':interpolation=nearest", five)
over = 5 * whole > 65535
ok = ok and bad == over.sum() and (found == 5 * whole % 65536).all()
ok = ok and look("geq=lum='min(65535,p(X,Y)*5)':interpolation=nearest", five)[1] == 0
less = look("geq=lum='p(X,Y)-1000':interpolation=nearest", np.maximum(whole - 1000, 0))
ok = ok and (less[0] == (whole - 1000) % 65536).all() and less[1] == (whole < 1000).sum()
ok = ok and (look("lut=c0=val", whole)[0] == np.minimum(whole, 65280)).all()
ok = ok and (look("lut=c0=val*5", five)[0] == np.minimum(five, 65280)).all()
ok = ok and (look("lut=c0=negval", 65535 - whole)[0] == np.maximum(65280 - whole, 0)).all()
ok = ok and look("negate", 65535 - whole)[1] == 0
found, bad, _ = look("lutyuv=y=val", whole)
ok = ok and bad > whole.size / 2 and 8 < np.abs(found - whole).max() <= 16
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: far becomes near, or stops at 65280"
