#!/usr/bin/env bash
# geolib counts a walk of 700 m as none, and a slow ride as half as long again
#
# One would swear: getPathLength sums the distances of consecutive fixes; the more often the receiver
#   measures, the better it follows the way.
# What happens: it sums distances that are whole metres, each rounded for itself. A walk of 700 m at
#   1.4 m/s has 700 by one fix in 10 s, 500 at 1 Hz, and 0 at 5 Hz and more; 0.6 m a fix count as 1: who
#   rides 900 m at 3 m/s comes out at 1500 with 5 Hz, and at 0 with 10. getSpeed is 0 for the walk at
#   5 Hz. getPreciseDistance as second argument is rounded in the same way. An accuracy cannot be
#   named, but wrapped: (a, b) => getDistance(a, b, 1e-4). That is not it yet: getDistance takes an
#   arccosine of nearly 1, whose steps are 9 cm, and the walk has 672 m at 5 Hz. Wrapped
#   getPreciseDistance is right within 2 m at every rate.
# What follows: wrap getPreciseDistance with its accuracy; a path length of GPS truth that falls with
#   its rate, or is a whole number without anyone's having rounded it, has this.
set -u
version=3.3.14
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "geolib@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "geolib $version cannot be had: not looked at"; exit 2; }
echo "version: geolib $(node -p 'require("./node_modules/geolib/package.json").version')"
echo "expected: 700 m for the walk and 900 m for the ride, at every rate"
cat >t.js <<'JS'
const { getDistance, getPathLength, getPreciseDistance, getSpeed } = require("geolib");

// Fixes along a parallel, `speed` m/s for `seconds`, `hz` a second (the sphere of getDistance).
const metre = 180 / Math.PI / 6378137 / Math.cos(48.1 * Math.PI / 180);
const fixes = (speed, seconds, hz) => Array.from({ length: Math.round(seconds * hz) + 1 }, (_, i) =>
  ({ latitude: 48.1, longitude: 11.5 + speed * i / hz * metre, time: 1305031098000 + 1000 * i / hz }));
const cosine = (a, b) => getDistance(a, b, 1e-4), fine = (a, b) => getPreciseDistance(a, b, 1e-4);
const seen = {};
for (const [name, speed, seconds, hz] of [["walk, 0.1 Hz", 1.4, 500, 0.1], ["walk, 1 Hz", 1.4, 500, 1], ["walk, 5 Hz", 1.4, 500, 5],
  ["walk, 10 Hz", 1.4, 500, 10], ["ride, 1 Hz", 3, 300, 1], ["ride, 5 Hz", 3, 300, 5], ["ride, 10 Hz", 3, 300, 10]]) {
  const path = fixes(speed, seconds, hz);
  const r = seen[name] = { want: speed * seconds, length: getPathLength(path), precise: getPathLength(path, getPreciseDistance),
    cosine: getPathLength(path, cosine), fine: getPathLength(path, fine), speed: getSpeed(path[0], path[1]) };
  console.log(`seen, ${name}: ${r.length} m of ${r.want}, with getPreciseDistance ${r.precise}, speed ${r.speed.toFixed(2)} m/s; `
    + `getDistance with 1e-4 ${r.cosine.toFixed(2)}; beside it, getPreciseDistance with 1e-4: ${r.fine.toFixed(2)}`);
}
const is = (name, length) => seen[name].length === length;
process.exit(Object.values(seen).every((r) => Math.abs(r.fine - r.want) < 2) && Math.abs(seen["walk, 0.1 Hz"].length - 700) <= 10
  && is("walk, 1 Hz", 500) && is("walk, 5 Hz", 0) && is("walk, 10 Hz", 0) && is("ride, 1 Hz", 900) && is("ride, 5 Hz", 1500) && is("ride, 10 Hz", 0)
  && Math.abs(seen["walk, 5 Hz"].cosine - 672) < 5 && seen["walk, 5 Hz"].precise === 0 && seen["walk, 5 Hz"].speed === 0 ? 0 : 1);
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: metres are counted, not measured"
