#!/usr/bin/env bash
# gps.js dates the fixes of a recorded log today, in between those that it dates rightly
#
# One would swear: the state that is built up from sentence to sentence has the date once an RMC or
#   ZDA has said it, and the GGA of the same epoch, which has a time of day only, changes the tenth of
#   a second at most.
# What happens: GGA and GLL put the day of the playback before their time of day, and state.time is
#   theirs until the next RMC: within one epoch of a log of 2011 it is 2011, today, 2011, today. What
#   a "data" event for GGA hands out, where height and quality are, is always today. In receivers'
#   order (RMC, GGA, GLL) the last word of every epoch is today's. A log over midnight goes back by a
#   day there; live, on the day itself, everything is right, and so it is in a test made with it.
# What follows: keep the date of the last RMC or ZDA oneself, and put it together with the time of day
#   (a step back by half a day or more is midnight); never read state.time after a GGA. A GPS truth
#   that begins years after the pictures, at the right hour, is this.
set -u
version=0.9.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "gps@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "gps $version cannot be had: not looked at"; exit 2; }
echo "version: gps $(node -p 'require("./node_modules/gps/package.json").version')"
echo "expected: 2011-05-10 and, after midnight, 2011-05-11 from every sentence"
cat >t.js <<'JS'
const module_ = require("gps"), GPS = module_.GPS ?? module_.default ?? module_;

const sentence = (text) => {
  const check = [...text].reduce((c, char) => c ^ char.charCodeAt(0), 0);
  return `$${text}*${check.toString(16).toUpperCase().padStart(2, "0")}`;
};
const place = "4806.00000,N,01130.00000,E";
const epoch = (clock, date) => [`GNRMC,${clock},A,${place},3.6,0.0,${date},,,A`,
  `GNGGA,${clock},${place},1,08,0.90,500.0,M,46.9,M,,`, `GNGLL,${place},${clock},A,A`];

const day = (time) => time.toISOString().slice(0, 10), clock = (time) => time.toISOString().slice(11, 22);
const before = day(new Date()), gps = new GPS(), seen = [], events = [];
gps.on("data", (data) => data.type === "GGA" && events.push(day(data.time)));
for (const [time, date] of [["120000.00", "100511"], ["235959.80", "100511"], ["000000.00", "110511"]]) {
  for (const text of epoch(time, date)) {
    gps.update(sentence(text));
    seen.push([text.slice(2, 5), day(gps.state.time), clock(gps.state.time)]);
  }
}
const after = day(new Date()), today = (d) => d === before || d === after;
for (const [kind, date, time] of seen) console.log(`seen, after ${kind}: ${today(date) ? "today" : date} ${time}`);
console.log(`seen: the three GGA events say ${events.map((d) => today(d) ? "today" : d)}`);
// The date of the last RMC kept beside it.
const own = [];
let last = null;
for (const [time, date] of [["120000.00", "100511"], ["235959.80", "100511"], ["000000.00", "110511"]]) {
  for (const text of epoch(time, date)) {
    const data = GPS.Parse(sentence(text));
    if (data.type === "RMC") last = day(data.time);
    own.push(last);
  }
}
console.log(`beside it, keeping the date of the RMC: ${own.join(" ")}`);
const days = ["2011-05-10", "2011-05-10", "2011-05-11"], clocks = ["12:00:00.00", "23:59:59.80", "00:00:00.00"];
const ok = seen.every(([kind, date, time], i) => time === clocks[Math.floor(i / 3)]
  && (kind === "RMC" ? date === days[Math.floor(i / 3)] : today(date)));
process.exit(ok && events.length === 3 && events.every(today) && own.every((d, i) => d === days[Math.floor(i / 3)]) ? 0 : 1);
JS
nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: recorded fixes are of today"
