#!/usr/bin/env bash
# HDF5's scale-offset filter turns missing depth into the nearest wall, or a whole tile into zeros
#
# One would swear: h5py's scaleoffset=3 keeps depth in metres to a millimetre, as it says; it packs
#   floats as whole numbers, so what a NaN becomes may depend, but infinity and NaN fare alike, and
#   depth beside a hole is safe.
# What happens: infinity comes back as infinity. A NaN comes back as the smallest depth of its tile
#   (chunk), a good reading like any other: the holes of a depth camera become patches at the
#   distance of what is nearest. And where a tile's first pixel is NaN, a tile of doubles comes back
#   with all its NaN, but one of floats as zeros altogether: of a picture with ten rows missing,
#   which touch eight tiles, 32000 good readings are gone besides 6400 missing ones. No word is said
#   on writing or reading.
# What follows: 16-bit millimetres, or 0 for missing, go through the filter as they should; zeros
#   come back below a millimetre. A file of floats that has been through it holds no NaN where there
#   ought to be some: that is the sign.
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
want python3-h5py 3.7.0
want libhdf5-103-1 1.10.8
echo "expected: depth to a millimetre; NaN where there was NaN, or at least not a depth"
cat >"$tmp/t.py" <<'PY'
import sys

import h5py
import numpy as np

good = np.random.default_rng(1).uniform(0.4, 8.4, (480, 640))


def through(kind, missing, where, value=np.nan):
    depth = good.astype(kind)
    depth[where] = value
    with h5py.File(sys.argv[1], "w") as f:
        f.create_dataset("depth", data=depth, chunks=(60, 80), scaleoffset=3)
    with h5py.File(sys.argv[1]) as f:
        return depth, f["depth"][()]


def tell(name, depth, back):
    hole = ~np.isfinite(depth)
    lost = int((~(np.abs(back[~hole] - depth[~hole]) <= 0.001)).sum())
    same = int(((back == depth) | (np.isnan(back) & np.isnan(depth)))[hole].sum())
    print(f"seen, {name}: of {hole.sum()} missing {same} come back so, {np.isfinite(back[hole]).sum()} as numbers from "
          f"{np.nanmin(back[hole]):.3f} to {np.nanmax(back[hole]):.3f}" if np.isfinite(back[hole]).any() else
          f"seen, {name}: of {hole.sum()} missing {same} come back so", f"; good readings lost: {lost}")
    return int(hole.sum()), same, lost


inner, rows = np.s_[200:210, 200:210], np.s_[60:70]
ok = True
for kind in (np.float32, np.float64):
    depth, back = through(kind, np.nan, inner)
    n, same, lost = tell(f"{kind.__name__}, a hole of 10 x 10 within a tile", depth, back)
    nearest = np.nanmin(depth[180:240, 160:240])
    ok = ok and same == 0 and lost == 0 and np.abs(back[inner] - nearest).max() < 0.001
    depth, back = through(kind, np.nan, rows)
    n, same, lost = tell(f"{kind.__name__}, ten rows that tiles begin with", depth, back)
    ok = ok and ((same, lost) == (6400, 0) if kind == np.float64 else (same, lost) == (0, 32000) and not back[60:120].any())
    for where in (inner, rows):
        depth, back = through(kind, None, where, np.inf)
        n, same, lost = tell(f"{kind.__name__}, infinity there", depth, back)
        ok = ok and same == n and lost == 0
    depth, back = through(kind, None, rows, 0)
    ok = ok and np.abs(back - depth).max() < 0.001
    print(f"seen, {kind.__name__}, 0 there: {np.abs(back - depth).max():.4f} off at most")
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" "$tmp/depth.h5" || { echo "the behaviour has changed"; exit 1; }
echo "as described: what is missing becomes the nearest, or all becomes 0"
