#!/usr/bin/env bash
# netcdfjs takes a record's padding for data: an inlier count comes with a -32767 behind it
#
# One would swear: a classic NetCDF file with one record a frame (time, pose, inlier count, state) is
#   read as its writer and every other reader have it: one number a frame each, bytes with a sign.
# What happens: a record's part of each variable is filled up to four bytes; netcdfjs gives the
#   filling as values. The count, 16 bits, of every frame becomes [100, -32767], the state, 8 bits,
#   [0, 129, 129, 129], and a row of three 16-bit numbers has a fourth. Doubles and floats beside
#   them are right, as is any such variable that is alone in its file (the format knows no padding
#   there). BYTE is signed in the format; here -1 is 255. What comes out
#   differs in its nesting too: numbers for t, arrays for the count; count - 50 is NaN.
# What follows: take as many values of each record as the variable's own dimensions say, and give
#   bytes their sign; or write counts and states as 32-bit integers. A plot that has -32767 at every
#   second point has this.
set -u
version=4.0.0
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
want python3-scipy 1.10
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "netcdfjs@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "netcdfjs $version cannot be had: not looked at"; exit 2; }
echo "version: netcdfjs $(node -p 'require("./node_modules/netcdfjs/package.json").version')"
echo "expected: inliers 100 101 102 103 104, state 0 1 -1 0 1"
cat >t.py <<'PY'
import json

import numpy as np
from scipy.io import netcdf_file

counts, states, rows = 100 + np.arange(5), np.array([0, 1, -1, 0, 1]), np.arange(15).reshape(5, 3)


def write(name, *kinds):
    with netcdf_file(name, "w") as f:
        f.createDimension("time", None)
        f.createDimension("axis", 3)
        for k, kind, values in kinds:
            v = f.createVariable(k, kind, ("time", "axis")[:values.ndim])
            for i, value in enumerate(values):
                v[i] = value


write("run.nc", ("t", "f8", 1305031102.175304 + np.arange(5) / 30), ("inliers", "i2", counts), ("state", "i1", states), ("row", "i2", rows))
write("alone.nc", ("inliers", "i2", counts))
with netcdf_file("run.nc", mmap=False) as f:
    print(json.dumps({k: v[:].tolist() for k, v in f.variables.items()}))
PY
cat >t.mjs <<'JS'
import { readFileSync } from "node:fs";
import { NetCDFReader } from "netcdfjs";

const run = new NetCDFReader(readFileSync("run.nc")), alone = new NetCDFReader(readFileSync("alone.nc"));
const scipy = JSON.parse(readFileSync("scipy.json", "utf8")), text = JSON.stringify;
for (const k of ["inliers", "state", "row"]) {
  console.log(`seen, ${k}: ${text(run.getDataVariable(k))}; SciPy, which wrote it, reads ${text(scipy[k])}`);
}
console.log(`seen: t as SciPy: ${text(run.getDataVariable("t")) === text(scipy.t)}; `
  + `the count alone in a file: ${text(alone.getDataVariable("inliers"))}`);
// As many values as the dimensions say, bytes with a sign.
const own = (k, wide) => run.getDataVariable(k).map((record) => record.slice(0, wide));
const signed = own("state", 1).map(([v]) => v << 24 >> 24);
console.log(`beside it, cut to their dimensions: ${text(own("inliers", 1).flat())} ${text(signed)} ${text(own("row", 3))}`);
process.exit(text(run.getDataVariable("inliers")) === text([100, 101, 102, 103, 104].map((v) => [v, -32767]))
  && text(run.getDataVariable("state")) === text([0, 1, 255, 0, 1].map((v) => [v, 129, 129, 129]))
  && run.getDataVariable("row").every((r) => r.length === 4 && r[3] === -32767)
  && text(run.getDataVariable("t")) === text(scipy.t) && text(alone.getDataVariable("inliers")) === text(scipy.inliers)
  && text(own("inliers", 1).flat()) === text(scipy.inliers) && text(signed) === text(scipy.state)
  && text(own("row", 3)) === text(scipy.row) ? 0 : 1);
JS
/usr/bin/python3 t.py >scipy.json && nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: padding is read as data"
