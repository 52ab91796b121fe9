#!/usr/bin/env bash
# geotiff.js reads big-endian 16-bit depth with differences wrong: 1001, 2001 become 1001, 1745
#
# One would swear: byte order is the first thing that a TIFF says, and every reader heeds it; a file
#   that is read right uncompressed is read right compressed, and what is off fails or is noise.
# What happens: with a predictor (each pixel is the difference from the one to its left, which most
#   writers use when they compress) geotiff.js adds the differences up before it swaps the bytes: as
#   numbers of the machine's order, so that what should carry from the low byte to the high one
#   carries from the high to the low. A row of 1, 1001, 2001, 3001 is read 1, 1001, 1745, 2489. Where
#   no low byte overflows it is right: the left margin, and all of a wall that is faced; elsewhere
#   depth is off by multiples of 256, mostly. The same picture big-endian without a predictor, or
#   little-endian with it, is right, and "tiff" reads all four right. Nothing is said. ImageMagick
#   (tiff:endian=msb) and libtiff's tiffcp -B -c zip:2 write such files: the same happens.
# What follows: depth in TIFF for web pages is to be little-endian, or without predictor, or PNG. A
#   depth picture with streaks to the right of edges, in steps of 256 units, that another program
#   shows smooth is this; what reads depth in a browser needs a big-endian picture with slopes among
#   its tests.
set -u
geotiff=3.0.5 tiff=7.1.3
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "geotiff@$geotiff" "tiff@$tiff" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "geotiff $geotiff or tiff $tiff cannot be had: not looked at"; exit 2; }
echo "version: geotiff $(node -p 'require("./node_modules/geotiff/package.json").version'), tiff $tiff"
echo "expected: the stored depths from every file"
cat >t.mjs <<'JS'
import zlib from "zlib";
import { fromArrayBuffer } from "geotiff";
import { decode } from "tiff";

const width = 64, height = 48;
// A TIFF of 16-bit grey in one deflated strip; `big` is the byte order, `differences` the predictor.
function write(depth, big, differences) {
  const pixels = new DataView(new ArrayBuffer(2 * width * height));
  for (let i = 0; i < width * height; i++) {
    const before = differences && i % width ? depth[i - 1] : 0;
    pixels.setUint16(2 * i, (depth[i] - before) & 65535, !big);
  }
  const strip = zlib.deflateSync(new Uint8Array(pixels.buffer));
  const tags = [[256, 3, width], [257, 3, height], [258, 3, 16], [259, 3, 8], [262, 3, 1], [273, 4, 8], [277, 3, 1],
    [278, 3, height], [279, 4, strip.length], [317, 3, differences ? 2 : 1], [339, 3, 1]];
  const start = 8 + strip.length + strip.length % 2;
  const out = new DataView(new ArrayBuffer(start + 2 + 12 * tags.length + 4));
  out.setUint16(0, big ? 0x4d4d : 0x4949);
  out.setUint16(2, 42, !big);
  out.setUint32(4, start, !big);
  new Uint8Array(out.buffer).set(strip, 8);
  out.setUint16(start, tags.length, !big);
  tags.forEach(([tag, type, value], i) => {
    const at = start + 2 + 12 * i;
    out.setUint16(at, tag, !big);
    out.setUint16(at + 2, type, !big);
    out.setUint32(at + 4, 1, !big);
    if (type === 3) out.setUint16(at + 8, value, !big);
    else out.setUint32(at + 8, value, !big);
  });
  return out.buffer;
}

const wrong = (read, depth) => [...depth].filter((d, i) => read[i] !== d).length / depth.length;
const slope = Uint16Array.from({ length: width * height }, (_, i) => 1 + 1000 * (i % width));
const faced = new Uint16Array(width * height).fill(2345);
const seen = {};
for (const [name, depth] of [["a slope", slope], ["a faced wall", faced]]) {
  for (const [order, big] of [["little", false], ["big", true]]) {
    for (const differences of [false, true]) {
      const file = write(depth, big, differences), image = await (await fromArrayBuffer(file)).getImage();
      const [read] = await image.readRasters(), other = decode(file)[0].data;
      const off = Math.max(...depth.map((d, i) => Math.abs(read[i] - d)));
      seen[`${name} ${order} ${differences}`] = [wrong(read, depth), wrong(other, depth)];
      const share = (r) => `${(100 * wrong(r, depth)).toFixed(0)} % wrong`;
      console.log(`seen, ${name}, ${order}-endian, ${differences ? "with" : "without"} differences: `
        + `geotiff ${[...read.slice(0, 5)]}, ${share(read)}, by up to ${off}; tiff ${share(other)}`);
    }
  }
}
// What adding up in the machine's order gives, by hand: bytes swapped, summed, swapped back.
const swap = (v) => ((v & 255) << 8) | (v >> 8);
let sum = swap(1);
const byHand = [1, ...Array.from({ length: 4 }, () => swap(sum = (sum + swap(1000)) & 65535))];
console.log(`beside it, sums in the wrong byte order by hand: ${byHand}`);
const broken = seen["a slope big true"];
const rest = Object.entries(seen).filter(([name]) => name !== "a slope big true").every(([, v]) => v[0] === 0 && v[1] === 0);
process.exit(broken[0] > 0.9 && broken[1] === 0 && rest && byHand.join() === "1,1001,1745,2489,3233" ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: differences are added up in the wrong byte order"
