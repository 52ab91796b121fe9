#!/usr/bin/env bash
# togeojson hands all times behind a fix without one to the fix before theirs
#
# One would swear: a GPX track's times in the GeoJSON stand beside its coordinates, one for one, with
#   null where a fix had none; other values are kept so.
# What happens: times (coordinateProperties.times) has an entry only for fixes that have a time: of
#   four fixes of which the second has none, three times come, and the third fix has the time of the
#   fourth. Each such fix moves all that follow by one more: in a log at 1 Hz with 5 of 100 times
#   missing the last places have stamps 5 s too late, 7 m for a walker. Heart rates of the same fixes
#   have null in the gap, and stay in step; heights that are missing shorten their own coordinate
#   only. A segment of one fix is dropped with its time. togpx, which writes GPX from GeoJSON, does
#   not look into coordinateProperties at all: through both a track loses every time.
# What follows: compare the lengths of times and coordinates before the first use, or read GPX
#   oneself; a truth that lags behind the estimate by whole seconds, more towards its end, has this.
set -u
version=7.1.3 xmldom=0.9.8 togpx=0.5.4
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "@tmcw/togeojson@$version" "@xmldom/xmldom@$xmldom" "togpx@$togpx" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "togeojson $version, xmldom $xmldom or togpx $togpx cannot be had: not looked at"; exit 2; }
echo "version: togeojson $(node -p 'JSON.parse(require("fs").readFileSync("node_modules/@tmcw/togeojson/package.json")).version'), togpx $togpx"
echo "expected: as many times as fixes, null where there is none"
cat >t.mjs <<'JS'
import { createRequire } from "node:module";
import { gpx } from "@tmcw/togeojson";
import { DOMParser } from "@xmldom/xmldom";

const togpx = createRequire(import.meta.url)("togpx");
const clock = (i) => new Date(Date.UTC(2011, 4, 10, 12, 38, 10) + 1000 * i).toISOString();
const pulse = (v) => `<extensions><gpxtpx:TrackPointExtension xmlns:gpxtpx="http://www.garmin.com/xmlschemas/TrackPointExtension/v1"><gpxtpx:hr>${v}</gpxtpx:hr></gpxtpx:TrackPointExtension></extensions>`;
// Fixes of a walk to the north, 1.4 m a second; those of `without` have neither time nor heart rate.
const fix = (i, without) => `<trkpt lat="${(48 + i * 1.4 / 111195).toFixed(9)}" lon="11.5"><ele>${500 + i}</ele>`
  + `${without.includes(i) ? "" : `<time>${clock(i)}</time>${pulse(100 + i)}`}</trkpt>`;
const track = (count, without) => gpx(new DOMParser().parseFromString(
  `<gpx xmlns="http://www.topografix.com/GPX/1/1" version="1.1"><trk><trkseg>${Array.from({ length: count }, (_, i) => fix(i, without)).join("")}</trkseg></trk></gpx>`,
  "text/xml"));
const parts = (collection) => {
  const [{ geometry, properties: { coordinateProperties: { times, heart } } }] = collection.features;
  return { places: geometry.coordinates, times, heart };
};
const short = parts(track(4, [1])), whole = parts(track(4, [])), full = track(4, []);
console.log(`seen: of 4 fixes, the second without a time, there are ${short.places.length} places, times ${short.times.map((t) => t.slice(17, 19))}, `
  + `heart rates ${JSON.stringify(short.heart)}; all with times: ${whole.times.map((t) => t.slice(17, 19))}`);
// How early the time at each place's index is.
const missing = [20, 40, 55, 70, 90], long = parts(track(100, missing));
const early = long.times.map((t, k) => (Date.parse(t) - Date.parse(clock(k))) / 1000);
const metres = (early.at(-1) * 1.4).toFixed(1);
console.log(`seen: of 100 fixes with ${missing.length} times missing, the last time stands at a fix ${early.at(-1)} s before its own, ${metres} m; `
  + `heart rates in step: ${long.heart.every((v, i) => missing.includes(i) ? v === null : v === 100 + i)}`);
const back = togpx(full), times = (back.match(/<time>/g) ?? []).length, points = back.match(/<trkpt/g).length;
full.features[0].properties.coordTimes = full.features[0].properties.coordinateProperties.times;
const helped = (togpx(full).match(/<time>/g) ?? []).length;
console.log(`seen: back through togpx ${points} fixes have ${times} times; with the times laid into coordTimes ${helped}`);
process.exit(short.places.length === 4 && short.times.join() === [0, 2, 3].map(clock).join() && JSON.stringify(short.heart) === "[100,null,102,103]"
  && whole.times.join() === [0, 1, 2, 3].map(clock).join() && long.times.length === 95 && early.at(-1) === 5 && early[0] === 0
  && long.heart.length === 100 && points === 4 && times === 0 && helped === 4 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: times move up to where there is none"
