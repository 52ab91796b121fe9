#!/usr/bin/env bash
# h5wasm shows another picture in place of one that it cannot unpack
#
# One would swear: a data set whose compression the reader does not have (h5py's own "lzf" is not in
#   the HDF5 library) ends in an error, or in nothing.
# What happens: value and slice() give an array of the right kind and length, without any exception;
#   the HDF5 library's report goes to standard error only (in a browser, the console). Once
#   another data set of that size has been read, the array is that one's picture, but for a dozen of
#   307200 pixels. With depth 0 as gzip and depth 1 to 3 as LZF, all of them are depth 0;
#   with gzip and LZF in turn every second one is the one before it. h5py reads all of them;
#   activate_throwing_error_handler(), called beforehand, makes an error of it.
# What follows: call activate_throwing_error_handler() before the first file, or look at filters of a
#   data set; a viewer whose pictures stand still or come late by one, while shapes and stamps are
#   right, has this.
set -u
version=0.10.3
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
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "h5wasm@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "h5wasm $version cannot be had: not looked at"; exit 2; }
echo "version: h5wasm $(sed -n 's/.*"version": "\(.*\)".*/\1/p' node_modules/h5wasm/package.json)"
echo "expected: depths of 1500, 1800, 2100 and 2400 at the first pixel, or an error"
cat >t.py <<'PY'
import h5py
import numpy as np

y, x = np.mgrid[0:480, 0:640]
with h5py.File("depth.h5", "w") as f:
    for k in range(4):
        for how in ("gzip", "lzf"):
            f.create_dataset(f"{how}{k}", data=(1500 + 300 * k + x // 40 * 10 + y // 30).astype("u2"),
                             chunks=(60, 80), compression=how)
with h5py.File("depth.h5") as f:
    print("seen: h5py reads", *(f"{f[f'lzf{k}'][0, 0]} ({(f[f'lzf{k}'][:] == f[f'gzip{k}'][:]).all()})" for k in range(4)))
PY
cat >t.mjs <<'JS'
import * as h5 from "h5wasm/node";

const module_ = await h5.ready, want = [0, 1, 2, 3].map((k) => 1500 + 300 * k);
// Which of the four depths each of `names`, read one after the other, is, but for at most 20 of its pixels.
const pixels = 640 * 480, depth = (k, i) => 1500 + 300 * k + 10 * Math.floor(i % 640 / 40) + Math.floor(i / 640 / 30);
const which = (picture) => want.findIndex((_, k) => picture.length === pixels
  && picture.reduce((same, v, i) => same + (v === depth(k, i)), 0) >= pixels - 20);
const file = new h5.File("depth.h5", "r"), read = (names) => names.map((name) => which(file.get(name).value));
const kept = read(["gzip0", "lzf1", "lzf2", "lzf3"]);
const turns = read(["gzip0", "lzf1", "gzip2", "lzf3"]);
const good = read(["gzip0", "gzip1", "gzip2", "gzip3"]);
file.get("gzip2").value;
const part = Array.from(file.get("lzf1").slice([[0, 2], [0, 2]]));
console.log(`seen: gzip0 lzf1 lzf2 lzf3 are the pictures ${kept}; gzip0 lzf1 gzip2 lzf3 are ${turns}; all by gzip ${good}`);
console.log(`seen: a slice of lzf1 is ${part}`);
module_.activate_throwing_error_handler();
let said = "nothing";
try { file.get("lzf1").value; } catch (error) { said = String(error.message ?? error); }
console.log(`beside it, with the throwing handler: ${said === "nothing" ? said : "an error"}, "${said.split("\n")[0].slice(0, 60)}"`);
process.exit(kept.join() === "0,0,0,0" && turns.join() === "0,0,2,2" && good.join() === "0,1,2,3" && part.length === 4
  && said !== "nothing" ? 0 : 1);
JS
/usr/bin/python3 t.py && nice node t.mjs 2>hdf5.log || { tail -3 hdf5.log; echo "the behaviour has changed"; exit 1; }
echo "seen: $(grep -c "filter 'lzf' is not registered" hdf5.log) reports on standard error"
echo "as described: what cannot be unpacked is another picture"
