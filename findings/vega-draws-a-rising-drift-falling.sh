#!/usr/bin/env bash
# Vega's linear trend over stamps falls where the drift rises; its quadratic one is right
#
# One would swear: a straight line through points that lie on one is that line, over stamps as over
#   seconds from the start, and r squared is 1.
# What happens: regressionLinear, which Vega's and Vega-Lite's regression takes unasked, subtracts the
#   squares of means that are alike in all their digits. An error that rises by 60 cm in 10 minutes,
#   Unix seconds, 30 Hz, no noise at all, has a line that falls by 16 cm and starts at 40; with dates
#   (milliseconds, as a time axis has them) it falls by 1 cm. Over 2 seconds it is level. Only hours
#   of dates are right. r squared, where one looks, is -0.6. "log" and a polynomial of order 1 do the
#   same; "quad" and a polynomial of order 3, in the same file, take the mean off first and rise by
#   60.0 cm. Seconds from the first frame, and of the GPS week, are right.
# What follows: give regression a field with seconds from the start (and the axis the stamps), or
#   method "quad"; a trend in a dashboard that contradicts its own points has this.
set -u
version=2.0.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "vega-statistics@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "vega-statistics $version cannot be had: not looked at"; exit 2; }
echo "version: vega-statistics $(node -p 'JSON.parse(require("fs").readFileSync("node_modules/vega-statistics/package.json")).version')"
echo "expected: the rise that is there, r squared 1"
cat >t.mjs <<'JS'
import { regressionLinear, regressionLog, regressionPoly, regressionQuad } from "vega-statistics";

// An error of 2 cm that grows by 1 mm a second, and what each method says it grows by.
const poly = (order) => (...args) => regressionPoly(...args, order);
const methods = { linear: regressionLinear, log: regressionLog, "order 1": poly(1), quad: regressionQuad, "order 3": poly(3) };
function rises(seconds, hz, unit, start) {
  const rows = Array.from({ length: seconds * hz }, (_, i) => ({ x: (start + i / hz) * unit, y: 0.02 + 0.001 * i / hz }));
  const want = rows.at(-1).y - rows[0].y, out = { want };
  for (const [name, fit] of Object.entries(methods)) {
    const { predict, rSquared } = fit(rows, (r) => r.x, (r) => r.y);
    out[name] = { rise: predict(rows.at(-1).x) - predict(rows[0].x), rSquared };
  }
  return out;
}
const unix = 1403636579.763555, seen = {};
for (const [name, ...how] of [["2 s, Unix seconds", 2, 30, 1, unix], ["600 s, Unix seconds", 600, 30, 1, unix],
  ["600 s, dates", 600, 30, 1000, unix], ["2 h, dates", 7200, 1, 1000, unix], ["600 s, GPS week", 600, 30, 1, 550000], ["600 s, from 1 s", 600, 30, 1, 1]]) {
  const r = seen[name] = rises(...how);
  console.log(`seen, ${name}: rises by ${(100 * r.want).toFixed(1)} cm; ` + Object.keys(methods).map((m) =>
    `${m} ${(100 * r[m].rise).toFixed(1)} (r squared ${r[m].rSquared.toFixed(2)})`).join(", "));
}
const right = (name, method) => Math.abs(seen[name][method].rise - seen[name].want) < 0.01 * seen[name].want && seen[name][method].rSquared > 0.99;
const all = (name, ...of) => of.every((m) => right(name, m));
process.exit(["600 s, Unix seconds", "600 s, dates"].every((n) => seen[n].linear.rise < 0.2 * seen[n].want && seen[n].linear.rSquared < 0.5)
  && seen["600 s, Unix seconds"].linear.rise < -0.05 && Math.abs(seen["2 s, Unix seconds"].linear.rise) < 1e-3
  && Object.keys(seen).every((n) => all(n, "quad", "order 3")) && all("2 h, dates", "linear") && all("600 s, GPS week", "linear", "order 1")
  && all("600 s, from 1 s", "linear", "order 1") ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: the trend has nothing to do with the points"
