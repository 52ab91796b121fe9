#!/usr/bin/env bash
# three's EXRLoader reads float depth as halves, the last row first, unasked and unsaid
#
# One would swear: an EXR with 32-bit floats comes out as 32-bit floats, row by row from the top as in
#   the file, and what a loader changes is in the texture it returns (flipY).
# What happens: data is a Uint16Array of halves whatever the file holds: of a wall that leans away
#   from 2 to 4.4 m, a millimetre a pixel, 17 steps of 64 are left in a row (4.350 and 4.351 are both
#   4.34765625; beyond 4 m a half knows 4 mm, beyond 8 m 8 mm). Its first row is the picture's last,
#   with flipY false, so that depth taken row by row is off by up to 2.35 m here. The one channel Y
#   comes four numbers a pixel. setDataType(FloatType) gives the floats as they are; the rows stay
#   from below.
# What follows: setDataType(FloatType) before parse, and row h - 1 - y for y, wherever numbers are
#   taken from the data (unprojecting, comparing); only a GPU that draws it needs neither.
set -u
three=0.187.0
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
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "three@$three" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "three $three cannot be had: not looked at"; exit 2; }
echo "version: three $(node -p 'require("./node_modules/three/package.json").version')"
echo "expected: 2.000, 2.001, 2.002 ... in the first row, as floats"
# 64 x 48 floats as PFM (rows from below there, by its definition): 1 mm a column, 5 cm a row.
node -e 'const w = 64, h = 48, b = Buffer.alloc(4 * w * h);
for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) b.writeFloatLE(2 + 0.001 * x + 0.05 * y, 4 * ((h - 1 - y) * w + x));
process.stdout.write(Buffer.concat([Buffer.from("Pf\n64 48\n-1\n"), b]))' >metres.pfm
oiiotool metres.pfm --chnames Y -d float --compression zip -o metres.exr || exit 2
for y in 0 47; do echo "seen: in the file row $y begins with $(oiiotool metres.exr --cut 1x1+0+$y --printstats | sed -n 's/.*Stats Avg: *\([0-9.]*\).*/\1/p')"; done
cat >t.mjs <<'JS'
globalThis.self = globalThis;
import { readFileSync } from "node:fs";
import { DataUtils, FloatType, HalfFloatType } from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";

function read(name, type) {
  const bytes = readFileSync(name), loader = new EXRLoader();
  if (type) loader.setDataType(type);
  const { data, width, height, flipY } = loader.parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  const each = data.length / (width * height);
  return { kind: data.constructor.name, each, flipY, height, at: (x, row) => { const v = data[each * (row * width + x)]; return data instanceof Uint16Array ? DataUtils.fromHalfFloat(v) : v; } };
}
const plain = read("metres.exr"), half = read("metres.exr", HalfFloatType), floats = read("metres.exr", FloatType);
const depth = (x, y) => 2 + 0.001 * x + 0.05 * y;
// The largest error if rows are taken as they come, and if they are taken from below.
function off(r) {
  let straight = 0, below = 0;
  for (let y = 0; y < 48; y++) for (let x = 0; x < 64; x++) {
    straight = Math.max(straight, Math.abs(r.at(x, y) - depth(x, y)));
    below = Math.max(below, Math.abs(r.at(x, 47 - y) - depth(x, y)));
  }
  return [straight, below];
}
for (const [name, r] of [["as it comes", plain], ["with FloatType", floats]]) {
  const [straight, below] = off(r), steps = new Set(Array.from({ length: 64 }, (_, x) => r.at(x, 0))).size;
  console.log(`seen, ${name}: ${r.kind}, ${r.each} a pixel, flipY ${r.flipY}; first row ${r.at(0, 0).toFixed(4)} ${r.at(1, 0).toFixed(4)}, ${steps} different of 64; `
    + `off by up to ${straight.toFixed(4)} m, rows from below ${below.toFixed(5)} m`);
}
const [a, b] = [off(plain), off(floats)];
process.exit(plain.kind === "Uint16Array" && half.kind === "Uint16Array" && floats.kind === "Float32Array" && plain.flipY === false
  && Math.abs(plain.at(0, 0) - 4.35) < 0.01 && a[1] > 0.0015 && a[1] < 0.005 && b[1] < 1e-6 && b[0] > 2.3 && Math.abs(plain.at(0, 47) - 2) < 1e-6 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: halves, and from below"
