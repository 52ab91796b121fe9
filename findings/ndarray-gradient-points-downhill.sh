#!/usr/bin/env bash
# ndarray-gradient points downhill, and half as steeply at the picture's border
#
# One would swear: the gradient of a picture that grows by 3 a column is 3, by central differences,
#   and 3 or nothing at the border.
# What happens: it is -3, along every axis: the left neighbour less the right one (its page shows the
#   same for a single 1 without saying so). Its size is right, so that gradient magnitudes, corner
#   scores and structure tensors, in which it comes squared, are as they should be; whatever is
#   linear in it is reversed. One step of photometric alignment (Gauss-Newton on a shift) of a picture
#   moved by 0.8 of a pixel goes 0.8 the other way, and ten of them end 25 pixels off. At the border
#   the neighbour outside is taken for the border's own pixel, without halving the distance: -1.5.
# What follows: take it with a minus, and leave out one pixel all around; a test of a gradient needs a
#   slope, not the magnitude.
set -u
version=1.0.1
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "ndarray-gradient@$version" ndarray@1.0.19 >npm.log 2>&1 ||
  { tail -3 npm.log; echo "ndarray-gradient $version cannot be had: not looked at"; exit 2; }
echo "version: ndarray-gradient $(node -p 'require("./node_modules/ndarray-gradient/package.json").version')"
echo "expected: 3 and 10 everywhere; 0.8 of a pixel"
cat >t.js <<'JS'
const ndarray = require("ndarray"), gradient = require("ndarray-gradient");

const size = 64;
const picture = (of) => ndarray(Float64Array.from({ length: size * size }, (_, i) => of(Math.floor(i / size), i % size)), [size, size]);
const slope = (image) => {
  const out = ndarray(new Float64Array(2 * size * size), [size, size, 2]);
  gradient(out, image);
  return (y, x) => [out.get(y, x, 0), out.get(y, x, 1)];
};
const own = (image) => (y, x) => [(image.get(y + 1, x) - image.get(y - 1, x)) / 2, (image.get(y, x + 1) - image.get(y, x - 1)) / 2];

const plane = slope(picture((y, x) => 10 * y + 3 * x));
console.log(`seen: a picture that grows by 10 a row and 3 a column has the gradient ${plane(20, 30)}, at its left border ${plane(20, 0)}`);

// One or more steps of Gauss-Newton for the shift along x and y that takes one picture to the other.
const scene = (dx) => (y, x) => 128 + 40 * Math.sin(0.21 * (x - dx) + 0.07 * y) + 30 * Math.cos(0.13 * y - 0.05 * (x - dx));
function align(way, steps) {
  const target = picture(scene(0.8));
  let shift = [0, 0];
  for (let k = 0; k < steps; k++) {
    const moved = picture((y, x) => scene(shift[1])(y - shift[0], x)), g = way(moved);
    let a = 0, b = 0, c = 0, u = 0, v = 0;
    for (let y = 8; y < size - 8; y++) {
      for (let x = 8; x < size - 8; x++) {
        const [gy, gx] = g(y, x), r = moved.get(y, x) - target.get(y, x);
        a += gy * gy; b += gy * gx; c += gx * gx; u += gy * r; v += gx * r;
      }
    }
    const det = a * c - b * b;
    shift = [shift[0] + (c * u - b * v) / det, shift[1] + (a * v - b * u) / det];
  }
  return shift;
}
const one = align(slope, 1), ten = align(slope, 10), right = align(own, 1), settled = align(own, 10);
const say = (s) => s.map((v) => v.toFixed(2)).join(", ");
console.log(`seen: one step of alignment finds ${say(one)} (down, right) of 0, 0.8; ten steps end at ${say(ten)}`);
console.log(`beside it, right less left: ${say(right)}; ten steps ${say(settled)}`);
const near = (a, b, e) => a.every((v, i) => Math.abs(v - b[i]) < e);
process.exit(near(plane(20, 30), [-10, -3], 1e-12) && near(plane(20, 0), [-10, -1.5], 1e-12) && near(one, [0, -0.8], 0.05)
  && ten[1] < -2 && near(right, [0, 0.8], 0.05) && near(settled, [0, 0.8], 1e-3) ? 0 : 1);
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: the gradient is reversed"
