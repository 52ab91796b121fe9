#!/usr/bin/env bash
# image-js moves a picture by half a pixel when it is resized, even to the size it has
#
# One would swear: resize to the picture's own size gives back the picture, by any interpolation; and
#   a quarter of the size lies where the large picture lies: small pixel i is about 4i + 1.5.
# What happens: by the default, bilinear (bicubic is the same), pixel i of the result is read at (i -
#   0.5) times the step, where it should be (i + 0.5) times the step less 0.5. To its own size a
#   picture comes out blurred and half a pixel further right and down; at half the size it is off by
#   one of the large pixels, at a quarter by two, and after three halvings by seven. 16-bit depth of
#   2000 and 4000 comes out with 3000 at the edge, at its own size. By nearest the own size is exact,
#   and small pixel i is 4i, the corner of its block.
# What follows: a point found at i in a picture made small by image-js lies at (i - 0.5) times the
#   step in the large one; intrinsics for it are to be made by the same rule. Two programs whose
#   keypoints differ by a fixed amount to the lower right that doubles with the octave have this.
set -u
version=1.7.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "image-js@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "image-js $version cannot be had: not looked at"; exit 2; }
echo "version: image-js $(node -p 'require("./node_modules/image-js/package.json").version')"
echo "expected: pixel i of the result from (i + 0.5) s - 0.5, where s is the step"
cat >t.mjs <<'JS'
import { Image } from "image-js";

const size = 64;
const picture = (of) => new Image(size, size, { colorModel: "GREY", bitDepth: 16,
  data: Uint16Array.from({ length: size * size }, (_, i) => of(i % size, Math.floor(i / size))) });
const slope = picture((x) => 1000 * x);

// Where in the large picture the pixels in the middle of a row of the result were read.
function grid(image, wide, interpolationType) {
  const small = image.resize({ width: wide, height: wide, interpolationType });
  const i = wide / 2, step = size / wide;
  const read = small.getValue(i, i, 0) / 1000, right = (i + 0.5) * step - 0.5, corner = i * step;
  console.log(`seen, ${size} to ${wide}, ${interpolationType ?? "as it comes"}: pixel ${i} is read at ${read.toFixed(3)}, `
    + `its middle lies at ${right}: ${(read - right).toFixed(3)} off`);
  return { off: read - right, fromCorner: read - corner, small };
}

const near = (a, b) => Math.abs(a - b) < 2e-3;
let ok = true;
for (const [wide, off] of [[64, -0.5], [32, -1], [16, -2], [128, -0.25], [256, -0.125]]) {
  const bilinear = grid(slope, wide), nearest = grid(slope, wide, "nearest");
  ok = ok && near(bilinear.off, off) && (wide > size || near(nearest.fromCorner, 0));
}
// Three halvings, one after the other.
let level = slope;
for (let k = 0; k < 3; k++) level = level.resize({ width: level.width / 2, height: level.height / 2 });
const far = level.getValue(4, 4, 0) / 1000 - (4.5 * 8 - 0.5);
console.log(`seen: after three halvings pixel 4 is ${far.toFixed(3)} off`);
// Two depths side by side, at their own size.
const step = picture((x) => x < 32 ? 2000 : 4000), values = (image) => [...new Set(image.getRawImage().data)];
const same = step.resize({ width: size, height: size });
const exact = step.resize({ width: size, height: size, interpolationType: "nearest" });
console.log(`seen: depths of 2000 and 4000 at their own size become ${values(same)}; by nearest ${values(exact)}`);
process.exit(ok && near(far, -7) && values(same).join() === "2000,3000,4000" && values(exact).join() === "2000,4000" ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: resized is moved"
