#!/usr/bin/env bash
# d3's %f and %L take few digits for few microseconds: .6659 of a second is 6.659 ms
#
# One would swear: "%s.%f" reads what stands behind the point as a part of a second, so that .6659 is
#   665.9 ms, as Python's %f does; stamps of any number of digits may be mixed.
# What happens: the digits are read as a whole number of microseconds (%L: milliseconds), however many
#   there are: .6659 is 6659 us and .5 nothing at all; with %L .5 is 5 ms. TUM's images have six
#   digits, its ground truth four, so that images are right to the millisecond and the truth beside
#   them is pressed into the first 10 ms of every second, off by up to 0.99 s, without any null.
#   Whatever prints times without zeros at the end (awk, %g, JavaScript) gives every tenth stamp of
#   six digits that way, and those alone go astray. The same in utcParse and ISO times.
# What follows: fill the digits up to six before the parser sees them, or split at the point and
#   reckon oneself. Poses that stand in heaps at whole seconds have this; with more than six digits
#   nothing is read, and parse gives null.
set -u
version=4.1.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "d3-time-format@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "d3-time-format $version cannot be had: not looked at"; exit 2; }
echo "version: d3-time-format $(node -p 'JSON.parse(require("fs").readFileSync("node_modules/d3-time-format/package.json")).version')"
echo "expected: 1305031098666 ms from 1305031098.6659, as from 1305031098.665900"
cat >t.mjs <<'JS'
import { execFileSync } from "node:child_process";
import { timeParse, utcParse } from "d3-time-format";

const micro = timeParse("%s.%f"), milli = timeParse("%s.%L"), iso = utcParse("%Y-%m-%dT%H:%M:%S.%f");
const ms = (date) => date === null ? null : date.getTime();
const seen = ["1305031098.665900", "1305031098.6659", "1305031098.5", "1305031098.05"].map((text) => [text, ms(micro(text)), ms(milli(text))]);
for (const [text, f, l] of seen) console.log(`seen, ${text}: %f ${f}, %L ${l}`);
const day = ["2011-05-10T12:38:18.665900", "2011-05-10T12:38:18.6659"].map((text) => ms(iso(text)));
const python = execFileSync("/usr/bin/python3", ["-c",
  "from datetime import datetime as d; print(d.strptime('12:38:18.6659', '%H:%M:%S.%f').microsecond)"]).toString().trim();
console.log(`seen, as ISO times: ${day.map((v) => v % 1000)} ms behind the second; Python's %f: ${python} microseconds`);

// 10 s of a truth at 100 Hz with four digits, as TUM has them.
const stamps = Array.from({ length: 1000 }, (_, i) => (1305031098.6659 + i * 0.01).toFixed(4));
const exact = (text) => { const [s, part] = text.split("."); return Number(s) * 1000 + Math.floor(Number(part.padEnd(6, "0").slice(0, 6)) / 1000); };
const off = stamps.map((text) => Math.abs(ms(micro(text)) - exact(text)));
const filled = stamps.map((text) => Math.abs(ms(micro(text.padEnd(17, "0"))) - exact(text)));
const back = stamps.filter((text, i) => i > 0 && ms(micro(text)) < ms(micro(stamps[i - 1]))).length;
const last = Math.max(...stamps.map((text) => ms(micro(text)) % 1000));
console.log(`seen: 1000 stamps of four digits are off by up to ${Math.max(...off)} ms, all within ${last + 1} ms behind a whole second, `
  + `${back} go back`);
console.log(`beside it, filled up to six digits: off by up to ${Math.max(...filled)} ms`);
// Six digits less the zeros at their end.
const trimmed = Array.from({ length: 1000 }, (_, i) => String((1305031098175304 + i * 33331) / 1e6));
const astray = trimmed.filter((text) => ms(micro(text)) !== exact(text)), short = trimmed.filter((text) => text.length < 17);
console.log(`seen: of 1000 stamps printed without zeros at the end ${short.length} have less than six digits, ${astray.length} go astray`);
const want = 1305031098000;
process.exit(seen[0][1] === want + 665 && seen[1][1] === want + 6 && seen[2].slice(1).join() === [want, want + 5].join()
  && seen[3][2] === want + 5 && day[0] % 1000 === 665 && day[1] % 1000 === 6 && python === "665900"
  && Math.max(...off) > 980 && last < 10 && Math.max(...filled) === 0 && astray.length > 80 && astray.length <= short.length ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: digits are counted from the wrong end"
