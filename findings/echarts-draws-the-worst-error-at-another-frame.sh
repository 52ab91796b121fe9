#!/usr/bin/env bash
# ECharts' sampling "max" draws the worst error at another frame's time, behind a gap even
#
# One would swear: a line with sampling "max" keeps the largest value of each piece where it was, so
#   that pointing at a peak tells its frame.
# What happens: of each piece the largest value is kept and put at the time of the piece's middle: one
#   point that never was, of one frame's stamp and another's error. 10000 frames of 30 Hz on 600
#   pixels make pieces of 17, so that peaks are up to 0.3 s off. Pieces are of equal numbers of points,
#   not of equal time: where the camera paused for 200 s in the midst of one, an error just before the
#   pause is drawn just behind it, 200 s late. "minmax" keeps times, and so does "lttb", which however
#   drops one of two peaks 0.1 s apart.
# What follows: sampling "minmax", or a peak's time from one's own array by its value; and a null
#   between two rows where there is a pause does not help, as pieces go on across it.
set -u
version=6.1.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "echarts@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "echarts $version cannot be had: not looked at"; exit 2; }
echo "version: echarts $(node -p 'require("./node_modules/echarts/package.json").version')"
echo "expected: each peak at its own time"
cat >t.mjs <<'JS'
import * as echarts from "echarts";

const n = 10000;
let seed = 7;
const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
const small = Array.from({ length: n }, () => 0.02 + 0.005 * random());
// What a chart 600 pixels wide draws: the times at which it has the errors of `peaks` (frames), each of another height.
function drawn(sampling, times, peaks, rest = (v) => v) {
  const error = small.map((v, i) => peaks.includes(i) ? 0.3 + 0.01 * peaks.indexOf(i) : v);
  const chart = echarts.init(null, null, { renderer: "svg", ssr: true, width: 600, height: 300 });
  chart.setOption({ animation: false, grid: { left: 0, right: 0, top: 0, bottom: 0 }, yAxis: { type: "value" },
    xAxis: { type: "value", min: times[0], max: times[n - 1] },
    series: [{ type: "line", showSymbol: false, sampling, data: rest(times.map((t, i) => [t, error[i]])) }] });
  chart.renderToSVGString();
  const data = chart.getModel().getSeriesByIndex(0).getData(), points = new Map();
  for (let i = 0; i < data.count(); i++) points.set(data.get("y", i), data.get("x", i));
  chart.dispose();
  return { count: points.size, at: peaks.map((k) => points.get(error[k])), want: peaks.map((k) => times[k]) };
}

const even = Array.from({ length: n }, (_, i) => i / 30), peaks = [1000, 5000, 7777, 9990];
const say = (values) => values.map((v) => v === undefined ? "nowhere" : v.toFixed(2)).join(" ");
const seen = {};
for (const sampling of ["max", "minmax", "lttb", undefined]) {
  const r = seen[sampling] = drawn(sampling, even, peaks);
  console.log(`seen, ${sampling ?? "no sampling"}: errors of ${say(r.want)} s are drawn at ${say(r.at)} s, ${r.count} points`);
}
// Any frame of one piece: how far it is drawn from its place, at most.
const off = Array.from({ length: 17 }, (_, k) => drawn("max", even, [5000 + k])).map((r) => Math.abs(r.at[0] - r.want[0]));
console.log(`seen, max: of the frames of one piece up to ${Math.max(...off).toFixed(2)} s off`);
// A pause of 200 s behind frame 5001 + k: the error is in the last frame before it.
const paused = Array.from({ length: 17 }, (_, k) => 5001 + k).map((k) => drawn("max", even.map((t, i) => i > k ? t + 200 : t), [k]));
const late = paused.map((r) => r.at[0] - r.want[0]).filter((v) => v > 100);
const k = 5001 + paused.findIndex((r) => r.at[0] - r.want[0] > 100), gap = even.map((t, i) => i > k ? t + 200 : t);
const kept = drawn("minmax", gap, [k]), broken = drawn("max", gap, [k], (rows) => [...rows.slice(0, k + 1), [rows[k][0] + 1, null], ...rows.slice(k + 1)]);
console.log(`seen: with a pause of 200 s behind it, in ${late.length} of 17 places of the pause the worst error is drawn up to ${Math.max(...late).toFixed(2)} s late`);
console.log(`beside it, minmax: ${(kept.at[0] - kept.want[0]).toFixed(2)} s late; max with a null in the pause: ${(broken.at[0] - broken.want[0]).toFixed(2)} s late`);
const pair = drawn("lttb", even, [1000, 1003]);
console.log(`seen, lttb: of peaks at ${say(pair.want)} s ${say(pair.at)} s are drawn`);
const right = (r) => r.at.every((v, i) => Math.abs(v - r.want[i]) < 1e-9);
process.exit(!right(seen.max) && right(seen.minmax) && right(seen.undefined) && right(seen.lttb) && Math.max(...off) > 0.25 && Math.max(...off) < 0.31
  && late.length > 3 && Math.max(...late) > 200 && right(kept) && broken.at[0] - broken.want[0] > 199
  && pair.at.filter((v) => v === undefined).length === 1 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: peaks are drawn at other times"
