#!/usr/bin/env bash
# jsfeat's Gaussian blur darkens a picture by two hundredths, for some sigmas and not for others
#
# One would swear: a blur leaves the mean as it is; a flat picture stays what it was whatever sigma, and
#   the difference of two blurs of it is 0.
# What happens: for bytes the kernel is made of whole 256ths, each rounded for itself, along rows and
#   columns; for sigma 1, 2, 2.5 and 3 their sum is under 256, and 200 becomes 196, for 1.2, 1.6, 4 and
#   5 it is 200. Five such blurs in a row, as in a scale space, leave 180 of 200. A stack of 1, 1.2,
#   1.6, 2, 2.5 has bands of 4 grey levels between flat levels, where corners of low contrast have
#   as much. box_blur_gray takes one off a flat picture as well. Kernels of 3 to 9 without a sigma, and
#   pictures of floats, stay as they are. (Sigma 1 is 1.12 wide besides.)
# What follows: blur floats, or by kernel size without sigma, or ask a flat picture first; a photometric
#   residual between a blurred and a plain picture has a gain of 0.98 in it.
set -u
version=0.0.8
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "jsfeat@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "jsfeat $version cannot be had: not looked at"; exit 2; }
echo "version: jsfeat $(node -p 'require("./node_modules/jsfeat/package.json").version')"
echo "expected: 200 from each"
cat >t.js <<'JS'
const jsfeat = require("jsfeat");

const size = 80, middle = 40 * size + 40;
const flat = (kind, value) => {
  const m = new jsfeat.matrix_t(size, size, kind | jsfeat.C1_t);
  for (let i = 0; i < size * size; i++) m.data[i] = value;
  return m;
};
function blurred(from, kind, times, kernel, sigma) {
  let image = from;
  for (let k = 0; k < times; k++) {
    const out = flat(kind, 0);
    jsfeat.imgproc.gaussian_blur(image, out, kernel, sigma);
    image = out;
  }
  return image.data[middle];
}
const bytes = jsfeat.U8_t, floats = jsfeat.F32_t, sigmas = [1, 1.2, 1.6, 2, 2.5, 3, 4, 5];
const once = sigmas.map((s) => blurred(flat(bytes, 200), bytes, 1, 0, s));
const inFloats = sigmas.map((s) => blurred(flat(floats, 200), floats, 1, 0, s));
const kernels = [3, 5, 7, 9].map((k) => blurred(flat(bytes, 200), bytes, 1, k, 0)), five = blurred(flat(bytes, 200), bytes, 5, 0, 2);
const box = flat(bytes, 0);
jsfeat.imgproc.box_blur_gray(flat(bytes, 200), box, 3);
console.log(`seen: a flat picture of 200, sigma ${sigmas}: ${once}; five times sigma 2: ${five}`);
console.log(`seen: the same in floats ${inFloats.map((v) => v.toFixed(2))}; kernels of 3, 5, 7, 9 without sigma ${kernels}; box of 3: ${box.data[middle]}`);
const near = (v) => Math.abs(v - 200) < 0.01;
process.exit(once.join() === "196,200,200,196,196,196,200,200" && five === 180 && inFloats.every(near) && kernels.every((v) => v === 200)
  && box.data[middle] === 199 ? 0 : 1);
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: some sigmas darken"
