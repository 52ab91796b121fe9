#!/usr/bin/env bash
# Draco shuffles the points of a cloud when it quantises them, unless it is told to hurry
#
# One would swear: a compressed cloud has the points of the original in their order, a little off:
#   point i is pixel i of the depth picture; speed trades size for time, and nothing else.
# What happens: unquantised, the order is kept. With the positions quantised (14 bits) every speed
#   from 0 to 9 sorts the points into a tree of space: of 4096 points of an organised cloud, row by
#   row, one at most is at its index. The count is right, the cloud looks the same, and attributes
#   that were encoded with it (here the index itself) go along with their points. At speed 10 the
#   order is kept again, and the file is half as large as well, here. Nothing in the file or the
#   decoder's answer says which it was.
# What follows: what belongs to points by their index and is kept beside the file (labels, the pixel,
#   normals of one's own, tracks, links of a graph) is to be encoded as an attribute, or speed 10 is
#   to be asked for. A map whose colours are right and whose labels are confetti after compression is
#   this.
set -u
version=1.5.9
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "draco3d@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "draco3d $version cannot be had: not looked at"; exit 2; }
echo "version: draco3d $(node -p 'require("draco3d/package.json").version')"
echo "expected: point i at index i, at any speed"
cat >t.js <<'JS'
const draco3d = require("draco3d");

// An organised cloud of 64 x 64: a wavy wall, in metres.
const side = 64, count = side * side;
const points = Float32Array.from({ length: 3 * count }, (_, k) => {
  const i = Math.floor(k / 3), x = (i % side) * 0.01, y = Math.floor(i / side) * 0.01;
  return [x, y, 2 + 0.3 * Math.sin(9 * x) * Math.cos(7 * y)][k % 3];
});

(async () => {
  const enc = await draco3d.createEncoderModule({}), dec = await draco3d.createDecoderModule({});
  function through(speed, bits) {
    const encoder = new enc.Encoder(), builder = new enc.PointCloudBuilder(), cloud = new enc.PointCloud();
    builder.AddFloatAttribute(cloud, enc.POSITION, count, 3, points);
    const own = builder.AddInt32Attribute(cloud, enc.GENERIC, count, 1, Int32Array.from({ length: count }, (_, i) => i));
    encoder.SetSpeedOptions(speed, speed);
    if (bits) encoder.SetAttributeQuantization(enc.POSITION, bits);
    const out = new enc.DracoInt8Array(), size = encoder.EncodePointCloudToDracoBuffer(cloud, false, out);
    const bytes = Int8Array.from({ length: size }, (_, i) => out.GetValue(i));
    const buffer = new dec.DecoderBuffer(), decoder = new dec.Decoder(), back = new dec.PointCloud();
    buffer.Init(bytes, size);
    decoder.DecodeBufferToPointCloud(buffer, back);
    const at = new dec.DracoFloat32Array(), index = new dec.DracoInt32Array();
    decoder.GetAttributeFloatForAllPoints(back, decoder.GetAttribute(back, decoder.GetAttributeId(back, dec.POSITION)), at);
    decoder.GetAttributeInt32ForAllPoints(back, decoder.GetAttributeByUniqueId(back, own), index);
    let kept = 0, off = 0;
    const met = new Set();
    for (let i = 0; i < back.num_points(); i++) {
      const was = index.GetValue(i);
      met.add(was);
      if (was === i) kept++;
      off = Math.max(off, ...[0, 1, 2].map((d) => Math.abs(at.GetValue(3 * i + d) - points[3 * was + d])));
    }
    console.log(`seen, ${bits ? `${bits} bits` : "unquantised"}, speed ${speed}: ${kept} of ${count} points at their index; `
      + `all there: ${met.size === count}; by their own index up to ${(1000 * off).toFixed(2)} mm off; ${size} bytes`);
    return { kept, all: met.size === count && back.num_points() === count, off };
  }
  let ok = true;
  for (const speed of [0, 5, 10]) {
    const r = through(speed, 0);
    ok = ok && r.all && r.kept === count && r.off === 0;
  }
  for (const speed of [0, 3, 5, 7, 9]) {
    const r = through(speed, 14);
    ok = ok && r.all && r.kept < count / 20 && r.off < 1e-4;
  }
  const r = through(10, 14);
  process.exit(ok && r.all && r.kept === count && r.off < 1e-4 ? 0 : 1);
})();
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: speed decides over the order"
