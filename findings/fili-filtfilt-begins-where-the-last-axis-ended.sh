#!/usr/bin/env bash
# fili's filtfilt begins each axis where the last one ended, and the first at nothing
#
# One would swear: filtfilt, forwards and back, has no delay and, of a camera that stands still, gives
#   that place; the same input has the same output, whatever the filter has seen before.
# What happens: the filter is not set to the input's first value, nor set back between calls. Of 100 m
#   throughout the first sample comes out as 60, 11 of 300 are off by more than 1 m (all at the
#   beginning: the way back begins in the state in which the way there has ended, so that the end
#   is right). The next axis filtered with the same object, 0 m throughout, begins at -3.4; an axis
#   of 100 m after one of 5000 at -109. The same input twice gives two outputs. singleStep
#   and multiStep keep their state on purpose, but here both directions run within one call.
#   reinit() beforehand takes the state away, not the beginning; the first value subtracted before
#   and added after takes both away for a camera that stands.
# What follows: a new filter (or reinit) for every axis, the first value taken off; leave out the first
#   samples of what moves. SciPy's filtfilt, whose name it has, does both by itself.
set -u
version=2.0.3
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
want python3-scipy 1.10
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "fili@$version" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "fili $version cannot be had: not looked at"; exit 2; }
echo "version: fili $(node -p 'require("./node_modules/fili/package.json").version')"
echo "expected: 100 throughout, then 0 throughout"
scipy=$(/usr/bin/python3 -c 'from scipy.signal import butter, filtfilt
b, a = butter(2, 3 / 15)
print(max(abs(filtfilt(b, a, [100.0] * 300) - 100)))')
cat >t.js <<'JS'
const Fili = require("fili");

const coefficients = () => new Fili.CalcCascades().lowpass({ order: 2, characteristic: "butterworth", Fs: 30, Fc: 3 });
const fresh = () => new Fili.IirFilter(coefficients());
const still = (value) => Array(300).fill(value), range = (v) => `${v[0].toFixed(2)} ${v[1].toFixed(2)} ${v[2].toFixed(2)} ... ${v.at(-1).toFixed(2)}`;
const one = fresh(), x = one.filtfilt(still(100)), y = one.filtfilt(still(0)), again = fresh(), first = again.filtfilt(still(100)), second = again.filtfilt(still(100));
const off = x.filter((v) => Math.abs(v - 100) > 1).length;
console.log(`seen: 100 throughout becomes ${range(x)}, ${off} of 300 off by more than 1; the next axis, 0 throughout, ${range(y)}`);
console.log(`seen: 100 throughout once more becomes ${range(second)}`);
const utm = fresh();
utm.filtfilt(still(5000));
const after = utm.filtfilt(still(100));
console.log(`seen: 100 after an axis of 5000 becomes ${range(after)}`);
const reset = fresh();
reset.filtfilt(still(5000));
reset.reinit();
const clean = reset.filtfilt(still(100));
const own = (values) => fresh().filtfilt(values.map((v) => v - values[0])).map((v) => v + values[0]);
console.log(`beside it: after reinit ${range(clean)}; a new filter and the first value taken off ${range(own(still(100)))}; SciPy is off by ${process.argv[2]}`);
// No delay: a pulse stays where it is.
const pulse = fresh().filtfilt(Array.from({ length: 201 }, (_, i) => i === 100 ? 1 : 0)), sum = pulse.reduce((a, b) => a + b, 0);
const centre = pulse.reduce((a, v, i) => a + i * v, 0) / sum;
console.log(`seen: a pulse at 100 has its centre at ${centre.toFixed(3)} afterwards, sum ${sum.toFixed(3)}`);
const near = (a, b, e) => Math.abs(a - b) < e;
process.exit(x[0] > 50 && x[0] < 70 && off > 5 && off < 20 && near(x.at(-1), 100, 1e-6) && y[0] < -3 && y[0] > -4 && near(y.at(-1), 0, 1e-6)
  && first.every((v, i) => v === x[i]) && second.some((v, i) => Math.abs(v - first[i]) > 1) && after[0] < -100 && after[0] > -120
  && clean.every((v, i) => near(v, x[i], 1e-9)) && own(still(100)).every((v) => near(v, 100, 1e-9)) && Number(process.argv[2]) < 1e-6
  && near(centre, 100, 1e-6) && near(sum, 1, 1e-6) ? 0 : 1);
JS
nice node t.js "$scipy" 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: one axis begins with another"
