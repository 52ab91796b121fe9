#!/usr/bin/env bash
# gl-matrix's angle between two equal orientations is not 0 but NaN, for every second one
#
# One would swear: quat.getAngle(q, q) of a unit quaternion is 0, and of two that are nearly the
#   same some small angle.
# What happens: it is acos(2 dot^2 - 1), and a normalized quaternion of floats is seldom one of
#   length 1 to the last bit: where dot^2 comes out above 1 the angle is NaN. That is so for half of
#   all orientations with themselves, and for 2 in 5 pairs that are 0.02 degrees apart; the others
#   are 0.024 degrees from themselves in the median. From 0.1 degrees on it is right within about
#   0.01. With setMatrixArrayType(Array), in doubles, a quarter of equal orientations are still NaN
#   apart. An arc tangent of the same floats (of conjugate(a) * b) is right within 1e-5 degrees, and
#   three's angleTo, which clamps, is never NaN. wgpu-matrix's quat.angle has the same formula and
#   the same NaN.
# What follows: a plot of rotation errors or a check "has the camera moved" made with it loses
#   just the best frames, and which ones is chance; a mean of them is NaN, Math.max too, and a test
#   angle < limit fails for the perfect pose. The angle is 2 atan2(|vector|, |w|).
set -u
matrix=3.4.4 wgpu=3.4.2 three=0.187.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "gl-matrix@$matrix" "wgpu-matrix@$wgpu" "three@$three" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "gl-matrix $matrix, wgpu-matrix $wgpu or three $three cannot be had: not looked at"; exit 2; }
echo "version: gl-matrix $(node -p 'require("gl-matrix/package.json").version'), wgpu-matrix $wgpu, three $three"
echo "expected: no NaN; 0 for equal orientations"
cat >t.mjs <<'JS'
import { glMatrix, quat } from "gl-matrix";
import { Quaternion } from "three";
import { quat as gpu } from "wgpu-matrix";

let state = 1;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647 - 0.5;
const degrees = (radians) => (radians * 180) / Math.PI;
const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

function byTangent(a, b) {
  const d = quat.multiply(quat.create(), quat.conjugate(quat.create(), a), b);
  return degrees(2 * Math.atan2(Math.hypot(d[0], d[1], d[2]), Math.abs(d[3])));
}

// 4000 pairs of unit quaternions, `apart` degrees apart.
function look(apart) {
  const seen = [], tangent = [], three = [];
  let lost = 0, wgpu = 0;
  for (let i = 0; i < 4000; i++) {
    const a = quat.fromValues(random(), random(), random(), random());
    quat.normalize(a, a);
    const turn = quat.setAxisAngle(quat.create(), [0.6, 0, 0.8], (apart * Math.PI) / 180);
    const b = apart === 0 ? quat.clone(a) : quat.normalize(quat.create(), quat.multiply(quat.create(), a, turn));
    const angle = degrees(quat.getAngle(a, b));
    if (Number.isNaN(angle)) lost++;
    else seen.push(angle);
    if (Number.isNaN(gpu.angle(a, b))) wgpu++;
    tangent.push(Math.abs(byTangent(a, b) - apart));
    three.push(degrees(new Quaternion(...a).angleTo(new Quaternion(...b))));
  }
  return { lost: lost / 4000, wgpu: wgpu / 4000, median: seen.length ? median(seen) : NaN,
           most: Math.max(...seen.map((s) => Math.abs(s - apart))),
           tangent: Math.max(...tangent), three: three.filter(Number.isNaN).length };
}

const say = (name, r) => console.log(`seen, ${name}: NaN for ${(100 * r.lost).toFixed(0)} in 100, `
  + `else ${r.median.toPrecision(2)} in the median and off by up to ${r.most.toPrecision(2)}; `
  + `by arc tangent off by ${r.tangent.toPrecision(1)} at most; NaN in `
  + `wgpu-matrix for ${(100 * r.wgpu).toFixed(0)} in 100, in three for ${r.three}`);
const at = {};
for (const apart of [0, 0.005, 0.02, 0.1]) say(`${apart} degrees apart`, (at[apart] = look(apart)));
glMatrix.setMatrixArrayType(Array);
const doubles = look(0);
say("0 degrees apart, in doubles", doubles);

const half = (r) => r.lost > 0.3 && r.lost < 0.6;
const others = Object.values(at).every((r) => r.tangent < 5e-5 && r.three === 0);
const gpuHalf = [0, 0.005, 0.02].every((apart) => at[apart].wgpu > 0.3 && at[apart].wgpu < 0.6);
const fits = half(at[0]) && half(at[0.005]) && half(at[0.02]) && at[0].median > 0.01 && at[0.1].lost === 0 && at[0.1].most < 0.02;
process.exit(fits && gpuHalf && doubles.lost > 0.1 && others ? 0 : 1);
JS
node t.mjs || { echo "the behaviour has changed"; exit 1; }
echo "as described: equal orientations are NaN apart"
