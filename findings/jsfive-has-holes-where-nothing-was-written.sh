#!/usr/bin/env bash
# jsfive has holes where nothing was written, not the fill value
#
# One would swear: an HDF5 data set gives its fill value wherever nothing was written, whoever reads it;
#   the format says so, and h5py's fillvalue=65535 is there to be read.
# What happens: the part of the array for pieces (chunks) that were never written is undefined, whatever
#   the fill value, 0 as well: a sum in a loop is NaN, reduce and forEach step over them (the mean by
#   reduce and length of a stack of 6 depths of which 3 were recorded is half of what it is), JSON has
#   null, and copied into a Uint16Array they are 0, which is another thing than 65535. Length and
#   shape are right. A data set without chunks that was never written is undefined
#   throughout, and one with chunks has no values at all, length 0, for its shape of 6 by 4. What was
#   written in part without chunks is right. The value is known: fillvalue, beside it, says 65535.
#   h5py and h5wasm give it.
# What follows: after jsfive put the data set's fillvalue wherever the array has undefined, before it
#   becomes a typed array; recordings that ended early, or skip frames, have such pieces.
set -u
version=0.4.2 other=0.10.3
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
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "jsfive@$version" "h5wasm@$other" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "jsfive $version or h5wasm $other cannot be had: not looked at"; exit 2; }
echo "version: jsfive $(sed -n 's/.*"version": "\(.*\)".*/\1/p' node_modules/jsfive/package.json), h5wasm $other"
echo "expected: 1000 1001 65535 65535 1004 65535"
cat >t.py <<'PY'
import h5py

with h5py.File("depth.h5", "w") as f:
    for name, fill in (("invalid", 65535), ("zero", 0)):
        stack = f.create_dataset(name, shape=(6, 48, 64), dtype="u2", chunks=(1, 48, 64), fillvalue=fill)
        for k in (0, 1, 4):
            stack[k] = 1000 + k
    f.create_dataset("untouched", shape=(6, 4), dtype="u2", chunks=(2, 4), fillvalue=7)
    f.create_dataset("plain", shape=(6, 4), dtype="u2", fillvalue=7)
    f.create_dataset("part", shape=(6, 4), dtype="u2", fillvalue=7)[0] = 1
with h5py.File("depth.h5") as f:
    print("seen: h5py reads", *f["invalid"][:, 0, 0], "and", *f["untouched"][:, 0])
PY
cat >t.mjs <<'JS'
import { readFileSync } from "node:fs";
import * as five from "jsfive";
import * as h5 from "h5wasm/node";

await h5.ready;
const bytes = readFileSync("depth.h5"), file = new five.File(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "depth.h5");
const beside = new h5.File("depth.h5", "r");
const firsts = (values, size) => Array.from({ length: 6 }, (_, k) => values[k * size]);
const seen = {};
for (const [name, size] of [["invalid", 48 * 64], ["zero", 48 * 64], ["untouched", 4], ["plain", 4], ["part", 4]]) {
  const set = file.get(name), values = set.value, right = Array.from(beside.get(name).value);
  const filled = Array.from({ length: right.length }, (_, i) => values[i] ?? set.fillvalue);
  seen[name] = { length: values.length, holes: Array.from(values).filter((v) => v === undefined).length, first: firsts(values, size).join(),
    mean: values.reduce((a, b) => a + b, 0) / values.length, typed: firsts(Uint16Array.from(values), size).join(), mended: filled.join() === right.join() };
  const r = seen[name];
  console.log(`seen, ${name}: ${r.length} values for ${set.shape}, ${r.holes} undefined: ${r.first.replaceAll(",,", ",-,").replaceAll(",,", ",-,")}; `
    + `mean by reduce ${r.mean.toFixed(1)}; as Uint16Array ${r.typed}; h5wasm ${firsts(right, size)}; fillvalue ${set.fillvalue}; with it put in, the same: ${r.mended}`);
}
const { invalid, zero, untouched, plain, part } = seen, half = 3 * 48 * 64;
process.exit([invalid, zero].every((r) => r.length === 2 * half && r.holes === half && r.first === "1000,1001,,,1004,"
  && r.typed === "1000,1001,0,0,1004,0" && Math.abs(r.mean - (1000 + 1001 + 1004) / 6) < 1e-9) && untouched.length === 0 && plain.holes === 24
  && part.holes === 0 && Object.values(seen).every((r) => r.mended) ? 0 : 1);
JS
/usr/bin/python3 t.py && nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: what was not written is undefined"
