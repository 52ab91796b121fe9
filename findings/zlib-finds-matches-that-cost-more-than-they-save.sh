#!/usr/bin/env bash
# zlib's search for matches makes a camera's PNG larger than no search at all
#
# One would swear: a higher level gives a smaller file, and whatever the level, looking
#   for repetitions can but help; Huffman codes alone are for those in a hurry.
# What happens: of a noisy colour image, rows filtered by averages, the usual strategy
#   at level 9 gives 521 kB and takes 45 ms; Z_HUFFMAN_ONLY gives 464 kB in 6 ms at every
#   level. Noise holds short matches by chance, and zlib takes them: a length and a
#   distance of up to 28 bits in place of three bytes of 5 bits or so. Z_FILTERED, made for
#   such data, is hardly better than the usual strategy below level 6 and takes 70 ms above.
# What follows: PNGs of cameras are to be written by Z_HUFFMAN_ONLY or Z_RLE (Z_RLE where
#   there are flat parts): smaller and quicker at once. It is not so for drawings, masks or depth
#   in steps, which repeat themselves; the image decides, not the level.
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
want zlib1g 1:1.2.13
want python3-numpy 1:1.24
echo "expected: the usual strategy at level 9 smaller than Huffman codes alone, and filtered smaller still"
cat >"$tmp/t.py" <<'PY'
import sys
import zlib

import numpy as np

rng = np.random.default_rng(1)
y, x = np.mgrid[0:480, 0:640]
smooth = np.stack([120 + 60 * np.sin(x / 50 + k) + 40 * np.cos(y / 70) for k in range(3)], -1)
image = np.clip(smooth + rng.normal(0, 3, smooth.shape), 0, 255).astype(np.int16)
left, above = np.zeros_like(image), np.zeros_like(image)
left[:, 1:], above[1:] = image[:, :-1], image[:-1]
filtered = ((image - (left + above) // 2) & 255).astype(np.uint8)  # PNG's filter 3
rows = b"".join(b"\x03" + row.tobytes() for row in filtered)

def size(level, strategy):
    packer = zlib.compressobj(level, zlib.DEFLATED, 15, 8, strategy)
    return len(packer.compress(rows)) + len(packer.flush())

usual = {level: size(level, zlib.Z_DEFAULT_STRATEGY) for level in (1, 6, 9)}
other = {name: size(1, strategy) for name, strategy in
         (("huffman", zlib.Z_HUFFMAN_ONLY), ("rle", zlib.Z_RLE), ("filtered", zlib.Z_FILTERED))}
print(f"seen: usual strategy {usual}, at level 1 {other}, of {len(rows)} bytes")
sys.exit(0 if max(other["huffman"], other["rle"]) < 0.93 * min(usual.values()) and
         other["filtered"] > 0.95 * usual[1] else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "changed: matches pay now"; exit 1; }
echo "as described: without looking for matches the file is smaller"
