#!/usr/bin/env bash
# turf puts a place along a track at the height of the next fix, and simplify drops a climb
#
# One would swear: along(track, d) is a point between two fixes, with its height between theirs as its
#   longitude and latitude are; or it has no height.
# What happens: longitude and latitude are interpolated, the height is the next fix's as a whole: 1 cm
#   behind a fix at 500 m, on the way to one 10 m on at 501, it is 501. lineSliceAlong and lineChunk
#   cut with it: a piece from 5 to 15 m begins at 501, where the track is at 500.5, and a chunk's end
#   and the next one's beginning are too high by up to a whole climb. nearestPointOnLine and lineSlice
#   leave the height away. length, simplify and cleanCoords know the plane only: a drone that rises by
#   50 m on the spot has a length of 0, and cleanCoords takes the fix at the top off.
# What follows: take what along gives for the plane, and interpolate the height oneself by the same
#   fraction; for truth of a climbing or flying camera measure in metres before turf sees anything.
#   Heights that go up in steps, early by one fix uphill and early downhill, are this.
set -u
version=7.4.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "@turf/along@$version" "@turf/line-slice-along@$version" \
  "@turf/line-chunk@$version" "@turf/nearest-point-on-line@$version" "@turf/length@$version" "@turf/clean-coords@$version" \
  "@turf/helpers@$version" >npm.log 2>&1 || { tail -3 npm.log; echo "turf $version cannot be had: not looked at"; exit 2; }
echo "version: turf $(node -p 'JSON.parse(require("fs").readFileSync("node_modules/@turf/along/package.json")).version')"
echo "expected: 500.0, 500.1, 500.5, 501.0, 501.5"
cat >t.mjs <<'JS'
import { along } from "@turf/along";
import { cleanCoords } from "@turf/clean-coords";
import { lineString, point } from "@turf/helpers";
import { length } from "@turf/length";
import { lineChunk } from "@turf/line-chunk";
import { lineSliceAlong } from "@turf/line-slice-along";
import { nearestPointOnLine } from "@turf/nearest-point-on-line";

// A fix every 10 m to the east, each 1 m higher (turf's sphere).
const metre = 180 / Math.PI / 6371008.8, units = { units: "meters" };
const fix = (east, north, height) => [11.5 + east * metre / Math.cos(48.1 * Math.PI / 180), 48.1 + north * metre, height];
const fixes = Array.from({ length: 20 }, (_, i) => fix(10 * i, 0, 500 + i)), track = lineString(fixes);
const east = ([lon]) => (lon - 11.5) / metre * Math.cos(48.1 * Math.PI / 180);
const asked = [0, 0.01, 1, 5, 9.99, 15], got = asked.map((d) => along(track, d, units).geometry.coordinates);
console.log(`seen: at ${asked} m along the places are ${got.map((p) => east(p).toFixed(2))} m east, their heights ${got.map((p) => p[2])}`);
const piece = lineSliceAlong(track, 5, 15, units).geometry.coordinates.map((p) => p[2]);
const chunk = lineChunk(track, 15, units).features.map((f) => f.geometry.coordinates.map((p) => p[2]));
console.log(`seen: heights of the piece from 5 to 15 m: ${piece}; of the first chunks of 15 m: ${chunk.slice(0, 2).join(" | ")}`);
const nearest = nearestPointOnLine(track, point(fix(5, 1, 500.5))).geometry.coordinates;
const rise = lineString([fix(0, 0, 500), fix(0, 0, 550), fix(10, 0, 550)]), cleaned = cleanCoords(rise).geometry.coordinates;
console.log(`seen: nearestPointOnLine gives ${nearest.length} numbers; a rise of 50 m and 10 m ahead are ${length(rise, units).toFixed(2)} m long, `
  + `heights after cleanCoords ${cleaned.map((p) => p[2])}`);
// By the fraction of the stretch, in the height as well.
const own = asked.map((d) => { const i = Math.floor(d / 10); return fixes[i][2] + (d / 10 - i) * (fixes[i + 1][2] - fixes[i][2]); });
console.log(`beside it, by the same fraction: ${own}`);
process.exit(got.every((p, i) => Math.abs(east(p) - asked[i]) < 0.01) && got.map((p) => p[2]).join() === "500,501,501,501,501,502"
  && piece.join() === "501,501,502" && chunk[0].join() === "500,501,502" && chunk[1][0] === 502 && nearest.length === 2
  && Math.abs(length(rise, units) - 10) < 0.01 && cleaned.map((p) => p[2]).join() === "500,550" && Math.abs(own[5] - 501.5) < 1e-9 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: heights go in steps"
