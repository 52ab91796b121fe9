#!/usr/bin/env bash
# density-clustering counts points of its clusters as noise, and which ones hangs on their order
#
# One would swear: after DBSCAN every point is in one cluster or it is noise, and the two add up.
# What happens: a point at the border of a cluster that is looked at before the cluster is found goes
#   into noise, and stays there when the cluster takes it in later. Of 0, 1, 2 with a reach of 1.5 and
#   3 points the cluster is 1, 0, 2 and the noise is 0; put 1 first, and there is none. Of 300
#   flow vectors of three objects and clutter, from the top down, 6 of the 80 in noise are inside
#   clusters. Also the reach is open: points exactly one reach apart are not neighbours, as they are
#   for scikit-learn, so that all pixels of a grid are noise with a reach of 1. What is in no cluster
#   is otherwise the same as there.
# What follows: take noise as what is in no cluster, never from .noise; and give a reach between the
#   grid's steps (1.01). Objects whose outlines are dropped as outliers, differently each time the
#   points come in another order, have this.
set -u
version=1.3.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
have() { dpkg-query -W -f '${Version}' "$1" 2>/dev/null; }
want() { # package, start of its version
  [ -n "$(have "$1")" ] || { apt-get update -qq && apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=300 "$1"; } >"$tmp/apt.log" 2>&1
  case $(have "$1") in
    "$2"*) echo "version: $1 $(have "$1")" ;;
    *) echo "$1 '$(have "$1")', wanted $2: not looked at"; exit 2 ;;
  esac
}
want python3-sklearn 1.2.1
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "density-clustering@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "density-clustering $version cannot be had: not looked at"; exit 2; }
echo "version: density-clustering $(node -p 'require("./node_modules/density-clustering/package.json").version')"
echo "expected: clusters and noise add up to the points"
cat >t.py <<'PY'
import json
import sys

import numpy as np
from sklearn.cluster import DBSCAN

given = json.load(sys.stdin)
print(json.dumps([DBSCAN(eps=g["reach"], min_samples=g["least"]).fit(np.array(g["points"], float)).labels_.tolist() for g in given]))
PY
cat >t.js <<'JS'
const { execFileSync } = require("node:child_process"), { DBSCAN } = require("density-clustering");

let seed = 7;
const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
const normal = () => Math.sqrt(-2 * Math.log(random())) * Math.cos(2 * Math.PI * random());
const flow = Array.from({ length: 300 }, (_, i) => i % 5 === 4 ? [30 * random() - 15, 30 * random() - 15]
  : [[0, 0], [6, 1], [-3, 5]][i % 3].map((c) => c + normal()));
flow.sort((a, b) => a[1] - b[1]);
const grid = Array.from({ length: 100 }, (_, i) => [i % 10, Math.floor(i / 10)]);
const cases = { "0 1 2": [[[0], [1], [2]], 1.5, 3], "1 0 2": [[[1], [0], [2]], 1.5, 3], flow: [flow, 0.8, 6],
  "grid, reach 1": [grid, 1, 4], "grid, reach 1.01": [grid, 1.01, 4] };
const python = JSON.parse(execFileSync("/usr/bin/python3", ["t.py"], { input: JSON.stringify(Object.values(cases).map(([points, reach, least]) => ({ points, reach, least }))) }));
const seen = {};
Object.entries(cases).forEach(([name, [points, reach, least]], k) => {
  const by = new DBSCAN(), clusters = by.run(points, reach, least), inside = new Set(clusters.flat());
  const both = by.noise.filter((i) => inside.has(i)), outside = points.map((_, i) => i).filter((i) => !inside.has(i));
  const noise = python[k].map((l, i) => l < 0 ? i : -1).filter((i) => i >= 0);
  seen[name] = { points: points.length, inside: inside.size, noise: by.noise.length, both: both.length, clusters: clusters.length,
    same: outside.join() === noise.join(), theirs: noise.length };
  const r = seen[name];
  console.log(`seen, ${name}: ${r.points} points, ${r.inside} in ${r.clusters} clusters, ${r.noise} called noise, ${r.both} of them in a cluster; `
    + `scikit-learn has ${r.theirs} noise, what is in no cluster is the same: ${r.same}`);
});
const is = (name, want) => Object.entries(want).every(([k, v]) => seen[name][k] === v);
process.exit(is("0 1 2", { inside: 3, noise: 1, both: 1, theirs: 0, same: true }) && is("1 0 2", { inside: 3, noise: 0 })
  && seen.flow.both >= 3 && seen.flow.same && seen.flow.noise === seen.flow.theirs + seen.flow.both && seen.flow.clusters >= 3
  && is("grid, reach 1", { clusters: 0, noise: 100, theirs: 0 }) && is("grid, reach 1.01", { clusters: 1, inside: 100, same: true }) ? 0 : 1);
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: noise and clusters overlap"
