#!/usr/bin/env bash
# ahrs: one filter does not hear an accelerometer with a zero in it, the other is NaN when level
#
# One would swear: both filters of ahrs pull roll and pitch to where the accelerometer has gravity;
#   gains of 0 leave the gyro alone.
# What happens: Mahony drops the whole reading if any of its three numbers is exactly 0. An IMU
#   that leans by 30 degrees about one axis has that, and so have three readings in ten of one that
#   lies level, has noise of 10 mg and counts in steps of 4: in the first case it stays at 0 degrees
#   for ever, where 1e-6 in place of the 0 brings it to 30. Madgwick, if IMU and filter agree
#   exactly (level, at rest, from the start), divides nothing by nothing: the quaternion is NaN
#   from the first sample on, and remains it; with 1e-6 it is right. And 0 for beta or kp is taken for
#   "not given": a Mahony that is to run on the gyro alone has the usual gain of 1.
# What follows: add a thousandth of the accelerometer's step to numbers that are 0 before they go in,
#   ask for isNaN after the first sample, and name 1e-9 for gains of 0. Simulated IMUs, which are
#   level to the last bit, and real ones in steps meet all of it.
set -u
version=1.3.3
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "ahrs@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "ahrs $version cannot be had: not looked at"; exit 2; }
echo "version: ahrs $(node -p 'require("./node_modules/ahrs/package.json").version')"
echo "expected: 30 degrees of roll from each; 0 when level; 0 by the gyro alone"
cat >t.js <<'JS'
const AHRS = require("ahrs");

// The roll in degrees after `seconds` at rest at 100 Hz, the accelerometer being read(i) of gravity.
function roll(algorithm, options, read, seconds = 20) {
  const filter = new AHRS({ sampleInterval: 10, algorithm, doInitialisation: false, ...options });
  for (let i = 0; i < seconds * 100; i++) filter.update(0, 0, 0, ...read(i));
  return filter.getEulerAngles().roll * 180 / Math.PI;
}
const lean = 30 * Math.PI / 180, leaning = (x) => () => [x, Math.sin(lean), Math.cos(lean)], level = (x) => () => [x, 0, 1];
const mahony = roll("Mahony", { kp: 0.5 }, leaning(0)), nudged = roll("Mahony", { kp: 0.5 }, leaning(1e-6));
const madgwick = roll("Madgwick", { beta: 0.1 }, leaning(0));
console.log(`seen, leaning by 30 degrees: Mahony ${mahony.toFixed(2)}, with 1e-6 for 0 ${nudged.toFixed(2)}; Madgwick ${madgwick.toFixed(2)}`);
const flat = roll("Madgwick", {}, level(0), 0.01), flatNudged = roll("Madgwick", {}, level(1e-6), 20), later = roll("Madgwick", {},
  (i) => i === 0 ? [0, 0, 1] : leaning(0.01)());
console.log(`seen, level: Madgwick after one sample ${flat}, leaning afterwards ${later}; with 1e-6 ${flatNudged.toFixed(2)}`);
// Nearly level, with noise, in steps of 4 mg, counted: how many readings have a zero.
let seed = 1;
const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
const noise = () => 0.01 * Math.sqrt(-2 * Math.log(random())) * Math.cos(2 * Math.PI * random());
const steps = Array.from({ length: 2000 }, () => [noise(), noise(), 1 + noise()].map((v) => 0.004 * Math.round(v / 0.004)));
const zeros = steps.filter((s) => s.some((v) => v === 0)).length / steps.length;
const alone = roll("Mahony", { kp: 0 }, leaning(1e-6)), small = roll("Mahony", { kp: 1e-9 }, leaning(1e-6));
console.log(`seen: of readings of a level IMU in steps of 4 mg, noise of 10 mg, ${(100 * zeros).toFixed(0)} % have a zero`);
console.log(`seen: Mahony with kp 0 goes to ${alone.toFixed(2)}, with kp 1e-9 to ${small.toFixed(2)}`);
const near = (a, b) => Math.abs(a - b) < 0.5;
process.exit(mahony === 0 && near(nudged, 30) && near(madgwick, 30) && Number.isNaN(flat) && Number.isNaN(later) && near(flatNudged, 0)
  && zeros > 0.1 && near(alone, 30) && near(small, 0) ? 0 : 1);
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: zeros silence one filter and break the other"
