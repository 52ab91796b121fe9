#!/usr/bin/env bash
# three measures a curve in 200 pieces, however many poses it goes through
#
# One would swear: CatmullRomCurve3 goes through all points given, so its getLength is at least the sum
#   of the distances between them, and getPointAt(0.5) is where half of the way is done.
# What happens: getLength and getPointAt measure it at 201 places, spread evenly over the poses,
#   with straight lines between; of 5100 poses, 170 s at 30 Hz, that is one in 25. A camera
#   that swings before a desk comes out with 105 m of its 133, a walk with steps of 3 cm with 170 of
#   176, which looks like smoothing and hangs on the number of poses: 20 s of the same are right. Half
#   of the way, getPointAt(0.5), shifts by as much as the parts are missed unevenly. With
#   arcLengthDivisions set to four times the number of poses all are right, as a CurvePath of straight
#   pieces is without. SplineCurve does the same.
# What follows: set arcLengthDivisions, or sum the distances oneself; a path length in a viewer that
#   is shorter than evo's and gets worse as the recording gets longer has this.
set -u
three=0.187.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "three@$three" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "three $three cannot be had: not looked at"; exit 2; }
echo "version: three $(node -p 'require("./node_modules/three/package.json").version')"
echo "expected: at least the sum of the distances; half of the way at half of it"
cat >t.mjs <<'JS'
import { CatmullRomCurve3, CurvePath, LineCurve3, SplineCurve, Vector2, Vector3 } from "three";

let seed = 7;
const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
const noise = () => Math.sqrt(-2 * Math.log(random())) * Math.cos(2 * Math.PI * random());
// `seconds` of poses at 30 Hz.
const poses = (seconds, of) => Array.from({ length: 30 * seconds }, (_, i) => new Vector3(...of(i / 30)));
const swing = (t, size) => [0.4, 0.31, 0.7].map((hz, k) => size[k] * Math.sin(2 * Math.PI * hz * t));
const sum = (points) => points.slice(1).reduce((s, p, i) => s + p.distanceTo(points[i]), 0);
// How far along the poses the place nearest to p is.
function along(points, p) {
  const near = points.reduce((best, q, i) => q.distanceTo(p) < points[best].distanceTo(p) ? i : best, 0);
  return sum(points.slice(0, near + 1));
}
function look(name, points) {
  const curve = new CatmullRomCurve3(points), set = new CatmullRomCurve3(points), path = new CurvePath();
  set.arcLengthDivisions = 4 * points.length;
  for (let i = 1; i < points.length; i++) path.add(new LineCurve3(points[i - 1], points[i]));
  const whole = sum(points), half = (c) => along(points, c.getPointAt(0.5)) / whole;
  const r = { length: curve.getLength() / whole, set: set.getLength() / whole, path: path.getLength() / whole, half: half(curve), halfSet: half(set) };
  const percent = (v) => `${(100 * v).toFixed(1)} %`;
  console.log(`seen, ${name}: ${points.length} poses, ${whole.toFixed(2)} m between them; getLength ${percent(r.length)} of it, with divisions `
    + `set ${percent(r.set)}, CurvePath ${percent(r.path)}; getPointAt(0.5) at ${percent(r.half)} of the way, with divisions ${percent(r.halfSet)}`);
  return r;
}
const desk = look("before a desk, 170 s", poses(170, (t) => swing(t, [0.4, 0.2, 0.1])));
const short = look("before a desk, 20 s", poses(20, (t) => swing(t, [0.4, 0.2, 0.1])));
const walk = look("a walk of 170 s with steps of 3 cm", poses(170, (t) => [10 * Math.cos(t / 10), 10 * Math.sin(t / 10), 0.03 * Math.sin(4 * Math.PI * t)]));
const calm = look("100 s straight on, then 70 s with swings across", poses(170, (t) => [t / 2, t > 100 ? swing(t - 100, [0, 0.5, 0])[1] : 0, 0]));
const jitter = look("a walk with 2 mm of noise", poses(170, (t) => [t / 2 + 0.002 * noise(), 0.002 * noise(), 0.002 * noise()]));
const flat = new SplineCurve(poses(170, (t) => swing(t, [0.4, 0.2, 0])).map((p) => new Vector2(p.x, p.y)));
const plain = flat.points.slice(1).reduce((s, p, i) => s + p.distanceTo(flat.points[i]), 0);
console.log(`seen, SplineCurve in the plane: ${(100 * flat.getLength() / plain).toFixed(1)} %`);
const right = (r) => Math.abs(r.set - 1) < 0.02 && Math.abs(r.path - 1) < 1e-9;
process.exit([desk, short, walk, calm, jitter].every(right) && desk.length < 0.9 && flat.getLength() < 0.9 * plain && Math.abs(short.length - 1) < 0.02
  && walk.length < 0.98 && Math.abs(calm.half - calm.halfSet) > 0.01 && Math.abs(calm.halfSet - 0.5) < 0.005 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: curves are measured at 201 places"
