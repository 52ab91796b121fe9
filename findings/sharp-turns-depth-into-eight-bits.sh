#!/usr/bin/env bash
# sharp makes 8-bit sRGB of 16-bit grey, even when it is asked for 16 bits
#
# One would swear: PNG in, PNG out leaves a 16-bit grey picture one; raw output
#   with depth "ushort" hands out the stored numbers.
# What happens: the pipeline ends in 8-bit sRGB unless told otherwise. A depth
#   PNG that is only cropped is written as an 8-bit picture of three channels,
#   10000 mm becoming 39; raw({depth: "ushort"}) gives those same small numbers
#   in 16-bit boxes, with info.depth saying "ushort". stats(), asked of the
#   same file, says 10000. Only toColourspace("grey16") keeps what was there,
#   in raw output and in PNG.
# What follows: depth that passed through a web tool built on sharp (thumbnails,
#   crops, uploads) has lost its low byte, and "ushort" in a description proves
#   nothing. A reader of depth folders should say so when a depth picture has
#   8 bits and three equal channels; a web page of ours reads PNG depth with a
#   decoder that gives 16 bits.
set -u
want=0.34.5
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "sharp@$want" >"$tmp/npm.log" 2>&1 ||
  { tail -3 "$tmp/npm.log"; echo "sharp $want cannot be had: not looked at"; exit 2; }
echo "version: sharp $(node -p 'require("sharp/package.json").version'), libvips $(node -p 'require("sharp").versions.vips')"
echo "expected: 0 1 500 1000 2345 4095 9999 10000 in one channel of 16 bits"
cat >t.js <<'JS'
const sharp = require("sharp"), zlib = require("zlib"), fs = require("fs");

// A PNG by hand: 8 x 8, grey, 16 bits.
const table = Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1;
  return n >>> 0;
});
const crc = (bytes) => (bytes.reduce((c, b) => table[(c ^ b) & 255] ^ (c >>> 8), 0xffffffff) ^ 0xffffffff) >>> 0;
const u32 = (n) => { const b = Buffer.alloc(4); b.writeUInt32BE(n >>> 0); return b; };
const chunk = (kind, body) => { const both = Buffer.concat([Buffer.from(kind), body]); return Buffer.concat([u32(body.length), both, u32(crc(both))]); };
const depth = [0, 1, 500, 1000, 2345, 4095, 9999, 10000];
const row = Buffer.alloc(17);
depth.forEach((d, i) => row.writeUInt16BE(d, 1 + 2 * i));
fs.writeFileSync("depth.png", Buffer.concat([
  Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]),
  chunk("IHDR", Buffer.concat([u32(8), u32(8), Buffer.from([16, 0, 0, 0, 0])])),
  chunk("IDAT", zlib.deflateSync(Buffer.concat(Array(8).fill(row)))), chunk("IEND", Buffer.alloc(0))]));

const same = (a, b) => a.length === b.length && a.every((v, i) => v === b[i]);
const firstRow = ({ data, info }) => {
  const all = info.depth === "ushort" ? new Uint16Array(data.buffer, data.byteOffset, data.length / 2) : data;
  return Array.from({ length: 8 }, (_, i) => all[i * info.channels]);
};
const raw = async (pipeline) => pipeline.toBuffer({ resolveWithObject: true });

(async () => {
  const before = await sharp("depth.png").metadata();
  const top = (await sharp("depth.png").stats()).channels[0].max;
  console.log(`seen: the file is ${before.depth}, ${before.channels} channel, ${before.space}; stats() says its largest value is ${top}`);
  await sharp("depth.png").extract({ left: 0, top: 0, width: 8, height: 4 }).png().toFile("crop.png");
  const crop = await sharp("crop.png").metadata();
  const cropped = firstRow(await raw(sharp("crop.png").raw()));
  console.log(`seen: cropped to PNG: ${crop.depth}, ${crop.channels} channels, ${crop.space}, ${cropped.join(" ")}`);
  const asked = await raw(sharp("depth.png").raw({ depth: "ushort" }));
  console.log(`seen: raw, depth "ushort": info says ${asked.info.depth}, ${asked.info.channels} channels, ${firstRow(asked).join(" ")}`);
  const told = await raw(sharp("depth.png").toColourspace("grey16").raw({ depth: "ushort" }));
  console.log(`seen: with toColourspace("grey16"): ${told.info.depth}, ${told.info.channels} channel, ${firstRow(told).join(" ")}`);
  const small = [0, 0, 1, 3, 9, 15, 39, 39];
  const ok = before.depth === "ushort" && top === 10000 && crop.depth === "uchar" && crop.channels === 3
    && same(cropped, small) && asked.info.depth === "ushort" && same(firstRow(asked), small) && same(firstRow(told), depth);
  process.exit(ok ? 0 : 1);
})();
JS
node t.js || { echo "the behaviour has changed"; exit 1; }
