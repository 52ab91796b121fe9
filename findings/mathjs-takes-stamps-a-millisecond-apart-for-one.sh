#!/usr/bin/env bash
# mathjs takes stamps a millisecond apart for one, and gives the second that follows as their floor
#
# One would swear: numbers in mathjs are doubles, which know today's seconds to a quarter of a
#   microsecond; floor(t) is the whole second, mod(t, 1) lies in [0, 1), sort sorts, min is the
#   smallest.
# What happens: all of these compare within a relative tolerance (relTol, 1e-12), which is 1.3 ms for
#   Unix seconds. The floor of 1305031102.9995 is 1305031103, mod(t, 1) is -0.0005, and the ceiling of
#   what is half a millisecond past a second is that second. sort leaves stamps of 5 kHz in the order
#   they came in, min gives one that is not the smallest, "larger" of two 1 ms apart is false,
#   setDistinct keeps 4 of 10. Unix time in nanoseconds, as numbers, compares likewise. Seconds from
#   the first frame are right, and so are Unix seconds with relTol set to 1e-15, which then holds for
#   everything.
# What follows: stamps are to be split into seconds and parts by Math.floor or whole numbers before
#   they reach mathjs; an association or a filter typed by a user (t > 1305031102.175) is to be
#   evaluated from zero. Events and an IMU of 1 kHz meet this; pictures at 30 Hz only at the turn of a
#   second, where one stamp in 900 gets the wrong second.
set -u
version=15.2.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "mathjs@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "mathjs $version cannot be had: not looked at"; exit 2; }
echo "version: mathjs $(node -p 'require("./node_modules/mathjs/package.json").version')"
echo "expected: what Math and Array give"
cat >t.mjs <<'JS'
import { all, create } from "mathjs";

const say = (name, r) => console.log(`seen, ${name}: the floor of .9995 is ${r.up ? "the next" : "its own"} second, `
  + `the ceiling of .0005 ${r.down ? "the last" : "the next"}, mod(t, 1) of .9995 ${r.rest.toFixed(4)}, `
  + `larger() 1 ms apart ${r.larger}, sorted ${r.sorted}, min ${r.min.toFixed(1)} ms late, ${r.distinct} of 10 distinct`);

// Ten stamps of 5 kHz in a mixed order; `unit` is one second, and `start` a whole one.
function look(math, start, unit) {
  const stamps = Array.from({ length: 10 }, (_, i) => start + 2e-4 * unit * ((7 * i + 3) % 10));
  const sorted = math.sort(stamps, "asc");
  return {
    up: math.floor((start + 0.9995 * unit) / unit) === start / unit + 1,
    down: math.ceil((start + 0.0005 * unit) / unit) === start / unit,
    rest: math.mod((start + 0.9995 * unit) / unit, 1),
    larger: math.larger(start + 1e-3 * unit, start),
    sorted: sorted.every((t, i) => i === 0 || t > sorted[i - 1]),
    min: (math.min(stamps) - start) / unit * 1000,
    distinct: math.setDistinct(stamps).length,
  };
}

const math = create(all);
const unix = look(math, 1305031102, 1), nanos = look(math, 1305031102e9, 1e9), zero = look(math, 2, 1);
math.config({ relTol: 1e-15 });
const strict = look(math, 1305031102, 1);
say("Unix seconds", unix);
say("Unix nanoseconds", nanos);
say("seconds from the first frame", zero);
say("Unix seconds, relTol 1e-15", strict);
const typed = create(all).evaluate("1305031102.1760 > 1305031102.1752");
console.log(`seen: "1305031102.1760 > 1305031102.1752" is ${typed}`);

// A 30 Hz camera for an hour: the seconds of how many stamps differ from Math.floor's?
const loose = create(all), frames = 108000;
let wrong = 0;
for (let i = 0; i < frames; i++) {
  const t = 1305031102.175304 + i * 0.0333337;
  if (loose.floor(t) !== Math.floor(t)) wrong++;
}
console.log(`seen: of ${frames} stamps at 30 Hz ${wrong} get the wrong second`);
const blurred = (r) => r.up && r.down && r.rest < 0 && !r.larger && !r.sorted && r.min > 0 && r.distinct < 10;
const right = (r) => !r.up && !r.down && r.rest > 0.999 && r.larger && r.sorted && r.min === 0 && r.distinct === 10;
process.exit(blurred(unix) && blurred(nanos) && right(zero) && right(strict) && typed === false
  && wrong > frames / 1000 && wrong < frames / 500 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: a millisecond is nothing to mathjs today"
